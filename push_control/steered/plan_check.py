"""Checks of a plan before it is driven: it pushes this object, from where it is, to its goal."""

import math
from typing import NamedTuple

import numpy as np
from push_control.steered.estimation.contact_site import CONTACT_TOLERANCE
from push_control.steered.plan_consistency import check_consistency
from push_model.contact import find_contact
from push_model.geometry import BoolArray, distance, FloatArray, Pose, wrap_angle
from push_model.parameters import PushedObject, RoundRobot
from push_model.trajectory import PushLine, PushTrajectory
from push_navigation.occupancy_map import OccupancyMap
from push_primitives.face_points import face_points
from push_primitives.simplification import simplified_object

# Speed and yaw rate of a plan over the limits of the robot; chosen: planners keep to the limits,
# and samples of a straight push, which are a mean, are not exact.
MAX_SPEED_RATIO = 1.2
# Length of a plan, at most so many times the distance from its start to the goal, and besides so
# many times the size of object and robot. Chosen: the turns of 532 plans, of all kinds of contacts
# and both drives, with limits of 20 to 100 m on their paths, take up to 17 sizes.
MAX_DETOUR_RATIO = 2.0
TURNING_ROOM_RATIO = 25.0
# Distance between two positions that are compared with a map, over the side of a cell; chosen: no
# obstacle fits between them. And the number of them from which on they are farther apart; chosen:
# 250 m of a map with cells of 5 cm, in less than 0.1 s.
SPACING_RATIO = 0.5
MAX_POSITIONS = 10_000


class PoseRegion(NamedTuple):
    """
    Region of poses in which the object should be.

    :param pose: ``Pose`` of the object.
    :param max_distance: distance up to which a pose counts as there [m].
    :param max_rotation: rotation up to which it does [rad].
    """

    pose: Pose
    max_distance: float
    max_rotation: float

    def contains(self, pose: Pose) -> bool:
        """Tell whether a pose counts as there."""
        return (distance(self.pose, pose) <= self.max_distance
                and abs(wrap_angle(pose.theta - self.pose.theta)) <= self.max_rotation)


class ExpectedEnds(NamedTuple):
    """
    Ends that a plan has to have.

    :param starts: each ``PoseRegion`` in which it may start; empty where that is not known.
    :param goal: ``PoseRegion`` of the goal; None where that is not known.
    :param is_last: whether the push has to end at the goal; other pushes follow otherwise.
    """

    starts: tuple[PoseRegion, ...] = ()
    goal: PoseRegion | None = None
    is_last: bool = True


class ExpectedPush(NamedTuple):
    """
    Push that a plan has to make.

    :param obj: the ``PushedObject``.
    :param robot: the ``RoundRobot``.
    :param ends: the ``ExpectedEnds``.
    :param occupancy_map: ``OccupancyMap`` that it has to keep to; None for open floor.
    """

    obj: PushedObject
    robot: RoundRobot
    ends: ExpectedEnds
    occupancy_map: OccupancyMap | None


def check_plan(plan: PushTrajectory, expected: ExpectedPush) -> None:
    """
    Refuse a plan that does not do what is expected.

    :raises ValueError: saying what is wrong with it.
    """
    _check_ends(plan, expected.ends, expected.obj)
    _check_speeds(plan, expected.robot)
    _check_contact(plan, expected.obj, expected.robot)
    if plan.line is not None:
        _check_face(plan.line, expected.obj)
    check_consistency(plan, expected.obj, expected.robot)
    check_length(plan, expected)
    if expected.occupancy_map is not None:
        check_map(plan, expected.obj, expected.robot, expected.occupancy_map)


def _check_ends(plan: PushTrajectory, ends: ExpectedEnds, obj: PushedObject) -> None:
    start, end = (Pose(*plan.object_poses[sample].tolist()) for sample in (0, -1))
    if ends.starts and not any(region.contains(start) for region in ends.starts):
        raise ValueError('the plan starts where the object is not: '
                         + _offset_text(start, ends.starts[-1]))
    goal = ends.goal
    if goal is None or goal.contains(end):
        return
    if ends.is_last:
        raise ValueError('the plan ends beside the goal: ' + _offset_text(end, goal))
    limit = distance(start, goal.pose) + obj.size
    # A straight push may make room for the next one; what it may take is bounded by its length.
    if not plan.style.is_straight and distance(end, goal.pose) > limit:
        raise ValueError(f'the plan leads away from the goal: got an end '
                         f'{distance(end, goal.pose):.2f} m from it, expected at most {limit:.2f} '
                         'm, one size of the object farther than at the start')


def check_length(plan: PushTrajectory, expected: ExpectedPush) -> None:
    """
    Refuse a detour that no turn of this object needs.

    :raises ValueError: naming the length, and what was expected.
    """
    goal, obj, robot = expected.ends.goal, expected.obj, expected.robot
    end = plan.object_poses[-1] if goal is None else goal.pose
    direct = distance(plan.object_poses[0], end)
    limit = MAX_DETOUR_RATIO * direct + TURNING_ROOM_RATIO * (obj.size + 2.0 * robot.radius)
    for name in ('object_poses', 'contact_poses', 'robot_poses'):
        length = float(np.hypot(*np.diff(getattr(plan, name)[:, :2], axis=0).T).sum())
        if length > limit:
            raise ValueError(f'the plan is too long: got {length:.1f} m of {name}, expected at '
                             f'most {limit:.1f} m for a goal {direct:.2f} m away')


def _offset_text(pose: Pose, region: PoseRegion) -> str:
    rotation = abs(wrap_angle(pose.theta - region.pose.theta))
    return (f'got {distance(region.pose, pose):.3f} m and {math.degrees(rotation):.1f} deg off, '
            f'expected at most {region.max_distance:g} m and '
            f'{math.degrees(region.max_rotation):.1f} deg')


def _check_speeds(plan: PushTrajectory, robot: RoundRobot) -> None:
    """Refuse speeds beyond the robot, be they stated or those from sample to sample."""
    steps = np.diff(plan.robot_poses, axis=0) / np.diff(plan.times)[:, None]
    for rates in (steps, plan.robot_twists):
        speed = float(np.hypot(rates[:, 0], rates[:, 1]).max())
        yaw_rate = float(np.abs(rates[:, 2]).max())
        if speed > MAX_SPEED_RATIO * robot.max_speed:
            raise ValueError(f'the plan is beyond the robot: got {speed:.3g} m/s, expected at '
                             f'most {robot.max_speed:g} m/s')
        if yaw_rate > MAX_SPEED_RATIO * robot.max_yaw_rate:
            raise ValueError(f'the plan is beyond the robot: got {yaw_rate:.3g} rad/s, expected '
                             f'at most {robot.max_yaw_rate:g} rad/s')


def _check_contact(plan: PushTrajectory, obj: PushedObject, robot: RoundRobot) -> None:
    """Refuse a plan whose robot does not touch this object at first, or is far from it later."""
    start, center = Pose(*plan.object_poses[0].tolist()), plan.robot_poses[0, :2].tolist()
    gap = find_contact(obj, start, center, robot.radius).gap
    # False for a gap that is not a number.
    if not abs(gap) <= CONTACT_TOLERANCE:
        raise ValueError(f'the plan is for another object or robot: got a gap of {gap:.3f} m '
                         f'between them at its start, expected at most {CONTACT_TOLERANCE:g} m')
    apart = _greatest_distance(plan.robot_poses, plan.object_poses)
    largest = _extent(obj) + robot.radius + CONTACT_TOLERANCE
    if apart > largest:
        raise ValueError(f'the plan loses the object: got {apart:.2f} m between it and the robot, '
                         f'expected at most {largest:.2f} m')


def _greatest_distance(poses: FloatArray, others: FloatArray) -> float:
    return float(np.hypot(*(poses - others)[:, :2].T).max())


def _check_face(line: PushLine, obj: PushedObject) -> None:
    """Refuse a push at a face that this object does not have."""
    last = face_points(simplified_object(obj))[-1].face
    if line.face > last:
        raise ValueError(f'the plan is for another object: got a push at face {line.face}, '
                         f'expected one from 0 to {last}')


def check_map(plan: PushTrajectory, obj: PushedObject, robot: RoundRobot,
              occupancy_map: OccupancyMap) -> None:
    """
    Refuse a plan into an obstacle, be it between two samples.

    :raises ValueError: naming the body, and where.
    """
    spacing = SPACING_RATIO * occupancy_map.resolution
    objects = _filled_in(plan.object_poses, spacing, _extent(obj))
    _check_body('object', objects, occupancy_map.object_collisions(obj, objects, 0.0))
    robots = _filled_in(plan.robot_poses, spacing, 0.0)
    _check_body('robot', robots, occupancy_map.robot_collisions(robot, robots, 0.0))
    if plan.line is not None:
        # What the robot drives; the samples may cut its arc short.
        distances = np.linspace(0.0, plan.line.length, _count(plan.line.length, spacing),
                                dtype=np.float64)
        driven = plan.line.robot_poses(Pose(*plan.object_poses[0].tolist()), distances)
        _check_body('robot', driven, occupancy_map.robot_collisions(robot, driven, 0.0))


def _filled_in(poses: FloatArray, spacing: float, extent: float) -> FloatArray:
    """
    Interpolate between the samples, so that no point of a body moves farther than a spacing.

    :param poses: (x, y, theta), shape (n, 3).
    :param spacing: [m].
    :param extent: distance of the outermost point of the body from its origin [m].
    :return: poses with those of the samples, shape (m, 3).
    """
    columns = np.column_stack((poses[:, :2], np.unwrap(poses[:, 2])))
    steps = np.abs(np.diff(columns, axis=0))
    lengths = np.concatenate(([0.0], np.cumsum(np.hypot(steps[:, 0], steps[:, 1])
                                               + extent * steps[:, 2])))
    count = _count(float(lengths[-1]), spacing)
    between = np.union1d(lengths, np.linspace(0.0, lengths[-1], count))
    return np.column_stack([np.interp(between, lengths, column) for column in columns.T])


def _count(length: float, spacing: float) -> int:
    """Count positions along a path at most so far apart, up to a number that takes no time."""
    return 2 + int(min(length / spacing, MAX_POSITIONS))


def _extent(obj: PushedObject) -> float:
    """Distance of the outermost point of an object from its origin [m]."""
    return obj.radius if not obj.outline else max(math.hypot(*point) for point in obj.outline)


def _check_body(name: str, poses: FloatArray, collides: BoolArray) -> None:
    """Refuse poses that lead into an obstacle; a body that stands in one at first may leave it."""
    if collides.all():
        raise ValueError(f'the plan keeps the {name} in obstacles of the map')
    free = int(np.argmin(collides))
    if collides[free:].any():
        x, y, _ = poses[free + int(np.argmax(collides[free:]))].tolist()
        raise ValueError(f'the plan leads the {name} into an obstacle of the map, at {x:.2f} m, '
                         f'{y:.2f} m')
