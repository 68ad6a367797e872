"""
Shortest forward paths of bounded curvature, with unequal radii to the left and to the right.

After L. E. Dubins (1957); the construction by tangent circles works for unequal radii as well.
"""

import math
from typing import NamedTuple

from push_model.geometry import Pose

SIDES = {'L': 1.0, 'S': 0.0, 'R': -1.0}


class DubinsPath(NamedTuple):
    """
    A path of up to three arcs and straight lines.

    :param start: ``Pose`` at its beginning.
    :param word: its pieces in order, letters L, S, R.
    :param lengths: length of each piece [m].
    :param curvatures: signed curvature of each piece, positive to the left [1/m].
    """

    start: Pose
    word: str
    lengths: tuple
    curvatures: tuple

    @property
    def length(self):
        """Length of the whole path [m]."""
        return sum(self.lengths)

    def at(self, s):
        """
        Return the pose and curvature after a way; beyond the ends the path goes on straight.

        :param s: way from the start [m].
        :return: (``Pose`` with unwrapped angle, curvature [1/m]).
        """
        pose, left = self.start, s
        if s < 0.0:
            return advance_along_arc(pose, s, 0.0), 0.0
        for length, curvature in zip(self.lengths, self.curvatures):
            if left <= length:
                return advance_along_arc(pose, left, curvature), curvature
            pose, left = advance_along_arc(pose, length, curvature), left - length
        return advance_along_arc(pose, left, 0.0), 0.0


def advance_along_arc(pose, length, curvature):
    """
    Follow an arc.

    :param pose: ``Pose`` at its beginning.
    :param length: way along the arc [m], may be negative.
    :param curvature: signed curvature [1/m].
    :return: ``Pose`` at its end.
    """
    half = 0.5 * curvature * length
    chord = length * (math.sin(half) / half if abs(half) > 1e-9 else 1.0)
    return Pose(pose.x + chord * math.cos(pose.theta + half),
                pose.y + chord * math.sin(pose.theta + half), pose.theta + 2.0 * half)


def dubins_paths(start, goal, radius_left, radius_right):
    """
    Find every Dubins path between two poses, shortest first.

    :param start: ``Pose`` at the beginning.
    :param goal: ``Pose`` at the end.
    :param radius_left: radius of left turns [m], above 0.
    :param radius_right: radius of right turns [m], above 0.
    :return: list of ``DubinsPath``; LSL and RSR always exist.
    :raises ValueError: where a radius is not above 0 and finite.
    """
    radii = {'L': radius_left, 'R': radius_right}
    for side, radius in radii.items():
        if not 0.0 < radius < math.inf:
            raise ValueError(f'radius {side}: got {radius!r}, expected a finite one above 0 [m]')
    found = []
    for word in ('LSL', 'RSR', 'LSR', 'RSL', 'LRL', 'RLR'):
        solve = _curve_line_curve if word[1] == 'S' else _three_curves
        for lengths in solve(start, goal, word, radii):
            curvatures = tuple(SIDES[c] / radii.get(c, 1.0) for c in word)
            found.append(DubinsPath(Pose(*start), word, lengths, curvatures))
    return sorted(found, key=lambda path: path.length)


def _center(pose, side, radii):
    offset = SIDES[side] * radii[side]
    return pose[0] - offset * math.sin(pose[2]), pose[1] + offset * math.cos(pose[2])


def _arc(side, begin, end, radii):
    turn = (SIDES[side] * (end - begin)) % (2.0 * math.pi)
    return 0.0 if 2.0 * math.pi - turn < 1e-9 else turn * radii[side]


def _curve_line_curve(start, goal, word, radii):
    first, last = word[0], word[2]
    x0, y0 = _center(start, first, radii)
    x1, y1 = _center(goal, last, radii)
    between, bearing = math.hypot(x1 - x0, y1 - y0), math.atan2(y1 - y0, x1 - x0)
    cross = SIDES[first] * radii[first] - SIDES[last] * radii[last]
    if between < abs(cross):
        return []
    heading = bearing + (math.asin(cross / between) if between > 0.0 else 0.0)
    if between == 0.0:
        heading = start[2]
    line = math.sqrt(between * between - cross * cross)
    return [(_arc(first, start[2], heading, radii), line, _arc(last, heading, goal[2], radii))]


def _three_curves(start, goal, word, radii):
    outer, inner = word[0], word[1]
    x0, y0 = _center(start, outer, radii)
    x1, y1 = _center(goal, outer, radii)
    between, bearing = math.hypot(x1 - x0, y1 - y0), math.atan2(y1 - y0, x1 - x0)
    reach = radii['L'] + radii['R']
    if between > 2.0 * reach or between < 1e-12:
        return []
    opening = math.acos(0.5 * between / reach)
    found = []
    for sign in (1.0, -1.0):
        quarter = SIDES[outer] * 0.5 * math.pi
        leave = bearing + sign * opening + quarter
        join = bearing + math.pi - sign * opening + quarter
        found.append((_arc(outer, start[2], leave, radii), _arc(inner, leave, join, radii),
                      _arc(outer, join, goal[2], radii)))
    return found
