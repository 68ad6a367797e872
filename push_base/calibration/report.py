"""What was measured, in words and as files that robot and scenarios use."""

from collections.abc import Callable, Iterator
import math
from typing import Any

from push_base.calibration.drive_fit import DriveFit
from push_base.calibration.estimation import BaseCalibration, MAX_AGE, MIN_AGE
from push_base.calibration.findings import find_faults
from push_base.calibration.topics import Noise, TopicTimes
from push_base.calibration.touch import TouchResult
from push_model.files.mapping import to_mapping
from push_model.interval import Interval
from push_model.parameters import RoundRobot

HEAD = '# Of calibrate: intervals are those of 95 %.'
# Digits of numbers in files.
DIGITS = 4
# Least speeds below this need no pulses [m/s]; chosen: slower than anything that is commanded.
NO_LEAST_SPEED = 0.005
# Half widths of unknown noises that files state at least, as parameters are above 0.
MIN_NOISE = 1e-4
# Periods of object poses that may be missing, and least time-out [s]; chosen: a computer may be
# busy for as long.
LOST_PERIODS, MIN_TIMEOUT = 3.0, 0.1
# Force that a base is stated to have over that at which its wheels spun; chosen: what warns of
# such an object.
SPIN_FORCE_RATIO = 0.9
# Parameters of the robot that nothing here measures.
STATED = {'radius', 'drive', 'track', 'max_push_force', 'identify_base'}

# A line of a file: name, value, comment.
Entry = tuple[str, Any, str]


def summary(calibration: BaseCalibration) -> str:
    """
    Write what was measured, and what is wrong.

    :return: lines.
    """
    recording = calibration.recording
    lines: list[str] = []
    if recording.interruption is not None:
        lines += [f'Ended early: {recording.interruption.value}. What was measured until then:']
    lines += [f'  {name:24} {text}' for name, text in rows(calibration)]
    if calibration.failures:
        lines.append('Not computed:')
        lines += [f'* {failure}' for failure in calibration.failures]
    faults = find_faults(calibration)
    lines.append('Nothing is wrong with base and sensors, as far as was measured.' if not faults
                 else 'What is wrong, and what to do:')
    for finding in faults:
        lines += [f'* {finding.sentence}', f'  {finding.remedy}']
    lines.append('Not measured: ' + (
        'radius at a touch, mounting of the tracker, pushing force (--touch).'
        if calibration.touches is None else
        'offsets of object poses across the push, the greatest pushing force.'))
    return '\n'.join(lines)


def rows(calibration: BaseCalibration) -> list[tuple[str, str]]:
    """List what was measured as (name, value with its interval)."""
    robot = calibration.recording.robot
    table: list[tuple[str, str]] = []
    drive = calibration.drive
    if drive is None:
        table.append(('drive', 'not measured'))
    else:
        table += _drive_rows(robot, drive)
    errors = calibration.errors
    if errors is None:
        table.append(('scale of odometry', 'not measured: nothing measures the robot in the '
                      'world (robot_pose)'))
    else:
        table += [('scale of odometry', _text(errors.scale, 100.0, '%', 2)),
                  ('scale of its rotations', _text(errors.yaw_scale, 100.0, '%', 2)),
                  ('drift of its heading', _text(errors.heading_drift, 1.0, 'rad/m', 4))]
    table += _topic_rows('odometry', calibration.odometry_times)
    table += _noise_rows('velocity noise', calibration.velocity_noise, ('mm/s', 'mrad/s'))
    table += _topic_rows('object poses', calibration.object_times)
    table += _noise_rows('object pose noise', calibration.object_noise, ('mm', 'mrad'))
    if calibration.touches is not None:
        table += _touch_rows(calibration.touches)
    elif calibration.recording.object is not None:
        table.append(('touch', 'not done: no object poses of an object ahead, or it was stopped'))
    return table


def _drive_rows(robot: RoundRobot, drive: DriveFit) -> list[tuple[str, str]]:
    names = _channel_names(robot)
    table = [('dead time', _text(drive.dead_time, 1000.0, 'ms', 0)),
             ('lag', _text(drive.time_constant, 1000.0, 'ms', 0)),
             ('acceleration', _text(drive.acceleration, 1.0, 'm/s^2', 2)),
             ('yaw acceleration', _text(drive.yaw_acceleration, 1.0, 'rad/s^2', 1))]
    units = ('m/s', 'm/s' if robot.drive == 'differential' else 'rad/s')
    table += [(f'least speed, {name}', _text(least, 1.0, unit, 3))
              for name, least, unit in zip(names, drive.least_speeds, units)]
    table += [(f'speed, {name}', _text(scale, 100.0, '% of the command', 1))
              for name, scale in zip(names, drive.scales)]
    response = drive.response
    for name, value, unit in (('step of speeds', drive.speed_step, 'm/s'),
                              ('greatest speed', response.max_speed, 'm/s'),
                              ('greatest yaw rate', response.max_yaw_rate, 'rad/s')):
        if 0.0 < value < math.inf:
            table.append((name, f'{value:.3f} {unit}'))
    return table


def _touch_rows(result: TouchResult) -> Iterator[tuple[str, str]]:
    for name, error in (('radius + size + offset', result.combined),
                        ('radius + size', result.size_error),
                        ('offset of object poses', result.pose_offset)):
        if error is not None:
            yield name, 'greater than stated by ' * (name != 'offset of object poses') + _text(
                error, 1000.0, 'mm', 1)
    if result.stamp_delay is not None:
        yield 'object stamps too late', _text(result.stamp_delay, 1000.0, 'ms', 0)
    ratio = min(touch.object_ratio for touch in result.touches)
    force = f'{result.needed_force:.0f} N as stated'
    is_unseen = any(touch.is_object_unseen for touch in result.touches)
    yield 'force needed', force
    yield 'force available', 'not known' if is_unseen else (
        f'less: the object came {100.0 * max(0.0, ratio):.0f} % of the way of the wheels'
        if result.is_too_weak else
        f'as much: the object came {100.0 * ratio:.0f} % of the way of the wheels')


def _channel_names(robot: RoundRobot) -> tuple[str, str]:
    return (('left wheel', 'right wheel') if robot.drive == 'differential'
            else ('translation', 'rotation'))


def _topic_rows(name: str, times: TopicTimes | None) -> Iterator[tuple[str, str]]:
    if times is not None:
        yield name, (f'{times.rate:.1f} Hz, {1000.0 * times.age:.0f} ms old '
                     f'(99 %: {1000.0 * times.max_age.value:.0f} ms)')


def _noise_rows(name: str, noise: Noise | None,
                units: tuple[str, str]) -> Iterator[tuple[str, str]]:
    if noise is not None:
        yield name, (f'{1000.0 * noise.position:.2f} {units[0]}, '
                     f'{1000.0 * noise.heading:.2f} {units[1]}')


def _text(interval: Interval | None, factor: float, unit: str, digits: int) -> str:
    if interval is None:
        return 'not reached: as stated'
    value, low, high = (f'{factor * number:.{digits}f}' for number in interval)
    return f'{value} {unit} ({low} to {high})'


def robot_entries(calibration: BaseCalibration) -> list[Entry]:
    """
    List the parameters of the robot, as measured, else as stated.

    :return: (name, value, comment) of every parameter of ``RoundRobot``.
    """
    robot, drive = calibration.recording.robot, calibration.drive
    entries = [] if drive is None else _drive_entries(robot, drive)
    touches = calibration.touches
    if touches is not None and touches.is_too_weak:
        force = min(robot.max_push_force, _rounded(SPIN_FORCE_RATIO * touches.needed_force))
        entries.append(('max_push_force', force, 'wheels spun at an object that needs '
                        f'{touches.needed_force:.1f} N'))
    measured = {entry[0]: entry for entry in entries}
    comment = 'not measured' if drive is None else 'as stated'
    return [measured.get(name, (name, value, 'as stated' if name in STATED else comment))
            for name, value in to_mapping(robot).items()]


def _drive_entries(robot: RoundRobot, drive: DriveFit) -> list[Entry]:
    """List the parameters that are measured."""
    response = drive.response
    entries = [_limit('max_speed', robot.max_speed, response.max_speed),
               _limit('max_yaw_rate', robot.max_yaw_rate, response.max_yaw_rate),
               _measured('max_acceleration', drive.acceleration, robot.max_acceleration),
               _measured('max_yaw_acceleration', drive.yaw_acceleration,
                         robot.max_yaw_acceleration),
               _measured('time_constant', drive.time_constant, robot.time_constant),
               _measured('dead_time', drive.dead_time, robot.dead_time)]
    first, second = drive.least_speeds
    if robot.drive == 'differential':
        # Of both wheels the one that turns later.
        known = [interval for interval in (first, second) if interval is not None]
        entries.append(_least('min_speed', max(known, default=None), robot.min_speed))
        entries.append(('min_yaw_rate', 0.0, 'of holonomic bases'))
    else:
        entries.append(_least('min_speed', first, robot.min_speed))
        entries.append(_least('min_yaw_rate', second, robot.min_yaw_rate))
    entries.append(('speed_step', _rounded(drive.speed_step), 'measured'))
    return entries


def _limit(name: str, stated: float, reached: float) -> Entry:
    if reached < stated:
        return name, _rounded(reached), f'measured; stated: {stated:g}'
    return name, stated, 'as stated; no lower limit was seen'


def _measured(name: str, interval: Interval | None, stated: float) -> Entry:
    if interval is None:
        return name, stated, 'as stated; not reached'
    return name, _rounded(interval.value), _comment(interval)


def _least(name: str, interval: Interval | None, stated: float) -> Entry:
    if interval is None:
        return name, stated, 'as stated; no ramp moved the base'
    value = interval.value if interval.value >= NO_LEAST_SPEED else 0.0
    return name, _rounded(value), _comment(interval)


def _comment(interval: Interval) -> str:
    return f'95 %: {_rounded(interval.low):g} to {_rounded(interval.high):g}'


def _rounded(value: float) -> float:
    return round(value, DIGITS)


def sensor_entries(calibration: BaseCalibration) -> list[Entry]:
    """List the settings of simulated sensors that err as these do."""
    entries: list[Entry] = []
    for prefix, times in (('odometry', calibration.odometry_times),
                          ('pose', calibration.object_times)):
        if times is not None:
            entries.append((f'{prefix}_rate', round(times.rate, 1), 'measured'))
    times = calibration.object_times
    if times is not None:
        entries.append(('pose_latency', max(0.0, _rounded(times.age)),
                        f'median age; of 99 %: up to {_rounded(times.max_age.value):g}'))
    for names, noise in ((('odometry_speed_noise', 'odometry_yaw_rate_noise'),
                          calibration.velocity_noise),
                         (('pose_noise', 'pose_heading_noise'), calibration.object_noise)):
        if noise is not None:
            entries += [(names[0], _rounded(noise.position), 'at rest'),
                        (names[1], _rounded(noise.heading), 'at rest')]
    errors = calibration.errors
    if errors is not None:
        entries += [(name, _rounded(interval.value), _comment(interval)) for name, interval in (
            ('odometry_scale', errors.scale), ('odometry_yaw_scale', errors.yaw_scale),
            ('odometry_heading_drift', errors.heading_drift))]
    return entries


def controller_entries(calibration: BaseCalibration) -> list[tuple[str, list[Entry]]]:
    """List parameters of the controller, by group."""
    groups: list[tuple[str, list[Entry]]] = []
    errors, noise = calibration.errors, calibration.object_noise
    if errors is not None:
        groups.append(('supervision', [
            ('odometry_scale', max(MIN_NOISE, _rounded(_extent(errors.scale))),
             'greatest error within the interval'),
            ('odometry_drift', max(MIN_NOISE, _rounded(_extent(errors.heading_drift))),
             'likewise')]))
    control = [] if noise is None else [
        ('pose_noise', max(MIN_NOISE, _rounded(noise.position)), 'at rest'),
        ('heading_noise', max(MIN_NOISE, _rounded(noise.heading)), 'at rest')]
    timeout = pose_timeout(calibration.object_times)
    if timeout is not None:
        control.append(('pose_timeout', _rounded(timeout.value),
                        f'age of 99 % and three periods; {_comment(timeout)}'))
    if control:
        groups.append(('control', control))
    return groups


def pose_timeout(times: TopicTimes | None) -> Interval | None:
    """
    Choose the time-out of object poses, by the age of nearly all and some lost ones.

    :param times: ``TopicTimes`` of the object poses.
    :return: [s]; None where nothing came, or stamps are of another clock.
    """
    if times is None or not MIN_AGE <= times.age <= MAX_AGE:
        return None
    return Interval(*(max(MIN_TIMEOUT, age + LOST_PERIODS / times.rate)
                      for age in times.max_age))


def _extent(interval: Interval) -> float:
    return max(abs(interval.low), abs(interval.high))


def robot_file(calibration: BaseCalibration) -> str:
    """Write the robot, for launch files and scenarios."""
    return '\n'.join([HEAD, *_lines(robot_entries(calibration), 0)]) + '\n'


def sensor_file(calibration: BaseCalibration) -> str:
    """Write the sensors, for scenarios."""
    return '\n'.join([HEAD, *(_lines(sensor_entries(calibration), 0) or ['{}'])]) + '\n'


def parameter_file(calibration: BaseCalibration) -> str:
    """Write parameters of the nodes."""
    lines = ['# Of calibrate: behind your parameter file, as a second one.', '/**:',
             '  ros__parameters:', '    robot:', *_lines(robot_entries(calibration), 6)]
    groups = controller_entries(calibration)
    if groups:
        lines += ['/**/push_controller:', '  ros__parameters:']
        for name, entries in groups:
            lines += [f'    {name}:', *_lines(entries, 6)]
    return '\n'.join(lines) + '\n'


# What writes each file, by its name: any of them may be written without the others.
WRITERS: dict[str, Callable[[BaseCalibration], str]] = {
    'robot.yaml': robot_file, 'sensors.yaml': sensor_file, 'params.yaml': parameter_file,
    'report.txt': lambda calibration: summary(calibration) + '\n'}


def files(calibration: BaseCalibration) -> dict[str, str]:
    """
    Write all files.

    :return: texts by file name, of ``WRITERS``.
    """
    return {name: write(calibration) for name, write in WRITERS.items()}


def _lines(entries: list[Entry], indent: int) -> list[str]:
    return [f'{" " * indent}{name}: {_yaml(value)}  # {comment}'
            for name, value, comment in entries]


def _yaml(value: Any) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    return '.inf' if value == math.inf else str(value)
