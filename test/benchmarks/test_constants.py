"""Constants that a benchmark changes: all that use them see it, and only then."""

import ast
import importlib
import inspect

from benchmarks.tasks.constants import Constant, CONSTANTS, replaced, value_of
from push_scenario.dds import result
from push_scenario.simulation import loop
import pytest


@pytest.mark.parametrize('constant', CONSTANTS, ids=lambda constant: constant.name)
def test_a_constant_is_replaced_and_put_back(constant: Constant) -> None:
    """Each that is listed exists, and is a positive number."""
    original = value_of(constant)
    assert original > 0.0
    with replaced(constant, 2.0 * original):
        assert value_of(constant) == 2.0 * original
    assert value_of(constant) is original


@pytest.mark.parametrize('constant', CONSTANTS, ids=lambda constant: constant.name)
def test_no_value_is_derived_of_a_constant_before_it_is_replaced(constant: Constant) -> None:
    """Modules read it in functions alone; what they have computed at import would stay."""
    source = inspect.getsource(importlib.import_module(constant.module))
    assert lines_read_at_import(source, constant.name) == []


@pytest.mark.parametrize('line', ['TWICE = 2.0 * STD', 'def f(std=STD): pass',
                                  'class A: std = STD', 'f = lambda std=STD: std'])
def test_a_value_that_is_derived_at_import_is_found(line: str) -> None:
    """Also as a default, or in a class."""
    assert lines_read_at_import(f'STD = 0.1\n{line}\n', 'STD') == [2]
    assert lines_read_at_import('STD = 0.1\ndef f():\n    return STD\n', 'STD') == []


def lines_read_at_import(source: str, name: str) -> list[int]:
    """List the lines in which a name is read outside of the bodies of functions."""
    found: list[int] = []

    def visit(node: ast.AST) -> None:
        if isinstance(node, ast.Name) and node.id == name and isinstance(node.ctx, ast.Load):
            found.append(node.lineno)
        is_function = isinstance(node, (ast.FunctionDef, ast.Lambda))
        for child in ast.iter_child_nodes(node.args if is_function else node):
            visit(child)
    visit(ast.parse(source))
    return found


def test_a_module_that_imports_a_constant_sees_the_other_value() -> None:
    """Also where an error ends the run."""
    constant = Constant('push_scenario.simulation.loop', 'REST_SPEED', 'm/s', '')
    original = loop.REST_SPEED
    assert result.REST_SPEED is original
    with pytest.raises(ZeroDivisionError), replaced(constant, 1.0):
        assert result.REST_SPEED == 1.0
        raise ZeroDivisionError
    assert result.REST_SPEED is loop.REST_SPEED is original
