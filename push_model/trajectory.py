"""Trajectory of a push: object, contact and robot over time, from planner to controller."""

import dataclasses
import enum
import os

import numpy as np
from push_model.geometry import FloatArray

COLUMNS = ('object_poses', 'object_twists', 'contact_poses', 'contact_twists', 'robot_poses',
           'robot_twists')


class PushStyle(enum.Enum):
    """
    How the contact behaves while a push is driven, and so what the driver may do.

    A steered push holds the contact where it is on the object: the robot corrects the pushing
    angle and stops where the contact is lost. In an unsteered push the robot keeps to a straight
    line or one arc; the contact may roll and slide along the side, and neither is an error. Such a
    push aims at the goal of the task, with whatever pose of the object is best for that; one to a
    waypoint aims at the end of its own trajectory, from where the next one goes on.
    """

    STEERED = 'steered'
    UNSTEERED = 'unsteered'
    WAYPOINT = 'waypoint'

    @property
    def is_unsteered(self) -> bool:
        """Whether the contact may roll and slide."""
        return self is not PushStyle.STEERED


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
    :param style: how the push is driven; the trajectory of an unsteered push is the mean of what
        may happen.
    :raises ValueError: naming the array, its shape or the sample that is wrong.
    """

    times: FloatArray
    object_poses: FloatArray
    object_twists: FloatArray
    contact_poses: FloatArray
    contact_twists: FloatArray
    robot_poses: FloatArray
    robot_twists: FloatArray
    style: PushStyle = PushStyle.STEERED

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
        np.savez(path, times=self.times, style=np.array(self.style.value),
                 **{name: getattr(self, name) for name in COLUMNS})

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> 'PushTrajectory':
        """
        Read a trajectory that ``save`` wrote.

        :param path: the file.
        :raises ValueError: where an array or the style is missing or wrong.
        """
        with np.load(path) as data:
            missing = sorted(({'times', 'style'} | set(COLUMNS)) - set(data.files))
            if missing:
                raise ValueError(f'{path}: got no {", ".join(missing)}, expected a PushTrajectory')
            arrays = {name: data[name] for name in ('times',) + COLUMNS}
            return cls(**arrays, style=_style(str(data['style']), path))


def _style(text: str, path: str | os.PathLike[str]) -> PushStyle:
    try:
        return PushStyle(text)
    except ValueError:
        styles = ', '.join(style.value for style in PushStyle)
        raise ValueError(f'{path}: got the style {text!r}, expected one of {styles}') from None
