"""What a map leaves of the chains of pushes: neither object nor robot meets an obstacle."""

import math

import numpy as np
from push_model.plan_request import PlanFailure
from push_navigation.obstacle import inflate
from push_planner.problem import PlanningFailed
from push_planner.sequence.kinematics import object_poses_along, SequenceMotions

MARGINS = (1.0, 0.5, 0.0)
ROUGH, FINE = 4, 8
# Of room that is lacking [s/m].
PRICE = 500.0


class ClearanceCheck:
    """
    A map with an object that is to go from start to goal in it.

    The object's margin is what start and goal allow, at most that of the settings.

    :param occupancy_map: ``push_navigation.occupancy_map.OccupancyMap``.
    :param obj: the ``PushedObject``.
    :param robot: the ``RoundRobot``.
    :param start: ``Pose`` of the object in the world.
    :param goal: ``Pose`` wanted for the object in the world.
    :param drive: ``DriveSettings``.
    :raises PlanningFailed: where start or goal is not free.
    """

    def __init__(self, occupancy_map, obj, robot, start, goal, drive):
        self.occupancy_map, self.obj, self.robot, self.start = occupancy_map, obj, robot, start
        self.robot_margin = drive.map_clearance
        for name, pose in (('object stands', start), ('goal is', goal)):
            if not occupancy_map.object_is_free(obj, [pose], 0.0):
                raise PlanningFailed(PlanFailure.NOT_FREE,
                                     f'the {name} at {pose.x:.2f} m, {pose.y:.2f} m, where the '
                                     'map has an obstacle or ends')
        self.margin = next(margin for margin in np.multiply(MARGINS, drive.map_clearance)
                           if occupancy_map.object_is_free(obj, [start, goal], margin))

    def excess(self, table):
        """
        Make what tells of many chains how much they lack room.

        :param table: ``push_planner.sequence.primitives.PrimitiveTable``.
        :return: function of (sites, ``SequenceMotions``, whether to look at the corners of the object
            too) to times that are added to those of the chains [s], shape (m,); 0 where they are
            free, infinite where the goal is not reached.
        """
        behind = np.array(table.places)[table.numbers, :2]
        radius, middle = self._circle()

        def excess(sites, chains, fine):
            lacking = np.full(len(sites), math.inf)
            some = np.isfinite(chains.ways).all(axis=1)
            chains = SequenceMotions(*(values[some] for values in chains))
            poses = self._in_map(object_poses_along(table, sites[some], chains, FINE if fine else ROUGH))
            robots = np.moveaxis(behind[sites[some]], -1, 0)[..., None]
            lacks = [self._lack(poses, *robots, self.robot.radius + self.robot_margin),
                     self._lack(poses, *middle, radius + self.margin)]
            if fine:
                lacks += [self._lack(poses, *corner, self.margin) for corner in self.obj.outline]
            lacking[some] = PRICE * np.sum(lacks, axis=0)
            return lacking

        return excess

    def is_free(self, object_poses, robot_poses):
        """
        Tell whether object and robot are free at all poses.

        :param object_poses: (x, y, theta) in the world, shape (n, 3).
        :param robot_poses: the same of the robot.
        """
        return (self.occupancy_map.object_is_free(self.obj, object_poses, self.margin)
                and self.occupancy_map.robot_is_free(self.robot, robot_poses, self.robot_margin))

    def fault(self, trajectory):
        """
        Tell what is wrong with a push; empty where nothing is.

        :param trajectory: ``PushTrajectory``.
        """
        free = self.is_free(trajectory.object_poses, trajectory.robot_poses)
        return '' if free else 'the push meets an obstacle or leaves the map'

    def steps_are_free(self, steps):
        """
        Tell whether a chain is free all along.

        :param steps: ``push_planner.sequence.steps.SequenceStep`` list.
        """
        for step in steps:
            robot = step.push.start.inverse() @ step.push.robot_start
            poses = step.object_poses(self.occupancy_map.resolution)
            if not self.is_free(poses, [pose @ robot for pose in poses]):
                return False
        return True

    def _in_map(self, poses):
        """Bring poses from the frame of the object as it stands into the cells of the map."""
        x, y, turn = np.moveaxis(poses, -1, 0)
        c, s = math.cos(self.start.theta), math.sin(self.start.theta)
        points = np.stack((self.start.x + c * x - s * y, self.start.y + s * x + c * y), axis=-1)
        x, y = self.occupancy_map.to_map(points.reshape(-1, 2)).T.reshape(2, *turn.shape)
        turn = turn + (self.start.theta - self.occupancy_map.origin.theta)
        return x, y, np.cos(turn), np.sin(turn)

    def _lack(self, poses, x, y, wanted):
        """How much too near to obstacles a point of the object, in its frame, comes [m]."""
        along, up, c, s = poses
        room = self.occupancy_map.clearance_in_map_frame(along + c * x - s * y, up + s * x + c * y)
        return np.maximum(wanted - room.min(axis=(1, 2)), 0.0)

    def _circle(self):
        """Radius and middle of a circle in the object."""
        if not self.obj.outline:
            return self.obj.radius, (0.0, 0.0)
        middle = np.array(self.obj.outline).mean(axis=0)
        return -float(inflate(self.obj.outline, 0.0, 0.0).distances([middle])[0]), tuple(middle)
