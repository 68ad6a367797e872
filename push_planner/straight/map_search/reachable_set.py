"""
Where the robot gets between two pushes, and how far that is: paths on a grid round the object.

The grid lies about the object and is filled breadth first from the robot. A grid point is
free where the robot keeps its margins from obstacles and object; a robot that has less where
it is may go where it does not get less.
"""

import math
from typing import Any, NamedTuple

from push_dynamics.compiled import compiled
from push_model.geometry import FloatArray, IntArray
from push_navigation.floor import clearance
from push_planner.straight.map_search.scene import distance_to_object

# Spacing of the grid [m]; chosen: a third of the radius of a small robot.
SPACING = 0.05
# Half the side of the window between pushes, in spacings; chosen: 1.4 m, all round a table, and
# 5 m, round through another room, where nothing is found in that.
HALF_WINDOW, WIDE_WINDOW = 28, 100
# Where the robot does not get [m]. Finite, see ``object_distance``.
UNREACHED = 1e9
DIAGONAL = math.sqrt(2.0)
# Rounding of the lengths of paths [m].
ROUNDING = 1e-6
# Points on half of the line along which the robot may have been displaced; chosen: see
# ``map_clearance``.
AXIS_STEPS = 3


class ReachableSet(NamedTuple):
    """
    Memory for the paths from one position of the robot.

    :param lengths: of the paths to grid points, shape (n, n), n odd and at least as much as the
        window needs [m]; the middle is at the object.
    :param moments: integrals of (x, y) along them, from where they start, shape (n, n, 2) [m^2];
        not used where the heading of the robot does not drift.
    :param queue: of grid points, a ring.
    """

    lengths: FloatArray
    moments: FloatArray
    queue: IntArray


class RobotMargins(NamedTuple):
    """
    Margins of the robot.

    :param obstacles: from obstacles of the map [m].
    :param object: from the object [m].
    :param position: what it keeps from obstacles at least as its position is uncertain [m].
    :param slope: growth of that per distance from where it starts [m/m]; all add as squares.
    :param drift: displacement for each lever of the path behind it, as of ``map_clearance`` [1/m].
    """

    obstacles: float
    object: float  # noqa: A003
    position: float = 0.0
    slope: float = 0.0
    drift: float = 0.0


@compiled
def fill_reachable_set(scene: Any, margins: Any, pose: Any, position: Any, half: int,
                       reachable: Any) -> int:
    """
    Write the lengths of the robot's paths from a position.

    :param scene: ``Scene``.
    :param margins: ``RobotMargins``.
    :param pose: (x, y, theta) of the object in the frame of the map.
    :param position: (x, y) of the robot there.
    :param half: half the side of the window [spacings].
    :param reachable: ``ReachableSet``, is written.
    :return: number of grid points that were looked at.
    """
    side = 2 * half + 1
    lengths, queue = reachable.lengths, reachable.queue
    for i in range(side):
        for j in range(side):
            lengths[i, j] = UNREACHED
    row = int(math.floor((position[1] - pose[1]) / SPACING + 0.5)) + half
    column = int(math.floor((position[0] - pose[0]) / SPACING + 0.5)) + half
    if row < 0 or column < 0 or row >= side or column >= side:
        return 0
    lengths[row, column] = 0.0
    queue[0] = row * side + column
    reachable.moments[row, column, 0] = reachable.moments[row, column, 1] = 0.0
    first, last = 0, 1
    size = queue.shape[0]
    origin = row, column, half
    while first < last:
        index = queue[first % size]
        first += 1
        i, j = index // side, index % side
        for a in range(max(0, i - 1), min(side, i + 2)):
            for b in range(max(0, j - 1), min(side, j + 2)):
                step = SPACING if a == i or b == j else DIAGONAL * SPACING
                length = lengths[i, j] + step
                if (lengths[a, b] > length + ROUNDING and last - first < size
                        and _may_step(scene, margins, pose, reachable, (i, j, a, b), origin)):
                    lengths[a, b] = length
                    queue[last % size] = a * side + b
                    last += 1
    return last


@compiled
def path_length(reachable: Any, pose: Any, half: int, x: float, y: float) -> float:
    """
    Find the length of the robot's path to a point: the least of the grid points about it.

    :param reachable: ``ReachableSet``, filled.
    :param pose: (x, y, theta) of the object in the frame of the map.
    :param half: half the side of the window [spacings].
    :param x: of the point [m].
    :param y: of the point [m].
    :return: length [m], ``UNREACHED`` where there is no path.
    """
    side = 2 * half + 1
    i0 = int(math.floor((y - pose[1]) / SPACING)) + half
    j0 = int(math.floor((x - pose[0]) / SPACING)) + half
    least = UNREACHED
    for i in range(max(0, i0), min(side, i0 + 2)):
        for j in range(max(0, j0), min(side, j0 + 2)):
            least = min(least, reachable.lengths[i, j])
    return least


@compiled
def needed_gap(margins: Any, away: float) -> float:
    """
    Compute what the robot keeps from obstacles, but for the drift of its heading.

    :param margins: ``RobotMargins``.
    :param away: from where it starts [m].
    :return: gap [m].
    """
    rising = margins.slope * away
    return max(margins.obstacles, math.sqrt(margins.position * margins.position + rising * rising))


@compiled
def _may_step(scene: Any, margins: Any, pose: Any, reachable: Any,
              step: tuple[int, int, int, int], origin: tuple[int, int, int]) -> bool:
    """
    Tell whether the robot may go from one grid point to the next.

    :param scene: ``Scene``.
    :param margins: ``RobotMargins``.
    :param pose: (x, y, theta) of the object.
    :param reachable: ``ReachableSet``, of which the moment at the end of the step is written.
    :param step: from a row and column of the grid to others.
    :param origin: row and column in which the path starts, and those of the object.
    """
    if not _may_drift(scene, margins, pose, reachable, step, origin):
        return False
    i, j, a, b = step
    if reachable.lengths[a, b] < UNREACHED:
        return True
    row, column, half = origin
    away = SPACING * math.sqrt(float((a - row) * (a - row) + (b - column) * (b - column)))
    return _may_enter(scene, margins, pose, (a - half, b - half), (i - half, j - half),
                      needed_gap(margins, away))


@compiled
def _may_drift(scene: Any, margins: Any, pose: Any, reachable: Any,
               step: tuple[int, int, int, int], origin: tuple[int, int, int]) -> bool:
    """
    Tell whether the robot is clear wherever the drift of its heading displaces it in a step.

    :param scene: ``Scene``.
    :param margins: ``RobotMargins``.
    :param pose: (x, y, theta) of the object.
    :param reachable: ``ReachableSet``, of which the moment at the end of the step is written.
    :param step: from a row and column of the grid to others.
    :param origin: row and column in which the path starts, and those of the object.
    """
    if margins.drift == 0.0:
        return True
    i, j, a, b = step
    row, column, half = origin
    length = SPACING if a == i or b == j else DIAGONAL * SPACING
    middle = 0.5 * length * SPACING
    moments = reachable.moments
    m_x = moments[i, j, 0] + middle * (b + j - 2 * column)
    m_y = moments[i, j, 1] + middle * (a + i - 2 * row)
    length += reachable.lengths[i, j]
    away_x, away_y = SPACING * (b - column), SPACING * (a - row)
    axis = margins.drift * (m_y - length * away_y), margins.drift * (length * away_x - m_x)
    rising = margins.slope * math.sqrt(away_x * away_x + away_y * away_y)
    other = math.sqrt(margins.position * margins.position + rising * rising)
    is_clear = _axis_is_clear(
        scene, pose[0] + SPACING * (b - half), pose[1] + SPACING * (a - half), axis, other)
    if is_clear:
        moments[a, b, 0], moments[a, b, 1] = m_x, m_y
    return is_clear


@compiled
def _axis_is_clear(scene: Any, x: float, y: float, axis: tuple[float, float],
                   other: float) -> bool:
    """
    Tell whether the robot is clear all along the long axis of the ellipse of its deviations.

    :param scene: ``Scene``.
    :param x: of the robot [m].
    :param y: of the robot [m].
    :param axis: half of it (x, y) [m].
    :param other: half of the other axis [m].
    """
    u, v = axis
    square = u * u + v * v
    if square < SPACING * SPACING:
        return True
    if clearance(scene.floor, x, y) >= scene.robot_radius + math.sqrt(square + other * other):
        return True
    for k in range(1, AXIS_STEPS + 1):
        part = k / AXIS_STEPS
        needed = scene.robot_radius + other * math.sqrt(1.0 - part * part)
        if (clearance(scene.floor, x + part * u, y + part * v) < needed
                or clearance(scene.floor, x - part * u, y - part * v) < needed):
            return False
    return True


@compiled
def _may_enter(scene: Any, margins: Any, pose: Any, point: tuple[int, int],
               before: tuple[int, int], needed: float) -> bool:
    """Tell whether the robot may come to a grid point (row, column) from the one before."""
    gap, away = _distances(scene, pose, point[0], point[1])
    if gap >= needed and away >= margins.object:
        return True
    if gap < 0.0 or away < 0.0:
        return False
    gap_before, away_before = _distances(scene, pose, before[0], before[1])
    return ((gap >= needed or gap > gap_before)
            and (away >= margins.object or away > away_before))


@compiled
def _distances(scene: Any, pose: Any, row: int, column: int) -> tuple[float, float]:
    """Find the distances of a robot at a grid point from obstacles and object [m]."""
    x, y = column * SPACING, row * SPACING
    gap = clearance(scene.floor, pose[0] + x, pose[1] + y) - scene.robot_radius
    # Beyond it the object is clear, wherever it points.
    beyond = math.sqrt(x * x + y * y) - scene.outer_radius - scene.robot_radius
    if beyond > 0.2:
        return gap, beyond
    c, s = math.cos(pose[2]), math.sin(pose[2])
    return gap, distance_to_object(scene, c * x + s * y, c * y - s * x) - scene.robot_radius
