"""
Paths of the flat output z, in the goal frame of z.

Anchored there, a path keeps its end where the object's goal is, whatever the centre of friction
turns out to be.
"""

import abc
import math
from typing import NamedTuple

import numpy as np
from push_model.dubins import advance_along_arc, dubins_paths, DubinsPath
from push_model.geometry import FloatArray, Pose, wrap_angle
from push_model.quasi_static import Vehicle
from push_model.trajectory import PushTrajectory

# Spacing of the samples of a path [m]. Chosen: a small part of any turn that can be pushed.
SPACING = 0.02
# Largest radius of a turn [m]. Chosen: nearly straight, and finite where a limit is nearly 0.
MAX_RADIUS = 20.0
# Smallest curvature whose inverse is taken [1/m].
MIN_CURVATURE = 1e-9
# Iterations of the projection, and the longest step of each [m]. Chosen: the pose has moved by
# millimetres since the last projection.
PROJECTION_ITERATIONS = 3
MAX_PROJECTION_STEP = 0.2
# Smallest ``1 - kappa e_y`` that a step is divided by: near the centre of a turn there is no
# projection.
MIN_PROJECTION_DIVISOR = 0.5
# Smallest ratio of chord to arc: that of nearly a full circle.
MIN_CHORD_RATIO = 0.1


class CurvatureLimits(NamedTuple):
    """Lowest and highest curvature of z [1/m]."""

    low: float
    high: float

    def clip(self, curvature: float) -> float:
        """
        Bring a curvature into the limits.

        :param curvature: as chosen [1/m].
        :return: the nearest curvature within the limits [1/m].
        """
        return min(self.high, max(self.low, curvature))

    def intersection(self, other: 'CurvatureLimits') -> 'CurvatureLimits':
        """
        Narrow the limits to those that hold for another reason as well.

        :param other: ``CurvatureLimits``.
        :return: ``CurvatureLimits``.
        """
        return CurvatureLimits(max(self.low, other.low), min(self.high, other.high))


class PathPoint(NamedTuple):
    """
    A point of a path.

    :param pose: ``Pose`` in the goal frame of z, x along the path.
    :param curvature: of the path there [1/m].
    """

    pose: Pose
    curvature: float


class FlatOutputPath(abc.ABC):
    """A path of z that ends at the origin of its frame, along x. ``length``: arc length [m]."""

    length: float

    @abc.abstractmethod
    def at(self, s: float) -> PathPoint:
        """
        Evaluate the path; straight on beyond the ends.

        :param s: arc length from the start [m].
        :return: ``PathPoint``.
        """

    @abc.abstractmethod
    def curvatures(self, s: FloatArray) -> FloatArray:
        """
        Evaluate curvatures; 0 beyond the end.

        :param s: arc lengths from the start [m], shape (n,).
        :return: curvatures [1/m], shape (n,).
        """


class SampledPath(FlatOutputPath):
    """The planned path, from the samples of a trajectory."""

    def __init__(self, vehicle: Vehicle, trajectory: PushTrajectory):
        """
        Take the path from a trajectory.

        :param vehicle: the nominal object as ``Vehicle``.
        :param trajectory: the ``PushTrajectory``.
        :raises ValueError: where z does not move.
        """
        arc_lengths, dense_poses = _with_arcs(_flat_output_poses(vehicle, trajectory))
        length = arc_lengths[-1]
        if length < SPACING:
            raise ValueError(f'trajectory: got a path of {length:.3f} m of the flat output, '
                             f'expected at least {SPACING} m')
        count = max(3, math.ceil(length / SPACING) + 1)
        self._arc_lengths = np.linspace(0.0, length, count)
        x, y, psi = (np.interp(self._arc_lengths, arc_lengths, column) for column in dense_poses)
        self._curvature: FloatArray = np.gradient(psi, self._arc_lengths)
        self._rows = list(zip(x.tolist(), y.tolist(), psi.tolist(), self._curvature.tolist()))
        self._spacing = float(self._arc_lengths[1])
        self.length = float(length)

    def at(self, s: float) -> PathPoint:
        """
        Evaluate the path; straight on beyond the ends.

        :param s: arc length from the start [m].
        :return: ``PathPoint``.
        """
        if s <= 0.0:
            return self._beyond(0, s)
        if s >= self.length:
            return self._beyond(-1, s - self.length)
        index = min(int(s / self._spacing), len(self._rows) - 2)
        ratio = s / self._spacing - index
        x, y, psi, curvature = (a + ratio * (b - a) for a, b in zip(self._rows[index],
                                                                    self._rows[index + 1]))
        return PathPoint(Pose(x, y, psi), curvature)

    def _beyond(self, row: int, distance: float) -> PathPoint:
        x, y, psi, curvature = self._rows[row]
        return PathPoint(advance_along_arc(Pose(x, y, psi), distance, 0.0), curvature)

    def curvatures(self, s: FloatArray) -> FloatArray:
        """
        Evaluate curvatures; 0 beyond the ends.

        :param s: arc lengths from the start [m], shape (n,).
        :return: curvatures [1/m], shape (n,).
        """
        return np.interp(s, self._arc_lengths, self._curvature, 0.0, 0.0)


class FinalStraightPath(FlatOutputPath):
    """A Dubins path, and a straight final approach to the goal."""

    def __init__(self, dubins: DubinsPath, final_straight: float):
        """
        Append the straight final approach.

        :param dubins: ``DubinsPath`` to the beginning of the final approach.
        :param final_straight: length of that [m].
        """
        self._dubins = dubins
        self.length = dubins.length + final_straight
        # Before the start, on each of the three segments, and beyond them.
        self._segment_ends = np.cumsum((0.0, *dubins.lengths))
        self._segment_curvatures = np.array((0.0, *dubins.curvatures, 0.0))

    def at(self, s: float) -> PathPoint:
        """
        Evaluate the path; straight on beyond the ends.

        :param s: arc length from the start [m].
        :return: ``PathPoint``.
        """
        return PathPoint(*self._dubins.at(s))

    def curvatures(self, s: FloatArray) -> FloatArray:
        """
        Evaluate curvatures; 0 beyond the ends.

        :param s: arc lengths from the start [m], shape (n,).
        :return: curvatures [1/m], shape (n,).
        """
        return self._segment_curvatures[np.searchsorted(self._segment_ends, s)]


class PathProjection(NamedTuple):
    """
    A pose, projected on a path.

    :param s: arc length of the projection from the start [m].
    :param lateral_error: distance from the path, left of it is positive [m].
    :param heading_error: from the direction of the path, to the left is positive [rad].
    :param curvature: of the path there [1/m].
    :param remaining_distance: arc length to the end [m].
    """

    s: float
    lateral_error: float
    heading_error: float
    curvature: float
    remaining_distance: float


def flat_output_pose(vehicle: Vehicle) -> Pose:
    """
    Pose of the frame of z in the object frame: at z, along the direction from C to F.

    :param vehicle: the object as ``Vehicle``.
    :return: ``Pose``.
    """
    return Pose(*vehicle.flat_output, vehicle.angle)


def path_to_goal(start: Pose, limits: CurvatureLimits, final_straight: float) -> FinalStraightPath:
    """
    Find the shortest path to the goal of z.

    :param start: ``Pose`` of z in its goal frame.
    :param limits: ``CurvatureLimits``, on either side of 0.
    :param final_straight: length of the straight final approach [m].
    :return: ``FinalStraightPath``.
    """
    left = min(MAX_RADIUS, 1.0 / max(limits.high, MIN_CURVATURE))
    right = min(MAX_RADIUS, 1.0 / max(-limits.low, MIN_CURVATURE))
    shortest = dubins_paths(start, Pose(-final_straight, 0.0, 0.0), left, right)[0]
    return FinalStraightPath(shortest, final_straight)


def project_on_path(path: FlatOutputPath, pose: Pose, s: float) -> PathProjection:
    """
    Project a pose on a path, near a given arc length.

    :param path: the ``FlatOutputPath``.
    :param pose: ``Pose`` in the goal frame of z.
    :param s: arc length at which to begin [m].
    :return: ``PathProjection``.
    """
    for _ in range(PROJECTION_ITERATIONS):
        on, curvature = path.at(s)
        cosine, sine = math.cos(on.theta), math.sin(on.theta)
        off_x, off_y = pose.x - on.x, pose.y - on.y
        ahead, lateral = cosine * off_x + sine * off_y, cosine * off_y - sine * off_x
        step = ahead / max(MIN_PROJECTION_DIVISOR, 1.0 - curvature * lateral)
        s += min(MAX_PROJECTION_STEP, max(-MAX_PROJECTION_STEP, step))
    on, curvature = path.at(s)
    lateral = math.cos(on.theta) * (pose.y - on.y) - math.sin(on.theta) * (pose.x - on.x)
    return PathProjection(s, lateral, wrap_angle(pose.theta - on.theta), curvature,
                          path.length - s)


def _flat_output_poses(vehicle: Vehicle, trajectory: PushTrajectory) -> FloatArray:
    """Return z (x, y, psi) for each sample in the frame of the last, shape (3, n)."""
    local = flat_output_pose(vehicle)
    rows = [Pose(*pose) @ local for pose in trajectory.object_poses.tolist()]
    to_goal = rows[-1].inverse()
    poses = np.array([to_goal @ row for row in rows]).T
    poses[2] = np.unwrap(poses[2])
    return poses


def _with_arcs(poses: FloatArray) -> tuple[FloatArray, FloatArray]:
    """
    Fill the gaps between samples by arcs through them.

    Returns arc lengths, shape (m,), and (x, y, psi), shape (3, m).
    """
    x, y, psi = poses
    rows, arc_lengths = [(x[0], y[0], psi[0])], [0.0]
    for i in range(len(x) - 1):
        chord, rotation = math.hypot(x[i + 1] - x[i], y[i + 1] - y[i]), psi[i + 1] - psi[i]
        if chord == 0.0:
            continue
        bearing = math.atan2(y[i + 1] - y[i], x[i + 1] - x[i])
        chord_ratio = math.sin(0.5 * rotation) / (0.5 * rotation) if rotation else 1.0
        length = chord / max(MIN_CHORD_RATIO, chord_ratio)
        start = Pose(x[i], y[i], bearing - 0.5 * rotation)
        count = max(1, math.ceil(length / SPACING))
        for k in range(1, count + 1):
            point = advance_along_arc(start, length * k / count, rotation / length)
            rows.append((point.x, point.y, psi[i] + rotation * k / count))
            arc_lengths.append(arc_lengths[-1] + length / count)
    return np.array(arc_lengths), np.array(rows).T
