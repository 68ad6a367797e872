"""The scenarios of a single push, in one process."""

import dataclasses
import math

import numpy as np
from push_model.plan_request import PlanFailure
from push_scenario.definition.catalogue import scenario_names
from push_scenario.definition.loader import load_scenario
from push_scenario.definition.placement import Placement
from push_scenario.definition.scenario import Start
from push_scenario.evaluation.metrics import is_as_expected, measure
from push_scenario.simulation.loop import simulate
from push_scenario.simulation.result import Outcome
from push_scenario.simulation.start import place_robot
import pytest
from studies.chapter4.support_friction import gaussian_friction

pytestmark = pytest.mark.slow
CLOSED_LOOPS = ('feedback', 'mpc')


@pytest.mark.parametrize('law', CLOSED_LOOPS)
@pytest.mark.parametrize('name', [name for name in scenario_names()
                                  if not name.startswith('task_')])
def test_every_scenario_ends_as_expected(name, law):
    result = simulate(load_scenario(name), law)
    assert is_as_expected(result), result.reason or measure(result)
    if result.outcome is Outcome.REFUSED:
        assert result.tape is None and result.reason
        return
    final = result.tape.rows[-1]
    rest = [final[result.tape.columns.index(f'{body}_{part}')]
            for body in ('object', 'robot') for part in ('v_x', 'v_y', 'omega')]
    assert np.abs(rest).max() < 2e-3
    assert result.duration <= result.tape['time'][-1] <= result.duration + 2.1


def test_open_loop_misses_the_demo_by_ten_times_the_bounds():
    demo = load_scenario('corner_push_mismatch')
    metrics = measure(simulate(demo, 'open_loop'))
    assert metrics.position_error > 10.0 * demo.bounds.position_error
    assert abs(metrics.heading_error) > 10.0 * demo.bounds.heading_error


@pytest.mark.parametrize('name', ['friction_noise', 'friction_interval', 'friction_shift'])
def test_open_loop_misses_where_friction_changes_during_the_push(name):
    """By more than the bounds; with nominal friction it would arrive."""
    changing = load_scenario(name)
    still = dataclasses.replace(changing, simulation=dataclasses.replace(
        changing.simulation, friction_changes=()))
    missed, arrived = (measure(simulate(case, 'open_loop')) for case in (changing, still))
    assert not missed.within_bounds and missed.position_error > 3.0 * arrived.position_error
    begins = [change.start for change in changing.simulation.friction_changes]
    assert max(begins) < missed.time


def test_random_friction_is_that_of_the_study():
    changes = load_scenario('friction_noise').simulation.friction_changes
    drawn = gaussian_friction(seed=0, deviation=0.2, period=0.5, duration=12.0)
    assert [dataclasses.replace(change, factor=round(change.factor, 2)) for change in drawn] == [
        *changes]


def test_open_loop_arrives_where_nominal_parameters_are_true():
    result = simulate(load_scenario('straight_push'), 'open_loop')
    assert result.control_law == 'open_loop'
    assert is_as_expected(result)


def test_equal_runs_give_equal_tapes_and_another_seed_another():
    one = load_scenario('curved_push')
    short = dataclasses.replace(one, time_limit=3.0)
    other = dataclasses.replace(short, simulation=dataclasses.replace(one.simulation, seed=99))
    tapes = [simulate(case).tape.to_bytes() for case in (short, short, other)]
    assert tapes[0] == tapes[1]
    assert tapes[0] != tapes[2]


def test_time_limit_ends_a_run_and_says_so():
    result = simulate(dataclasses.replace(load_scenario('straight_push'), time_limit=1.0))
    assert result.outcome is Outcome.TIME_LIMIT
    assert result.duration == pytest.approx(1.0, abs=0.05)
    assert not is_as_expected(result)


def test_robot_stands_while_poses_are_missing_and_goes_on_afterwards():
    case = load_scenario('sensor_dropout')
    last = case.sensors.pose_dropouts[-1][1]
    tape = simulate(dataclasses.replace(case, time_limit=last + 3.0)).tape
    stale = case.sensors.pose_latency + case.control.pose_timeout + 0.3
    for start, end in case.sensors.pose_dropouts:
        before = (tape['time'] > start - 0.5) & (tape['time'] < start)
        missing = (tape['time'] > start + stale) & (tape['time'] < end)
        assert missing.any() and before.any()
        assert np.abs(tape['command_v_x'][missing]).max() == 0.0
        assert np.abs(tape['robot_v_x'][missing]).max() < 0.02
        assert tape['robot_v_x'][before].min() > 0.05
    after = tape['time'] > last + 1.0
    assert tape['robot_v_x'][after].max() > 0.1


def test_a_robot_away_from_the_object_is_refused():
    case = load_scenario('straight_push')
    far = dataclasses.replace(case, start=dataclasses.replace(case.start, gap=0.2))
    result = simulate(far)
    assert result.outcome is Outcome.REFUSED
    assert result.codes == (PlanFailure.NOT_IN_CONTACT,)


def test_progress_is_reported_in_order():
    stages, times, distances = [], [], []

    def note(progress):
        stages.append(progress.stage)
        times.append(progress.time)
        distances.append(progress.distance)

    case = load_scenario('straight_push')
    result = simulate(dataclasses.replace(case, goal=dataclasses.replace(case.goal, x=0.3)),
                      progress=note)
    assert list(dict.fromkeys(stages)) == ['planning', 'pushing', 'settling']
    assert times == sorted(times)
    assert distances[0] == pytest.approx(0.3)
    assert distances[-1] == pytest.approx(measure(result).position_error, abs=1e-4)


def test_result_does_not_depend_on_the_world_frame():
    """It is as expected where start and goal are turned, too."""
    case, angle = load_scenario('straight_push'), 2.0
    start = dataclasses.replace(case.start.object, theta=case.start.object.theta + angle)
    goal = dataclasses.replace(case.goal, x=math.cos(angle), y=math.sin(angle),
                               theta=case.goal.theta + angle)
    turned = dataclasses.replace(case, start=dataclasses.replace(case.start, object=start),
                                 goal=goal)
    assert is_as_expected(simulate(turned))


def test_a_robot_without_a_place_is_put_at_the_quickest_site():
    """It pushes from there to a goal beside the box, sooner than from its own start."""
    placed = load_scenario('holonomic_face')
    goal = Placement(0.2, -1.2, 0.1)
    auto = dataclasses.replace(placed, goal=goal, start=Start(),
                               planner=dataclasses.replace(placed.planner, site='best'))
    assert place_robot(auto).robot_start == pytest.approx((0.0, 0.37, -math.pi / 2), abs=1e-9)
    result = simulate(auto)
    assert is_as_expected(result), result.reason
    other = simulate(dataclasses.replace(placed, goal=goal))
    assert other.plan is None or other.plan.duration > result.plan.duration
    with pytest.raises(ValueError, match='neither robot nor contact'):
        dataclasses.replace(placed, start=Start())
