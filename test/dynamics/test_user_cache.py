"""The user's cache: what is used stays, whatever else happens at the same time."""

from concurrent.futures import ThreadPoolExecutor
import os
import threading
import time

from push_dynamics.private_folder import warn_once
from push_dynamics.user_cache import DAY, user_cache
import pytest

USED, UNUSED, RECENT = '0123456789abcdef', 'fedcba9876543210', '0000000000000001'
# Of others, or of no version.
STRANGERS = ('machine_code', 'mine', '0123')
PROCESSES = 8


@pytest.fixture
def cache(tmp_path, monkeypatch):
    """Fill a cache with directories of several ages, each with a file."""
    monkeypatch.delenv('NUMBA_CACHE_DIR', raising=False)
    monkeypatch.setenv('XDG_CACHE_HOME', str(tmp_path))
    warn_once.cache_clear()
    folder = tmp_path / 'push_control'
    for name in (USED, UNUSED, RECENT, *STRANGERS):
        (folder / name / 'inner').mkdir(parents=True)
        (folder / name / 'inner' / 'code').write_bytes(b'code')
        age(folder / name, 29.0 if name == RECENT else 31.0)
    return folder


def age(path, days):
    """Let a directory or file be of former days."""
    then = time.time() - days * DAY
    os.utime(path, (then, then))


def names(folder):
    """List the directories that are complete."""
    return {path.parents[1].name for path in folder.glob('*/inner/code')}


def test_what_nobody_uses_is_removed_after_a_month(cache):
    """Not what is asked for now, nor what does not belong to a version."""
    assert user_cache(USED).path == cache / USED
    assert names(cache) == {USED, RECENT, *STRANGERS}
    assert not list(cache.glob('.removed*'))


def test_it_is_looked_for_once_a_day(cache):
    """A start costs nothing else."""
    user_cache(USED)
    (cache / UNUSED).mkdir()
    age(cache / UNUSED, 31.0)
    user_cache(USED)
    assert (cache / UNUSED).exists()
    age(cache / 'pruned', 1.1)
    user_cache(USED)
    assert not (cache / UNUSED).exists()


def test_several_processes_may_do_it_at_once(cache):
    """Whoever asks for a directory has it, be it an old one, and an interrupted removal ends."""
    (cache / UNUSED).rename(cache / f'.removed-{UNUSED}')
    wanted = [USED, *(f'{number:016x}' for number in range(2, 1 + PROCESSES))]
    start = threading.Barrier(PROCESSES)

    def ask(name):
        start.wait()
        return user_cache(name).path
    with ThreadPoolExecutor(PROCESSES) as threads:
        assert list(threads.map(ask, wanted)) == [cache / name for name in wanted]
    assert all((cache / name).is_dir() for name in (*wanted, RECENT, *STRANGERS))
    assert not list(cache.glob('.removed*'))


def test_a_cache_that_cannot_be_written_to_is_none(tmp_path, monkeypatch):
    """As where a file is in its place; the program goes on, and says so once."""
    (tmp_path / 'push_control').write_bytes(b'')
    monkeypatch.setenv('NUMBA_CACHE_DIR', str(tmp_path))
    with pytest.warns(RuntimeWarning, match=f'{tmp_path}.*without a cache') as warned:
        assert user_cache(USED) is None
        assert user_cache(UNUSED) is None
    assert len(warned) == 1


def test_a_cache_that_others_may_write_to_is_none(cache):
    """Nothing of theirs is run, and the warning names the folder and what to do."""
    cache.chmod(0o777)
    with pytest.warns(RuntimeWarning, match=f'{cache}: got mode 777.*chmod go-w'):
        assert user_cache(USED) is None


@pytest.mark.skipif(os.geteuid() == 0, reason='the superuser writes to every folder')
def test_a_cache_that_is_read_only_is_read(cache):
    """What it lacks is made without it."""
    user_cache(USED).write('code', b'code')
    folders = (cache / USED, cache)
    for folder in folders:
        folder.chmod(0o500)
    try:
        assert user_cache(USED).read('code') == b'code'
        with pytest.warns(RuntimeWarning, match='Permission denied'):
            assert user_cache(USED).read_or_make('more', lambda: b'more') == b'more'
        with pytest.warns(RuntimeWarning, match='without a cache'):
            assert user_cache('0123456789abcdee') is None
    finally:
        for folder in folders:
            folder.chmod(0o700)
