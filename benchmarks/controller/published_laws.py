"""Control laws from the literature, programmed from their formulas, for a holonomic robot."""

import math
from typing import Protocol

from push_model.geometry import Coordinates, Pose

# Gains k_f and k_c [rad/m] of A. Heins and A. P. Schoellig (RA-L 2024).
FORCE_GAIN = 0.3
OFFSET_GAIN = 0.1


class MeasuredForce(Protocol):
    """What the force-angle law measures of ``push_sim_node.truth.Truth``."""

    @property
    def normal(self) -> float:
        """Direction of the contact normal in the world [rad]."""
        ...

    @property
    def force_n(self) -> float:
        """Normal force on the object [N]."""
        ...

    @property
    def force_t(self) -> float:
        """Tangential force on the object [N]."""
        ...


class MeasuredPoses(Protocol):
    """What the dipole law measures of ``push_sim_node.truth.Truth``."""

    @property
    def object_pose(self) -> Pose:
        """Pose of the object in the world."""
        ...

    @property
    def robot_pose(self) -> Pose:
        """Pose of the robot in the world."""
        ...


def force_angle_law(truth: MeasuredForce, direction: float, offset: float) -> float:
    """
    Compute the direction of the push after A. Heins and A. P. Schoellig (RA-L 2024).

    ``psi = psi_path + (1 + k_f) (psi_force - psi_path) + k_c offset``: only the contact force and
    the position of the contact are measured. Without force the middle term is left out.

    :param truth: the ``Truth`` of the plant.
    :param direction: of the path, psi_path [rad].
    :param offset: of the contact to the left of the path [m].
    :return: psi [rad].
    """
    force_angle = 0.0
    if truth.force_n > 0.0:
        force = truth.normal + math.atan2(truth.force_t, truth.force_n)
        force_angle = math.remainder(force - direction, 2.0 * math.pi)
    return direction + (1.0 + FORCE_GAIN) * force_angle + OFFSET_GAIN * offset


def dipole_law(truth: MeasuredPoses, goal: Coordinates) -> float:
    """
    Compute the direction of the robot after T. Igarashi, Y. Kamiyama and M. Inami (ICRA 2010).

    The robot follows the field of a dipole at the object that points to the goal: at an angle phi
    from that direction it moves at 2 phi, so that it circles to behind the object and pushes. The
    law controls the position of the object, not its heading.

    :param truth: the ``Truth`` of the plant.
    :param goal: (x, y) [m].
    :return: direction [rad].
    """
    x, y = truth.object_pose[:2]
    towards = math.atan2(goal[1] - y, goal[0] - x)
    bearing = math.atan2(truth.robot_pose.y - y, truth.robot_pose.x - x)
    return towards + 2.0 * (bearing - towards)
