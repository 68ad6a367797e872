"""A calibration stays in its square, whatever the base makes of the commands."""

from collections import deque

from push_base.calibration.program import CalibrationProgram
from push_base.calibration.recording import Interruption
from push_model.geometry import Pose
from push_model.parameters import RoundRobot
from push_model.signals import Odometry, STOP, Twist
import pytest

PERIOD, LONGEST = 0.05, 200.0
SIDE, RADIUS = 1.5, 0.17


def calibrated(drive: str, gain: float, delay: float) -> tuple[float, Interruption | None]:
    """
    Calibrate a base.

    :param gain: speed over commanded speed.
    :param delay: of the commands [s].
    :return: how far it comes from its start along x or y [m], and why it was stopped.
    """
    robot = RoundRobot(radius=RADIUS, drive=drive, max_speed=0.5, max_yaw_rate=2.0,
                       max_acceleration=0.9)
    program, pose, twist = CalibrationProgram(robot, SIDE), Pose(0.0, 0.0, 0.0), STOP
    pending, result = deque([STOP] * round(delay / PERIOD)), 0.0
    for step in range(round(LONGEST / PERIOD)):
        pending.append(program.step(PERIOD * step, Odometry(PERIOD * step, pose, twist)))
        v_x, v_y, omega = pending.popleft()
        twist = Twist(gain * v_x, gain * v_y, omega)
        half = Pose(0.0, 0.0, 0.5 * PERIOD * twist.omega)
        pose = pose @ Pose(*half.rotate((PERIOD * twist.v_x, PERIOD * twist.v_y)),
                           2.0 * half.theta)
        result = max(result, abs(pose.x), abs(pose.y))
        if program.is_done:
            break
    assert program.is_done
    return result, program.recording.interruption


@pytest.mark.parametrize('drive', ['differential', 'holonomic'])
@pytest.mark.parametrize('gain, delay', [(1.0, 0.0), (1.2, 0.3), (1.5, 0.0)])
def test_a_base_that_is_faster_or_later_than_commanded_stays_in_the_square(
        drive: str, gain: float, delay: float) -> None:
    """With its whole body."""
    assert calibrated(drive, gain, delay)[0] < 0.5 * SIDE - RADIUS


@pytest.mark.parametrize('gain', [-1.0, -0.32])
def test_a_base_that_moves_the_other_way_ends_the_calibration(gain: float) -> None:
    """In its first step, of 0.3 m; the slow one is within the margins of all velocities."""
    distance, reason = calibrated('differential', gain, 0.0)
    assert reason is Interruption.WRONG_MOTION and distance < 0.31 * abs(gain)


@pytest.mark.parametrize('drive', ['differential', 'holonomic'])
@pytest.mark.parametrize('gain', [1.5, 2.5])
def test_a_base_too_fast_for_the_square_is_said_to_be_too_fast(drive: str, gain: float) -> None:
    """Though the square stops it before it has moved by what commands ask for."""
    distance, reason = calibrated(drive, gain, 0.0)
    assert reason is Interruption.RUNAWAY and distance < 0.1


def test_a_base_that_does_not_move_ends_the_calibration() -> None:
    """Odometry comes, and says so."""
    robot = RoundRobot(radius=RADIUS, max_speed=0.5, max_acceleration=0.9)
    program, time = CalibrationProgram(robot, SIDE), 0.0
    while not program.is_done and time < LONGEST:
        program.step(time, Odometry(time, Pose(0.0, 0.0, 0.0), STOP))
        time += PERIOD
    assert program.recording.interruption is Interruption.NO_MOTION and time < 60.0


def test_a_calibration_ends_where_odometry_does() -> None:
    """Within a second, with zeros."""
    robot = RoundRobot(radius=RADIUS, max_speed=0.5, max_acceleration=0.9)
    program, time = CalibrationProgram(robot, SIDE), 0.0
    program.step(time, Odometry(time, Pose(0.0, 0.0, 0.0), STOP))
    while not program.is_done and time < LONGEST:
        time += PERIOD
        command = program.step(time, None)
    assert program.recording.interruption is Interruption.ODOMETRY_LOST
    assert command == STOP and time < 1.5
