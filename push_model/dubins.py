"""
Dubins paths: shortest forward paths of bounded curvature, with unequal radii to either side.

After L. E. Dubins, On curves of minimal length with a constraint on average curvature (1957). A
path is a word of three letters: L and R are arcs at the tightest radius to the left and to the
right, S is a straight line. The construction by tangent circles works for unequal radii as well.
"""

from collections.abc import Iterator, Mapping
import math
from typing import NamedTuple

from push_model.geometry import Coordinates, Pose

SIDES = {'L': 1.0, 'S': 0.0, 'R': -1.0}
WORDS = ('LSL', 'RSR', 'LSR', 'RSL', 'LRL', 'RLR')
# Distance of two centres that are apart by rounding only [m]; chosen: maps are kilometres wide at
# most, in which coordinates are rounded to 1e-12 m.
SAME_CENTER = 1e-9
# Lengths of the three segments of a path [m].
Lengths = tuple[float, float, float]


class DubinsPath(NamedTuple):
    """
    A path of up to three arcs and straight lines.

    :param start: ``Pose`` at its beginning.
    :param word: its segments in order, letters L, S, R.
    :param lengths: length of each segment [m].
    :param curvatures: signed curvature of each segment, positive to the left [1/m].
    """

    start: Pose
    word: str
    lengths: tuple[float, ...]
    curvatures: tuple[float, ...]

    @property
    def length(self) -> float:
        """Length of the whole path [m]."""
        return sum(self.lengths)

    def at(self, s: float) -> tuple[Pose, float]:
        """
        Return pose and curvature at an arc length; beyond the ends the path goes on straight.

        :param s: arc length from the start [m].
        :return: (``Pose`` with unwrapped angle, curvature [1/m]).
        """
        pose, remaining = self.start, s
        if s < 0.0:
            return advance_along_arc(pose, s, 0.0), 0.0
        for length, curvature in zip(self.lengths, self.curvatures):
            if remaining <= length:
                return advance_along_arc(pose, remaining, curvature), curvature
            pose, remaining = advance_along_arc(pose, length, curvature), remaining - length
        return advance_along_arc(pose, remaining, 0.0), 0.0


def advance_along_arc(pose: Pose, length: float, curvature: float) -> Pose:
    """
    Follow an arc from a pose.

    :param pose: ``Pose`` at its beginning.
    :param length: arc length [m], may be negative.
    :param curvature: signed curvature [1/m].
    :return: ``Pose`` at its end.
    """
    half = 0.5 * curvature * length
    chord = length * (math.sin(half) / half if abs(half) > 1e-9 else 1.0)
    return Pose(pose.x + chord * math.cos(pose.theta + half),
                pose.y + chord * math.sin(pose.theta + half), pose.theta + 2.0 * half)


def shortest_length(start: Coordinates, goal: Coordinates, radius_left: float,
                    radius_right: float, costs: Mapping[str, float]) -> float:
    """
    Find the least length of all Dubins paths, whose segments may count differently.

    :param start: ``Pose`` at the beginning.
    :param goal: ``Pose`` at the end.
    :param radius_left: radius of arcs to the left [m], above 0.
    :param radius_right: radius of arcs to the right [m], above 0.
    :param costs: factor on the lengths of the segments by their letters L, S, R.
    :return: the sum [m].
    :raises ValueError: where a radius is not above 0 and finite.
    """
    return min(costs[word[0]] * first + costs[word[1]] * middle + costs[word[2]] * last
               for word, (first, middle, last) in _words(
                   start, goal, _radii(radius_left, radius_right)))


def dubins_paths(start: Coordinates, goal: Coordinates, radius_left: float,
                 radius_right: float) -> list[DubinsPath]:
    """
    Find every Dubins path between two poses, shortest first.

    :param start: ``Pose`` at the beginning.
    :param goal: ``Pose`` at the end.
    :param radius_left: radius of arcs to the left [m], above 0.
    :param radius_right: radius of arcs to the right [m], above 0.
    :return: list of ``DubinsPath``; LSL and RSR always exist.
    :raises ValueError: where a radius is not above 0 and finite.
    """
    radii = _radii(radius_left, radius_right)
    curvatures = {side: sign / radii.get(side, 1.0) for side, sign in SIDES.items()}
    start = Pose(*start)
    paths = [DubinsPath(start, word, lengths, tuple(curvatures[side] for side in word))
             for word, lengths in _words(start, goal, radii)]
    return sorted(paths, key=lambda path: path.length)


def _radii(left: float, right: float) -> dict[str, float]:
    """Name the radii by their sides."""
    radii = {'L': left, 'R': right}
    for side, radius in radii.items():
        if not 0.0 < radius < math.inf:
            raise ValueError(f'radius {side}: got {radius!r}, expected a finite one above 0 [m]')
    return radii


def _words(start: Coordinates, goal: Coordinates,
           radii: dict[str, float]) -> Iterator[tuple[str, Lengths]]:
    """Find the lengths of the segments of every word that leads to the goal."""
    first, last = ({side: _circle_center(pose, side, radii) for side in radii}
                   for pose in (start, goal))
    for word in WORDS:
        solve = _arc_line_arc if word[1] == 'S' else _three_arcs
        x, y = first[word[0]]
        to_x, to_y = last[word[2]]
        headings = start[2], goal[2]
        for lengths in solve(headings, (to_x - x, to_y - y), word, radii):
            yield word, lengths


def _circle_center(pose: Coordinates, side: str, radii: dict[str, float]) -> tuple[float, float]:
    """Centre of the circle on which the path leaves or reaches a pose."""
    offset = SIDES[side] * radii[side]
    return pose[0] - offset * math.sin(pose[2]), pose[1] + offset * math.cos(pose[2])


def _arc_length(side: str, start: float, end: float, radii: dict[str, float]) -> float:
    """Length of the arc between two headings; a full circle by rounding counts as none."""
    angle = (SIDES[side] * (end - start)) % (2.0 * math.pi)
    return 0.0 if 2.0 * math.pi - angle < 1e-9 else angle * radii[side]


def _arc_line_arc(headings: tuple[float, float], apart: tuple[float, float], word: str,
                  radii: dict[str, float]) -> list[Lengths]:
    """Path along the common tangent of the circles at start and goal, if they have one."""
    first, last = word[0], word[2]
    start, end = headings
    between, bearing = math.hypot(*apart), math.atan2(apart[1], apart[0])
    cross = SIDES[first] * radii[first] - SIDES[last] * radii[last]
    if between < abs(cross):
        return []
    heading = bearing + (math.asin(cross / between) if between > 0.0 else 0.0)
    if between < SAME_CENTER:
        # The bearing from one to the other says nothing; to follow it would take a full circle.
        heading = start
    line = math.sqrt(between * between - cross * cross)
    return [(_arc_length(first, start, heading, radii), line,
             _arc_length(last, heading, end, radii))]


def _three_arcs(headings: tuple[float, float], apart: tuple[float, float], word: str,
                radii: dict[str, float]) -> list[Lengths]:
    """Paths over a middle circle that touches those at start and goal, on either side of both."""
    outer, inner = word[0], word[1]
    start, end = headings
    between, bearing = math.hypot(*apart), math.atan2(apart[1], apart[0])
    side_length = radii['L'] + radii['R']
    if between > 2.0 * side_length or between < 1e-12:
        return []
    # The three centres make an isosceles triangle; this is the angle at its base.
    base_angle = math.acos(0.5 * between / side_length)
    lengths: list[Lengths] = []
    for sign in (1.0, -1.0):
        quarter = SIDES[outer] * 0.5 * math.pi
        leave = bearing + sign * base_angle + quarter
        join = bearing + math.pi - sign * base_angle + quarter
        lengths.append((_arc_length(outer, start, leave, radii),
                        _arc_length(inner, leave, join, radii),
                        _arc_length(outer, join, end, radii)))
    return lengths
