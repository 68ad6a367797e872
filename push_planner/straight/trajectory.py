"""Trajectory of a straight push: the robot's line or arc, and the mean effect on the object."""

import math

import numpy as np
from push_model.contact import find_contact
from push_model.geometry import FloatArray, Pose
from push_model.parameters import PushedObject, RoundRobot
from push_model.trajectory import PushLine, PushStyle, PushTrajectory
from push_planner.settings import PlannerSettings
from push_primitives.selection import interpolate_displacements, SelectedPush
from push_primitives.table import PrimitiveTable

# Taps are driven as long as this [s], but not slower than that [m/s]: chosen, so that a pose that
# comes ten times a second is seen a few times while the object moves, and no slower than usual
# drives move evenly.
TAP_TIME = 0.6
MIN_SPEED = 0.035
# Pushes shorter than this are taps [m].
TAP_LENGTH = 0.09
# Acceleration after the touch, and deceleration before the end, over the limit of the robot;
# chosen: leaves the rest to lag and load.
RAMP_FRACTION = 0.5
# Fewest samples of a push, and the finest spacing that short ones get [m].
MIN_SAMPLES = 9
FINEST_SPACING = 1e-3


def touch_speed(length: float, settings: PlannerSettings) -> float:
    """
    Choose the speed at first touch: that of steered pushes, or slower for taps [m/s].

    :param length: driven length [m].
    """
    if length >= TAP_LENGTH:
        return settings.pushing_speed
    return min(settings.pushing_speed, max(MIN_SPEED, length / TAP_TIME))


def greatest_speed(robot: RoundRobot, settings: PlannerSettings) -> float:
    """Choose the speed that a long push is driven at once it has begun [m/s]."""
    return max(settings.pushing_speed, min(settings.straight_speed, robot.max_speed))


def push_trajectory(obj: PushedObject, robot: RoundRobot, object_pose: Pose, robot_heading: float,
                    table: PrimitiveTable, selected: SelectedPush, *, settings: PlannerSettings,
                    style: PushStyle = PushStyle.STRAIGHT) -> PushTrajectory:
    """
    Lay out a push from the first contact to its end.

    :param object_pose: ``Pose`` of the object in the world.
    :param robot_heading: of the robot before the push, which a holonomic one keeps [rad].
    :param style: ``STRAIGHT`` or ``WAYPOINT``.
    """
    primitive, length = selected.primitive, selected.length
    driven = _driven_lengths(length, settings.sample_spacing)
    means = np.einsum('k,klc->lc', selected.weights, table.displacements[primitive])
    local = interpolate_displacements(table.lengths, means, driven)
    object_poses = np.array([object_pose @ Pose(*pose) for pose in local.tolist()])
    line = PushLine(Pose(*table.starts[primitive].tolist()), float(table.curvatures[primitive]),
                    length, int(table.faces[primitive]))
    robot_poses = line.robot_poses(object_pose, driven)
    speeds = _speeds(driven, robot, settings)
    times = np.concatenate([[0.0], np.cumsum(2.0 * np.diff(driven) / (speeds[1:] + speeds[:-1]))])
    directions = robot_poses[:, 2].copy()
    yaw_rates = line.curvature * speeds
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
                          robot_poses, robot_twists, style, line)


def _driven_lengths(length: float, spacing: float) -> FloatArray:
    count = max(math.ceil(length / spacing) + 1,
                min(MIN_SAMPLES, math.ceil(length / FINEST_SPACING) + 1), 3)
    return np.asarray(np.linspace(0.0, length, count), dtype=np.float64)


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
