"""
Paths of the flat point z, in the frame of the z-goal.

Anchored there, a path keeps its end where the object's goal is, whatever the friction centre
turns out to be.
"""

import math

import numpy as np
from push_model.dubins import advance_along_arc, dubins_paths
from push_model.geometry import Pose, wrap_angle

SPACING = 0.02
LONGEST_RADIUS = 20.0


def flat_output_pose(flat):
    """
    Pose of the frame of z in the object frame: at z, along the direction from C to F.

    :param flat: the ``Vehicle``.
    """
    return Pose(*flat.flat_output, flat.angle)


class SampledPath:
    """The planned path, from the samples of a trajectory."""

    def __init__(self, flat, trajectory):
        """
        Take the path from a trajectory.

        :param flat: the ``Vehicle`` as believed.
        :param trajectory: the ``PushTrajectory``.
        :raises ValueError: where z does not move.
        """
        poses = _flat_poses(flat, trajectory)
        ways, fine = _refined(poses)
        if ways[-1] < SPACING:
            raise ValueError(f'trajectory: got a path of {ways[-1]:.3f} m of the flat point, '
                             f'expected at least {SPACING} m')
        count = max(3, math.ceil(ways[-1] / SPACING) + 1)
        even = np.linspace(0.0, ways[-1], count)
        columns = [np.interp(even, ways, column) for column in fine]
        curvature = np.gradient(columns[2], even)
        self._rows = list(zip(*(column.tolist() for column in columns), curvature.tolist()))
        self._even, self._curvature = even, curvature
        self._spacing = float(even[1])
        self.length = float(ways[-1])

    def at(self, s):
        """
        Return pose and curvature after a way; straight on beyond the ends.

        :param s: way from the start [m].
        :return: (``Pose`` in the frame of the z-goal, curvature [1/m]).
        """
        if s <= 0.0 or s >= self.length:
            *pose, curvature = self._rows[0 if s <= 0.0 else -1]
            beyond = s if s <= 0.0 else s - self.length
            return advance_along_arc(Pose(*pose), beyond, 0.0), curvature
        index = min(int(s / self._spacing), len(self._rows) - 2)
        share = s / self._spacing - index
        row = [a + share * (b - a) for a, b in zip(self._rows[index], self._rows[index + 1])]
        return Pose(*row[:3]), row[3]

    def curvatures(self, ways):
        """
        Return curvatures after ways; 0 beyond the ends.

        :param ways: from the start [m], shape (n,).
        :return: curvatures [1/m], shape (n,).
        """
        return np.interp(ways, self._even, self._curvature, 0.0, 0.0)


class FinalStraightPath:
    """A Dubins path that ends in a straight run to the z-goal."""

    def __init__(self, dubins, final_straight):
        """
        Append the straight run.

        :param dubins: ``DubinsPath`` to the beginning of the run.
        :param final_straight: length of the run [m].
        """
        self._dubins = dubins
        self.length = dubins.length + final_straight
        self._ends = np.cumsum((0.0, *dubins.lengths))
        self._pieces = np.array((0.0, *dubins.curvatures, 0.0))

    def at(self, s):
        """
        Return pose and curvature after a way; straight on beyond the ends.

        :param s: way from the start [m].
        :return: (``Pose`` in the frame of the z-goal, curvature [1/m]).
        """
        return self._dubins.at(s)

    def curvatures(self, ways):
        """
        Return curvatures after ways; 0 beyond the ends.

        :param ways: from the start [m], shape (n,).
        :return: curvatures [1/m], shape (n,).
        """
        return self._pieces[np.searchsorted(self._ends, ways)]


def path_to_goal(start, limits, final_straight):
    """
    Find the shortest path to the z-goal.

    :param start: ``Pose`` of z in the frame of the z-goal.
    :param limits: (lowest, highest) curvature, on either side of 0 [1/m].
    :param final_straight: length of the straight end [m].
    :return: ``FinalStraightPath``.
    """
    left = min(LONGEST_RADIUS, 1.0 / max(limits[1], 1e-9))
    right = min(LONGEST_RADIUS, 1.0 / max(-limits[0], 1e-9))
    return FinalStraightPath(dubins_paths(start, Pose(-final_straight, 0.0, 0.0), left, right)[0], final_straight)


def project_on_path(path, pose, s):
    """
    Find a pose's place on a path, near a given place.

    :param path: the path.
    :param pose: ``Pose`` in the frame of the z-goal.
    :param s: way at which to begin [m].
    :return: way [m], lateral error (left of the path is positive) [m], heading error [rad],
        curvature of the path there [1/m].
    """
    for _ in range(3):
        on, curvature = path.at(s)
        cosine, sine = math.cos(on.theta), math.sin(on.theta)
        off_x, off_y = pose.x - on.x, pose.y - on.y
        ahead, aside = cosine * off_x + sine * off_y, cosine * off_y - sine * off_x
        s += min(0.2, max(-0.2, ahead / max(0.5, 1.0 - curvature * aside)))
    on, curvature = path.at(s)
    aside = math.cos(on.theta) * (pose.y - on.y) - math.sin(on.theta) * (pose.x - on.x)
    return s, aside, wrap_angle(pose.theta - on.theta), curvature


def _flat_poses(flat, trajectory):
    """Return z (x, y, psi) for each sample in the frame of the last, shape (3, n)."""
    local = flat_output_pose(flat)
    rows = [Pose(*pose) @ local for pose in trajectory.object_poses.tolist()]
    home = rows[-1].inverse()
    rows = np.array([home @ row for row in rows]).T
    rows[2] = np.unwrap(rows[2])
    return rows


def _refined(poses):
    """Fill the gaps between samples by arcs through them; return way and (x, y, psi)."""
    x, y, psi = poses
    fine, ways = [[x[0]], [y[0]], [psi[0]]], [0.0]
    for i in range(len(x) - 1):
        chord, turn = math.hypot(x[i + 1] - x[i], y[i + 1] - y[i]), psi[i + 1] - psi[i]
        if chord == 0.0:
            continue
        bearing = math.atan2(y[i + 1] - y[i], x[i + 1] - x[i])
        length = chord / max(0.1, math.sin(0.5 * turn) / (0.5 * turn) if turn else 1.0)
        start = Pose(x[i], y[i], bearing - 0.5 * turn)
        count = max(1, math.ceil(length / SPACING))
        for k in range(1, count + 1):
            point = advance_along_arc(start, length * k / count, turn / length)
            for column, value in zip(fine, (*point[:2], psi[i] + turn * k / count)):
                column.append(value)
            ways.append(ways[-1] + length / count)
    return np.array(ways), [np.array(column) for column in fine]
