"""The user's cache: what is used stays, whatever else happens at the same time."""

from concurrent.futures import ThreadPoolExecutor
import os
import threading
import time

from push_dynamics.user_cache import DAY, user_cache
import pytest

USED, UNUSED, RECENT = '0123456789abcdef', 'fedcba9876543210', '0000000000000001'
# Of others, or of no version.
STRANGERS = ('expressions', 'mine', '0123')
PROCESSES = 8


@pytest.fixture
def cache(tmp_path, monkeypatch):
    """Fill a cache with directories of several ages, each with a file."""
    monkeypatch.delenv('NUMBA_CACHE_DIR', raising=False)
    monkeypatch.setenv('XDG_CACHE_HOME', str(tmp_path))
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
    assert user_cache(USED) == str(cache / USED)
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
        return user_cache(name)
    with ThreadPoolExecutor(PROCESSES) as threads:
        assert list(threads.map(ask, wanted)) == [str(cache / name) for name in wanted]
    assert all((cache / name).is_dir() for name in (*wanted, RECENT, *STRANGERS))
    assert not list(cache.glob('.removed*'))


def test_a_cache_that_cannot_be_written_to_is_none(tmp_path, monkeypatch):
    """As where a file is in its place."""
    (tmp_path / 'push_control').write_bytes(b'')
    monkeypatch.setenv('NUMBA_CACHE_DIR', str(tmp_path))
    assert user_cache(USED) is None
