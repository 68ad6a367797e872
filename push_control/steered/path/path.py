"""
Paths of the flat output z, in the goal frame of z.

Anchored there, a path keeps its end where the object's goal is, whatever the centre of friction
turns out to be.
"""

import math
from typing import Any, NamedTuple

import numpy as np
from push_dynamics.compiled import compiled, interpreted, wrap_angles
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
# Distances ahead at which a path must keep to the limits: spacing [m] and number. Chosen: one
# metre, every 0.1 m.
LOOK_AHEAD_SPACING = 0.1
LOOK_AHEAD_COUNT = 11
# Columns of ``FlatOutputPath.rows``, beyond those of the pose.
CURVATURE = 3
START = 4
# Count of the numbers of a ``PathProjection``.
PROJECTION_SIZE = 5


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
        """Narrow the limits to those that hold for another reason as well."""
        return CurvatureLimits(max(self.low, other.low), min(self.high, other.high))


class PathPoint(NamedTuple):
    """
    A point of a path.

    :param pose: ``Pose`` in the goal frame of z, x along the path.
    :param curvature: of the path there [1/m].
    """

    pose: Pose
    curvature: float


@compiled
def path_point(rows: Any, s: float) -> PathPoint:
    """
    Evaluate a path; straight on beyond its ends.

    :param rows: ``FlatOutputPath.rows``.
    :param s: arc length from the start [m].
    """
    last = len(rows) - 1
    if not is_sampled(rows):
        index = 0 if s < 0.0 else 1
        while 0 < index < last and s > rows[index + 1, START]:
            index += 1
        return PathPoint(advance_along_arc(row_pose(rows[index]), s - rows[index, START],
                                           rows[index, CURVATURE]), rows[index, CURVATURE])
    if not 0.0 < s < rows[last, START]:
        index = last if s > 0.0 else 0
        return PathPoint(advance_along_arc(row_pose(rows[index]), s - rows[index, START], 0.0),
                         rows[index, CURVATURE])
    index = min(int(s / rows[1, START]), last - 1)
    ratio = s / rows[1, START] - index
    a, b = rows[index], rows[index + 1]
    return PathPoint(Pose(a[0] + ratio * (b[0] - a[0]), a[1] + ratio * (b[1] - a[1]),
                          a[2] + ratio * (b[2] - a[2])), a[3] + ratio * (b[3] - a[3]))


@compiled
def is_sampled(rows: Any) -> bool:
    """
    Tell samples from arcs, the first two rows of which begin at 0 alike.

    :param rows: ``FlatOutputPath.rows``.
    """
    return rows[1, START] > 0.0


@compiled
def row_pose(row: Any) -> Pose:
    """
    Read the pose of a row.

    :param row: of ``FlatOutputPath.rows``.
    """
    return Pose(row[0], row[1], row[2])


@compiled
def path_curvature(rows: Any, s: float) -> float:
    """
    Evaluate the curvature of a path; 0 beyond its ends.

    :param rows: ``FlatOutputPath.rows``.
    :param s: arc length from the start [m].
    :return: curvature [1/m].
    """
    if is_sampled(rows) and not 0.0 <= s <= rows[len(rows) - 1, START]:
        return 0.0
    return path_point(rows, s).curvature


@compiled
def read_curvatures(rows: Any, start: float, distances: Any, curvatures: Any) -> None:
    """
    Evaluate the curvatures of a path; 0 beyond its ends.

    :param rows: ``FlatOutputPath.rows``.
    :param start: arc length [m].
    :param distances: beyond it [m], shape (n,).
    :param curvatures: is written [1/m], shape (n,).
    """
    for i in range(len(distances)):
        curvatures[i] = path_curvature(rows, start + distances[i])


@compiled
def keeps_to(rows: Any, start: float, low: float, high: float) -> bool:
    """
    Tell whether the curvature of a path ahead, up to its end, keeps to limits.

    :param rows: ``FlatOutputPath.rows``.
    :param start: arc length [m].
    :param low: least curvature [1/m].
    :param high: greatest curvature [1/m].
    """
    longest = rows[len(rows) - 1, START] - start
    for i in range(LOOK_AHEAD_COUNT):
        distance = min(i * LOOK_AHEAD_SPACING, longest)
        if not low <= path_curvature(rows, start + distance) <= high:
            return False
    return True


@compiled
def keeps_path(rows: Any, projection: Any, errors: Any, limits: Any) -> bool:
    """
    Tell whether a path can be kept: z is near it, and ahead of z it keeps to the limits.

    :param rows: ``FlatOutputPath.rows``.
    :param projection: numbers of the ``PathProjection`` of z, shape (5,).
    :param errors: lateral [m] and heading error [rad] up to which z is near, shape (2,).
    :param limits: least and greatest curvature [1/m], shape (2,).
    """
    if abs(projection[1]) > errors[0] or abs(projection[2]) > errors[1]:
        return False
    return keeps_to(rows, projection[0], limits[0], limits[1])


class FlatOutputPath:
    """
    A path of z that ends at the origin of its frame, along x.

    ``rows``: x, y [m], psi [rad], curvature [1/m] and the arc length at which it begins [m], one
    row for each sample at equal distances, or for each arc; read-only, shape (n, 5). The last row
    is the end; of arcs, the first one is for what lies before the start.
    """

    def __init__(self, rows: FloatArray):
        """
        Take the rows.

        :param rows: shape (n, 5).
        """
        self.rows = np.ascontiguousarray(rows)
        self.rows.flags.writeable = False

    @property
    def length(self) -> float:
        """Arc length [m]."""
        return float(self.rows[-1, START])

    def at(self, s: float) -> PathPoint:
        """
        Evaluate the path; straight on beyond the ends.

        :param s: arc length from the start [m].
        """
        return interpreted(path_point)(self.rows, s)

    def curvatures(self, start: float, distances: FloatArray) -> FloatArray:
        """
        Evaluate curvatures; 0 beyond the end.

        :param start: arc length from the start [m].
        :param distances: beyond that [m], shape (n,).
        :return: curvatures [1/m], shape (n,).
        """
        curvatures: FloatArray = np.empty(len(distances))
        read_curvatures(self.rows, start, distances, curvatures)
        return curvatures


class SampledPath(FlatOutputPath):
    """The planned path, from the samples of a trajectory."""

    def __init__(self, vehicle: Vehicle, trajectory: PushTrajectory):
        """
        Take the path from a trajectory.

        :param vehicle: the nominal object as ``Vehicle``.
        :raises ValueError: where z does not move.
        """
        arc_lengths, dense_poses = _with_arcs(_flat_output_poses(vehicle, trajectory))
        length = arc_lengths[-1]
        if length < SPACING:
            raise ValueError(f'trajectory: got a path of {length:.3f} m of the flat output, '
                             f'expected at least {SPACING} m')
        count = max(3, math.ceil(length / SPACING) + 1)
        starts = np.linspace(0.0, length, count)
        x, y, psi = (np.interp(starts, arc_lengths, column) for column in dense_poses)
        super().__init__(np.column_stack((x, y, psi, np.gradient(psi, starts), starts)))


class FinalStraightPath(FlatOutputPath):
    """A Dubins path, and a straight final approach to the goal."""

    def __init__(self, route: DubinsPath, final_straight: float):
        """
        Append the straight final approach.

        :param route: ``DubinsPath`` to the beginning of the final approach.
        :param final_straight: length of that [m].
        """
        # Before the start, on each of the three segments and the final approach, and beyond.
        lengths = (0.0, *route.lengths, final_straight)
        curvatures = (0.0, *route.curvatures, 0.0, 0.0)
        poses = [route.start]
        for distance, curvature in zip(lengths, curvatures):
            poses.append(dubins.advance_along_arc(poses[-1], distance, curvature))
        super().__init__(np.column_stack((poses, curvatures, np.cumsum((0.0, *lengths)))))


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
    """
    return Pose(*vehicle.flat_output, vehicle.angle)


def path_to_goal(start: Pose, limits: CurvatureLimits, final_straight: float) -> FinalStraightPath:
    """
    Find the shortest path to the goal of z.

    :param start: ``Pose`` of z in its goal frame.
    :param limits: ``CurvatureLimits``, on either side of 0.
    :param final_straight: length of the straight final approach [m].
    """
    left_radius = min(MAX_RADIUS, 1.0 / max(limits.high, MIN_CURVATURE))
    right_radius = min(MAX_RADIUS, 1.0 / max(-limits.low, MIN_CURVATURE))
    shortest = dubins_paths(start, Pose(-final_straight, 0.0, 0.0), left_radius, right_radius)[0]
    return FinalStraightPath(shortest, final_straight)


def project_on_path(path: FlatOutputPath, pose: Pose, values: FloatArray) -> PathProjection:
    """
    Project a pose on a path, near a given arc length.

    :param pose: ``Pose`` in the goal frame of z.
    :param values: those of the last ``PathProjection``, become those of the new one; the first
        one is the arc length at which to begin [m].
    """
    write_projection(path.rows, *pose, values)
    return PathProjection(*values.tolist())


@compiled
def write_projection(rows: Any, x: float, y: float, theta: float, projection: Any) -> None:
    """
    Project a pose on a path, near a given arc length.

    :param rows: ``FlatOutputPath.rows``.
    :param x: of the pose in the goal frame of z [m].
    :param y: of the pose [m].
    :param theta: of the pose [rad].
    :param projection: numbers of a ``PathProjection``, is written; it begins with its s.
    """
    s = projection[0]
    for _ in range(PROJECTION_ITERATIONS):
        on, curvature = path_point(rows, s)
        cosine, sine = math.cos(on.theta), math.sin(on.theta)
        off_x, off_y = x - on.x, y - on.y
        along, lateral = cosine * off_x + sine * off_y, cosine * off_y - sine * off_x
        step = along / max(MIN_PROJECTION_DIVISOR, 1.0 - curvature * lateral)
        s += min(MAX_PROJECTION_STEP, max(-MAX_PROJECTION_STEP, step))
    on, curvature = path_point(rows, s)
    lateral = math.cos(on.theta) * (y - on.y) - math.sin(on.theta) * (x - on.x)
    off = wrap_angles(theta - on.theta)
    projection[0], projection[1], projection[2], projection[3] = s, lateral, off, curvature
    projection[4] = rows[len(rows) - 1, START] - s


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
