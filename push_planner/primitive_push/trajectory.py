"""Trajectory of an unsteered push: the robot's line or arc, and the mean effect on the object."""

import math

import numpy as np
from push_model.contact import find_contact
from push_model.geometry import FloatArray, Pose
from push_model.parameters import PushedObject, RoundRobot
from push_model.trajectory import PushStyle, PushTrajectory
from push_planner.settings import PlannerSettings
from push_primitives.selection import interpolate_displacements, SelectedPush
from push_primitives.table import PrimitiveTable

# Taps are driven as long as this [s], but not slower than that [m/s]: chosen, so that a pose that
# comes ten times a second is seen a few times while the object moves, and no slower than usual
# drives move evenly.
TAP_TIME = 0.6
LEAST_SPEED = 0.035
# Pushes shorter than this are taps [m].
TAP_LENGTH = 0.09
# Acceleration after the touch, and deceleration before the end, over the limit of the robot;
# chosen: leaves the rest to lag and load.
RAMP_FRACTION = 0.5
# Fewest samples of a push, and the finest spacing that short ones get [m].
LEAST_SAMPLES = 9
FINEST_SPACING = 1e-3


def touch_speed(length: float, settings: PlannerSettings) -> float:
    """
    Choose the speed at first touch: that of steered pushes, or slower for taps [m/s].

    :param length: driven length [m].
    :param settings: ``PlannerSettings``.
    """
    if length >= TAP_LENGTH:
        return settings.pushing_speed
    return min(settings.pushing_speed, max(LEAST_SPEED, length / TAP_TIME))


def greatest_speed(robot: RoundRobot, settings: PlannerSettings) -> float:
    """
    Choose the speed that a long push is driven at once it has begun [m/s].

    :param robot: the ``RoundRobot``.
    :param settings: ``PlannerSettings``.
    """
    return max(settings.pushing_speed, min(settings.unsteered_speed, robot.max_speed))


def push_trajectory(obj: PushedObject, robot: RoundRobot, object_pose: Pose, robot_heading: float,
                    table: PrimitiveTable, selected: SelectedPush, *, settings: PlannerSettings,
                    style: PushStyle = PushStyle.UNSTEERED) -> PushTrajectory:
    """
    Lay out a push from the first contact to its end.

    :param obj: the ``PushedObject``.
    :param robot: the ``RoundRobot``.
    :param object_pose: ``Pose`` of the object in the world.
    :param robot_heading: of the robot before the push, which a holonomic one keeps [rad].
    :param table: the ``PrimitiveTable``.
    :param selected: the ``SelectedPush``.
    :param settings: ``PlannerSettings``.
    :param style: ``UNSTEERED`` or ``WAYPOINT``.
    :return: ``PushTrajectory``.
    """
    number, length = selected.primitive, selected.length
    driven = _driven_lengths(length, settings.sample_spacing)
    means = np.einsum('k,klc->lc', selected.weights, table.displacements[number])
    local = interpolate_displacements(table.lengths, means, driven)
    object_poses = np.array([object_pose @ Pose(*pose) for pose in local.tolist()])
    start = object_pose @ Pose(*table.starts[number].tolist())
    curvature = float(table.curvatures[number])
    robot_poses = _along_arc(start, curvature, driven)
    speeds = _speeds(driven, robot, settings)
    times = np.concatenate([[0.0], np.cumsum(2.0 * np.diff(driven) / (speeds[1:] + speeds[:-1]))])
    directions = robot_poses[:, 2].copy()
    yaw_rates = curvature * speeds
    if robot.drive == 'holonomic':
        robot_poses[:, 2] = robot_heading
        yaw_rates = np.zeros_like(speeds)
    contact_poses = np.array([
        _contact_pose(obj, robot, Pose(*pose), Pose(*robot_pose))
        for pose, robot_pose in zip(object_poses.tolist(), robot_poses.tolist())])
    contact_poses[:, 2] = np.unwrap(contact_poses[:, 2])
    object_twists = np.gradient(object_poses, times, axis=0)
    arms = contact_poses[:, :2] - object_poses[:, :2]
    contact_twists = object_twists.copy()
    contact_twists[:, 0] -= object_twists[:, 2] * arms[:, 1]
    contact_twists[:, 1] += object_twists[:, 2] * arms[:, 0]
    contact_twists[:, 2] = np.gradient(contact_poses[:, 2], times)
    robot_twists = np.stack([speeds * np.cos(directions), speeds * np.sin(directions), yaw_rates],
                            axis=1)
    return PushTrajectory(times, object_poses, object_twists, contact_poses, contact_twists,
                          robot_poses, robot_twists, style)


def _driven_lengths(length: float, spacing: float) -> FloatArray:
    count = max(math.ceil(length / spacing) + 1,
                min(LEAST_SAMPLES, math.ceil(length / FINEST_SPACING) + 1), 3)
    return np.asarray(np.linspace(0.0, length, count), dtype=np.float64)


def _along_arc(start: Pose, curvature: float, driven: FloatArray) -> FloatArray:
    """Poses of the robot on an arc, its heading in the direction of motion, shape (n, 3)."""
    half = 0.5 * curvature * driven
    chords = driven * np.sinc(half / math.pi)
    return np.stack([start.x + chords * np.cos(start.theta + half),
                     start.y + chords * np.sin(start.theta + half),
                     start.theta + 2.0 * half], axis=1)


def _speeds(driven: FloatArray, robot: RoundRobot, settings: PlannerSettings) -> FloatArray:
    """Speeds along a push: ``v^2`` rises and falls linearly with the length."""
    length = float(driven[-1])
    touch = touch_speed(length, settings)
    if length < TAP_LENGTH:
        return np.full_like(driven, touch)
    least = min(touch, settings.end_speed)
    first = least if settings.acceleration > 0.0 else touch
    change = RAMP_FRACTION * robot.max_acceleration
    rise = settings.acceleration or change
    return np.minimum(greatest_speed(robot, settings), np.minimum(
        np.sqrt(first ** 2 + 2.0 * rise * driven),
        np.sqrt(least ** 2 + 2.0 * change * (length - driven))))


def _contact_pose(obj: PushedObject, robot: RoundRobot, object_pose: Pose,
                  robot_pose: Pose) -> tuple[float, float, float]:
    """Contact point and angle of the normal in the world, as if the gap were closed."""
    gamma = find_contact(obj, object_pose, robot_pose, robot.radius).gamma
    return (robot_pose.x + robot.radius * math.cos(gamma),
            robot_pose.y + robot.radius * math.sin(gamma), gamma)
