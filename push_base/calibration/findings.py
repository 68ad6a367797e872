"""What is wrong with a base or its sensors, and what to do about it."""

from collections.abc import Iterator
import enum
from typing import NamedTuple

import numpy as np
from push_base.calibration.drive_fit import DriveFit, plateau_ratios
from push_base.calibration.drive_response import predict
from push_base.calibration.estimation import BaseCalibration
from push_base.calibration.recording import Interruption, Purpose
from push_base.calibration.topics import pose_rows
from push_base.calibration.touch import TouchResult
from push_model.geometry import FloatArray
from push_model.parameters import RoundRobot

# Thresholds, all chosen: what tasks get by with.
MIN_RATE, MAX_GAP = 20.0, 0.2  # [Hz], [s]
MIN_POSE_RATE = 10.0  # [Hz]
# Part of a rate that is enough: periods jitter about one that is just reached.
RATE_MARGIN = 0.9
MAX_DEAD_TIME, MAX_LEAST_SPEED = 0.3, 0.1  # [s], [m/s]
MIN_ACCELERATION_RATIO, MIN_PLATEAU_RATIO, STOPPED_RATIO = 0.7, 0.8, 0.1
MAX_WHEEL_DIFFERENCE, MAX_SCALE_ERROR = 0.02, 0.08
MAX_ODOMETRY_ERROR = 0.03
MAX_SHIFT, SHIFT_DEVIATIONS = 0.03, 6.0  # [m]
MAX_HEADING_OFFSET = 0.35  # [rad]
MIN_DISPLACEMENT = 0.05  # [m]
MAX_TOUCH_ERROR, MAX_STAMP_DELAY = 0.005, 0.05  # [m], [s]


class Finding(enum.Enum):
    """Something wrong: what, and what to do; the text of reports."""

    NO_ODOMETRY = ('No odometry came.',
                   'Remap odom to the topic of the base; compare frame and quality of service.')
    ODOMETRY_LOST = ('Odometry ceased while the robot moved; it was stopped.',
                     'Look at driver, network and battery of the base.')
    NO_MOTION = ('The base does not move as commanded.',
                 'Release its emergency stop and undock it. Compare type (Twist or TwistStamped) '
                 'and topic of commands with what the base subscribes.')
    WRONG_MOTION = ('Odometry shows another motion than the commanded one.',
                    'Axes are those of REP-103: x ahead, y to the left, yaw to the left. Correct '
                    'the driver.')
    RUNAWAY = ('The base moves much faster than commanded; it was stopped.',
               'Compare units (m/s, rad/s), wheel radius and gear ratio in the driver.')
    NO_STOP = ('The base moves on after it was commanded to stop.',
               'Use the emergency stop. Look at its time-out of commands, its brakes, the floor, '
               'and what else commands it.')
    YAW_MIRRORED = ('Yaw of odometry is mirrored: it falls while the robot turns to the left.',
                    'Swap the wheels in the driver, or the sign of its gyroscope.')
    REVERSED = ('The base drives backwards where it should drive ahead.',
                'Change the sign in the driver, or turn base_frame around.')
    AXES_SWAPPED = ('Odometry moves along y where the robot drives along x.',
                    'Turn base_frame by a right angle, or swap the axes in the driver.')
    STOPPED = ('The base stopped for a while although it was commanded.',
               'Turn reflexes (bump, cliff, proximity, stuck) off; look at what else commands it.')
    SCALED = ('Commands were scaled down for a while.',
              'Take collision monitor or speed filter out while pushing, or give them room.')
    SMOOTHER = ('The base accelerates much less than stated.',
                'Raise the limits of the velocity smoother in between, or take it out; else keep '
                'the measured acceleration.')
    LATE = ('The base follows later than pushing needs.',
            'Shorten the way of commands: no smoother, wired network, rate of the driver.')
    HIGH_LEAST_SPEED = ('The wheels turn only from a high speed on.',
                        'Tune the speed controller of the motors (integral part, feedforward).')
    WRONG_SPEED = ('The base drives at another speed than commanded.',
                   'Correct wheel radius and track in the driver.')
    UNEVEN_WHEELS = ('One wheel turns faster than the other where both should be equal.',
                     'Correct the wheel radii, and the gains of the motors.')
    CLOCK_AHEAD = ('Stamps of odometry lie in the future: clocks differ.',
                   'Synchronize the clocks (chrony).')
    CLOCK_BEHIND = ('Stamps of odometry are old: clocks differ, or odometry is delayed.',
                    'Synchronize the clocks (chrony).')
    SLOW_ODOMETRY = ('Odometry comes less than 20 times a second.',
                     'Raise the rate of the driver.')
    ODOMETRY_GAPS = ('Odometry has gaps.', 'Use best effort and a better network.')
    SLOW_POSES = ('Object poses come less than 10 times a second.',
                  'Raise the rate of camera or tracker; control.pose_timeout needs three periods.')
    OBJECT_CLOCK_AHEAD = ('Stamps of object poses lie in the future: clocks differ.',
                          'Synchronize the clocks (chrony).')
    ODOMETRY_ERRS = ('Odometry measures distances or rotations wrongly.',
                     'Correct wheel radius (distances) and track (rotations) in the driver.')
    TRACKER_MIRRORED = ('The tracker sees the robot turn the other way round.',
                        'One frame is mirrored: look at the axes of the tracker (z up).')
    TRACKER_HEADING = ('The robot moves in another direction than the tracker says it faces.',
                       'Put the heading of the marker right: x of its frame is ahead.')
    OBJECT_MOVES_ALONG = ('The object stands, but its pose moves as the robot does.',
                          'Its frame is not that of odometry, or a transform is mirrored or late.')
    SIZE_WRONG = ('Radius of the robot, or size of the object, is not as stated.',
                  'Measure both (bumper pressed) and correct robot.radius or the outline.')
    POSES_OFFSET = ('Object poses are off along the push.',
                    'Correct where the marker sits on the object, or the frame of the tracker.')
    SIZE_OR_OFFSET = ('Robot and object touch elsewhere than sizes and poses say.',
                      'Measure radius (bumper pressed), outline, and the place of the marker. '
                      '--touch around tells sizes from poses.')
    STAMPS_SHIFTED = ('Object poses are not of the time of their stamps.',
                      'Stamp images when they are taken, in the driver of the tracker.')
    OBJECT_UNSEEN = ('The robot pushed, and the object did not move by its poses.',
                     'Look at what the tracker follows: another object, or a pose that stands.')
    TOO_WEAK = ('The wheels spin: the base pushes with less force than this object needs.',
                'Take a lighter object or smoother feet, load the drive wheels, or clean them; '
                'robot.max_push_force warns of other objects.')
    WHEELS_SLIP = ('The object comes less far than the wheels turn.',
                   'Correct odometry first. Else the wheels slip: the object is near to what the '
                   'base can push.')

    @property
    def sentence(self) -> str:
        """Sentence that states the fault."""
        return self.value[0]

    @property
    def remedy(self) -> str:
        """Remedy of the fault."""
        return self.value[1]


# What an interruption says by itself.
OF_INTERRUPTIONS: dict[Interruption | None, Finding] = {
    Interruption.ODOMETRY_LOST: Finding.ODOMETRY_LOST, Interruption.NO_MOTION: Finding.NO_MOTION,
    Interruption.RUNAWAY: Finding.RUNAWAY, Interruption.NO_STOP: Finding.NO_STOP}


class _Motion(NamedTuple):
    """Motion in the first segment of a kind: commanded speed, and displacement in own axes."""

    command: float
    displacement: FloatArray


def find_faults(calibration: BaseCalibration) -> list[Finding]:
    """
    List what is wrong.

    :return: in the order of ``Finding``.
    """
    faults = {*_of_program(calibration), *_of_times(calibration), *_of_odometry(calibration)}
    faults.update(_of_objects(calibration))
    if calibration.touches is not None:
        faults.update(_of_touches(calibration.touches))
    # Where the base moves otherwise than commanded, a model of it says nothing.
    drive = calibration.drive
    interruption = calibration.recording.interruption
    if drive is not None and not (interruption is not None and interruption.is_of_motion):
        faults.update(_of_drive(calibration.recording.robot, drive))
        faults.update(_of_plateaus(calibration, drive))
    return [finding for finding in Finding if finding in faults]


def _of_program(calibration: BaseCalibration) -> Iterator[Finding]:
    recording = calibration.recording
    if not recording.odometry:
        yield Finding.NO_ODOMETRY
    finding = OF_INTERRUPTIONS.get(recording.interruption)
    if finding is not None:
        yield finding
    if recording.interruption is Interruption.WRONG_MOTION:
        yield _wrong_motion(calibration)


def _wrong_motion(calibration: BaseCalibration) -> Finding:
    turn, line = _first_motion(calibration, 2), _first_motion(calibration, 0)
    if turn is not None and turn.command * turn.displacement[2] < 0.0:
        return Finding.YAW_MIRRORED
    if line is None:
        return Finding.WRONG_MOTION
    x, y = line.displacement[:2]
    if abs(y) > 2.0 * abs(x) and abs(y) > MIN_DISPLACEMENT:
        return Finding.AXES_SWAPPED
    is_reversed = line.command * x < 0.0 and abs(x) > MIN_DISPLACEMENT
    return Finding.REVERSED if is_reversed else Finding.WRONG_MOTION


def _first_motion(calibration: BaseCalibration, axis: int) -> _Motion | None:
    """Return what odometry says of the first step along an axis, and of the rest behind it."""
    recording = calibration.recording
    steps = [item for item in recording.commands
             if item.purpose is Purpose.STEP and item.twist[axis] != 0.0]
    if not steps:
        return None
    segment, command = steps[0].segment, steps[0].twist[axis]
    times = [item.time for item in recording.commands if segment <= item.segment <= segment + 1]
    poses = [item.odometry.pose for item in recording.odometry
             if times[0] <= item.arrival <= times[-1]]
    if len(poses) < 2:
        return None
    return _Motion(command, np.array(poses[0].inverse() @ poses[-1]))


def _of_times(calibration: BaseCalibration) -> Iterator[Finding]:
    odometry, objects = calibration.odometry_times, calibration.object_times
    if odometry is not None:
        if odometry.age < -0.005:
            yield Finding.CLOCK_AHEAD
        elif not calibration.is_clock_common:
            yield Finding.CLOCK_BEHIND
        if odometry.rate < RATE_MARGIN * MIN_RATE:
            yield Finding.SLOW_ODOMETRY
        elif odometry.longest_gap > MAX_GAP:
            yield Finding.ODOMETRY_GAPS
    if objects is not None:
        if objects.age < -0.005:
            yield Finding.OBJECT_CLOCK_AHEAD
        if objects.rate < RATE_MARGIN * MIN_POSE_RATE:
            yield Finding.SLOW_POSES


def _of_odometry(calibration: BaseCalibration) -> Iterator[Finding]:
    errors = calibration.errors
    if errors is None:
        return
    if errors.yaw_scale.value < -1.0:
        yield Finding.TRACKER_MIRRORED
        return
    if max(abs(errors.scale.value), abs(errors.yaw_scale.value)) > MAX_ODOMETRY_ERROR:
        yield Finding.ODOMETRY_ERRS
    if abs(errors.heading_offset) > MAX_HEADING_OFFSET:
        yield Finding.TRACKER_HEADING


def _of_objects(calibration: BaseCalibration) -> Iterator[Finding]:
    noise, poses = calibration.object_noise, calibration.recording.object_poses
    if noise is None:
        return
    rows = pose_rows([item.measured.pose for item in poses])
    # Without the few that are far off.
    deviation = float(np.ptp(np.quantile(rows[:, :2], (0.02, 0.98), axis=0), axis=0).max())
    if deviation > max(MAX_SHIFT, SHIFT_DEVIATIONS * noise.position):
        yield Finding.OBJECT_MOVES_ALONG


def _of_touches(result: TouchResult) -> Iterator[Finding]:
    for finding, error, limit in (
            (Finding.SIZE_WRONG, result.size_error, MAX_TOUCH_ERROR),
            (Finding.POSES_OFFSET, result.pose_offset, MAX_TOUCH_ERROR),
            (Finding.SIZE_OR_OFFSET, result.combined, MAX_TOUCH_ERROR),
            (Finding.STAMPS_SHIFTED, result.stamp_delay, MAX_STAMP_DELAY)):
        if error is not None and abs(error.value) > limit:
            yield finding
    if any(touch.is_object_unseen for touch in result.touches):
        yield Finding.OBJECT_UNSEEN
    if result.is_too_weak:
        yield Finding.TOO_WEAK
    elif any(touch.is_slipping for touch in result.touches):
        yield Finding.WHEELS_SLIP


def _of_drive(robot: RoundRobot, drive: DriveFit) -> Iterator[Finding]:
    accelerations = ((drive.acceleration, robot.max_acceleration),
                     (drive.yaw_acceleration, robot.max_yaw_acceleration))
    if any(measured is not None and measured.high < MIN_ACCELERATION_RATIO * stated
           for measured, stated in accelerations):
        yield Finding.SMOOTHER
    if drive.dead_time.low > MAX_DEAD_TIME:
        yield Finding.LATE
    least = [interval.value for interval in drive.least_speeds[:_wheel_count(robot)]
             if interval is not None]
    if least and max(least) > MAX_LEAST_SPEED:
        yield Finding.HIGH_LEAST_SPEED
    first, second = (scale.value for scale in drive.scales)
    if max(abs(first - 1.0), abs(second - 1.0)) > MAX_SCALE_ERROR:
        yield Finding.WRONG_SPEED
    if robot.drive == 'differential' and abs(first / second - 1.0) > MAX_WHEEL_DIFFERENCE:
        yield Finding.UNEVEN_WHEELS


def _wheel_count(robot: RoundRobot) -> int:
    """Return how many of the channels are speeds."""
    return 2 if robot.drive == 'differential' else 1


def _of_plateaus(calibration: BaseCalibration, drive: DriveFit) -> Iterator[Finding]:
    """Look for segments at whose end the base was slower than in the others."""
    signals = calibration.signals
    predicted = signals._replace(velocities=predict(
        calibration.recording.robot, drive.response, signals.sent, signals.commands,
        signals.times))
    ratios: list[float] = []
    for purpose in (Purpose.STEP, Purpose.LEVELS, Purpose.TURN, Purpose.LINE):
        for axis in range(3):
            pairs = zip(plateau_ratios(signals, drive.dead_time.value, purpose, axis),
                        plateau_ratios(predicted, drive.dead_time.value, purpose, axis))
            ratios += [measured / expected for (measured, _), (expected, _) in pairs
                       if abs(expected) > 0.3]
    if ratios and min(ratios) < STOPPED_RATIO:
        yield Finding.STOPPED
    elif ratios and min(ratios) < MIN_PLATEAU_RATIO * float(np.median(ratios)):
        yield Finding.SCALED
