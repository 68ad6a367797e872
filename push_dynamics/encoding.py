"""Translation of objects, robots and poses into the numbers that the kernel works on, and back."""

import math
from typing import Any, Sequence

from push_dynamics import layout
from push_dynamics.step import ROUNDING
from push_model.contact import find_contact, robot_gap
from push_model.friction import load_gradients
from push_model.geometry import Pose
from push_model.parameters import PushedObject, RoundRobot
from push_model.signals import Twist

# Overlap of robot and object at the start that is corrected [m], chosen: what rounded numbers of
# a scenario come to. A deeper one is a mistake.
MAX_OVERLAP = 5e-3
# Friction between walls and what touches them; chosen: cardboard or wood on plaster.
WALL_FRICTION = 0.3
# Force at which the drive of a robot stalls that pushes an object against a wall [N]; chosen: what
# a base of 15 kg brings to the floor.
STALL_FORCE = 100.0
# In place of the outline of a disc.
NO_OUTLINE = ((0.0, 0.0), (0.0, 0.0))


def body_values(obj: PushedObject, robot: RoundRobot, smoothing: float, creep: float = 0.0,
                wall_friction: float = WALL_FRICTION) -> list[float]:
    """
    Encode what does not change, in the order of ``layout``.

    :param smoothing: speed below which support friction turns viscous [m/s].
    :param creep: slip of the contact at its friction limit over the distance that the robot's
        surface moves, see ``contact_law``.
    :param wall_friction: Coulomb coefficient between walls and what touches them.
    """
    com_x, com_y = obj.center_of_mass
    return [obj.mass, obj.inertia, com_x, com_y, obj.radius, robot.radius,
            obj.contact_friction_coefficient, smoothing, creep, obj.contact_height,
            obj.center_of_mass_height, wall_friction, min(robot.max_push_force, STALL_FORCE)]


def drive_values(robot: RoundRobot) -> list[float]:
    """Encode lag and limits of the drive, in the order of ``layout``."""
    return [robot.time_constant, robot.max_acceleration, robot.max_yaw_acceleration]


def support_rows(obj: PushedObject, capacities: Sequence[float],
                 factors: Sequence[float]) -> list[tuple[float, ...]]:
    """
    Encode the supports, columns in the order of ``layout``.

    :param capacities: friction capacity of each support, under its load at rest [N].
    :param factors: factor on the friction of each support.
    """
    com_x, com_y = obj.center_of_mass
    weight = sum(obj.loads)
    return [(support.x - com_x, support.y - com_y, factor * capacity, factor * capacity, 1.0,
             load / weight, *gradient)
            for support, factor, capacity, load, gradient
            in zip(obj.supports, factors, capacities, obj.loads, load_gradients(obj))]


def resolve_overlap(obj: PushedObject, robot: RoundRobot, object_pose: Pose,
                    robot_pose: Pose) -> Pose:
    """
    Move a robot that overlaps a little with the object back until it touches.

    :param object_pose: ``Pose`` of the object frame in the world.
    :param robot_pose: ``Pose`` of the robot in the world.
    :return: ``Pose`` of the robot; the same where it only touches, but for rounding.
    :raises ValueError: where a pose is not finite or the overlap is above 5 mm.
    """
    for name, pose in (('object_pose', object_pose), ('robot_pose', robot_pose)):
        if not pose.is_finite():
            raise ValueError(f'{name}: got {tuple(pose)}, expected finite numbers')
    gap = robot_gap(obj, object_pose, robot_pose, robot.radius)
    if gap >= -ROUNDING:
        return robot_pose
    if gap < -MAX_OVERLAP:
        raise ValueError(f'robot_pose: got an overlap with the object of {-gap:g} m, expected '
                         f'at most {MAX_OVERLAP:g} m')
    normal = find_contact(obj, object_pose, robot_pose, robot.radius).gamma
    return Pose(robot_pose.x + gap * math.cos(normal), robot_pose.y + gap * math.sin(normal),
                robot_pose.theta)


def initial_state(obj: PushedObject, object_pose: Pose, robot_pose: Pose) -> list[float]:
    """
    Encode the state at rest, in the order of ``layout``.

    :param object_pose: ``Pose`` of the object frame in the world.
    :param robot_pose: ``Pose`` of the robot in the world.
    """
    state = [0.0] * layout.STATE_SIZE
    x, y = object_pose.transform(obj.center_of_mass)
    state[layout.X] = float(x)
    state[layout.Y] = float(y)
    state[layout.THETA] = float(object_pose.theta)
    state[layout.ROBOT_X] = float(robot_pose.x)
    state[layout.ROBOT_Y] = float(robot_pose.y)
    state[layout.ROBOT_THETA] = float(robot_pose.theta)
    return state


def encode_velocities(state: Any, center_of_mass: tuple[float, float], object_twist: Twist,
                      robot_twist: Twist) -> None:
    """
    Write the velocities of object and robot into a state.

    :param state: numbers in the order of ``layout``, are written.
    :param center_of_mass: (x, y) in the object frame [m].
    :param object_twist: velocity of the object frame's origin, world axes.
    :param robot_twist: velocity of the robot, own axes.
    """
    x, y = Pose(0.0, 0.0, float(state[layout.THETA])).rotate(center_of_mass)
    state[layout.V_X] = object_twist.v_x - object_twist.omega * y
    state[layout.V_Y] = object_twist.v_y + object_twist.omega * x
    state[layout.OMEGA] = object_twist.omega
    state[layout.ROBOT_V_X] = robot_twist.v_x
    state[layout.ROBOT_V_Y] = robot_twist.v_y
    state[layout.ROBOT_OMEGA] = robot_twist.omega


def object_pose_of(state: Any, center_of_mass: tuple[float, float]) -> Pose:
    """
    Decode the pose of the object frame in the world; the angle is not wrapped.

    :param state: numbers in the order of ``layout``.
    :param center_of_mass: (x, y) in the object frame [m].
    """
    theta = float(state[layout.THETA])
    back_x, back_y = Pose(0.0, 0.0, theta).rotate(center_of_mass)
    return Pose(float(state[layout.X]) - back_x, float(state[layout.Y]) - back_y, theta)


def object_twist_of(state: Any, center_of_mass: tuple[float, float]) -> Twist:
    """
    Decode the velocity of the object frame's origin, world axes, and the yaw rate.

    :param state: numbers in the order of ``layout``.
    :param center_of_mass: (x, y) in the object frame [m].
    """
    omega = float(state[layout.OMEGA])
    x, y = Pose(0.0, 0.0, float(state[layout.THETA])).rotate(center_of_mass)
    return Twist(float(state[layout.V_X]) + omega * y, float(state[layout.V_Y]) - omega * x, omega)


def robot_pose_of(state: Any) -> Pose:
    """
    Decode the pose of the robot in the world; the angle is not wrapped.

    :param state: numbers in the order of ``layout``.
    """
    return Pose(float(state[layout.ROBOT_X]), float(state[layout.ROBOT_Y]),
                float(state[layout.ROBOT_THETA]))


def robot_twist_of(state: Any) -> Twist:
    """
    Decode the velocity of the robot, own axes.

    :param state: numbers in the order of ``layout``.
    """
    return Twist(float(state[layout.ROBOT_V_X]), float(state[layout.ROBOT_V_Y]),
                 float(state[layout.ROBOT_OMEGA]))
