"""A base whose speeds are a part of what is commanded: learned, made up for, and still guarded."""

import dataclasses
import math

from helpers.objects import box
from push_model.geometry import Pose
from push_model.parameters import RoundRobot
from push_model.signals import Odometry, STOP, Twist
from push_safety.layer import SafetyLayer
from push_safety.status import SafetyReason
from push_sim_node.drive_imperfections import DriveImperfections, SpeedFactor
from push_sim_node.imperfect_drive import ImperfectDrive
import pytest

PERIOD = 0.02
ROBOTS = {drive: RoundRobot(0.17, drive=drive, max_acceleration=0.9)
          for drive in ('differential', 'holonomic')}


class Drive:
    """A base that is driven through the guard, along a path that winds."""

    def __init__(self, robot, imperfections=DriveImperfections(), odometry_scale=1.0, **true):
        """Start at rest."""
        self.layer = SafetyLayer(robot, box())
        self.base = ImperfectDrive(dataclasses.replace(robot, **true), imperfections,
                                   Pose(0.0, 0.0, 0.0), 1.0)
        self.scale = odometry_scale
        self.time, self.desired = 0.0, STOP
        self.stops = []
        self.is_off = False

    def go(self, seconds):
        """Drive on; a robot that is stopped starts from rest again."""
        for _ in range(round(seconds / PERIOD)):
            self._step()
        return self

    def _step(self):
        twist = STOP if self.is_off else self.base.odometry_twist
        was_stopped = self.layer.report is not None
        self.layer.observe(Odometry(self.time, self.base.odometry_pose, Twist(
            *(self.scale * value for value in twist))))
        report = self.layer.report
        if report is not None and not was_stopped:
            self.stops.append((self.time, report.code))
        speed = 0.2 if report is None else 0.0
        speed = min(speed, self.desired.v_x + 0.6 * PERIOD)
        self.desired = Twist(speed, 0.0, speed * 1.2 * math.sin(1.3 * self.time))
        self.base.command(self.layer.filter(self.desired, self.time))
        for _ in range(0 if self.is_off else 10):
            self.base.step(0.1 * PERIOD, (0.0, 0.0))
        self.time += PERIOD

    @property
    def gains(self):
        """Gains that are believed."""
        return self.layer.base_knowledge.gains


@pytest.mark.parametrize('drive', ROBOTS)
def test_motors_that_get_weaker_are_followed_and_stop_nobody(drive):
    """By a quarter within 14 s: no stop, and the robot is as fast as it should be."""
    weak = Drive(ROBOTS[drive], DriveImperfections(sag=0.25, sag_time=14.0)).go(17.0)
    assert not weak.stops
    assert weak.gains == pytest.approx((0.75, 0.75), rel=0.06)
    assert weak.base.odometry_twist.v_x == pytest.approx(0.2, rel=0.06)


def test_a_wheel_that_is_slow_is_learned_by_itself():
    """Within two seconds, and the robot drives straight again."""
    uneven = Drive(ROBOTS['differential'], DriveImperfections(left_wheel_factor=0.85)).go(4.0)
    assert not uneven.stops
    assert uneven.gains == (pytest.approx(0.85, abs=0.02), 1.0)
    deviation = uneven.layer.base_knowledge.gain_deviation
    assert abs(uneven.gains[0] - 0.85) < 2.0 * deviation < 0.1


@pytest.mark.parametrize('drive', ROBOTS)
@pytest.mark.parametrize('imperfections, true', [
    (DriveImperfections(), {}),
    (DriveImperfections(), {'dead_time': 0.2, 'time_constant': 0.15}),
    (DriveImperfections(), {'min_speed': 0.08, 'min_yaw_rate': 0.15}),
    (DriveImperfections(output_min_speed=0.08, output_min_yaw_rate=0.15), {}),
    (DriveImperfections(smoother_acceleration=0.3, smoother_yaw_acceleration=2.0), {})],
    ids=['good', 'late', 'dead band', 'dead band behind the lag', 'smoother'])
def test_other_faults_are_not_taken_for_a_gain(drive, imperfections, true):
    """Nor is odometry that errs by some per cent: commands stay as they are, to the bit."""
    for scale in (0.96, 1.04):
        assert Drive(ROBOTS[drive], imperfections, scale, **true).go(4.0).gains == (1.0, 1.0)


@pytest.mark.parametrize('drive', ROBOTS)
def test_half_the_speed_is_a_fault_once_and_then_is_known(drive):
    """Also that it comes back: after that all is as it was."""
    halved = Drive(ROBOTS[drive], DriveImperfections(
        speed_factors=(SpeedFactor(4.0, 9.0, 0.5),))).go(8.9)
    (time, code), = halved.stops
    assert 4.0 < time < 4.5 and code is SafetyReason.NOT_MOVING
    assert halved.gains == pytest.approx((0.5, 0.5), rel=0.05)
    assert len(halved.go(5.0).stops) <= 2
    assert halved.gains == (1.0, 1.0)


@pytest.mark.parametrize('drive', ROBOTS)
def test_a_base_that_is_off_is_noticed_whatever_was_learned(drive):
    """As soon as without that, within a period or two."""
    times = []
    for sag in (0.0, 0.25):
        weak = Drive(ROBOTS[drive], DriveImperfections(sag=sag, sag_time=0.01)).go(5.0)
        count, weak.is_off = len(weak.stops), True
        weak.go(1.0)
        times.append(weak.stops[count][0])
    assert times[1] <= times[0] + 2.5 * PERIOD < 5.0 + 0.25
