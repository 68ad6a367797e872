"""The loop of plant and robot: the same for a single push and for a task."""

import dataclasses
import itertools

import numpy as np
from push_model.signals import Odometry, STOP
from push_planner.steered.task_push import plan_steered_push
from push_scenario.definition.loader import load_scenario
from push_scenario.definition.task import Task
from push_scenario.evaluation.metrics import is_as_expected, measure
from push_scenario.simulation import loop
from push_scenario.simulation.history import single_push_history
from push_scenario.simulation.loop import SETTLE_TIME, simulate
from push_scenario.simulation.result import Outcome
from push_scenario.simulation.robot_control import Ending, RobotControl, RobotRecord
import pytest

PUSH = load_scenario('straight_push')
EVENT, MEASUREMENT = 'event', 'measurement'


class Standing(RobotControl):
    """A robot that stands until it ends the run, and keeps what it is asked."""

    def __init__(self, scenario, end_time):
        super().__init__(scenario, None)
        self.end_time = end_time
        self.steps = []
        self.plan_updates = []

    awaits_resume = False
    backs_off = False
    stage = 'standing'

    def on_safety_report(self, fault, stop):
        """Ignore it."""

    def step(self, observation, dt):
        """Stand."""
        self.steps.append((observation, dt))
        return STOP

    def update_plan(self, observation):
        """End the run when it is time."""
        self.plan_updates.append(observation)
        return Ending(Outcome.FAILED, 'tired') if observation.time >= self.end_time else None

    def record(self, ending, time):
        """Give the record of a push that nobody has planned."""
        return RobotRecord(single_push_history(*ending, time))


@pytest.fixture
def standing(monkeypatch):
    """Run a scenario with a robot that stands; return it and the result."""
    def run(end_time=np.inf, **options):
        robots = []

        def make(scenario, observation, planning_time, plan_push):
            robots.append(Standing(scenario, end_time))
            return robots[0]

        monkeypatch.setattr(loop, 'make_robot_control', make)
        scenario = dataclasses.replace(PUSH, time_limit=1.0, task=Task())
        return robots, simulate(scenario, **options)
    return run


def test_every_measurement_gets_one_step_with_the_time_since_the_last(standing):
    """The first one at time 0; each step sees the newest of both kinds of measurements."""
    (robot,), result = standing()
    times = [observation.time for observation, _ in robot.steps]
    assert times[0] == 0.0 and times == sorted(times)
    assert [dt for _, dt in robot.steps] == [0.0, *np.diff(times)]
    for observation, _ in robot.steps:
        newest = max(observation.odometry.time, observation.object_pose.time)
        assert isinstance(observation.odometry, Odometry) and newest <= observation.time
    assert set(result.tape['time']) <= set(times)


def test_planning_and_interventions_take_place_between_measurements(standing):
    """In this order, before every measurement that follows."""
    events = []
    robots, _ = standing(intervene=lambda *_: events.append('intervention'),
                         progress=lambda _: events.append(MEASUREMENT))
    before_end = events[1:2 * len(robots[0].plan_updates) + 1]
    assert before_end == [event for event, _ in zip(
        itertools.cycle(['intervention', MEASUREMENT]), before_end)]


def test_time_limit_ends_the_run_and_everything_comes_to_rest(standing):
    """The tape goes on for two rows at rest, and no further."""
    (robot,), result = standing()
    assert result.outcome is Outcome.TIME_LIMIT and '1 s' in result.reason
    assert result.duration == pytest.approx(1.0, abs=0.05)
    rest = result.tape['time'] > result.duration
    assert 1 <= rest.sum() <= 3 and result.tape['time'][-1] < result.duration + SETTLE_TIME
    assert robot.plan_updates[-1].time < 1.0


def test_the_robot_ends_the_run_with_its_outcome_and_reason(standing):
    """No plan is updated after that."""
    (robot,), result = standing(end_time=0.5)
    assert (result.outcome, result.reason) == (Outcome.FAILED, 'tired')
    assert result.duration == robot.plan_updates[-1].time == pytest.approx(0.5, abs=0.03)
    assert robot.steps[-1][0].time > result.duration


@pytest.mark.slow
def test_a_push_and_a_task_with_one_push_agree():
    """Same plant, same sensors, same kind of result; the object rests at the same goal."""
    push = simulate(PUSH)
    task = simulate(dataclasses.replace(PUSH, task=Task()),
                    plan_push=lambda *args, **_: plan_steered_push(*args[:4]))
    assert push.tape.columns == task.tape.columns
    for prefix in ('object', 'robot'):
        assert np.array_equal(push.tape.poses(prefix)[0], task.tape.poses(prefix)[0])
    one, other = measure(push), measure(task)
    assert one.pushes == other.pushes == 1
    assert one.object_path_length == pytest.approx(other.object_path_length, abs=0.02)
    assert max(one.position_error, other.position_error) < PUSH.bounds.position_error
    for result in (push, task):
        assert is_as_expected(result)
        states = [change.state.value for change in result.history]
        assert states.count('push') == 1 and states[-1] == result.outcome.value == 'done'
        assert result.history[-1].time == pytest.approx(result.duration, abs=0.05)
        speeds = [result.tape[f'{body}_v_x'][-1] for body in ('object', 'robot')]
        assert np.abs(speeds).max() < 2e-3
