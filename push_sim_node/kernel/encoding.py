"""Objects, robots and poses as the numbers that the kernel works on, and back."""

import math

from push_model.contact import find_contact
from push_model.geometry import Pose
from push_model.signals import Twist
from push_sim_node.kernel import layout as at

DEEPEST_OVERLAP = 5e-3
NO_OUTLINE = ((0.0, 0.0), (0.0, 0.0))


def body_numbers(obj, robot, smoothing):
    """
    Write down what does not change, in the order of ``layout``.

    :param obj: the ``PushedObject``.
    :param robot: the ``RoundRobot``.
    :param smoothing: speed below which support friction turns viscous [m/s].
    """
    com_x, com_y = obj.center_of_mass
    return [obj.mass, obj.inertia, com_x, com_y, obj.radius, robot.radius,
            obj.contact_friction_coefficient, smoothing]


def drive_numbers(robot):
    """
    Write down (time constant [s], acceleration limit [m/s^2], yaw acceleration limit [rad/s^2]).

    :param robot: the ``RoundRobot``.
    """
    return [robot.time_constant, robot.max_acceleration, robot.max_yaw_acceleration]


def support_rows(obj, capacities, factors):
    """
    Write down the supports as (x, y from the mass centre [m], friction capacity, twice [N]).

    The first capacity is that of the floor underfoot, the second that of plain floor.

    :param obj: the ``PushedObject``.
    :param capacities: friction capacity of each support [N].
    :param factors: factor on the friction of each support.
    """
    com_x, com_y = obj.center_of_mass
    return [(foot.x - com_x, foot.y - com_y, factor * capacity, factor * capacity)
            for foot, factor, capacity in zip(obj.supports, factors, capacities)]


def placed(obj, robot, object_pose, robot_pose):
    """
    Move a robot that overlaps a little with the object back until it touches.

    :param obj: the ``PushedObject``.
    :param robot: the ``RoundRobot``.
    :param object_pose: ``Pose`` of the object frame in the world.
    :param robot_pose: ``Pose`` of the robot in the world.
    :return: ``Pose`` of the robot.
    :raises ValueError: where a pose is not finite or the overlap is above 5 mm.
    """
    for name, pose in (('object_pose', object_pose), ('robot_pose', robot_pose)):
        if not pose.is_finite():
            raise ValueError(f'{name}: got {tuple(pose)}, expected finite numbers')
    _, gamma, gap = find_contact(obj, object_pose, robot_pose, robot.radius)
    if gap < -DEEPEST_OVERLAP:
        raise ValueError(f'robot_pose: got an overlap with the object of {-gap:g} m, expected '
                         f'at most {DEEPEST_OVERLAP:g} m')
    back = min(0.0, gap)
    return Pose(robot_pose.x + back * math.cos(gamma), robot_pose.y + back * math.sin(gamma),
                robot_pose.theta)


def start_state(obj, object_pose, robot_pose):
    """
    Write down the state at rest, in the order of ``layout``.

    :param obj: the ``PushedObject``.
    :param object_pose: ``Pose`` of the object frame in the world.
    :param robot_pose: ``Pose`` of the robot in the world.
    """
    state = [0.0] * at.STATE_SIZE
    state[at.X], state[at.Y] = map(float, object_pose.transform(obj.center_of_mass))
    state[at.THETA] = float(object_pose.theta)
    state[at.P_X:at.PHI + 1] = map(float, robot_pose)
    return state


def object_pose_of(state, center_of_mass):
    """
    Read the pose of the object frame in the world; the angle is not wrapped.

    :param state: numbers in the order of ``layout``.
    :param center_of_mass: (x, y) in the object frame [m].
    """
    x, y, theta = map(float, state[at.X:at.THETA + 1])
    back_x, back_y = Pose(0.0, 0.0, theta).rotate(center_of_mass)
    return Pose(x - back_x, y - back_y, theta)


def object_twist_of(state, center_of_mass):
    """
    Read the velocity of the object frame's origin, world axes, and the yaw rate.

    :param state: numbers in the order of ``layout``.
    :param center_of_mass: (x, y) in the object frame [m].
    """
    v_x, v_y, omega = map(float, state[at.V_X:at.OMEGA + 1])
    x, y = Pose(0.0, 0.0, float(state[at.THETA])).rotate(center_of_mass)
    return Twist(v_x + omega * y, v_y - omega * x, omega)
