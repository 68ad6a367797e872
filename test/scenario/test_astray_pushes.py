"""A single push that does not come to its goal ends, on the floor that its plan needed."""

import dataclasses
import math

import numpy as np
from push_control.steered.plan_bounds import DEVIATION_RATIO, LENGTH_MARGIN_RATIO
from push_model.events import PushEvent
from push_model.plan_request import PlanFailure
from push_model.signals import Twist
from push_safety.status import SafetyReason
from push_scenario.definition.loader import load_scenario
from push_scenario.definition.placement import Placement
from push_scenario.evaluation.metrics import deviation
from push_scenario.simulation.loop import simulate
from push_scenario.simulation.result import Outcome
import pytest

pytestmark = pytest.mark.slow
# Half of the distance between the wheels [m].
HALF_TRACK = 0.12
# What the object may slide on, and the estimate may be off [m].
SLACK = 0.02
# Ways in which a push that goes astray ends.
BOUNDS = {PushEvent.PATH_TOO_LONG, PushEvent.LEFT_FLOOR, PushEvent.NO_PROGRESS,
          PushEvent.GOAL_MISSED}


class SlowWheels:
    """Wheels of a base that turn slower than commanded; an ``Intervention`` of ``simulate``."""

    def __init__(self, left, right):
        self._ratios = left, right
        self._is_installed = False

    def __call__(self, simulation, _):
        if self._is_installed:
            return
        self._is_installed = True
        send = simulation.command

        def command(twist):
            left = self._ratios[0] * (twist.v_x - HALF_TRACK * twist.omega)
            right = self._ratios[1] * (twist.v_x + HALF_TRACK * twist.omega)
            send(Twist(0.5 * (left + right), twist.v_y, 0.5 * (right - left) / HALF_TRACK))
        simulation.command = command


def run(name, law, intervene=None, **changes):
    """Push, for as long as it takes."""
    scenario = dataclasses.replace(load_scenario(name), time_limit=900.0, **changes)
    return simulate(scenario, law, intervene=intervene)


def unlearned(name):
    """Return the robot of a scenario, which does not find out what its base is like."""
    return dataclasses.replace(load_scenario(name).robot, identify_base=False)


def check_bounds(result):
    """Check that the push has ended within length and floor of its first plan."""
    scenario = result.scenario
    positions = result.tape.poses('object')
    size, settings = scenario.object.size, scenario.control
    margin = settings.max_path_deviation or DEVIATION_RATIO * size
    assert deviation(positions, result.plan)[0].max() < margin + SLACK
    way = float(np.hypot(*np.diff(positions[:, :2], axis=0).T).sum())
    longest = settings.max_length_ratio * result.plan.path_length + LENGTH_MARGIN_RATIO * size
    assert way < longest + SLACK
    assert result.outcome is not Outcome.TIME_LIMIT
    assert result.outcome is Outcome.DONE or BOUNDS.intersection(result.codes), result.reason


# How fast the left and the right wheel turn.
LEFT_SLOW, RIGHT_SLOWER = (0.9, 1.0), (1.0, 0.85)


# All pairs of push and law, push and wheel, law and wheel.
@pytest.mark.parametrize('name, law, wheels', [
    ('straight_push', 'feedback', LEFT_SLOW), ('straight_push', 'mpc', RIGHT_SLOWER),
    ('curved_push', 'mpc', LEFT_SLOW), ('curved_push', 'feedback', RIGHT_SLOWER),
    ('holonomic_face', 'feedback', LEFT_SLOW), ('holonomic_face', 'mpc', RIGHT_SLOWER),
    ('bin_round', 'mpc', LEFT_SLOW), ('bin_round', 'feedback', RIGHT_SLOWER)])
def test_a_push_with_a_slow_wheel_ends(name, law, wheels):
    """At its goal, or with a reason that tells by how much it has missed that."""
    result = run(name, law, SlowWheels(*wheels))
    check_bounds(result)


def test_a_push_keeps_to_the_floor_that_the_settings_leave():
    """A narrow one ends it, and no other plan is requested, which would begin beyond it."""
    control = dataclasses.replace(load_scenario('curved_push').control, max_path_deviation=0.03)
    result = run('curved_push', 'feedback', SlowWheels(0.9, 1.0), control=control,
                 robot=unlearned('curved_push'))
    assert result.outcome is Outcome.FAILED and PushEvent.LEFT_FLOOR in result.codes
    check_bounds(result)


def test_no_push_is_needed_within_the_tolerances():
    """The run is over at once, and done: for each goal that the controller calls reached."""
    demo = load_scenario('straight_push')
    start, tolerances = demo.start.object, demo.control.tolerances
    for distance in (0.001, 0.005, 0.009, 0.99 * tolerances.position):
        goal = Placement(start.x, start.y - distance, start.theta + 0.9 * tolerances.heading)
        result = run('straight_push', 'feedback', goal=goal)
        assert result.outcome is Outcome.DONE and result.duration == 0.0
        assert PlanFailure.AT_GOAL in result.codes and result.pushes == 0
        assert result.position_error == pytest.approx(distance)


def test_a_push_that_ends_beside_its_goal_says_so_once():
    """A plan that would need more floor than the first one is not followed."""
    result = run('curved_push', 'feedback', SlowWheels(0.9, 1.0),
                 robot=unlearned('curved_push'))
    sentence = PushEvent.PLAN_EXCEEDS_FLOOR.value.split('; ')[-1]
    assert result.reason.count(sentence) == 1
    # What was wrong before it follows.
    assert SafetyReason.MOVES_OTHERWISE in result.codes
    assert math.dist(result.tape.poses('object')[-1, :2], result.scenario.goal.pose[:2]) < 0.5
