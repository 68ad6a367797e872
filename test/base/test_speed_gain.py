"""Gains of wheels and axes: what a base makes of commands, and what is sent for a motion."""

from helpers.objects import box
import numpy as np
from push_base.speed_gain import compensated, delivered, gain_matrix, MIN_COMPENSATED
from push_model.base_knowledge import BaseKnowledge
from push_model.parameters import RoundRobot
from push_model.signals import Twist
from push_model.wheels import wheel_speeds
from push_safety.layer import SafetyLayer
import pytest

COMMAND = Twist(0.2, 0.0, -0.3)
ROBOTS = {drive: RoundRobot(0.17, drive=drive, max_acceleration=9.0)
          for drive in ('differential', 'holonomic')}


def test_each_wheel_has_its_gain():
    """The twist that follows is that of wheels which turn so much faster or slower."""
    robot = ROBOTS['differential']
    after = delivered(COMMAND, robot, BaseKnowledge(first_gain=0.9, second_gain=1.2))
    left, right = wheel_speeds(COMMAND, robot.wheel_track)
    assert wheel_speeds(after, robot.wheel_track) == pytest.approx((0.9 * left, 1.2 * right))


def test_translation_and_rotation_of_a_holonomic_base_have_theirs():
    """Sideways as forwards."""
    after = delivered(Twist(0.2, -0.1, 0.3), ROBOTS['holonomic'],
                      BaseKnowledge(first_gain=0.9, second_gain=1.2))
    assert after == pytest.approx((0.18, -0.09, 0.36))


@pytest.mark.parametrize('drive', ROBOTS)
def test_what_is_compensated_is_delivered_as_desired(drive):
    """Down to the least gain that is made up for."""
    robot, known = ROBOTS[drive], BaseKnowledge(first_gain=0.8, second_gain=1.1)
    assert delivered(compensated(COMMAND, robot, known), robot, known) == pytest.approx(COMMAND)
    assert compensated(COMMAND, robot, BaseKnowledge()) is COMMAND
    np.testing.assert_array_equal(gain_matrix(robot, 1.0, 1.0), np.eye(3))


@pytest.mark.parametrize('drive', ROBOTS)
@pytest.mark.parametrize('first, second', [(0.5, 0.5), (0.5, 1.0), (1.1, 0.5)])
def test_a_base_that_is_slower_keeps_to_its_arc(drive: str, first: float, second: float) -> None:
    """It is slower in proportion, be it one wheel or both: it does not turn off."""
    robot, slow = ROBOTS[drive], BaseKnowledge(first_gain=first, second_gain=second)
    expected = tuple(0.5 / MIN_COMPENSATED * value for value in COMMAND)
    assert delivered(compensated(COMMAND, robot, slow), robot, slow) == pytest.approx(expected)


@pytest.mark.parametrize('drive', ROBOTS)
def test_no_compensation_exceeds_the_stated_greatest_speed(drive):
    """A weak base that is asked for all of it is as slow as it is."""
    robot = ROBOTS[drive]
    layer = SafetyLayer(robot, box())
    layer.start_from(BaseKnowledge(first_gain=0.8, second_gain=0.8))
    sent = [layer.filter(Twist(speed, 0.0, 0.0), 0.0).v_x
            for speed in (0.4 * robot.max_speed, robot.max_speed)]
    assert sent == pytest.approx((0.5 * robot.max_speed, robot.max_speed))
