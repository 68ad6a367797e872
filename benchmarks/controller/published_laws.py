"""Laws that others have published, from their formulas; they ask for a holonomic robot."""

import math

FORCE_GAIN, OFFSET_GAIN = 0.3, 0.1


def force_angle_law(truth, direction, offset):
    """
    Direction of the push by A. Heins and A. P. Schoellig (RA-L 2024).

    ``psi = psi_path + (1 + k_f) (psi_force - psi_path) + k_c offset``: only the contact force and
    the place of the contact are measured. Without force the middle term is left out.

    :param truth: ``push_sim_node.truth.Truth``.
    :param direction: of the path, psi_path [rad].
    :param offset: of the contact to the left of the path [m].
    :return: psi [rad].
    """
    aside = 0.0
    if truth.force_n > 0.0:
        force = truth.normal + math.atan2(truth.force_t, truth.force_n)
        aside = math.remainder(force - direction, 2.0 * math.pi)
    return direction + (1.0 + FORCE_GAIN) * aside + OFFSET_GAIN * offset


def dipole_law(truth, goal):
    """
    Direction of the robot's way by T. Igarashi, Y. Kamiyama and M. Inami (ICRA 2010).

    Field of a dipole at the object that points to the goal: the robot at an angle phi from that
    direction moves at 2 phi, so that it circles to behind the object and pushes. It steers the
    place of the object, not its heading.

    :param truth: ``push_sim_node.truth.Truth``.
    :param goal: (x, y) [m].
    :return: direction [rad].
    """
    x, y = truth.object_pose[:2]
    towards = math.atan2(goal[1] - y, goal[0] - x)
    place = math.atan2(truth.robot_pose.y - y, truth.robot_pose.x - x)
    return towards + 2.0 * (place - towards)
