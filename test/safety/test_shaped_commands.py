"""The guard shapes what a base cannot follow, and is relaxed in nothing by that."""

import dataclasses
import math

from helpers.objects import box
from push_model.geometry import Pose
from push_model.parameters import RoundRobot
from push_model.signals import Odometry, STOP, Twist
from push_model.wheels import wheel_speeds
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


def driven(robot, stated, seconds, command=SLOW, fails_at=math.inf, repeats_every=0):
    """
    Drive a base through the layer; return what was sent, the layer and the base.

    :param command: a ``Twist``, or one for each period.
    :param fails_at: when the base stops, whatever it is sent [s].
    :param repeats_every: of so many measurements one comes twice, and is answered twice.
    """
    layer = SafetyLayer(stated, box())
    base = ImperfectDrive(robot, DriveImperfections(), Pose(0.0, 0.0, 0.0), 1.0)
    sent = []
    for k in range(round(seconds / PERIOD)):
        time = PERIOD * k
        twist = base.odometry_twist if time < fails_at else STOP
        wanted = command if isinstance(command, Twist) else command[k]
        for _ in range(2 if repeats_every and k % repeats_every == 0 else 1):
            layer.observe(Odometry(time, base.odometry_pose, twist))
            answer = layer.filter(wanted, time)
        sent.append(answer)
        base.command(answer)
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
    assert layer.report.code is SafetyReason.NOT_MOVING


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


@pytest.mark.parametrize('drive', ['differential', 'holonomic'])
@pytest.mark.parametrize('dead_time', [0.0, 0.2])
def test_a_measurement_that_comes_twice_changes_nothing(drive, dead_time):
    """Neither what is sent nor what is learned of a base without statements, to the bit."""
    true = dataclasses.replace(robot_of(drive), dead_time=dead_time)
    stated = RoundRobot(0.17, drive=drive, max_acceleration=0.9)
    fast = [Twist(0.2, 0.0, 0.3 * math.sin(0.05 * k)) for k in range(150)]
    slow = [Twist(0.03, 0.0, 0.04 * math.sin(0.02 * k)) for k in range(300)]
    command = [*fast, *slow, *[STOP] * 10, *fast]
    seconds = PERIOD * len(command)
    once, layer, _ = driven(true, stated, seconds, command)
    sent, again, _ = driven(true, stated, seconds, command, repeats_every=3)
    assert sent == once
    assert again.base_knowledge == layer.base_knowledge
    assert layer.base_knowledge.min_speed > 0.0
    assert (layer.base_knowledge.dead_time > 0.0) == (dead_time > 0.0)


def wheels_of(robot, twists):
    """Return the speeds of all wheels, in one list."""
    return [speed for twist in twists for speed in wheel_speeds(twist, robot.wheel_track)]


def test_pulses_of_opposite_wheels_stay_within_the_yaw_rate():
    """And above the dead band, and the base turns as fast as it should."""
    robot = dataclasses.replace(robot_of('differential'), track=0.23, max_yaw_rate=0.6)
    sent, layer, _ = driven(robot, robot, 30.0, Twist(0.0, 0.0, 0.1))
    assert layer.report is None
    assert max(abs(twist.omega) for twist in sent) <= 0.6 * (1.0 + 1e-9)
    assert all(abs(speed) < 1e-12 or abs(speed) > 0.05 for speed in wheels_of(robot, sent))
    assert PERIOD * sum(twist.omega for twist in sent) == pytest.approx(3.0, abs=0.07)


@pytest.mark.parametrize('drive', ['differential', 'holonomic'])
def test_what_a_limit_cuts_off_a_pulse_is_still_owed(drive):
    """The base cannot accelerate to the height of a pulse: it gets more of them."""
    robot = dataclasses.replace(robot_of(drive), max_acceleration=0.15)
    sent, _, _ = driven(robot, robot, 30.0)
    speeds = [twist.v_x for twist in sent]
    assert 0.0 < max(speeds[:100]) < 0.1
    assert PERIOD * sum(speeds) == pytest.approx(30.0 * SLOW.v_x, abs=0.02)


def test_pulses_of_a_robot_without_odometry_are_whole_until_it_stands():
    """It is slowed down by fewer pulses; lower ones would not move its wheels."""
    robot = robot_of('differential')
    slowed = 0
    for last in range(100, 110):
        layer = SafetyLayer(robot, box())
        base = ImperfectDrive(robot, DriveImperfections(), Pose(0.0, 0.0, 0.0), 1.0)
        sent = []
        for k in range(last + 40):
            time = PERIOD * k
            if k <= last:
                layer.observe(Odometry(time, base.odometry_pose, base.odometry_twist))
            sent.append(layer.filter(Twist(0.045, 0.0, 0.0), time))
            base.command(sent[-1])
            base.step(PERIOD, (0.0, 0.0))
        speeds = wheels_of(robot, sent)
        assert all(speed == 0.0 or speed > 0.05 for speed in speeds)
        slowed += sum(twist != STOP for twist in sent[last + 4:])
        assert set(sent[last + 15:]) == {STOP}
    assert slowed > 0
