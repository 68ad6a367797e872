"""Machine code is made once, whoever needs it at the same time."""

import os
import pathlib
import subprocess
import sys

from push_dynamics.compiled import IS_COMPILED
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
import power
input()
print(power.power(2.0, 10), sum(dispatcher.stats.cache_misses.total() for dispatcher in (
    power.power.dispatcher, power.power_of_even.inner_dispatcher)))
"""

CALLED_BEFORE = """
import power
print(power.power_of_even(2.0, 4), power.power(2.0, 10),
      len(power.power_of_even.inner_dispatcher.overloads))
"""


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
    """One compiles both functions, the other loads them."""
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
    assert printed == [['1024.0', '0'], ['1024.0', '2']]


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
