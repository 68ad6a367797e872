"""Trajectory of a push: object, contact and robot over time, from planner to controller."""

import dataclasses
import enum
import math
import os
from typing import NamedTuple

import numpy as np
from push_model.geometry import FloatArray, Pose
from push_model.outlook import Outlook

# Distance between the ends of a line and the robot of its samples above which they contradict
# each other [m]; chosen: above the lag of a simulated robot, far below what moves the contact.
MAX_LINE_DEVIATION = 5e-3
COLUMNS = ('object_poses', 'object_twists', 'contact_poses', 'contact_twists', 'robot_poses',
           'robot_twists')


class PushStyle(enum.Enum):
    """
    Behaviour of the contact in a push, which decides what the driver may do.

    A steered push holds the contact where it is on the object: the robot corrects the pushing
    angle and stops where the contact is lost. In a straight push the robot keeps to a straight
    line or one arc; the contact may roll and slide along the side, and neither is an error. Such a
    push aims at the goal of the task, with whatever pose of the object is best for that; one to a
    waypoint aims at the end of its own trajectory, from where the next one goes on.
    """

    STEERED = 'steered'
    STRAIGHT = 'straight'
    WAYPOINT = 'waypoint'

    @property
    def is_straight(self) -> bool:
        """Tell whether the contact may roll and slide."""
        return self is not PushStyle.STEERED


class PushLine(NamedTuple):
    """
    Line or arc of the robot in a straight push, from the first contact on.

    :param start: centre of the robot at first contact and direction of motion, object frame.
    :param curvature: of the robot's path from there on, left positive [1/m].
    :param length: of that path [m].
    :param face: index of the face of the object that is pushed at, as in
        ``push_primitives.face_points``.
    """

    start: Pose
    curvature: float
    length: float
    face: int

    def robot_poses(self, object_pose: Pose, distances: FloatArray) -> FloatArray:
        """
        Compute poses of the robot in the world, its heading in the direction of motion.

        :param object_pose: ``Pose`` of the object at first contact.
        :param distances: driven from there, shape (n,) [m].
        :return: (x, y, theta), shape (n, 3).
        """
        start = object_pose @ self.start
        half = 0.5 * self.curvature * distances
        chords = distances * np.sinc(half / math.pi)
        return np.stack([start.x + chords * np.cos(start.theta + half),
                         start.y + chords * np.sin(start.theta + half),
                         start.theta + 2.0 * half], axis=1)


@dataclasses.dataclass(frozen=True, eq=False)
class PushTrajectory:
    """
    Samples of a push, in the world frame; arrays are read-only.

    :param times: time from the start [s], shape (n,), increasing, the first is 0.
    :param object_poses: object frame (x, y, theta) [m, m, rad], shape (n, 3), angle unwrapped.
    :param object_twists: its (v_x, v_y, omega) [m/s, m/s, rad/s], world axes, shape (n, 3).
    :param contact_poses: contact point and normal (x, y, gamma), shape (n, 3).
    :param contact_twists: material velocity of the object at the contact and yaw rate of the
        normal (v_x, v_y, gamma'), shape (n, 3).
    :param robot_poses: robot centre and heading (x, y, phi), shape (n, 3).
    :param robot_twists: its (v_x, v_y, omega_p), world axes, shape (n, 3).
    :param style: how the push is driven; the trajectory of a straight push is the mean of what
        may happen.
    :param line: what the robot drives in a straight push; None for a steered one.
    :param outlook: ``Outlook`` of the end: of the task, or of a single push; None where whoever
        planned states none.
    :raises ValueError: naming the array, its shape or the sample that is wrong, or what is wrong
        with the line.
    """

    times: FloatArray
    object_poses: FloatArray
    object_twists: FloatArray
    contact_poses: FloatArray
    contact_twists: FloatArray
    robot_poses: FloatArray
    robot_twists: FloatArray
    style: PushStyle = PushStyle.STEERED
    line: PushLine | None = None
    outlook: Outlook | None = None

    def __repr__(self) -> str:
        """Say in one line what it is."""
        return (f'<PushTrajectory, {self.style.value}: {len(self.times)} samples over '
                f'{self.times[-1]:.2f} s>')

    def __post_init__(self) -> None:
        """Check shapes and values, and freeze the arrays."""
        count = len(self.times)
        if count < 2:
            raise ValueError(f'PushTrajectory.times: got {count} samples, expected 2 or more')
        for name in ('times',) + COLUMNS:
            array = np.array(getattr(self, name), dtype=float)
            shape = (count,) if name == 'times' else (count, 3)
            if array.shape != shape:
                raise ValueError(f'PushTrajectory.{name}: got shape {array.shape}, expected '
                                 f'{shape}')
            if not np.isfinite(array).all():
                where = np.argwhere(~np.isfinite(array))[0].tolist()
                raise ValueError(f'PushTrajectory.{name}: got a value that is not finite at '
                                 f'{where}, expected finite numbers')
            array.setflags(write=False)
            object.__setattr__(self, name, array)
        if self.times[0] != 0.0 or (np.diff(self.times) <= 0.0).any():
            raise ValueError(f'PushTrajectory.times: got {self.times}, expected increasing times '
                             'from 0 [s]')
        self._check_line()

    def _check_line(self) -> None:
        """Refuse a line that is missing, out of place, or not that of the samples."""
        line = self.line
        if (line is not None) != self.style.is_straight:
            got, expected = ('none', 'one') if line is None else ('one', 'none')
            raise ValueError(f'PushTrajectory.line: got {got}, expected {expected}, as the push '
                             f'is {self.style.value}')
        if line is None:
            return
        if not (line.start.is_finite() and math.isfinite(line.curvature)
                and 0.0 < line.length < math.inf and line.face >= 0):
            raise ValueError(f'PushTrajectory.line: got {line}, expected finite values, a '
                             'length above 0 and a face from 0 on')
        ends = line.robot_poses(Pose(*self.object_poses[0].tolist()),
                                np.array([0.0, line.length]))
        deviation = float(np.hypot(*(ends - self.robot_poses[[0, -1]])[:, :2].T).max())
        # False for what is not a number as well.
        if not deviation <= MAX_LINE_DEVIATION:
            raise ValueError(f'PushTrajectory.line: got ends {deviation:.3g} m beside those of '
                             f'robot_poses, expected at most {MAX_LINE_DEVIATION:g} m')

    def straight_line(self) -> PushLine:
        """
        Return the line of a straight push.

        :raises ValueError: where the push is steered.
        """
        if self.line is None:
            raise ValueError('PushTrajectory.line: got none, expected that of a straight push')
        return self.line

    @property
    def duration(self) -> float:
        """Duration of the push [s]."""
        return float(self.times[-1])

    @property
    def path_length(self) -> float:
        """Length of the path of the robot's centre [m]."""
        return float(np.hypot(*np.diff(self.robot_poses[:, :2], axis=0).T).sum())

    def at(self, time: float) -> dict[str, FloatArray]:
        """
        Interpolate linearly, holding the ends.

        :param time: time from the start [s].
        :return: dict of the arrays' names to values, each of shape (3,).
        """
        return {name: np.array([np.interp(time, self.times, column)
                                for column in getattr(self, name).T]) for name in COLUMNS}

    def save(self, path: str | os.PathLike[str]) -> None:
        """
        Write the trajectory to a file.

        :param path: of the file, by convention ``*.npz``.
        """
        line = self.line
        values = [] if line is None else [*line.start, line.curvature, line.length, line.face]
        np.savez(path, times=self.times, style=np.array(self.style.value), line=np.array(values),
                 **{name: getattr(self, name) for name in COLUMNS})

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> 'PushTrajectory':
        """
        Read a trajectory that ``save`` wrote.

        :param path: the file.
        :raises ValueError: where an array, the style or the line is missing or wrong.
        """
        with np.load(path) as data:
            missing = sorted(({'times', 'style', 'line'} | set(COLUMNS)) - set(data.files))
            if missing:
                raise ValueError(f'{path}: got no {", ".join(missing)}, expected a PushTrajectory')
            arrays = {name: data[name] for name in ('times',) + COLUMNS}
            return cls(**arrays, style=_style(str(data['style']), path),
                       line=_line(data['line'].tolist(), path))


def _style(text: str, path: str | os.PathLike[str]) -> PushStyle:
    try:
        return PushStyle(text)
    except ValueError:
        styles = ', '.join(style.value for style in PushStyle)
        raise ValueError(f'{path}: got the style {text!r}, expected one of {styles}') from None


def _line(values: list[float], path: str | os.PathLike[str]) -> PushLine | None:
    if not values:
        return None
    if len(values) != 6:
        raise ValueError(f'{path}: got a line of {len(values)} values, expected 6')
    x, y, theta, curvature, length, face = values
    return PushLine(Pose(x, y, theta), curvature, length, int(face))
