"""What a map leaves of the chains of pushes: neither object nor robot meets an obstacle."""

import math

import numpy as np
from push_drive.inflated import inflated
from push_planner.chain_algebra import corners
from push_planner.problem import PlanningFailed

MARGINS = (1.0, 0.5, 0.0)


class Room:
    """
    A map with an object that is to go from start to goal in it.

    The object's margin is what start and goal allow, at most that of the settings.

    :param workspace: ``push_drive.workspace.Workspace``.
    :param obj: the ``PushedObject``.
    :param robot: the ``RoundRobot``.
    :param start: ``Pose`` of the object in the world.
    :param goal: ``Pose`` wanted for the object in the world.
    :param drive: ``DriveSettings``.
    :raises PlanningFailed: where start or goal is not free.
    """

    def __init__(self, workspace, obj, robot, start, goal, drive):
        self.workspace, self.obj, self.robot, self.start = workspace, obj, robot, start
        self.robot_margin = drive.map_clearance
        for name, pose in (('object stands', start), ('goal is', goal)):
            if not workspace.object_is_free(obj, [pose], 0.0):
                raise PlanningFailed(f'the {name} at {pose.x:.2f} m, {pose.y:.2f} m, where the '
                                     'map has an obstacle or ends')
        self.margin = next(margin for margin in np.multiply(MARGINS, drive.map_clearance)
                           if workspace.object_is_free(obj, [start, goal], margin))

    def filter(self, table, inner):
        """
        Make a quick test for many chains, of the corners of their ways only.

        :param table: ``push_planner.elements.Table``.
        :param inner: whether to count the circle inside the object, which all that is free passes,
            rather than the one round it.
        :return: function of (sites, ``Weighed``) to flags, shape (m,).
        """
        radius, (x, y) = self._circle(inner)
        behind = np.array(table.places)[table.numbers, :2]

        def free(sites, chains):
            flags = np.isfinite(chains.ways).all(axis=1)
            poses = corners(table, sites[flags], chains.turns[flags], chains.before[flags],
                            chains.after[flags])
            # The last corner is the goal, which is free.
            within = self._clearance(poses[:, :-1], x, y) >= radius + self.margin
            robots = np.repeat(behind[sites[flags]], 3, axis=1)
            clear = self._clearance(poses, robots[..., 0], robots[..., 1])
            flags[flags] = within.all(axis=1) & (
                clear >= self.robot.radius + self.robot_margin).all(axis=1)
            return flags

        return free

    def holds(self, object_poses, robot_poses):
        """
        Tell whether object and robot are free at all poses.

        :param object_poses: (x, y, theta) in the world, shape (n, 3).
        :param robot_poses: the same of the robot.
        """
        return (self.workspace.object_is_free(self.obj, object_poses, self.margin)
                and self.workspace.robot_is_free(self.robot, robot_poses, self.robot_margin))

    def holds_steps(self, steps):
        """
        Tell whether a chain is free all along.

        :param steps: ``push_planner.pushes.Step`` list.
        """
        for step in steps:
            robot = step.push.start.inverse() @ step.push.robot_start
            poses = step.object_poses(self.workspace.resolution)
            if not self.holds(poses, [pose @ robot for pose in poses]):
                return False
        return True

    def _clearance(self, poses, x, y):
        """Clearance of points of the object, given in its frame, at poses in its start frame."""
        c, s = np.cos(poses[..., 2]), np.sin(poses[..., 2])
        points = np.stack((poses[..., 0] + c * x - s * y, poses[..., 1] + s * x + c * y), axis=-1)
        c, s = math.cos(self.start.theta), math.sin(self.start.theta)
        points = points.reshape(-1, 2) @ np.array([[c, s], [-s, c]]) + self.start[:2]
        return self.workspace.clearance(points).reshape(poses.shape[:-1])

    def _circle(self, inner):
        """Radius and middle of a circle in the object, or of one round it."""
        if not self.obj.outline:
            return self.obj.radius, (0.0, 0.0)
        outline = np.array(self.obj.outline)
        middle = outline.mean(axis=0)
        if not inner:
            return float(np.linalg.norm(outline - middle, axis=1).max()), tuple(middle)
        return -float(inflated(self.obj.outline, 0.0, 0.0).distances([middle])[0]), tuple(middle)
