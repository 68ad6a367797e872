"""Machine code of casadi functions: the same numbers as casadi's, row by row."""

import os
import subprocess
import sys
from typing import Any

import casadi as ca
import numpy as np
from push_dynamics.machine_code import RowFunction, RowSequence
import pytest

# Machine code from files of which much has gone wrong, one after the other.
SPOILT = """
import pathlib, sys
import casadi as ca
import numpy as np
from push_dynamics.machine_code import RowFunction

def evaluate():
    x = ca.SX.sym('x')
    results = np.zeros((3, 1))
    RowFunction(ca.Function('f', [x], [ca.sin(x) + x ** 2], ['x'], ['results'])).bind(
        {'x': np.array([[1.0], [2.0], [3.0]]), 'results': results})()
    return results.tolist()

expected = evaluate()
files = list(pathlib.Path(sys.argv[1]).rglob('*.o'))
whole = [file.read_bytes() for file in files]
for place in (0.0, 0.01, 0.1, 0.5, 0.9, 0.999):
    for is_cut in (True, False):
        for file, content in zip(files, whole):
            k = int(place * len(content))
            file.write_bytes(content[:k] if is_cut else
                             content[:k] + bytes([content[k] ^ 255]) + content[k + 1:])
        assert evaluate() == expected, (place, is_cut)
        assert [file.read_bytes() for file in files] == whole, (place, is_cut)
print(len(files))
"""


def scalar_function():
    """Use every kind of operation, in two arguments."""
    x, y = ca.SX.sym('x', 2), ca.SX.sym('y')
    results = ca.vertcat(
        ca.sin(x[0]) * ca.cos(y), ca.sqrt(ca.fabs(x[1])) / y, ca.atan2(x[0], y), x[0] ** 2 - y,
        ca.if_else(x[0] > x[1], y, -x[1]), ca.fmax(x[0], ca.fmin(x[1], y)), 2.0 * x[0] + 1.0 / y,
        ca.exp(-y) + ca.log(ca.fabs(x[0])), ca.logic_not(x[0] > y), ca.tan(0.1 * y), y ** 2.5)
    return ca.Function('scalar', [x, y], [results], ['x', 'y'], ['results'])


@pytest.mark.parametrize('count', [1, 2, 8, 21])
@pytest.mark.parametrize('options', [{}, {'is_independent': True}, {'is_compiled': False}],
                         ids=str)
def test_machine_code_computes_what_casadi_does(options, count):
    """Also several rows at once, where an argument is the same in all, where nothing compiles."""
    function = scalar_function()
    rng = np.random.default_rng(3)
    x, y = rng.normal(size=(count, 2)), np.array([1.7])
    results = np.zeros((count, 11))
    RowFunction(function, **options).bind({'x': x, 'y': y, 'results': results})()
    expected = [np.array(function(row, y)).ravel() for row in x]
    np.testing.assert_allclose(results, expected, rtol=1e-13, atol=1e-14)


def test_a_row_goes_on_from_the_one_before():
    """Forward and, in reversed views, backward."""
    x = ca.SX.sym('x')
    twice = RowFunction(ca.Function('twice', [x], [2.0 * x], ['x'], ['next']))
    values = np.zeros((5, 1))
    values[0] = 1.0
    twice.bind({'x': values[:-1], 'next': values[1:]})()
    assert values.ravel().tolist() == [1.0, 2.0, 4.0, 8.0, 16.0]
    twice.bind({'x': values[:0:-1], 'next': values[-2::-1]})()
    assert values.ravel().tolist() == [256.0, 128.0, 64.0, 32.0, 16.0]


@pytest.mark.parametrize('options', [{}, {'is_independent': True}, {'is_compiled': False}],
                         ids=str)
def test_rows_of_a_gathered_argument_are_picked_by_number(options):
    """In any order, some of them often, others not at all."""
    rng = np.random.default_rng(5)
    x, y, results = rng.normal(size=(3, 2)), rng.uniform(1.0, 2.0, (7, 1)), np.zeros((7, 11))
    numbers = np.array([2, 0, 0, 2, 2, 0, 2])
    RowFunction(scalar_function(), gathered=['x'], **options).bind(
        {'x': x, 'y': y, 'results': results}, numbers)()
    expected = [np.array(scalar_function()(x[k], value)).ravel() for k, value in zip(numbers, y)]
    np.testing.assert_allclose(results, expected, rtol=1e-13, atol=1e-14)


@pytest.mark.parametrize('options', [{}, {'is_independent': True}, {'is_compiled': False}],
                         ids=str)
def test_a_call_evaluates_as_many_rows_as_it_is_given(options):
    """More than the memory of before has, and fewer; results of before stay as they are."""
    function, rng = RowFunction(scalar_function(), **options), np.random.default_rng(6)
    y = np.array([1.3])
    found = []
    for count in (3, 700, 5):
        x = rng.normal(size=(count, 2))
        results, = function({'x': x, 'y': y})
        found.append((results, [np.array(scalar_function()(row, y)).ravel() for row in x]))
    for results, expected in found:
        np.testing.assert_allclose(results, expected, rtol=1e-13, atol=1e-14)


@pytest.mark.parametrize('options', [{}, {'is_compiled': False}], ids=str)
def test_a_sequence_goes_on_from_what_its_parts_leave(options: dict[str, Any]) -> None:
    """Each over all its rows, or the first ones; sequences of sequences are one."""
    x = ca.SX.sym('x')
    twice = RowFunction(ca.Function('twice', [x], [2.0 * x], ['x'], ['next']), **options)
    more = RowFunction(ca.Function('more', [x], [x + 1.0], ['x'], ['next']), **options)
    first, second, third = np.array([[1.0], [2.0], [3.0]]), np.zeros((3, 1)), np.zeros((3, 1))
    doubled, added = (twice.bind({'x': first, 'next': second}),
                      more.bind({'x': second, 'next': third}))
    sequence = RowSequence(RowSequence(doubled), added)
    sequence()
    assert third.ravel().tolist() == [3.0, 5.0, 7.0]
    first[:] = 10.0
    doubled.count[0], added.count[0] = 2, 1
    sequence()
    assert second.ravel().tolist() == [20.0, 20.0, 6.0]
    assert third.ravel().tolist() == [21.0, 5.0, 7.0]


def test_rows_of_another_size_are_refused():
    """By their name."""
    function = RowFunction(scalar_function())
    with pytest.raises(ValueError, match='x: got shape'):
        function.bind({'x': np.zeros((3, 4)), 'y': np.ones(1), 'results': np.zeros((3, 11))})


@pytest.mark.slow
def test_machine_code_that_is_spoilt_is_made_again(tmp_path):
    """Cut off or with a wrong byte, in each part of a file; nothing of it is run."""
    pytest.importorskip('llvmlite')
    done = subprocess.run([sys.executable, '-c', SPOILT, str(tmp_path)], text=True,
                          env={**os.environ, 'NUMBA_CACHE_DIR': str(tmp_path),
                               'PYTHONPATH': os.pathsep.join(sys.path)}, capture_output=True)
    assert (done.returncode, done.stdout.strip()) == (0, '1'), done.stderr
