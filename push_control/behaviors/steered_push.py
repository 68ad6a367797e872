"""One steered push of a task, along a plan whose contact is held."""

from typing import Any, Callable, TYPE_CHECKING

import numpy as np
from push_control.behaviors.behavior import Behavior, BehaviorContext, MeasurementNeed
from push_control.behaviors.failures import BehaviorFailure, FailureReport
from push_control.behaviors.obstacle_guard import blocks_push
from push_control.perception.raw_perception import RawPerception
from push_control.steered.controller import Controller
from push_control.steered.status import ControllerStatus, Phase
from push_model.events import EventReport, UNBELIEVED_POSES
from push_model.geometry import Pose
from push_model.signals import STOP, Twist
from push_model.trajectory import PushTrajectory
from push_navigation.occupancy_map import OccupancyMap

if TYPE_CHECKING:  # A single push does without: it takes a while to import.
    from push_control.perception.perception import TaskPerception

# Standard deviation of the gap at the end of a push, in which the robot is in contact [m]; chosen.
GAP_STD = 0.005
# Clearance in a map that neither robot nor object may lack where the plan does not [m]; chosen:
# half of the clearance of plans, and none at all.
GUARDED_CLEARANCES = (0.025, 0.0)
# Standard deviation that a failed push adds to the robot's position [m]; chosen.
FAILED_PUSH_STD = 0.03
# Rejected poses up to which a failed push is evaluated; where more were rejected the object was
# carried off, which tells nothing of the robot. Chosen.
MAX_REJECTED_POSES = 1


class SteeredPush(Behavior['TaskPerception']):
    """Pushes along a plan."""

    # Its controller waits by itself.
    measurement_need = MeasurementNeed.NONE

    def __init__(self, context: BehaviorContext, target: PushTrajectory) -> None:
        """
        Start.

        :param context: the ``BehaviorContext``; its ``control`` with the present uncertainty.
        """
        super().__init__()
        self._context = context
        self._target = target
        self._controller = Controller(context.obj, context.robot, context.control)
        # That of all steps; None before the first.
        self._perception: RawPerception | None = None

    @property
    def push_cause(self) -> EventReport | None:
        """``EventReport`` of what is out of the ordinary, as the controller has it, or None."""
        return self._controller.event

    @property
    def push_status(self) -> ControllerStatus:
        """The ``ControllerStatus``."""
        return self._controller.status

    def is_blocked(self, occupancy_map: OccupancyMap | None, pose: Pose) -> bool:
        """Tell whether a new map, unlike the previous one, has an obstacle in the way."""
        context = self._context
        return blocks_push(self._target, context.obj, context.robot, context.occupancy_map,
                           occupancy_map, pose)

    def pause(self) -> None:
        """Let the controller stand; it goes on from where object and robot are then."""
        if self._perception is not None:
            self._controller.pause(self._perception.observation)

    def step(self, perception: 'TaskPerception', dt: float) -> Twist:
        """Compute the command; evaluate the push at its end."""
        self._perception = perception
        command = self._controller.step(self._target, perception.observation, dt)
        status = self._controller.status
        self.finished = status.phase is Phase.DONE
        # In a task the robot backs off, and the object is looked for where it is then.
        if status.phase is Phase.FAILED or status.event in UNBELIEVED_POSES:
            self.failure = self._controller.event
        else:
            self.failure = (self._path_deviation(perception.object_pose.pose)
                            or self._near_obstacle(status))
        has_estimate = self._context.control.control_law != 'open_loop'
        if (self.finished or self.failure is not None) and has_estimate and status.in_contact:
            self._evaluate(perception, status)
        return command if self.failure is None else STOP

    def _path_deviation(self, pose: Pose) -> FailureReport | None:
        path = self._target.object_poses[:, :2]
        deviation = float(np.hypot(*(path - (pose.x, pose.y)).T).min())
        # False for a pose that is not finite: the controller waits for a better one.
        if deviation > self._context.supervision.max_path_deviation:
            return BehaviorFailure.OFF_PLANNED_PATH.report(distance=deviation)
        return None

    def _near_obstacle(self, status: ControllerStatus) -> FailureReport | None:
        """Name the body that is nearer to an obstacle than allowed, and than planned."""
        occupancy_map, target = self._context.occupancy_map, self._target
        if occupancy_map is None or status.phase is not Phase.PUSHING:
            return None
        path = target.object_poses[:, :2] - status.object_pose[:2]
        nearest = int(np.hypot(*path.T).argmin())
        if _loses_clearance(occupancy_map.object_is_free, self._context.obj,
                            status.object_pose, Pose(*target.object_poses[nearest])):
            return BehaviorFailure.OBJECT_NEARS_OBSTACLE.report()
        if _loses_clearance(occupancy_map.robot_is_free, self._context.robot,
                            status.robot_pose, Pose(*target.robot_poses[nearest])):
            return BehaviorFailure.ROBOT_NEARS_OBSTACLE.report()
        return None

    def _evaluate(self, perception: 'TaskPerception', status: ControllerStatus) -> None:
        """Note whether the contact held, as the ensemble expects of a contact that does."""
        was_steady = (status.slips + status.contact_losses == 0
                      and status.rejected_poses <= MAX_REJECTED_POSES)
        if self.finished or was_steady:
            perception.on_push_succeeded()
            return
        perception.localization.inflate_covariance(FAILED_PUSH_STD)
        perception.correct_overlap(self._context.obj, self._context.robot, GAP_STD)


def _loses_clearance(is_free: Callable[..., bool], body: Any, pose: Pose, planned: Pose) -> bool:
    """Tell whether a body lacks a clearance at its pose that it has where the plan puts it."""
    return any(not is_free(body, [pose], clearance) and is_free(body, [planned], clearance)
               for clearance in GUARDED_CLEARANCES)
