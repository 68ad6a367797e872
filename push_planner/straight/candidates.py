"""
Straight pushes to choose from: the seam for a planner of one's own.

A task asks a ``PushPlanner`` for its next push. One that chooses among straight pushes has to know
which there are and what they do to the object, and to lay out the one it has chosen.
"""

import dataclasses

import numpy as np
from push_model.geometry import FloatArray, Pose
from push_model.parameters import RoundRobot
from push_model.plan_request import PlanFailure, PlanRequest
from push_navigation.occupancy_map import OccupancyMap
from push_navigation.settings import DriveSettings
from push_planner.problem import PlanningFailed
from push_planner.settings import PlannerSettings
from push_planner.straight.planner import (
    ApproachPaths, checked_request, friction_belief, lay_out, primitives_for,
)
from push_planner.straight.trajectory import greatest_speed
from push_planner.task_plan import TaskPlan
from push_primitives.selection import interpolate_displacements, SelectedPush
from push_primitives.store import PushPrimitives
from push_primitives.weights import sample_weights


@dataclasses.dataclass(frozen=True, eq=False)
class StraightPushes:
    """
    Straight pushes that an object may get now.

    :param starts: centre of the robot at the first contact and direction of motion (x, y, phi) in
        the object frame, shape (n, 3) [m, rad].
    :param curvatures: of the robot's path from there on, left positive, shape (n,) [1/m].
    :param lengths: driven lengths of the table, increasing from 0, shape (L,) [m].
    :param object_poses: expected pose (x, y, theta) of the object in the world after each push of
        each length, angle unwrapped, shape (n, L, 3) [m, rad].
    """

    starts: FloatArray
    curvatures: FloatArray
    lengths: FloatArray
    object_poses: FloatArray
    _request: PlanRequest
    _robot: RoundRobot
    _settings: PlannerSettings
    _primitives: PushPrimitives
    _weights: FloatArray
    _paths: ApproachPaths

    def plan(self, index: int, length: float) -> TaskPlan:
        """
        Plan a push, and the path to its start.

        :param index: of the push, as in ``starts``.
        :param length: driven length from the first contact, also between those of the table [m].
        :raises PlanningFailed: where the robot finds no path to the start.
        :raises ValueError: where there is no such push.
        """
        self._check(index, length)
        primitives, speed = self._primitives, greatest_speed(self._robot, self._settings)
        start = Pose(*self.starts[index].tolist())
        travel_time = self._paths.travel_time(start)
        if np.isinf(travel_time):
            raise PlanningFailed(PlanFailure.NO_FEASIBLE_SITE, self._paths.reason)
        means = np.einsum('k,klc->lc', self._weights, primitives.table.displacements[index])
        end = self._request.object_pose @ Pose(*interpolate_displacements(
            self.lengths, means, length).tolist())
        remaining = primitives.cost_to_go.at(end.inverse() @ self._request.goal,
                                             int(primitives.table.faces[index]))
        push_time = length / speed + primitives.settings.push_time
        selected = SelectedPush(index, length, self._weights, travel_time, remaining,
                                travel_time + push_time + remaining)
        return TaskPlan(*lay_out(self._request, self._robot, self._settings, primitives, selected,
                                 path=self._paths.to(start)))

    def _check(self, index: int, length: float) -> None:
        if not 0 <= index < len(self.starts):
            raise ValueError(f'index: got {index!r}, expected from 0 to {len(self.starts) - 1}')
        if not 0.0 < length <= self.lengths[-1]:
            raise ValueError(f'length: got {length!r}, expected above 0, at most '
                             f'{self.lengths[-1]:g} [m]')


def straight_pushes(request: PlanRequest, robot: RoundRobot, settings: PlannerSettings,
                    drive: DriveSettings,
                    occupancy_map: OccupancyMap | None = None) -> StraightPushes:
    """
    List the straight pushes that an object may get; the first call for an object makes its table.

    :param request: ``PlanRequest``, with what has been learned of the object.
    :param occupancy_map: ``OccupancyMap`` that the robot's path keeps to; what the object meets is
        for the caller to check.
    :raises PlanningFailed: where the object gets none.
    """
    request = checked_request(request, robot)
    primitives = primitives_for(request, robot, drive)
    table = primitives.table
    weights = sample_weights(table.friction_samples, friction_belief(request))
    local = np.einsum('k,nklc->nlc', weights, table.displacements)
    pose = request.object_pose
    c, s = np.cos(pose.theta), np.sin(pose.theta)
    object_poses = np.stack([pose.x + c * local[..., 0] - s * local[..., 1],
                             pose.y + s * local[..., 0] + c * local[..., 1],
                             pose.theta + local[..., 2]], axis=-1)
    return StraightPushes(table.starts, table.curvatures, table.lengths, object_poses, request,
                          robot, settings, primitives, weights,
                          ApproachPaths(request, robot, settings, drive, occupancy_map))
