"""Behaviours of a task: which one acts in which state, and how it is set up."""

import dataclasses
import math

from push_control.push.rollout_law import warm_up
from push_control.push.start import contact_start_point
from push_control.settings import ControlSettings
from push_control.task.approach import Approach, MovingApproach
from push_control.task.behavior import Behavior, BehaviorContext
from push_control.task.guarded_approach import GuardedApproach
from push_control.task.inspection import Inspection
from push_control.task.perception import TaskPerception
from push_control.task.primitive_push import PrimitivePush
from push_control.task.push import SupervisedPush
from push_control.task.retreat import Retreat
from push_control.task.settings import aimed_tolerances, SupervisionSettings
from push_control.task.status import TaskState
from push_model.friction import friction_center
from push_model.geometry import distance, Pose
from push_model.parameters import PushedObject, RoundRobot
from push_model.trajectory import PushStyle, PushTrajectory
from push_navigation.occupancy_map import OccupancyMap
from push_navigation.settings import DriveSettings
from push_primitives.cost_settings import CostSettings
from push_primitives.store import load_primitives, PushPrimitives
from push_primitives.weights import FrictionBelief

# Standard deviations below which no push knows the centre of friction, over its distance from the
# contact, and the push direction [rad]; chosen: the floor is not the same everywhere.
CENTER_STD_RATIO = 0.03
PUSH_DIRECTION_STD = 0.02
# Gains as for convergence within a distance shorter by this factor, and the least fraction of the
# friction cone that feedback may use; chosen: pushes of a task are short and may fail.
GAIN_FACTOR = 1.5
FEEDBACK_CONE_FRACTION = 0.9
# Standard deviation of the gap of a robot whose pose overlaps the object [m]; chosen: the noise of
# one object pose.
OVERLAP_STD = 0.002
# Length of the retreat after an unsteered push [m]; chosen: what the robot covers while the object
# is measured, and more than the clearance that a path around the object needs at least.
SHORT_RETREAT = 0.06
# Tolerance that every push keeps [m, rad].
ANY_ERROR = 1.0


class BehaviorFactory:
    """
    Makes the behaviour of each state.

    ``occupancy_map``: the ``OccupancyMap``, or None on open floor.
    """

    def __init__(self, obj: PushedObject, robot: RoundRobot, control: ControlSettings,
                 drive: DriveSettings, supervision: SupervisionSettings) -> None:
        """
        Start with the nominal object on open floor.

        :param obj: the nominal ``PushedObject``.
        :param robot: the ``RoundRobot``.
        :param control: ``ControlSettings``, which are adapted to pushes of a task.
        :param drive: ``DriveSettings``.
        :param supervision: ``SupervisionSettings``.
        """
        self._obj = obj
        self._robot = robot
        self._prepared: PushPrimitives | None = None
        self.set_settings(control, drive, supervision)
        self.occupancy_map: OccupancyMap | None = None

    def set_settings(self, control: ControlSettings, drive: DriveSettings,
                     supervision: SupervisionSettings) -> None:
        """
        Set the settings of the behaviours that are made from now on.

        :param control: ``ControlSettings``, which are adapted to pushes of a task.
        :param drive: ``DriveSettings``.
        :param supervision: ``SupervisionSettings``.
        """
        self._control = _for_task(control)
        self._drive = drive
        self._supervision = supervision

    def create(self, state: TaskState, target: PushTrajectory | None, goal: Pose | None,
               perception: TaskPerception) -> Behavior | None:
        """
        Make the behaviour of a state.

        :param state: the ``TaskState``.
        :param target: the ``PushTrajectory``, or None.
        :param goal: goal ``Pose`` of the object, or None.
        :param perception: ``TaskPerception`` of robot and object.
        :return: ``Behavior``, or None where the robot stands.
        """
        context = BehaviorContext(
            perception.localization.obj, self._robot, self._control, self._drive,
            self._supervision, self.occupancy_map)
        if state is TaskState.RETREAT:
            if target is not None and target.style.is_unsteered:
                return Retreat(context, min(self._drive.retreat_distance, SHORT_RETREAT),
                               self._drive.speed)
            return Retreat(context, self._drive.retreat_distance)
        if target is None:
            return None
        is_unsteered = target.style.is_unsteered
        if state is TaskState.APPROACH and is_unsteered:
            # Now, while the robot stands: at the first time and after a change of settings it may
            # take long. The push that follows without a stop has the same.
            self._prepared = self._load_primitives(perception)
            warm_up(self._prepared, perception.localization)
            return MovingApproach(context, target)
        if state is TaskState.APPROACH:
            return Approach(context, target)
        if state is TaskState.ALIGN:
            return GuardedApproach(context, target, perception.object_at_rest)
        if state is TaskState.PUSH and is_unsteered and goal is not None:
            if target.style is PushStyle.WAYPOINT:
                goal = Pose(*target.object_poses[-1].tolist())
            primitives = self._prepared or self._load_primitives(perception)
            return PrimitivePush(context, primitives, perception.localization, target, goal)
        if state is TaskState.PUSH:
            control = self._with_present_uncertainty(target, perception)
            return SupervisedPush(context._replace(control=control), target)
        return None

    def inspection(self, perception: TaskPerception) -> Behavior:
        """
        Make the behaviour that sees the object from another side.

        :param perception: ``TaskPerception`` of robot and object.
        """
        return Inspection(BehaviorContext(
            perception.localization.obj, self._robot, self._control, self._drive,
            self._supervision, self.occupancy_map))

    def remaining_time(self, object_pose: Pose, goal: Pose) -> float | None:
        """
        Expect the time that a task still takes, where its error does not show it.

        By the cost-to-go of the last unsteered push: nothing is loaded or made here.

        :param object_pose: ``Pose`` of the object.
        :param goal: goal ``Pose`` of the object.
        :return: time [s]; None where each push brings the object nearer to its goal.
        """
        primitives = self._prepared
        if primitives is None or not primitives.is_learned:
            return None
        to_goal = object_pose.inverse() @ goal
        return min(primitives.cost_to_go.at(to_goal, face)
                   for face in range(primitives.table.face_count))

    def _load_primitives(self, perception: TaskPerception) -> PushPrimitives:
        """Load what the planner has chosen the push from."""
        position_tolerance, heading_tolerance = aimed_tolerances(self._control, self._supervision)
        localization = perception.localization
        knowledge, obj = localization.knowledge, localization.obj
        belief = FrictionBelief(friction_center(obj), obj.contact_friction_coefficient,
                                knowledge.center_deviation, knowledge.contact_friction_deviation)
        return load_primitives(self._obj, self._robot, CostSettings(
            position_tolerance=position_tolerance, heading_tolerance=heading_tolerance,
            robot_speed=self._drive.limited_to(self._robot).speed, drive=self._robot.drive),
            belief)

    def correct_overlap(self, perception: TaskPerception) -> None:
        """
        Correct a robot pose that overlaps the object.

        :param perception: ``TaskPerception`` of robot and object.
        """
        perception.correct_overlap(self._obj, self._robot, OVERLAP_STD)

    def _with_present_uncertainty(self, target: PushTrajectory,
                                  perception: TaskPerception) -> ControlSettings:
        localization = perception.localization
        distance_to_center = distance(contact_start_point(target), localization.friction_center)
        center_std_ratio = localization.knowledge.center_deviation / distance_to_center
        heading_std = localization.standard_deviations[2]
        return dataclasses.replace(
            self._control, center_std_ratio=math.hypot(CENTER_STD_RATIO, center_std_ratio),
            push_direction_std=math.hypot(PUSH_DIRECTION_STD, heading_std))


def _for_task(control: ControlSettings) -> ControlSettings:
    """
    Adapt settings to one push among several.

    Whatever error it leaves, the next push corrects; so it neither goes back for another approach
    nor asks for a plan by itself, and its feedback is stiffer.
    """
    return dataclasses.replace(
        control, position_tolerance=ANY_ERROR, heading_tolerance=ANY_ERROR,
        max_reapproaches=0, max_replan_requests=0,
        feedback_cone_fraction=max(control.feedback_cone_fraction, FEEDBACK_CONE_FRACTION),
        # Not above the ranges of these settings.
        lateral_gain=min(100.0, GAIN_FACTOR ** 2 * control.lateral_gain),
        heading_gain=min(50.0, GAIN_FACTOR * control.heading_gain),
        max_curvature_rate=min(1000.0, GAIN_FACTOR ** 2 * control.max_curvature_rate))
