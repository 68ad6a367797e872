"""The guard shapes what a base cannot follow, and is relaxed in nothing by that."""

import dataclasses
import math

from helpers.objects import box
from push_model.geometry import Pose
from push_model.parameters import RoundRobot
from push_model.signals import Odometry, STOP, Twist
from push_safety.layer import SafetyLayer
from push_safety.status import SafetyReason
from push_sim_node.drive_imperfections import DriveImperfections
from push_sim_node.imperfect_drive import ImperfectDrive
import pytest

PERIOD = 0.02
SLOW = Twist(0.02, 0.0, 0.0)


def robot_of(drive):
    """Return a robot that turns its wheels from 0.05 m/s on."""
    return RoundRobot(0.17, drive=drive, max_acceleration=0.9, min_speed=0.05, min_yaw_rate=0.1)


def driven(robot, stated, seconds, command=SLOW, fails_at=math.inf):
    """Drive a base through the layer; return what was sent, and the layer."""
    layer = SafetyLayer(stated, box())
    base = ImperfectDrive(robot, DriveImperfections(), Pose(0.0, 0.0, 0.0), 1.0)
    sent = []
    for k in range(round(seconds / PERIOD)):
        time = PERIOD * k
        twist = base.odometry_twist if time < fails_at else STOP
        layer.observe(Odometry(time, base.odometry_pose, twist))
        sent.append(layer.filter(command, time))
        base.command(sent[-1])
        for _ in range(10):
            base.step(0.1 * PERIOD, (0.0, 0.0))
    return sent, layer, base


@pytest.mark.parametrize('drive', ['differential', 'holonomic'])
def test_pulses_move_the_base_and_are_no_fault(drive):
    """A minute of creeping: the models see what is sent, and explain the motion."""
    robot = robot_of(drive)
    sent, layer, base = driven(robot, robot, 60.0)
    assert layer.report is None
    assert base.odometry_pose.x == pytest.approx(1.2, abs=0.05)
    assert {twist == STOP for twist in sent} == {False, True}


@pytest.mark.parametrize('drive', ['differential', 'holonomic'])
def test_without_what_is_stated_the_same_base_is_stopped(drive):
    """It does not move at all: commands are not pulses, and the guard notices it."""
    robot = robot_of(drive)
    stated = dataclasses.replace(robot, min_speed=0.0, min_yaw_rate=0.0)
    _, layer, base = driven(robot, stated, 2.0, Twist(0.045, 0.0, 0.0))
    assert base.odometry_pose.x == 0.0
    assert layer.report.reason is SafetyReason.NOT_MOVING


@pytest.mark.parametrize('drive', ['differential', 'holonomic'])
def test_a_base_that_is_off_stops_the_robot_as_soon_as_one_without_dead_band(drive):
    """Nothing but STOP leaves the layer then, although the controller commands on."""
    times = []
    for stated in (robot_of(drive), RoundRobot(0.17, drive=drive, max_acceleration=0.9)):
        sent, layer, _ = driven(stated, stated, 2.0, Twist(0.2, 0.0, 0.0), fails_at=1.0)
        assert layer.report is not None
        times.append(next(k for k, twist in enumerate(sent) if k > 50 and twist == STOP))
        assert set(sent[times[-1]:]) == {STOP}
    assert times[0] == times[1]
