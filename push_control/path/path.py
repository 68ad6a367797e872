"""
Paths of the flat output z, in the goal frame of z.

Anchored there, a path keeps its end where the object's goal is, whatever the centre of friction
turns out to be.
"""

import math
from typing import Any, NamedTuple

import numpy as np
from push_dynamics.compiled import compiled, interpreted
from push_model import dubins
from push_model.dubins import dubins_paths, DubinsPath
from push_model.geometry import FloatArray, Pose
from push_model.quasi_static import Vehicle
from push_model.trajectory import PushTrajectory

advance_along_arc = compiled(dubins.advance_along_arc)

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


class PathNumbers(NamedTuple):
    """
    A path, as compiled functions read it.

    :param rows: x, y [m], psi [rad] and curvature [1/m], one row for each sample at equal
        distances, or for the beginning of each arc, shape (n, 4).
    :param begins: arc lengths of the rows [m], shape (n,).
    :param is_sampled: whether the rows are samples. Of arcs, the first row is for what lies before
        the start.
    """

    rows: Any
    begins: Any
    is_sampled: bool


@compiled
def path_point(path: PathNumbers, s: float) -> PathPoint:
    """
    Evaluate a path; straight on beyond its ends.

    :param path: ``PathNumbers``.
    :param s: arc length from the start [m].
    :return: ``PathPoint``.
    """
    rows, begins = path.rows, path.begins
    last = len(begins) - 1
    if not path.is_sampled:
        index = 0 if s < 0.0 else 1
        while 0 < index < last and s > begins[index + 1]:
            index += 1
        pose = Pose(rows[index, 0], rows[index, 1], rows[index, 2])
        return PathPoint(advance_along_arc(pose, s - begins[index], rows[index, 3]),
                         rows[index, 3])
    if not 0.0 < s < begins[last]:
        index = last if s > 0.0 else 0
        pose = Pose(rows[index, 0], rows[index, 1], rows[index, 2])
        return PathPoint(advance_along_arc(pose, s - begins[index], 0.0), rows[index, 3])
    index = min(int(s / begins[1]), last - 1)
    ratio = s / begins[1] - index
    a, b = rows[index], rows[index + 1]
    return PathPoint(Pose(a[0] + ratio * (b[0] - a[0]), a[1] + ratio * (b[1] - a[1]),
                          a[2] + ratio * (b[2] - a[2])), a[3] + ratio * (b[3] - a[3]))


@compiled
def path_curvature(path: PathNumbers, s: float) -> float:
    """
    Evaluate the curvature of a path; 0 beyond its ends.

    :param path: ``PathNumbers``.
    :param s: arc length from the start [m].
    :return: curvature [1/m].
    """
    last = len(path.begins) - 1
    if path.is_sampled and not 0.0 <= s <= path.begins[last]:
        return 0.0
    return path_point(path, s).curvature


@compiled
def read_curvatures(path: PathNumbers, start: float, distances: Any, curvatures: Any) -> None:
    """
    Evaluate the curvatures of a path; 0 beyond its ends.

    :param path: ``PathNumbers``.
    :param start: arc length [m].
    :param distances: beyond it [m], shape (n,).
    :param curvatures: is written [1/m], shape (n,).
    """
    for i in range(len(distances)):
        curvatures[i] = path_curvature(path, start + distances[i])


@compiled
def curvature_range(path: PathNumbers, start: float, distances: Any,
                    longest: float) -> CurvatureLimits:
    """
    Find the least and the greatest curvature of a path ahead.

    :param path: ``PathNumbers``.
    :param start: arc length [m].
    :param distances: beyond it [m], shape (n,).
    :param longest: to which they are shortened [m].
    :return: ``CurvatureLimits``.
    """
    low, high = math.inf, -math.inf
    for i in range(len(distances)):
        curvature = path_curvature(path, start + min(distances[i], longest))
        low, high = min(low, curvature), max(high, curvature)
    return CurvatureLimits(low, high)


class FlatOutputPath:
    """
    A path of z that ends at the origin of its frame, along x.

    ``length``: arc length [m]. ``numbers``: ``PathNumbers``.
    """

    length: float
    numbers: PathNumbers

    def at(self, s: float) -> PathPoint:
        """
        Evaluate the path; straight on beyond the ends.

        :param s: arc length from the start [m].
        :return: ``PathPoint``.
        """
        return interpreted(path_point)(self.numbers, s)

    def curvatures(self, start: float, distances: FloatArray) -> FloatArray:
        """
        Evaluate curvatures; 0 beyond the end.

        :param start: arc length from the start [m].
        :param distances: beyond that [m], shape (n,).
        :return: curvatures [1/m], shape (n,).
        """
        curvatures: FloatArray = np.empty(len(distances))
        read_curvatures(self.numbers, start, distances, curvatures)
        return curvatures

    def curvature_range(self, start: float, distances: FloatArray,
                        longest: float) -> CurvatureLimits:
        """
        Find the least and the greatest curvature ahead.

        :param start: arc length from the start [m].
        :param distances: beyond that [m], shape (n,).
        :param longest: to which they are shortened [m].
        :return: ``CurvatureLimits``.
        """
        return curvature_range(self.numbers, start, distances, longest)


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
        begins = np.linspace(0.0, length, count)
        x, y, psi = (np.interp(begins, arc_lengths, column) for column in dense_poses)
        rows = np.column_stack((x, y, psi, np.gradient(psi, begins)))
        self.numbers = PathNumbers(rows, begins, True)
        self.length = float(length)


class FinalStraightPath(FlatOutputPath):
    """A Dubins path, and a straight final approach to the goal."""

    def __init__(self, route: DubinsPath, final_straight: float):
        """
        Append the straight final approach.

        :param route: ``DubinsPath`` to the beginning of the final approach.
        :param final_straight: length of that [m].
        """
        self.length = route.length + final_straight
        # Before the start, on each of the three segments, and beyond them.
        begins = np.cumsum((0.0, 0.0, *route.lengths))
        curvatures = np.array((0.0, *route.curvatures, 0.0))
        pose = route.start
        poses = [pose, pose]
        for distance, curvature in zip(route.lengths, route.curvatures):
            pose = dubins.advance_along_arc(pose, distance, curvature)
            poses.append(pose)
        self.numbers = PathNumbers(np.column_stack((poses, curvatures)), begins, False)


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
    return projected(path.numbers, path.length, pose, s)


@compiled
def projected(path: PathNumbers, length: float, pose: Pose, s: float) -> PathProjection:
    """
    Project a pose on a path, near a given arc length.

    :param path: ``PathNumbers``.
    :param length: of the path [m].
    :param pose: ``Pose`` in the goal frame of z.
    :param s: arc length at which to begin [m].
    :return: ``PathProjection``.
    """
    for _ in range(PROJECTION_ITERATIONS):
        on, curvature = path_point(path, s)
        cosine, sine = math.cos(on.theta), math.sin(on.theta)
        off_x, off_y = pose.x - on.x, pose.y - on.y
        ahead, lateral = cosine * off_x + sine * off_y, cosine * off_y - sine * off_x
        step = ahead / max(MIN_PROJECTION_DIVISOR, 1.0 - curvature * lateral)
        s += min(MAX_PROJECTION_STEP, max(-MAX_PROJECTION_STEP, step))
    on, curvature = path_point(path, s)
    lateral = math.cos(on.theta) * (pose.y - on.y) - math.sin(on.theta) * (pose.x - on.x)
    # The heading error, within half a turn to either side.
    off = pose.theta - on.theta
    off -= 2.0 * math.pi * math.floor(off / (2.0 * math.pi) + 0.5)
    return PathProjection(s, lateral, off, curvature, length - s)


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
            point = dubins.advance_along_arc(start, length * k / count, rotation / length)
            rows.append((point.x, point.y, psi[i] + rotation * k / count))
            arc_lengths.append(arc_lengths[-1] + length / count)
    return np.array(arc_lengths), np.array(rows).T
