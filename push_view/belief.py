"""What the robot sees and believes while it pushes, as columns beside those of the tape."""

import math

from push_control.perception.perception import TaskPerception
from push_control.task.supervisor import Supervisor
from push_model.parameters import PushedObject
from push_model.signals import PoseCovariance
from push_sim_node.simulation import Simulation

# Columns behind those of the tape; one friction coefficient per support follows. The centre of
# friction and the place of the object have standard deviations along the axes of their ellipses,
# and the angle of the first: in the frame of the object, and in that of the world.
BELIEF_COLUMNS = (
    # 1 where the camera sees the object, and where there is no camera; else 0.
    'object_seen',
    'believed_object_deviation_major', 'believed_object_deviation_minor',
    'believed_object_deviation_angle', 'believed_object_heading_deviation',
    'believed_object_x', 'believed_object_y', 'believed_object_theta',
    'believed_robot_x', 'believed_robot_y', 'believed_robot_theta',
    'believed_center_x', 'believed_center_y', 'believed_center_deviation_major',
    'believed_center_deviation_minor', 'believed_center_angle', 'believed_contact_friction')
# Rows for which friction as identified is kept, as it costs more; chosen: ten times a second at
# 50 Hz.
FRICTION_STRIDE = 5


def belief_columns(obj: PushedObject) -> tuple[str, ...]:
    """Name the columns of what is believed of an object."""
    return BELIEF_COLUMNS + tuple(f'believed_friction_{i}' for i in range(len(obj.supports)))


def believed_poses(supervisor: Supervisor) -> tuple[float, ...]:
    """
    Look up where object and robot are believed to be, and how well that of the object is known.

    :return: the columns of the deviations of the object, (x, y, theta) of it, then of the robot
        [m, m, rad]; nan before the first measurements.
    """
    unknown = (math.nan,) * 3
    status, estimate = supervisor.status, supervisor.object_estimate
    if not isinstance(supervisor.perception, TaskPerception):
        return (*_deviations(None), *status.push.object_pose, *status.push.robot_pose)
    robot_pose = status.robot_pose
    return (*_deviations(None if estimate is None else estimate.covariance),
            *(unknown if estimate is None else estimate.pose),
            *(unknown if robot_pose is None else robot_pose))


def _deviations(covariance: PoseCovariance | None) -> tuple[float, float, float, float]:
    """Return those of the object along the axes of its ellipse, the angle, and of its heading."""
    if covariance is None:
        return math.nan, math.nan, math.nan, math.nan
    return (*_ellipse(covariance.x_x, covariance.x_y, covariance.y_y),
            math.sqrt(max(0.0, covariance.theta_theta)))


def _ellipse(x_x: float, x_y: float, y_y: float) -> tuple[float, float, float]:
    """Return the standard deviations along the axes, the greater first, and the angle of that."""
    mean, half = 0.5 * (x_x + y_y), math.hypot(0.5 * (x_x - y_y), x_y)
    return (math.sqrt(max(0.0, mean + half)), math.sqrt(max(0.0, mean - half)),
            0.5 * math.atan2(2.0 * x_y, x_x - y_y))


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
    obj = localization.obj
    return (*localization.knowledge.friction_center,
            *_ellipse(*localization.friction_center_covariance),
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

    def sample(self, row: int, simulation: Simulation,
               supervisor: Supervisor) -> tuple[float, ...]:
        """
        Look up what is seen and believed now.

        :param row: number of the row of the tape; one that is lower than before is of another run.
        :return: numbers in the order of ``belief_columns``.
        """
        if not self._friction_row <= row < self._friction_row + FRICTION_STRIDE:
            self._friction_row = row
            self._friction = believed_friction(supervisor, self._count)
        return (float(simulation.is_object_seen), *believed_poses(supervisor), *self._friction)


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
            self._rows[row] = self._sampler.sample(row, simulation, supervisor)

    def row(self, index: int) -> tuple[float, ...]:
        """
        Look up what was believed.

        :param index: of the row of the tape.
        :return: numbers in the order of ``columns``; nan where nothing was recorded.
        """
        return self._rows.get(index, (math.nan,) * len(self.columns))

    def clear(self) -> None:
        """Forget everything, as for another run."""
        self._rows.clear()
