"""Shaped commands: what a base with dead band or steps gets, and where it ends up."""

import math

import numpy as np
from push_base.command_shaper import CommandShaper, MAX_QUANTUM, pulse_height
from push_model.base_knowledge import BaseKnowledge
from push_model.geometry import Pose
from push_model.parameters import RoundRobot
from push_model.signals import STOP, Twist
from push_model.wheels import twist_of_wheels, wheel_speeds
from push_sim_node.drive_imperfections import DriveImperfections
from push_sim_node.imperfect_drive import ImperfectDrive, is_ideal
import pytest

PERIOD = 0.02
BANDS = {'min_speed': 0.05, 'min_yaw_rate': 0.1, 'track': 0.23}
DRIVES = 'differential', 'holonomic'


def robot_of(drive, **fields):
    """Return a robot with a dead band."""
    return RoundRobot(0.17, drive=drive, **{**BANDS, **fields})


def shaped(shaper, commands):
    """Return what is sent for each command, one a period, shape (n, 3)."""
    return np.array([shaper.shape(command, PERIOD * k) for k, command in enumerate(commands)])


def channels(robot, twists):
    """Return speeds of wheels, or translation and rotation, shape (n, 2)."""
    if robot.drive == 'differential':
        return np.array([wheel_speeds(Twist(*twist), robot.wheel_track) for twist in twists])
    return np.column_stack([np.hypot(twists[:, 0], twists[:, 1]), twists[:, 2]])


def slow_commands(seed, drive, count=1000):
    """Draw commands that vary slowly, below and above the dead band."""
    rng = np.random.default_rng(seed)
    t = PERIOD * np.arange(count)
    v_x, v_y, omega = (size * np.sin(rng.uniform(0.3, 1.5) * t + rng.uniform(0.0, 6.0))
                       for size in (0.15, 0.1, 0.5))
    return [Twist(float(x), float(y) if drive == 'holonomic' else 0.0, float(w))
            for x, y, w in zip(v_x, v_y, omega)]


@pytest.mark.parametrize('drive', DRIVES)
def test_where_nothing_is_stated_the_command_itself_passes(drive):
    """Not an equal twist, the same: to wheels and back would change the last digit."""
    shaper = CommandShaper(RoundRobot(0.17, drive=drive))
    for k, command in enumerate(slow_commands(1, drive)):
        assert shaper.shape(command, PERIOD * k) is command


@pytest.mark.parametrize('drive', DRIVES)
def test_a_command_that_the_base_follows_passes_itself(drive):
    """Also where other commands would be shaped."""
    shaper = CommandShaper(robot_of(drive))
    command = Twist(0.25, 0.0, 0.3 if drive == 'holonomic' else 0.1)
    for k in range(100):
        assert shaper.shape(command, PERIOD * k) == command


@pytest.mark.parametrize('drive', DRIVES)
@pytest.mark.parametrize('seed', range(5))
def test_what_is_sent_is_nothing_or_above_the_dead_band(drive, seed):
    """With a margin of a tenth at least, in every channel."""
    robot = robot_of(drive)
    sent = channels(robot, shaped(CommandShaper(robot), slow_commands(seed, drive)))
    bands = (0.05, 0.05) if drive == 'differential' else (0.05, 0.1)
    for speeds, band in zip(np.abs(sent.T), bands):
        assert (speeds[speeds > 1e-12] > 1.1 * band * (1.0 - 1e-9)).all()
        assert (speeds < 1e-12).any()


@pytest.mark.parametrize('drive', DRIVES)
@pytest.mark.parametrize('seed', range(5))
def test_the_mean_is_right(drive, seed):
    """No wheel is farther from where it should be than half a pulse and a period."""
    robot, commands = robot_of(drive), slow_commands(seed, drive)
    difference = shaped(CommandShaper(robot), commands) - np.array(commands)
    owed = np.cumsum(PERIOD * difference, axis=0)
    height = pulse_height(0.05, 0.08, MAX_QUANTUM)
    # What is owed is forgotten where a channel passes, which a slow command does few times.
    bound = 4.0 * height * (0.5 * 0.08 + PERIOD)
    assert np.abs(owed[:, :2]).max() < bound
    constant = CommandShaper(robot)
    slow = [Twist(0.02, 0.0, 0.0)] * 500
    distance = PERIOD * shaped(constant, slow)[:, 0].sum()
    assert distance == pytest.approx(0.02 * 10.0, abs=height * (0.5 * 0.08 + PERIOD))


def times_of(rate, jitter, seconds, seed):
    """Return times of commands, whose distances vary evenly by the jitter [s]."""
    rng = np.random.default_rng(seed)
    count = round(seconds * rate)
    return np.cumsum(1.0 / rate + rng.uniform(-jitter, jitter, count))


@pytest.mark.parametrize('drive', DRIVES)
@pytest.mark.parametrize('rate', [20, 33, 50])
@pytest.mark.parametrize('jitter', [0.0, 0.002])
@pytest.mark.parametrize('pulse', [0.08, 0.104])
@pytest.mark.parametrize('command', [
    Twist(0.005, 0.0, 0.0), Twist(-0.02, 0.0, 0.0), Twist(0.04, 0.0, 0.1),
    Twist(0.0, 0.0, 0.05)])
def test_no_pulse_goes_against_what_is_desired(drive, rate, jitter, pulse, command):
    """At any rate of commands, although pulses last whole periods; and the mean is right."""
    robot = robot_of(drive)
    shaper = CommandShaper(robot)
    shaper.knowledge = BaseKnowledge(min_speed=0.05, min_yaw_rate=0.1, pulse=pulse)
    times = times_of(rate, jitter, 60.0, 5)
    sent = channels(robot, np.array([shaper.shape(command, time) for time in times.tolist()]))
    desired = channels(robot, np.array([command]))[0]
    assert (sent * np.sign(desired) >= -1e-12).all()
    driven = (sent[:-1] * np.diff(times)[:, None]).sum(axis=0)
    heights = pulse_height(np.array([0.05, 0.05 if drive == 'differential' else 0.1]).max(),
                           pulse, MAX_QUANTUM / (0.5 * robot.wheel_track))
    bound = heights * (0.5 * pulse + np.diff(times).max())
    assert driven == pytest.approx(desired * (times[-1] - times[0]), abs=bound)


@pytest.mark.parametrize('rate', [20, 33, 50])
@pytest.mark.parametrize('jitter', [0.0, 0.002])
def test_no_translation_goes_against_a_direction_that_turns(rate, jitter):
    """No vector has, as its pulse starts, a part against the one that is desired."""
    robot = robot_of('holonomic')
    shaper = CommandShaper(robot)
    shaper.knowledge = BaseKnowledge(min_speed=0.05, min_yaw_rate=0.1, pulse=0.104)
    times = times_of(rate, jitter, 60.0, 6)
    desired = [Twist(0.01 * math.cos(0.2 * time), 0.01 * math.sin(0.2 * time), 0.0)
               for time in times.tolist()]
    sent = np.array([shaper.shape(command, time)
                     for command, time in zip(desired, times.tolist())])
    starts = np.flatnonzero(np.any(np.diff(sent, axis=0), axis=1)) + 1
    assert (np.sum(sent * desired, axis=1)[starts] >= -1e-12).all()
    owed = np.cumsum((sent - desired)[:-1] * np.diff(times)[:, None], axis=0)
    height = pulse_height(0.05, 0.104, MAX_QUANTUM)
    # What a pulse went too far in one direction is across the desired one after a quarter turn.
    assert np.hypot(*owed[:, :2].T).max() <= height * (0.104 + np.diff(times).max())


@pytest.mark.parametrize('rate', [20, 33, 50])
@pytest.mark.parametrize('count', range(5, 40, 5))
def test_a_wheel_that_is_to_stand_does_not_go_to_and_fro(rate, count):
    """It gets one pulse at most for what it is owed from before."""
    robot = robot_of('differential', track=0.25)
    shaper = CommandShaper(robot)
    about_right = Twist(0.1, 0.0, -0.8)
    assert wheel_speeds(about_right, robot.wheel_track)[1] == 0.0
    commands = [Twist(0.01, 0.0, 0.0)] * count + [about_right] * 500
    right = channels(robot, np.array([shaper.shape(command, k / rate)
                                      for k, command in enumerate(commands)]))[count:, 1]
    moves = np.abs(right) > 1e-12
    assert np.count_nonzero(np.diff(moves.astype(int), prepend=0) == 1) <= 1
    assert not moves[rate:].any()


@pytest.mark.parametrize('drive', DRIVES)
def test_a_stop_passes_at_once_and_clears_what_is_owed(drive):
    """In the middle of a pulse, and a second one starts as the first did."""
    shaper = CommandShaper(robot_of(drive))
    slow = Twist(0.0213, 0.0, 0.0)
    first = shaped(shaper, [slow] * 100)
    k = int(np.flatnonzero(first[:, 0])[0])
    shaper = CommandShaper(robot_of(drive))
    for i in range(k + 1):
        sent = shaper.shape(slow, PERIOD * i)
    assert sent != STOP
    assert shaper.shape(STOP, PERIOD * (k + 1)) == STOP
    again = [shaper.shape(slow, PERIOD * (k + 2 + i)) for i in range(100)]
    assert np.array(again) == pytest.approx(first, abs=1e-12)


@pytest.mark.parametrize('drive', DRIVES)
def test_mirrored_commands_are_shaped_alike(drive):
    commands = slow_commands(3, drive)
    mirrored = [Twist(-v_x, -v_y, -omega) for v_x, v_y, omega in commands]
    robot = robot_of(drive)
    assert shaped(CommandShaper(robot), mirrored) == pytest.approx(
        -shaped(CommandShaper(robot), commands), abs=1e-12)


@pytest.mark.parametrize('drive', DRIVES)
def test_steps_of_speed_are_kept_and_their_mean_is_right(drive):
    """Every channel is a whole number of steps, and on average what is desired."""
    robot = RoundRobot(0.17, drive=drive, speed_step=0.02, track=0.2)
    sent = shaped(CommandShaper(robot), [Twist(0.133, 0.0, 0.17)] * 1000)
    speeds = channels(robot, sent) / (0.02 if drive == 'differential' else (0.02, 0.2))
    assert speeds == pytest.approx(np.round(speeds), abs=1e-9)
    assert sent.mean(axis=0) == pytest.approx((0.133, 0.0, 0.17), abs=2e-3)


@pytest.mark.parametrize('drive', DRIVES)
@pytest.mark.parametrize('behind', [False, True])
def test_a_base_with_a_dead_band_goes_where_it_should(drive, behind):
    """It creeps a decimetre where it did not move at all, and behind the lag a part of that."""
    stated = robot_of(drive, max_acceleration=0.9)
    faults = DriveImperfections(output_min_speed=0.05) if behind else DriveImperfections()
    true = RoundRobot(0.17, drive=drive, max_acceleration=0.9) if behind else stated
    assert not is_ideal(true, faults)
    distances = []
    for shaper in (CommandShaper(RoundRobot(0.17, drive=drive)), CommandShaper(stated)):
        base = ImperfectDrive(true, faults, Pose(0.0, 0.0, 0.0), 1.0)
        for k in range(250):
            base.command(shaper.shape(Twist(0.02, 0.0, 0.0), PERIOD * k))
            for _ in range(10):
                base.step(0.1 * PERIOD, (0.0, 0.0))
        distances.append(base.odometry_pose.x)
    assert distances[0] == 0.0
    if behind:
        assert 0.02 < distances[1] < 0.1
    else:
        assert distances[1] == pytest.approx(0.1, abs=0.01)


def test_pulses_are_no_higher_than_they_must():
    """Twice the least speed, less where that is far, and never less than a tenth above it."""
    heights = [pulse_height(least, 0.08, MAX_QUANTUM) for least in np.linspace(0.0, 0.3, 100)]
    for least, height in zip(np.linspace(0.0, 0.3, 100), heights):
        assert 1.1 * least <= height <= 2.2 * least
        assert height <= max(1.1 * least, MAX_QUANTUM / 0.08)
    assert np.all(np.diff(heights) >= 0.0)


def test_what_is_known_counts_from_the_next_command_on():
    shaper = CommandShaper(RoundRobot(0.17, track=0.2))
    slow = Twist(0.01, 0.0, 0.0)
    assert shaper.shape(slow, 0.0) is slow
    shaper.knowledge = BaseKnowledge(min_speed=0.05)
    sent = [shaper.shape(slow, 0.02 * k).v_x for k in range(1, 200)]
    assert min(sent) == 0.0 and max(sent) == pytest.approx(0.11)


@pytest.mark.parametrize('seed', range(4))
def test_a_command_that_is_asked_for_twice_at_once_is_shaped_once(seed):
    """As where a measurement comes twice; also where an axis is to stand and is still owed."""
    robot = robot_of('holonomic')
    wanted = [Twist(command.v_x, command.v_y, 0.0) if k % 7 < 4 else Twist(0.0, 0.0, command.omega)
              for k, command in enumerate(slow_commands(seed, 'holonomic'))]
    once, twice = CommandShaper(robot), CommandShaper(robot)
    for k, command in enumerate(wanted):
        sent = once.shape(command, PERIOD * k)
        assert twice.shape(command, PERIOD * k) == sent
        assert twice.shape(command, PERIOD * k) == sent


def test_wheels_and_twist_are_inverse():
    """At any speed, and a robot turns about a wheel that rests."""
    rng = np.random.default_rng(4)
    for v_x, omega, track in rng.uniform(0.1, 2.0, (20, 3)):
        left, right = wheel_speeds(Twist(v_x, 0.0, omega), track)
        assert twist_of_wheels(left, right, track) == pytest.approx((v_x, 0.0, omega))
    assert wheel_speeds(Twist(0.1, 0.0, 1.0), 0.2)[0] == 0.0
    assert math.copysign(1.0, wheel_speeds(Twist(0.0, 0.0, 1.0), 0.2)[0]) == -1.0
