"""A single push: the behaviours of a task with one steered push."""

from typing import Any

from push_control.behaviors.behavior import Behavior, Stand
from push_control.behaviors.progress import ProgressMonitor
from push_control.behaviors.retreat import Retreat
from push_control.behaviors.single_push import PromptPlan, SinglePush
from push_control.goal import TaskGoal
from push_control.perception.raw_perception import RawPerception
from push_control.settings import ControlSettings
from push_control.steered.rehearsal import rehearsal_plan
from push_control.supervision_settings import SupervisionSettings
from push_control.task.behavior_factory import BehaviorFactory
from push_control.task.state_machine import SINGLE_PUSH_TABLE
from push_control.task.status import TaskState
from push_model.geometry import Pose
from push_model.observation import Observation
from push_model.parameters import PushedObject, RoundRobot
from push_model.signals import ObjectPose, Odometry, STOP
from push_model.trajectory import PushTrajectory
from push_navigation.settings import DriveSettings


class SinglePushBehaviors(BehaviorFactory):
    """Makes the behaviours of a task with one steered push."""

    table = SINGLE_PUSH_TABLE
    keeps_plan = True

    def __init__(self, obj: PushedObject, robot: RoundRobot, control: ControlSettings,
                 drive: DriveSettings, supervision: SupervisionSettings) -> None:
        """
        Start on open floor.

        :raises ValueError: where the object is not seen from everywhere.
        """
        if supervision.has_limited_view:
            raise ValueError(
                'supervision.view_angle, view_nearest, view_farthest: got a limited view, '
                'expected none: a single push needs poses all along, a task does not')
        super().__init__(obj, robot, control, drive, supervision)

    def new_perception(self, since: float) -> RawPerception:
        """
        Take measurements as they come: the controller of the push estimates by itself.

        :param since: not used.
        """
        return RawPerception(self._control)

    def create(self, state: TaskState, target: PushTrajectory | None, goal: TaskGoal | None,
               perception: RawPerception, progress: ProgressMonitor) -> Behavior[Any]:
        """
        Make the behaviour of a state.

        :param progress: not used.
        """
        context = self._context(self._obj)
        if state is TaskState.PLAN and goal is not None:
            return PromptPlan(context, goal)
        if state is TaskState.PUSH and target is not None:
            return SinglePush(context, target, None if goal is None else goal.pose)
        if state is TaskState.RETREAT:
            return Retreat(context, self._drive.retreat_distance)
        return Stand()

    def rehearse(self) -> None:
        """Start a straight push: that loads the steering law and the filter."""
        plan = rehearsal_plan(self._obj, self._robot)
        perception = self.new_perception(0.0)
        perception.update(Observation(
            0.0, Odometry(0.0, Pose(*plan.robot_poses[0].tolist()), STOP),
            ObjectPose(0.0, Pose(*plan.object_poses[0].tolist()))))
        SinglePush(self._context(self._obj), plan).step(perception, 0.0)
