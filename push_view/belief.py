"""What the robot believes while it pushes, as further columns beside those of the tape."""

import math

import numpy as np
from push_control.perception.perception import TaskPerception
from push_control.task.supervisor import Supervisor
from push_model.parameters import PushedObject
from push_sim_node.simulation import Simulation

# Columns behind those of the tape; one friction coefficient per support follows. The centre of
# friction has standard deviations along the axes of its ellipse, and the angle of the first.
BELIEF_COLUMNS = (
    'believed_object_x', 'believed_object_y', 'believed_object_theta',
    'believed_robot_x', 'believed_robot_y', 'believed_robot_theta',
    'believed_center_x', 'believed_center_y', 'believed_center_deviation_major',
    'believed_center_deviation_minor', 'believed_center_angle', 'believed_contact_friction')
# Number of columns of poses, which change all the time.
POSES = 6
# Rows for which friction as identified is kept, as it costs more; chosen: ten times a second at
# 50 Hz.
FRICTION_STRIDE = 5


def belief_columns(obj: PushedObject) -> tuple[str, ...]:
    """Name the columns of what is believed of an object."""
    return BELIEF_COLUMNS + tuple(f'believed_friction_{i}' for i in range(len(obj.supports)))


def believed_poses(supervisor: Supervisor) -> tuple[float, ...]:
    """
    Look up where object and robot are believed to be.

    :return: (x, y, theta) of the object, then of the robot [m, m, rad]; nan before the first
        measurements.
    """
    unknown = (math.nan,) * 3
    status, estimate = supervisor.status, supervisor.object_estimate
    if not isinstance(supervisor.perception, TaskPerception):
        return (*status.push.object_pose, *status.push.robot_pose)
    robot_pose = status.robot_pose
    return (*(unknown if estimate is None else estimate.pose),
            *(unknown if robot_pose is None else robot_pose))


def believed_friction(supervisor: Supervisor, count: int) -> tuple[float, ...]:
    """
    Look up friction as identified.

    :param count: number of supports.
    :return: the columns behind the poses; nan where nothing is known.
    """
    perception = supervisor.perception
    if not isinstance(perception, TaskPerception):
        return (*supervisor.status.push.friction_center, *(math.nan,) * (count + 4))
    if perception.object_estimate is None:
        return (math.nan,) * (count + 6)
    localization = perception.localization
    xx, xy, yy = localization.friction_center_covariance
    variances, axes = np.linalg.eigh(np.array([[xx, xy], [xy, yy]]))
    minor, major = np.sqrt(np.maximum(variances, 0.0)).tolist()
    angle = math.atan2(axes[1, 1], axes[0, 1])
    obj = localization.obj
    return (*localization.knowledge.friction_center, major, minor, angle,
            obj.contact_friction_coefficient,
            *(support.friction_coefficient for support in obj.supports))


class BeliefSampler:
    """
    Looks up what is believed at one row after the other, friction at some of them.

    :param count: number of supports.
    """

    def __init__(self, count: int) -> None:
        self._count = count
        self._friction: tuple[float, ...] = ()
        self._friction_row = -FRICTION_STRIDE

    def sample(self, row: int, supervisor: Supervisor) -> tuple[float, ...]:
        """
        Look up what is believed now.

        :param row: number of the row of the tape; one that is lower than before is of another run.
        :return: numbers in the order of ``belief_columns``.
        """
        if not self._friction_row <= row < self._friction_row + FRICTION_STRIDE:
            self._friction_row = row
            self._friction = believed_friction(supervisor, self._count)
        return believed_poses(supervisor) + self._friction


class BeliefRecorder:
    """
    Records what is believed at every row of the tape; an ``Intervention`` that disturbs nothing.

    :param obj: the nominal ``PushedObject``.
    """

    def __init__(self, obj: PushedObject) -> None:
        self.columns = belief_columns(obj)
        self._sampler = BeliefSampler(len(obj.supports))
        self._rows: dict[int, tuple[float, ...]] = {}

    def __call__(self, simulation: Simulation, supervisor: Supervisor) -> None:
        """Take down what is believed after the last measurement."""
        row = len(simulation.rows) - 1
        if row not in self._rows:
            self._rows[row] = self._sampler.sample(row, supervisor)

    def row(self, number: int) -> tuple[float, ...]:
        """
        Look up what was believed.

        :param number: of the row of the tape.
        :return: numbers in the order of ``columns``; nan where nothing was recorded.
        """
        return self._rows.get(number, (math.nan,) * len(self.columns))

    def clear(self) -> None:
        """Forget everything, as for another run."""
        self._rows.clear()
