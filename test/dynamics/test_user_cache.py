"""The user's cache: what is used stays, whatever else happens at the same time."""

from concurrent.futures import ThreadPoolExecutor
import os
import re
import threading
import time

from push_dynamics.cache_activity import CacheActivity, USUAL_FUNCTIONS
from push_dynamics.cli import main
from push_dynamics.private_folder import warn_once
import push_dynamics.user_cache
from push_dynamics.user_cache import cached_files, DAY, user_cache
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


def test_the_cache_is_bounded_and_what_was_read_last_stays(cache, monkeypatch):
    """Files go, whatever folder they are in, the longest unused first."""
    monkeypatch.setattr(push_dynamics.user_cache, 'MAX_SIZE', 1000.0)
    folder = user_cache(USED)
    for index in range(8):
        folder.write(f'{index}.npz', bytes(200))
        age(folder.path / f'{index}.npz', 8.0 - index)
    assert folder.read('0.npz') == bytes(200)
    age(cache / 'pruned', 1.1)
    user_cache(USED)
    left = {file.path.name for file in cached_files() if file.path.suffix == '.npz'}
    assert left == {'0.npz', '6.npz', '7.npz'}
    assert sum(file.size for file in cached_files()) <= 0.75 * 1000.0


def test_the_command_shows_and_clears_the_cache(cache, capsys):
    user_cache(USED).write('table-1.npz', bytes(2000000))
    user_cache(USED).write('push.code', bytes(1000000))
    assert main([]) == 0
    shown = capsys.readouterr().out
    assert str(cache) in shown and 'cleared' not in shown
    assert re.search(r'machine code +1 files +1.0 MB', shown)
    assert re.search(r'tables of pushes +1 files +2.0 MB', shown)
    assert main(['--clear']) == 0
    assert cached_files() == [] and names(cache) == set()
    assert user_cache(USED).read('push.code') is None


def test_what_is_new_in_the_cache_is_told(cache):
    """Code by its number, also that which was there, in folders that are in use; then tables."""
    user_cache(USED).write('old.code', b'code')
    age(cache / USED, 3.0)
    activity = CacheActivity()
    assert activity() == ''
    folder = user_cache(USED)
    assert activity() == ''
    folder.write('new.code', b'code')
    assert activity() == f'compiling 2 of about {USUAL_FUNCTIONS}'
    with folder.reserved('table-1.npz'):
        assert activity() == 'table of pushes, step 1 of 2'
        folder.write('table-1.npz', b'table')
    with folder.reserved('cost-1.npz'):
        assert activity() == 'table of pushes, step 2 of 2'
        folder.write('cost-1.npz', b'cost')
    assert 'table' not in activity()


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
