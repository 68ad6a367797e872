"""The public API: a scenario is simulated, measured, reported and drawn in five lines."""

import subprocess
import sys

import push_scenario
import pytest

LAZY = ('casadi', 'matplotlib', 'numba', 'rclpy')


@pytest.mark.slow
def test_five_lines_do(tmp_path):
    """As the docstring of the package has them."""
    scenario = push_scenario.load_scenario('straight_push')
    result = push_scenario.simulate(scenario)
    assert push_scenario.measure(result).within_bounds and push_scenario.is_as_expected(result)
    assert 'final position error' in push_scenario.format_report([result])
    push_scenario.draw_figure([result], tmp_path / 'push.png')
    assert (tmp_path / 'push.png').stat().st_size > 10_000


@pytest.mark.parametrize('name', push_scenario.__all__)
def test_every_public_name_is_there_and_documented(name):
    """And listed by ``dir``."""
    assert getattr(push_scenario, name).__doc__
    assert name in dir(push_scenario)


def test_an_unknown_name_is_refused():
    with pytest.raises(AttributeError, match='push_scenario.*solve'):
        push_scenario.solve


@pytest.mark.slow
def test_nothing_heavy_is_imported_before_it_is_used():
    """Neither by the package nor by its files of scenarios."""
    assert loaded('push_scenario, push_model.files.data') == []
    # Not even numpy.
    assert loaded('push_model, push_planner, push_control', ('numpy', *LAZY)) == []


@pytest.mark.slow
@pytest.mark.parametrize('module, heavy', [
    ('push_scenario.cli', LAZY),
    ('push_control.controller_node', ('matplotlib', 'numba', 'scipy')),
    ('push_sim_node.sim_node', ('casadi', 'matplotlib', 'numba', 'scipy'))])
def test_commands_and_nodes_import_what_they_need_to_begin(module, heavy):
    """Machine code comes with the first call."""
    assert loaded(module, heavy) == []


def loaded(modules, names=LAZY):
    """Import modules in another process; list which of some packages came with them."""
    code = f'import sys, {modules}\nprint(*[name for name in {names} if name in sys.modules])'
    done = subprocess.run([sys.executable, '-c', code], capture_output=True, text=True, check=True)
    return done.stdout.split()
