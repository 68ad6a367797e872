"""
Recordings as text: a CSV table with a row for each command and each measurement.

Comments stand above it: the nominal robot, as JSON, the object, if it is touched, and why the
recording ended early, if it did. Read again, a recording is the same to the last digit,
without covariances.
"""

import csv
import io
import json

from push_base.calibration.recording import (
    Interruption, Purpose, ReceivedOdometry, ReceivedPose, Recording, SentCommand,
)
from push_model.files.mapping import from_mapping, Location, to_mapping
from push_model.geometry import Pose
from push_model.parameters import PushedObject, RoundRobot
from push_model.signals import ObjectPose, Odometry, Twist

ROBOT, OBJECT, INTERRUPTION = '# robot: ', '# object: ', '# ended early: '
COLUMNS = ('kind', 'time', 'stamp', 'x', 'y', 'theta', 'v_x', 'v_y', 'omega', 'segment', 'purpose')
COMMAND, ODOMETRY, OBJECT_POSE, ROBOT_POSE = 'command', 'odometry', 'object_pose', 'robot_pose'


def to_csv(recording: Recording) -> str:
    """
    Write a recording.

    :return: text; times in it are those of sending or arrival.
    """
    lines = io.StringIO()
    lines.write(f'{ROBOT}{json.dumps(to_mapping(recording.robot))}\n')
    if recording.object is not None:
        lines.write(f'{OBJECT}{json.dumps(to_mapping(recording.object))}\n')
    if recording.interruption is not None:
        lines.write(f'{INTERRUPTION}{recording.interruption.name}\n')
    table = csv.writer(lines, lineterminator='\n')
    table.writerow(COLUMNS)
    table.writerows((COMMAND, item.time, '', '', '', '', *item.twist, item.segment,
                     item.purpose.name) for item in recording.commands)
    table.writerows((ODOMETRY, item.arrival, item.odometry.time, *item.odometry.pose,
                     *item.odometry.twist, '', '') for item in recording.odometry)
    for kind, poses in ((OBJECT_POSE, recording.object_poses),
                        (ROBOT_POSE, recording.robot_poses)):
        table.writerows((kind, item.arrival, item.measured.time, *item.measured.pose,
                         '', '', '', '', '') for item in poses)
    return lines.getvalue()


def from_csv(text: str, name: str = 'recording.csv') -> Recording:
    """
    Read a recording.

    :param text: as ``to_csv`` writes it.
    :param name: of its file, for messages.
    :raises ValueError: naming file and line where it cannot be read.
    """
    lines = text.splitlines()
    if not lines or not lines[0].startswith(ROBOT):
        raise ValueError(f'{name}: line 1: expected {ROBOT!r} and a robot')
    try:
        values = json.loads(lines[0][len(ROBOT):])
    except ValueError as error:
        raise ValueError(f'{name}: line 1: {error}') from error
    recording = Recording(from_mapping(RoundRobot, values, Location(name)))
    for number, line in enumerate(lines[1:], 2):
        try:
            if line.startswith(INTERRUPTION):
                recording.interruption = Interruption[line[len(INTERRUPTION):]]
            elif line.startswith(OBJECT):
                recording.object = from_mapping(
                    PushedObject, json.loads(line[len(OBJECT):]), Location(name))
            elif line != ','.join(COLUMNS):
                _add(recording, line.split(','))
        except (ValueError, KeyError) as error:
            raise ValueError(f'{name}: line {number}: got {line!r}, expected a row of '
                             f'{",".join(COLUMNS)}') from error
    return recording


def _add(recording: Recording, row: list[str]) -> None:
    """Add a row; a ``ValueError`` or ``KeyError`` says that it is none."""
    kind, time, stamp, *fields, segment, purpose = row
    if kind == COMMAND:
        recording.commands.append(SentCommand(
            float(time), Twist(*map(float, fields[3:])), int(segment), Purpose[purpose]))
        return
    pose = Pose(*map(float, fields[:3]))
    if kind == ODOMETRY:
        recording.odometry.append(ReceivedOdometry(
            float(time), Odometry(float(stamp), pose, Twist(*map(float, fields[3:])))))
        return
    poses = {OBJECT_POSE: recording.object_poses, ROBOT_POSE: recording.robot_poses}[kind]
    poses.append(ReceivedPose(float(time), ObjectPose(float(stamp), pose)))
