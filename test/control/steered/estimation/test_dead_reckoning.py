"""Dead reckoning of the robot: odometry summed up, its heading error, and corrections."""

import math

from push_control.steered.estimation.contact_site import ContactOffset
from push_control.steered.estimation.dead_reckoning import RobotDeadReckoning, RobotMotion
from push_model.geometry import Pose
from push_model.signals import Twist
import pytest


def motions(twist, heading, duration=4.0, step=0.01, error=0.0):
    """List steps of a constant twist; the filter has another heading by an error."""
    headings = [heading + k * step * twist.omega for k in range(round(duration / step))]
    return [RobotMotion(twist, step, step * abs(twist.v_x), start + error) for start in headings]


def test_steps_add_up_to_an_arc():
    """Of the radius and the length that twist and time give."""
    start = RobotDeadReckoning((1.0, -2.0), 0.5)
    end = start.moved(motions(Twist(0.2, 0.0, 0.1), 0.5))
    radius, angle = 0.2 / 0.1, 0.1 * 4.0
    arc = Pose(1.0, -2.0, 0.5) @ Pose(radius * math.sin(angle), radius * (1.0 - math.cos(angle)),
                                      angle)
    assert (*end.center, end.heading) == pytest.approx(arc, abs=1e-6)
    assert end.heading_error == pytest.approx(0.0, abs=1e-12)


def test_a_lasting_heading_error_is_taken_over():
    """Within some distance, not at once: the filter's heading is noisy."""
    start, steps = RobotDeadReckoning((0.0, 0.0), 0.0), motions(Twist(0.2, 0.0, 0.0), 0.0,
                                                                error=0.1)
    soon, late = start.moved(steps[:10]), start.moved(steps * 5)
    assert 0.0 < soon.heading_error < 0.02
    assert late.heading_error == pytest.approx(0.1, abs=1e-3)
    assert late.heading == 0.0


def test_without_motion_nothing_changes_and_steps_can_be_split():
    """The estimator hands over its steps as they come."""
    start, steps = RobotDeadReckoning((0.3, 0.4), 1.0), motions(Twist(0.1, 0.05, 0.2), 1.0)
    assert start.moved(()) == start
    assert start.moved(steps[:150]).moved(steps[150:]) == start.moved(steps)


def test_a_correction_takes_the_offset_back():
    """A robot seen behind and beside its place is moved there: the drift was the other way."""
    robot = RobotDeadReckoning((1.0, 1.0), 0.0).corrected(ContactOffset(0.01, 0.002), 0.0)
    assert robot.center == pytest.approx((1.01, 0.998))
    turned = RobotDeadReckoning((1.0, 1.0), 0.0).corrected(ContactOffset(0.01, 0.0), math.pi / 2)
    assert turned.center == pytest.approx((1.0, 1.01))
