"""What is learned of a base from its motion: dead time, least speeds, length of pulses."""

import dataclasses
import math
from unittest.mock import patch

import numpy as np
from push_base import base_identifier
from push_base.base_identifier import (
    BaseIdentifier, FREE_QUANTUM, MAX_GAP, MOVING_RATIOS, STEP)
from push_base.command_shaper import CommandShaper, MARGINS, MAX_QUANTUM, pulse_height
from push_model.base_knowledge import BaseKnowledge, PULSE
from push_model.geometry import Pose
from push_model.parameters import RoundRobot
from push_model.signals import Odometry, STOP, Twist
from push_sim_node.drive_imperfections import DriveImperfections
from push_sim_node.imperfect_drive import ImperfectDrive
import pytest

PERIOD = 0.02
DRIVES = 'differential', 'holonomic'
NOMINAL = {'max_speed': 0.3, 'max_yaw_rate': 1.9, 'max_acceleration': 0.9, 'track': 0.23}


def robot_of(drive, **fields):
    """Return a robot as in the benchmarks."""
    return RoundRobot(0.17, drive=drive, **{**NOMINAL, **fields})


def commands(drive, seed, count=400):
    """Draw ramps to targets, as paths have them, with stops between."""
    rng = np.random.default_rng(seed)
    command, target = np.zeros(3), np.zeros(3)
    for k in range(count):
        if k % 60 == 0:
            moves = rng.uniform() < 0.8
            target = rng.uniform(-1.0, 1.0, 3) * (0.3, 0.3, 1.2) * moves
        command = command + np.clip(target - command, -0.018, 0.018)
        yield Twist(float(command[0]), float(command[1]) if drive == 'holonomic' else 0.0,
                    float(command[2]))


def learned(true, stated, sequence, faults=DriveImperfections(), noise=0.0, known=None,
            repeats_every=0):
    """
    Return the identifier of a base that got commands through the shaper, and the base.

    :param repeats_every: of so many measurements one comes twice.
    """
    rng = np.random.default_rng(11)
    identifier, shaper = BaseIdentifier(stated), CommandShaper(stated)
    identifier.knowledge = known or identifier.knowledge
    base = ImperfectDrive(true, faults, Pose(0.0, 0.0, 0.0), 1.0)
    for k, command in enumerate(sequence):
        time = PERIOD * k
        measured = Twist(*(np.array(base.odometry_twist)
                           + noise * rng.standard_normal(3) * (1.0, 1.0, 4.0)).tolist())
        for _ in range(2 if repeats_every and k % repeats_every == 0 else 1):
            identifier.observe(Odometry(time, base.odometry_pose, measured))
        shaper.knowledge = identifier.knowledge
        sent = shaper.shape(command, time)
        identifier.add_command(sent, time)
        base.command(sent)
        for _ in range(5):
            base.step(0.2 * PERIOD, (0.0, 0.0))
    return identifier, base


@pytest.mark.parametrize('drive', DRIVES)
@pytest.mark.parametrize('lag', [0.05, 0.1, 0.15])
@pytest.mark.parametrize('noise', [0.0, 0.005])
def test_of_a_good_base_nothing_is_learned(drive, lag, noise):
    """Whatever its lag is, within a half of what is stated, and with noise of odometry."""
    identifier, _ = learned(robot_of(drive, time_constant=lag), robot_of(drive),
                            commands(drive, 1), noise=noise)
    assert identifier.has_dead_time
    assert identifier.knowledge == BaseKnowledge()


@pytest.mark.parametrize('drive', DRIVES)
@pytest.mark.parametrize('lag', [0.05, 0.1, 0.12])
@pytest.mark.parametrize('acceleration', [0.4, 0.9])
@pytest.mark.parametrize('seed', [3, 4])
def test_of_a_good_base_that_is_stopped_at_once_nothing_is_learned(drive, lag, acceleration,
                                                                   seed):
    """Its acceleration is what delays it, which is as stated."""
    jumps = [command if k % 45 < 30 else STOP for k, command in enumerate(commands(drive, seed))]
    stated = robot_of(drive, max_acceleration=acceleration, max_yaw_acceleration=4 * acceleration)
    true = dataclasses.replace(stated, time_constant=lag)
    identifier, _ = learned(true, stated, jumps)
    assert identifier.has_dead_time
    assert identifier.knowledge == BaseKnowledge()


@pytest.mark.parametrize('drive', DRIVES)
@pytest.mark.parametrize('dead_time', [0.1, 0.2, 0.3])
@pytest.mark.parametrize('noise', [0.0, 0.005])
def test_the_dead_time_is_found_within_two_seconds_of_driving(drive, dead_time, noise):
    """To 0.04 s, which is what prediction needs."""
    identifier, _ = learned(robot_of(drive, dead_time=dead_time), robot_of(drive),
                            [Twist(0.25, 0.0, 0.5)] * 100, noise=noise)
    assert identifier.knowledge.dead_time == pytest.approx(dead_time, abs=0.04)
    assert identifier.knowledge.min_speed == identifier.knowledge.min_yaw_rate == 0.0


def test_a_dead_time_that_is_stated_wrong_is_corrected():
    """Also where there is none."""
    stated = robot_of('differential', dead_time=0.3)
    identifier, _ = learned(robot_of('differential'), stated, commands('differential', 2))
    assert identifier.knowledge.dead_time == 0.0


def speeds_up(drive, count=300):
    """Command jumps of speed and yaw rate, with stops between."""
    return [Twist(0.25, 0.0, 1.2 if drive == 'differential' else -1.0) if k % 100 < 60 else STOP
            for k in range(count)]


SMOOTHER = DriveImperfections(smoother_acceleration=0.3, smoother_yaw_acceleration=2.0)
SLOW = {'max_acceleration': 0.3, 'max_yaw_acceleration': 2.0}


@pytest.mark.parametrize('drive', DRIVES)
@pytest.mark.parametrize('dead_time', [0.0, 0.2])
@pytest.mark.parametrize(('limits', 'faults'), [(SLOW, DriveImperfections()), ({}, SMOOTHER)])
@pytest.mark.parametrize('noise', [0.0, 0.005])
def test_accelerations_below_what_is_stated_are_found(drive, dead_time, limits, faults, noise):
    """Of the base or of a smoother before it, to a fifth; they are no dead time."""
    identifier, _ = learned(robot_of(drive, dead_time=dead_time, **limits), robot_of(drive),
                            speeds_up(drive), faults, noise)
    known = identifier.knowledge
    assert known.max_acceleration == pytest.approx(0.3, rel=0.2)
    assert known.max_yaw_acceleration == pytest.approx(2.0, rel=0.2)
    # A smoother is a lag before that of the drive.
    assert dead_time - 0.04 <= known.dead_time <= dead_time + 0.14


@pytest.mark.parametrize('drive', DRIVES)
def test_accelerations_come_back_where_a_smoother_is_taken_out(drive):
    stated = robot_of(drive)
    slow, _ = learned(dataclasses.replace(stated, **SLOW), stated, speeds_up(drive))
    assert slow.knowledge.max_acceleration < 0.4
    base = ImperfectDrive(stated, DriveImperfections(), Pose(0.0, 0.0, 0.0), 1.0)
    for k, command in enumerate(speeds_up(drive), 300):
        slow.observe(Odometry(PERIOD * k, base.odometry_pose, base.odometry_twist))
        slow.add_command(command, PERIOD * k)
        base.command(command)
        for _ in range(5):
            base.step(0.2 * PERIOD, (0.0, 0.0))
    assert math.isinf(slow.knowledge.max_acceleration)
    assert math.isinf(slow.knowledge.max_yaw_acceleration)


def test_a_robot_is_limited_to_less_than_what_its_base_reaches():
    """And it is the same robot where nothing is known of that."""
    robot = robot_of('differential')
    assert BaseKnowledge(dead_time=0.2).limited(robot) is robot
    assert BaseKnowledge(max_acceleration=2.0).limited(robot) is robot
    limited = BaseKnowledge(max_acceleration=0.4).limited(robot)
    assert 0.3 < limited.max_acceleration < 0.4
    assert limited == dataclasses.replace(robot, max_acceleration=limited.max_acceleration)


@pytest.mark.parametrize('drive', DRIVES)
@pytest.mark.parametrize('least', [0.05, 0.08])
@pytest.mark.parametrize('dead_time', [0.0, 0.2])
def test_a_base_that_did_not_creep_creeps(drive, least, dead_time):
    """After a fast drive it is asked for less than it can, learns that, and goes there."""
    true = robot_of(drive, min_speed=least, min_yaw_rate=2.0 * least, dead_time=dead_time)
    fast, slow = [Twist(0.25, 0.0, 0.0)] * 75, [Twist(0.03, 0.0, 0.0)] * 600
    identifier, base = learned(true, robot_of(drive), [*fast, *slow])
    _, only_fast = learned(true, robot_of(drive), [*fast, *[STOP] * 50])
    assert 0.0 < identifier.knowledge.min_speed <= 0.13
    assert base.odometry_pose.x - only_fast.odometry_pose.x > 0.15


@pytest.mark.parametrize('noise', [0.0, 0.005])
def test_a_base_that_hardly_asks_one_of_its_wheels_creeps_too(noise):
    """As in slow bends: neither wheel turns, so that the robot does not turn about one."""
    stated = robot_of('differential')
    bend = Twist(0.009, 0.0, 0.044)
    sequence = [*[Twist(0.25, 0.0, 0.0)] * 75, *[STOP] * 50, *[bend] * 600]
    true = robot_of('differential', min_speed=0.05)
    identifier, base = learned(true, stated, sequence, noise=noise)
    assert identifier.knowledge.min_speed > 0.0
    fixed = robot_of('differential', identify_base=False)
    _, only_fast = learned(true, fixed, sequence, noise=noise)
    turned = base.odometry_pose.theta - only_fast.odometry_pose.theta
    assert turned > 0.3 * 600 * PERIOD * bend.omega
    of_good_base, _ = learned(stated, stated, sequence, noise=noise)
    assert of_good_base.knowledge == BaseKnowledge()


@pytest.mark.parametrize('drive', DRIVES)
def test_pulses_get_longer_behind_a_ramp_and_come_back(drive):
    """Short pulses never reach the least speed there; once they move the base they shrink."""
    faults = DriveImperfections(output_min_speed=0.08, output_min_yaw_rate=0.15)
    fast, slow = [Twist(0.25, 0.0, 0.0)] * 75, [Twist(0.03, 0.0, 0.0)] * 600
    identifier, base = learned(robot_of(drive), robot_of(drive), [*fast, *slow], faults)
    assert identifier.knowledge.min_speed > 0.0
    _, fixed = learned(robot_of(drive), robot_of(drive, identify_base=False), [*fast, *slow],
                       faults)
    assert base.odometry_pose.x > fixed.odometry_pose.x + 0.05
    assert PULSE <= identifier.knowledge.pulse <= 0.16


@pytest.mark.parametrize('drive', DRIVES)
def test_pulses_of_a_good_base_come_back_from_the_cap(drive):
    """It was blocked: pulses move it, and get short and low until a lower one gains nothing."""
    stated = robot_of(drive, min_speed=0.13, min_yaw_rate=0.35)
    known = BaseKnowledge.stated(stated)._replace(pulse=0.16)
    sequence = [*[Twist(0.25, 0.0, 0.0)] * 75, *[Twist(0.04, 0.0, 0.0)] * 1500]
    identifier, _ = learned(robot_of(drive), stated, sequence, known=known)
    assert identifier.knowledge.pulse == PULSE
    height = pulse_height(identifier.knowledge.min_speed, PULSE, MAX_QUANTUM)
    assert height * PULSE == pytest.approx(FREE_QUANTUM)


@pytest.mark.parametrize('drive', DRIVES)
@pytest.mark.parametrize('least', [0.05, 0.09, 0.13])
def test_a_base_with_a_dead_band_goes_on_creeping(drive, least):
    """Its least speed comes down no farther than to where its pulses still move it."""
    stated = robot_of(drive, min_speed=least, min_yaw_rate=0.2)
    known = BaseKnowledge.stated(stated)._replace(pulse=0.16)
    _, base = learned(stated, stated, [Twist(0.03, 0.0, 0.0)] * 1500, known=known)
    assert base.odometry_pose.x > MOVING_RATIOS[0] * 0.9


@pytest.mark.parametrize('drive', DRIVES)
def test_fast_driving_tells_nothing_of_what_pulses_need(drive):
    """A base with a dead band does it, too; pulses that move the base lower the least speed."""
    stated = robot_of(drive, min_speed=0.1, min_yaw_rate=0.2)
    fast, slow = [Twist(0.3, 0.0, 0.0)] * 250, [Twist(0.04, 0.0, 0.0)] * 250
    for sequence, is_lowered in ((fast, False), ([*fast[:75], *slow], True)):
        identifier, _ = learned(robot_of(drive), stated, sequence)
        assert (identifier.knowledge.min_speed < 0.1) == is_lowered


@pytest.mark.parametrize('drive', DRIVES)
def test_pulses_that_move_nothing_tell_that_the_least_speed_is_above_them(drive):
    """The next ones are above twice their height, and the base creeps."""
    true = robot_of(drive, min_speed=0.085, min_yaw_rate=0.2)
    known = BaseKnowledge(min_speed=0.03, min_yaw_rate=0.1)
    # The dead time has to be known before, by a drive with stops.
    fast = [Twist(0.25, 0.0, 0.0), STOP]
    sequence = [command for command in fast * 3 for _ in range(30)]
    identifier, _ = learned(true, robot_of(drive), [*sequence, *[Twist(0.03, 0.0, 0.0)] * 150],
                            known=known)
    height = MARGINS[0] * known.min_speed
    assert identifier.knowledge.min_speed >= min(height, 0.06)


def test_a_base_that_stands_above_the_cap_is_not_one_with_a_dead_band():
    """It is blocked or off: no least speed explains that, and the guard has to stop it."""
    identifier = BaseIdentifier(robot_of('differential'))
    base = ImperfectDrive(robot_of('differential', min_speed=1e-9), DriveImperfections(),
                          Pose(0.0, 0.0, 0.0), 1.0)
    for k in range(200):
        time = PERIOD * k
        is_off = k > 100
        identifier.observe(Odometry(time, base.odometry_pose,
                                    STOP if is_off else base.odometry_twist))
        command = Twist(0.2, 0.0, 0.0)
        identifier.add_command(command, time)
        base.command(command)
        base.step(PERIOD, (0.0, 0.0))
    assert identifier.knowledge.min_speed == 0.0


def test_what_was_sent_by_others_is_no_evidence():
    """After a pause in which the base was moved by somebody, nothing of before counts."""
    identifier, _ = learned(robot_of('differential', dead_time=0.2), robot_of('differential'),
                            commands('differential', 3))
    known = identifier.knowledge
    identifier.forget()
    for k in range(50):
        identifier.observe(Odometry(100.0 + PERIOD * k, Pose(0.0, 0.0, 0.0),
                                    Twist(0.3 * math.sin(k), 0.0, 0.0)))
    assert identifier.knowledge == known


@pytest.mark.parametrize('drive', DRIVES)
def test_a_measurement_that_comes_twice_counts_once(drive):
    """What is learned is the same to the bit, at every time."""
    true = robot_of(drive, dead_time=0.2, min_speed=0.05, min_yaw_rate=0.1)
    for count in range(25, 400, 25):
        once, again = (learned(true, robot_of(drive), commands(drive, 3, count),
                               repeats_every=every)[0] for every in (0, 3))
        assert again.knowledge == once.knowledge
    assert once.knowledge.dead_time > 0.1


def test_a_jump_of_time_is_not_followed_step_by_step():
    """Commands whose time is an hour ahead cost nothing, and what was before is forgotten."""
    def filled():
        return learned(robot_of('differential'), robot_of('differential'),
                       [Twist(0.2, 0.0, 0.0)] * 50)[0]

    steps = []
    for jump in (MAX_GAP, 3600.0, 1e9, -3600.0):
        identifier = filled()
        with patch.object(base_identifier, 'track_commands',
                          side_effect=base_identifier.track_commands) as follow:
            identifier.add_command(STOP, PERIOD * 49 + jump)
        steps.append(follow.call_count)
    assert 0 < steps[0] <= MAX_GAP / STEP + 1
    assert steps[1:] == [0, 0, 0]


def test_where_it_is_told_so_all_stays_as_stated():
    stated = robot_of('differential', identify_base=False, dead_time=0.1, min_speed=0.02)
    identifier, _ = learned(robot_of('differential', dead_time=0.3, min_speed=0.08), stated,
                            commands('differential', 4))
    assert identifier.knowledge == BaseKnowledge(0.1, 0.02)
