"""From a push sequence to its pushes: where each begins and ends, and the problem it poses."""

import dataclasses
import itertools
import math
from typing import NamedTuple, Sequence

from push_model.dubins import advance_along_arc
from push_model.geometry import Pose
from push_model.parameters import Contact
from push_model.trajectory import PushTrajectory
from push_planner.collocation.speed_profile import push_time
from push_planner.problem import PushProblem
from push_planner.sequence.primitives import PrimitiveTable, PushPrimitive
from push_planner.settings import PlannerSettings

# With these three, nearly all pushes of random sequences are solved, and at the first attempt.
# Distance over which the normal of a differential drive settles before the final straight, in
# radii of the robot.
SETTLING_RADII = 1.5
# Fraction of the straight end of a push that is asked of its plan at least.
MIN_FINAL_FRACTION = 0.1
# How much longer than meant a push may be.
MAX_LENGTH_RATIO = 1.3


class Move(NamedTuple):
    """
    One move of a push sequence: straight, rotation, straight.

    :param primitive: number of the ``PushPrimitive``.
    :param rotation: signed rotation of the object [rad].
    :param straight_before: length before the rotation [m].
    :param straight_after: length after it [m].
    """

    primitive: int
    rotation: float
    straight_before: float
    straight_after: float


class PushSequence(NamedTuple):
    """
    A sequence of moves; those that follow each other at one contact location are one push.

    :param moves: ``Move`` tuple.
    :param duration: of all together, and of correcting a miss of the last push times its
        probability, about [s].
    """

    moves: tuple[Move, ...]
    duration: float


class FlatSegment(NamedTuple):
    """
    Segment of the path of the flat output point.

    :param length: [m].
    :param curvature: signed [1/m].
    """

    length: float
    curvature: float


class PlannedPush(NamedTuple):
    """
    One push of a sequence.

    :param contact: the ``Contact``.
    :param start: ``Pose`` of the object before it.
    :param end: ``Pose`` of the object after it.
    :param robot_start: ``Pose`` of the robot at the contact before it.
    :param robot_end: ``Pose`` of the robot at the contact after it.
    :param duration: of the push alone [s].
    :param path_length: of the contact [m].
    """

    contact: Contact
    start: Pose
    end: Pose
    robot_start: Pose
    robot_end: Pose
    duration: float
    path_length: float


class SequenceStep(NamedTuple):
    """
    One push of a sequence before it is planned.

    :param problem: the ``PushProblem``.
    :param push: the ``PlannedPush``, about.
    :param segments: ``FlatSegment`` of the flat output point.
    """

    problem: PushProblem
    push: PlannedPush
    segments: tuple[FlatSegment, ...]

    @property
    def rotation(self) -> float:
        """Angle by which the push rotates the object, to and fro [rad]."""
        return sum(abs(length * curvature) for length, curvature in self.segments)

    def object_poses(self, spacing: float) -> list[Pose]:
        """
        Sample the path of the object.

        :param spacing: largest distance between samples [m].
        :return: list of ``Pose`` in the world.
        """
        flat = _flat_pose(self.problem)
        flat_inverse = flat.inverse()
        here = self.push.start @ flat
        poses = [self.push.start]
        for length, curvature in self.segments:
            count = max(1, math.ceil(length * (1.0 + abs(curvature)) / spacing))
            poses += [advance_along_arc(here, length * i / count, curvature) @ flat_inverse
                      for i in range(1, count + 1)]
            here = advance_along_arc(here, length, curvature)
        return poses


def sequence_poses(trajectory: PushTrajectory, later_steps: Sequence[SequenceStep],
                   spacing: float) -> list[Sequence[float]]:
    """
    Sample the path of the object through a sequence.

    :param trajectory: ``PushTrajectory`` of the first push.
    :param later_steps: ``SequenceStep`` of each of the others.
    :param spacing: largest distance between samples of these [m].
    :return: list of (x, y, theta) in the world.
    """
    poses: list[Sequence[float]] = trajectory.object_poses.tolist()
    for step in later_steps:
        poses += step.object_poses(spacing)
    return poses


def build_steps(sequence: PushSequence, table: PrimitiveTable, start: Pose, goal: Pose,
                settings: PlannerSettings) -> list[SequenceStep]:
    """
    Divide a sequence into its pushes, and find where each of them ends.

    :param sequence: the ``PushSequence``.
    :param table: the ``PrimitiveTable``.
    :param start: ``Pose`` of the object in the world.
    :param goal: ``Pose`` of the object in the world; the last push is to end exactly there.
    :param settings: ``PlannerSettings``.
    :return: list of ``SequenceStep``.
    """
    pushes = [list(moves) for _, moves in itertools.groupby(
        sequence.moves, key=lambda move: table.locations[move.primitive])]
    steps: list[SequenceStep] = []
    pose = start
    for moves in pushes:
        primitive = table.primitives[moves[0].primitive]
        segments, path_length = _segments(moves, table)
        flat = _flat_pose(primitive.problem)
        here = pose @ flat
        for length, curvature in segments:
            here = advance_along_arc(here, length, curvature)
        end = goal if moves is pushes[-1] else here @ flat.inverse()
        problem = primitive.problem_at(pose, end, _push_settings(
            settings, primitive, path_length, segments[-1].length))
        push = PlannedPush(problem.contact, pose, end, pose @ primitive.robot_pose,
                           end @ primitive.robot_pose, push_time(settings, path_length),
                           path_length)
        steps.append(SequenceStep(problem, push, segments))
        pose = end
    return steps


def _flat_pose(problem: PushProblem) -> Pose:
    """Flat output point with the direction in which it moves, in the object frame."""
    vehicle = problem.vehicle
    return Pose(*vehicle.flat_output, vehicle.angle)


def _segments(moves: Sequence[Move],
              table: PrimitiveTable) -> tuple[tuple[FlatSegment, ...], float]:
    """Path of the flat output point in one push, and the path length of the contact."""
    segments: list[FlatSegment] = []
    path_length = 0.0
    for number, rotation, before, after in moves:
        primitive = table.primitives[number]
        arc = abs(rotation) * primitive.radius
        segments += [FlatSegment(before, 0.0),
                     FlatSegment(arc, primitive.side / primitive.radius),
                     FlatSegment(after, 0.0)]
        path_length += before + primitive.length_ratio * arc + after
    return tuple(segments), path_length


def _push_settings(settings: PlannerSettings, primitive: PushPrimitive, path_length: float,
                   straight: float) -> PlannerSettings:
    """Shorten the final straight, so that the normal settles; refuse pushes longer than meant."""
    settled = max(straight - SETTLING_RADII * primitive.problem.robot.radius,
                  MIN_FINAL_FRACTION * straight)
    return dataclasses.replace(
        settings, final_straight=min(settings.final_straight, settled), heading_free=False,
        max_path_length=min(settings.max_path_length, MAX_LENGTH_RATIO * path_length))
