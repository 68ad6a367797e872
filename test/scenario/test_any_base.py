"""Tasks and pushes by bases with dead bands and dead times, stated and not."""

import dataclasses

from push_control.behaviors.failures import BehaviorFailure
from push_control.goal import TaskFailure
from push_scenario import load_scenario, simulate
from push_scenario.simulation.result import Outcome
from push_sim_node.drive_imperfections import DriveImperfections
import pytest

pytestmark = pytest.mark.slow
BASES = {'dead band': {'min_speed': 0.08, 'min_yaw_rate': 0.15}, 'dead time': {'dead_time': 0.3}}


def on_base(name, base, stated, identified=False):
    """Return the result of a scenario with such a base."""
    scenario = load_scenario(name)
    robot = dataclasses.replace(scenario.robot, identify_base=identified,
                                **(base if stated else {}))
    return simulate(dataclasses.replace(
        scenario, robot=robot, true_robot=dataclasses.replace(scenario.true_robot, **base),
        time_limit=20.0))


@pytest.mark.parametrize('kind', BASES)
def test_a_short_task_is_done_where_the_base_is_stated(kind):
    """As precisely as by a good base; where it is neither stated nor learned it is not done."""
    result = on_base('task_tap', BASES[kind], stated=True)
    assert result.outcome is Outcome.DONE
    assert result.position_error < 0.01
    assert on_base('task_tap', BASES[kind], stated=False).outcome is not Outcome.DONE


@pytest.mark.parametrize('kind', BASES)
def test_a_short_task_is_done_where_the_base_has_to_be_learned(kind):
    """Nothing is stated, and the goal is reached within the tolerance."""
    result = on_base('task_tap', BASES[kind], stated=False, identified=True)
    assert result.outcome is Outcome.DONE
    assert result.position_error < 0.01


@pytest.mark.parametrize('name', ['curved_push', 'holonomic_face'])
def test_a_steered_push_by_a_late_base_is_more_precise_where_that_is_stated(name):
    """The laws act on the push a dead time and a lag ahead."""
    stated, unstated = (on_base(name, {'dead_time': 0.2}, stated) for stated in (True, False))
    assert stated.outcome is unstated.outcome is Outcome.DONE
    assert stated.position_error < 0.5 * unstated.position_error


def test_an_object_that_is_too_heavy_is_called_so():
    """Not the tracker, nor the robot's place: the wheels spin, and the task ends for that."""
    scenario = load_scenario('task_slippery')
    force = 0.4 * sum(scenario.true_object.capacities)
    true = dataclasses.replace(scenario.true_robot, max_push_force=force)
    result = simulate(dataclasses.replace(scenario, true_robot=true, time_limit=40.0))
    assert result.outcome is Outcome.FAILED
    assert result.status.failure is TaskFailure.TOO_HEAVY
    assert result.duration < 20.0


def test_a_base_that_stalls_at_an_object_calls_it_too_heavy():
    """Its wheels stand still, rather than spin."""
    scenario = load_scenario('task_slippery')
    force = 0.4 * sum(scenario.true_object.capacities)
    settings = dataclasses.replace(scenario.simulation, drive=DriveImperfections(
        stall_force=force))
    result = simulate(dataclasses.replace(scenario, simulation=settings, time_limit=40.0))
    assert result.status.failure is TaskFailure.TOO_HEAVY
    assert BehaviorFailure.BASE_STALLS in result.status.codes
    assert result.duration < 20.0


@pytest.mark.parametrize('name, ratio, is_stated', [
    ('task_slippery', 1.0, False), ('task_slippery', 50.0, True), ('task_turn', 50.0, False)])
def test_an_object_that_does_not_move_at_all_is_too_heavy(name, ratio, is_stated):
    """Whether the force is stated or not."""
    scenario = load_scenario(name)
    obj = dataclasses.replace(scenario.true_object, mass=ratio * scenario.true_object.mass)
    force = 0.02 * sum(scenario.true_object.capacities)
    true = dataclasses.replace(scenario.true_robot, max_push_force=force)
    robot = dataclasses.replace(scenario.robot, max_push_force=force)
    result = simulate(dataclasses.replace(
        scenario, robot=robot if is_stated else scenario.robot, true_robot=true, true_object=obj,
        time_limit=60.0))
    assert result.outcome is Outcome.FAILED
    assert result.status.failure is TaskFailure.TOO_HEAVY
    assert result.duration < 40.0
    assert {BehaviorFailure.WHEELS_SPIN, BehaviorFailure.OBJECT_UNYIELDING} & set(
        result.status.codes)


def test_the_forces_are_named_before_the_first_push():
    """Where the robot's file states that it is too weak, the history starts with a warning."""
    scenario = load_scenario('task_turn')
    weak = dataclasses.replace(scenario.robot, max_push_force=2.0)
    result = simulate(dataclasses.replace(scenario, robot=weak, time_limit=0.5))
    assert 'the robot pushes with 2 N' in result.history[0].reason
