"""Machine code is made once, whoever needs it at the same time."""

import os
import pathlib
import pickle
import shutil
import subprocess
import sys

from helpers.disk import full_disk
from push_dynamics.compiled import IS_COMPILED
from push_dynamics.private_folder import PrivateFolder
import pytest

MODULE = """
from push_dynamics.compiled import compiled

@compiled
def power(base, exponent):
    return base * power_of_even(base, exponent - 1) if exponent % 2 else power_of_even(
        base, exponent)

@compiled
def power_of_even(base, exponent):
    result = 1.0
    for _ in range(exponent // 2):
        result *= base * base
    return result
"""
SCRIPT = """
import sys
import power
input()
print(power.power(2.0, 10), sum(dispatcher.stats.cache_misses.total() for dispatcher in (
    power.power.dispatcher, power.power_of_even.inner_dispatcher)),
    'numba.cpython.cmathimpl' in sys.modules)
"""

CALLED_BEFORE = """
import power
print(power.power_of_even(2.0, 4), power.power(2.0, 10),
      len(power.power_of_even.inner_dispatcher.overloads))
"""

USED = """
import power
print(power.power(2.0, 10), sum(dispatcher.stats.cache_misses.total() for dispatcher in (
    power.power.dispatcher, power.power_of_even.inner_dispatcher)))
"""


class Attack:
    """A pickled object that makes a file when it is loaded."""

    def __init__(self, path):
        self.path = path

    def __reduce__(self):
        return pathlib.Path.touch, (self.path,)


@pytest.fixture(scope='module')
def compiled_once(tmp_path_factory):
    """Compile ``MODULE``, and keep a copy of its machine code."""
    folder = tmp_path_factory.mktemp('compiled')
    (folder / 'power.py').write_text(MODULE)
    assert run(folder).stdout.split() == ['1024.0', '2']
    shutil.copytree(folder / 'cache', folder / 'whole')
    return folder


@pytest.fixture
def power_cache(compiled_once):
    """Fill the cache with that machine code."""
    shutil.rmtree(compiled_once / 'cache', ignore_errors=True)
    shutil.copytree(compiled_once / 'whole', compiled_once / 'cache')
    return compiled_once


def run(folder):
    """Call what is compiled; print the result, and how many functions were not in the cache."""
    environment = {**os.environ, 'NUMBA_CACHE_DIR': str(folder / 'cache'),
                   'PYTHONPATH': os.pathsep.join([str(folder), *sys.path])}
    return subprocess.run([sys.executable, '-c', USED], env=environment, text=True,
                          capture_output=True, check=True)


def contents(folder):
    """List the files of a cache that are not empty."""
    return [path for path in sorted((folder / 'cache').rglob('*'))
            if path.is_file() and path.stat().st_size]


@pytest.mark.slow
@pytest.mark.skipif(not IS_COMPILED, reason='numba is not installed')
def test_machine_code_that_is_spoilt_is_made_again(power_cache):
    """In every file, and once; ``test_private_folder`` has more ways to spoil one."""
    cut_off, flipped = contents(power_cache)
    cut_off.write_bytes(cut_off.read_bytes()[:-1])
    content = bytearray(flipped.read_bytes())
    content[-300] ^= 64
    flipped.write_bytes(content)
    assert run(power_cache).stdout.split() == ['1024.0', '2']
    assert run(power_cache).stdout.split() == ['1024.0', '0']


@pytest.mark.slow
@pytest.mark.skipif(not IS_COMPILED, reason='numba is not installed')
def test_an_object_of_others_in_the_cache_is_not_loaded(power_cache, tmp_path):
    """In place of a file, by whoever could write to it once."""
    for path in contents(power_cache):
        path.write_bytes(pickle.dumps(Attack(tmp_path / 'attacked')))
    assert run(power_cache).stdout.split() == ['1024.0', '2']
    assert not (tmp_path / 'attacked').exists()


@pytest.mark.slow
@pytest.mark.skipif(not IS_COMPILED, reason='numba is not installed')
def test_nothing_is_loaded_from_a_cache_that_others_may_write_to(power_cache, tmp_path):
    """Even with digests that fit; the program goes on without a cache, and says so once."""
    for path in contents(power_cache):
        PrivateFolder(path.parent).write(path.name, pickle.dumps(Attack(tmp_path / 'attacked')))
    (power_cache / 'cache').chmod(0o777)
    done = run(power_cache)
    assert done.stdout.split() == ['1024.0', '2']
    assert not (tmp_path / 'attacked').exists()
    assert done.stderr.count('others may write to it') == 1


@pytest.mark.slow
@pytest.mark.skipif(not IS_COMPILED, reason='numba is not installed')
@pytest.mark.skipif(os.geteuid() != 0, reason='only the superuser makes folders of others')
def test_nothing_is_loaded_from_a_cache_of_another_user(power_cache, tmp_path):
    """Even with digests that fit, by the superuser least of all."""
    for path in contents(power_cache):
        PrivateFolder(path.parent).write(path.name, pickle.dumps(Attack(tmp_path / 'attacked')))
    os.chown(power_cache / 'cache' / 'push_control', 65534, -1)
    done = run(power_cache)
    assert done.stdout.split() == ['1024.0', '2']
    assert not (tmp_path / 'attacked').exists()
    assert done.stderr.count('of user 65534') == 1


@pytest.mark.slow
@pytest.mark.skipif(not IS_COMPILED, reason='numba is not installed')
def test_a_full_disk_is_no_cache(power_cache):
    """The program goes on and says so once."""
    shutil.rmtree(power_cache / 'cache')
    with full_disk(100):
        done = run(power_cache)
    assert done.stdout.split() == ['1024.0', '2']
    assert done.stderr.count('File too large') == 1


@pytest.mark.slow
@pytest.mark.skipif(not IS_COMPILED, reason='numba is not installed')
def test_what_python_has_called_is_not_compiled_again(tmp_path: pathlib.Path) -> None:
    """Other compiled functions call the same machine code."""
    (tmp_path / 'power.py').write_text(MODULE)
    environment = {**os.environ, 'NUMBA_CACHE_DIR': str(tmp_path),
                   'PYTHONPATH': os.pathsep.join([str(tmp_path), *sys.path])}
    done = subprocess.run([sys.executable, '-c', CALLED_BEFORE], env=environment, text=True,
                          capture_output=True, check=True)
    assert done.stdout.split() == ['16.0', '1024.0', '0']


@pytest.mark.slow
@pytest.mark.skipif(not IS_COMPILED, reason='numba is not installed')
def test_processes_that_start_together_compile_once(tmp_path):
    """One compiles both functions; the other loads them, without what compilers need."""
    (tmp_path / 'power.py').write_text(MODULE)
    environment = {**os.environ, 'NUMBA_CACHE_DIR': str(tmp_path),
                   'PYTHONPATH': os.pathsep.join([str(tmp_path), *sys.path])}
    processes = [subprocess.Popen([sys.executable, '-c', SCRIPT], env=environment, text=True,
                                  stdin=subprocess.PIPE, stdout=subprocess.PIPE)
                 for _ in range(2)]
    for process in processes:
        process.stdin.write('\n')
        process.stdin.flush()
    printed = sorted(process.communicate()[0].split() for process in processes)
    assert printed == [['1024.0', '0', 'False'], ['1024.0', '2', 'True']]


@pytest.mark.slow
@pytest.mark.skipif(not IS_COMPILED, reason='numba is not installed')
def test_machine_code_for_a_type_that_is_gone_is_made_again(tmp_path):
    """As where an update has renamed it, in a module elsewhere."""
    for folder in ('functions', 'types', 'cache'):
        (tmp_path / folder).mkdir()
    (tmp_path / 'functions' / 'rectangle.py').write_text(
        'from push_dynamics.compiled import compiled\n\n'
        '@compiled\ndef area(size):\n    return size.x * size.y\n')
    environment = {**os.environ, 'NUMBA_CACHE_DIR': str(tmp_path / 'cache'),
                   'PYTHONPATH': os.pathsep.join([str(tmp_path / 'functions'),
                                                  str(tmp_path / 'types'), *sys.path])}
    for name in ('Size', 'Extent', 'Extent'):
        (tmp_path / 'types' / f'{name.lower()}s.py').write_text(
            f"from typing import NamedTuple\n\n{name} = NamedTuple('{name}', x=float, y=float)\n")
        script = (f'import rectangle, {name.lower()}s\n'
                  f'print(rectangle.area({name.lower()}s.{name}(2.0, 3.0)))')
        done = subprocess.run([sys.executable, '-c', script], env=environment, text=True,
                              capture_output=True, check=True)
        assert done.stdout.strip() == '6.0'
        (tmp_path / 'types' / 'sizes.py').unlink(missing_ok=True)
