"""Repeated pushes: the behaviours of a task that takes as many pushes as it needs."""

from collections.abc import Callable
import contextlib
import dataclasses
import functools
import math

import numpy as np
from push_control.behaviors.approach import MovingApproach, StandoffApproach
from push_control.behaviors.behavior import Behavior, BehaviorContext, Stand
from push_control.behaviors.guarded_approach import GuardedApproach
from push_control.behaviors.inspection import Inspection
from push_control.behaviors.look import Look, LookMargin, RetreatIntoView
from push_control.behaviors.plan import PlanBehavior
from push_control.behaviors.progress import ProgressMonitor
from push_control.behaviors.retreat import Retreat
from push_control.behaviors.rollout_law import warm_up
from push_control.behaviors.steered_push import SteeredPush
from push_control.behaviors.straight_push import StraightPush
from push_control.goal import TaskGoal
from push_control.perception.perception import TaskPerception
from push_control.settings import ControlSettings
from push_control.steered.start import contact_start_point
from push_control.supervision_settings import aimed_tolerances, SupervisionSettings
from push_control.task.behavior_factory import BehaviorFactory
from push_control.task.state_machine import REPEATED_PUSHES_TABLE
from push_control.task.status import TaskState
from push_model.friction import friction_center
from push_model.geometry import distance, Pose
from push_model.observation import Observation
from push_model.parameters import PushedObject, RoundRobot
from push_model.signals import ObjectPose, Odometry, STOP
from push_model.trajectory import PushStyle, PushTrajectory
from push_navigation.occupancy_map import OccupancyMap
from push_navigation.path import NoPathFound
from push_navigation.path_planner import plan_path
from push_navigation.settings import DriveSettings
from push_primitives.cost_settings import CostSettings
from push_primitives.simplification import simplified_object
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
# Length of the retreat after a straight push [m]; chosen: what the robot covers while the object
# is measured, and more than the clearance that a path around the object needs at least.
SHORT_RETREAT = 0.06
# Tolerance that every push keeps [m, rad].
ANY_ERROR = 1.0
# Measurements of a rehearsal: period [s], and poses clear of each other.
REHEARSAL_PERIOD = 0.05
REHEARSAL_ROBOT = Pose(0.0, 0.0, 0.0)
REHEARSAL_OBJECT = Pose(3.0, 0.0, 0.0)
# Its map: resolution and corner [m], rows and columns, and where a wall is between robot and goal.
REHEARSAL_GOAL = Pose(2.0, 0.0, 0.0)
MAP_RESOLUTION, MAP_CORNER, MAP_SHAPE = 0.1, Pose(-3.0, -3.0, 0.0), (60, 100)
WALL_ROWS, WALL_COLUMN = slice(28, 32), 40


class RepeatedPushBehaviors(BehaviorFactory):
    """Makes the behaviours of a task of several pushes."""

    table = REPEATED_PUSHES_TABLE
    keeps_plan = False

    def __init__(self, obj: PushedObject, robot: RoundRobot, control: ControlSettings,
                 drive: DriveSettings, supervision: SupervisionSettings) -> None:
        """
        Start on open floor.

        :param obj: the nominal ``PushedObject``; a fine outline and many supports are simplified,
            as the planner does.
        """
        super().__init__(simplified_object(obj), robot, control, drive, supervision)
        # Perception keeps what it is made with.
        self._perception_settings = control, supervision
        self._prepared: PushPrimitives | None = None
        self._look_margin = LookMargin()

    def set_settings(self, control: ControlSettings, drive: DriveSettings,
                     supervision: SupervisionSettings) -> None:
        """Adapt the settings to pushes of a task, for behaviours that are made from now on."""
        super().set_settings(_for_task(control), drive, supervision)

    def new_perception(self, since: float) -> TaskPerception:
        """Estimate where robot and object are."""
        return TaskPerception(self._obj, self._robot, *self._perception_settings, since=since)

    def create(self, state: TaskState, target: PushTrajectory | None, goal: TaskGoal | None,
               perception: TaskPerception, progress: ProgressMonitor) -> Behavior[TaskPerception]:
        """Make the behaviour of a state."""
        context = self._context(perception.localization.obj)
        if state is TaskState.PLAN and goal is not None:
            return PlanBehavior(context._replace(obj=self._obj), progress, goal,
                                self._remaining_time)
        if state is TaskState.RETREAT:
            return self._retreat(context, target, perception)
        if state is TaskState.LOOK:
            return Look(context, self._look_margin)
        if state is TaskState.APPROACH and target is not None:
            return self._approach(context, target, perception)
        if state is TaskState.ALIGN and target is not None:
            return GuardedApproach(context, target, perception.object_at_rest)
        if state is TaskState.PUSH and target is not None:
            return self._push(context, target, goal, perception, has_spun=progress.has_spun)
        return Stand()

    def rehearse(self) -> None:
        """Localize a robot far off the object, weigh one straight push, and go round a wall."""
        perception = self.new_perception(-math.inf)
        for time in (0.0, REHEARSAL_PERIOD):
            perception.update(Observation(time, Odometry(time, REHEARSAL_ROBOT, STOP),
                                          ObjectPose(time, REHEARSAL_OBJECT)))
        warm_up(self._load_primitives(perception), perception.localization)
        # The first map may come while the robot drives, and what it needs takes long to import.
        with contextlib.suppress(NoPathFound):
            plan_path(self._robot, self._obj, REHEARSAL_OBJECT, REHEARSAL_ROBOT, REHEARSAL_GOAL,
                      self._drive, occupancy_map=_rehearsal_map())

    def inspection(self, perception: TaskPerception) -> Behavior[TaskPerception]:
        """Make the behaviour that sees the object from another side."""
        return Inspection(self._context(perception.localization.obj))

    def _retreat(self, context: BehaviorContext, target: PushTrajectory | None,
                 perception: TaskPerception) -> Behavior[TaskPerception]:
        if perception.has_limited_view:
            return RetreatIntoView(context, min(self._drive.retreat_distance, SHORT_RETREAT),
                                   self._drive.speed)
        if target is not None and target.style.is_straight:
            return Retreat(context, min(self._drive.retreat_distance, SHORT_RETREAT),
                           self._drive.speed)
        return Retreat(context, self._drive.retreat_distance)

    def _approach(self, context: BehaviorContext, target: PushTrajectory,
                  perception: TaskPerception) -> Behavior[TaskPerception]:
        if not target.style.is_straight:
            return StandoffApproach(context, target)
        # Now, while the robot stands; the push that follows without a stop has the same.
        self._prepared = self._load_primitives(perception)
        warm_up(self._prepared, perception.localization)
        return MovingApproach(context, target)

    def _push(self, context: BehaviorContext, target: PushTrajectory, goal: TaskGoal | None,
              perception: TaskPerception, *, has_spun: bool) -> Behavior[TaskPerception]:
        if not target.style.is_straight or goal is None:
            control = self._with_present_uncertainty(target, perception)
            return SteeredPush(context._replace(control=control), target)
        end = goal.pose
        if target.style is PushStyle.WAYPOINT:
            end = Pose(*target.object_poses[-1].tolist())
        primitives = self._prepared or self._load_primitives(perception)
        return StraightPush(context, primitives, perception.localization, target, end,
                            has_spun=has_spun)

    def _remaining_time(self, object_pose: Pose, goal: Pose) -> float | None:
        """
        Expect the time that a task still takes [s]; None where its error shows that well enough.

        It is the cost-to-go of the last straight push: nothing is loaded or made here.
        """
        primitives = self._prepared
        if primitives is None or not primitives.is_learned:
            return None
        to_goal = object_pose.inverse() @ goal
        return min(primitives.cost_to_go.at(to_goal, face)
                   for face in range(primitives.table.face_count))

    def preparation(self, target: PushTrajectory,
                    perception: TaskPerception) -> Callable[[], object] | None:
        """Load primitives, which are made first after a change of settings."""
        return self._primitive_loading(perception) if target.style.is_straight else None

    def _load_primitives(self, perception: TaskPerception) -> PushPrimitives:
        """Load what the planner has chosen the push from."""
        return self._primitive_loading(perception)()

    def _primitive_loading(self, perception: TaskPerception) -> Callable[[], PushPrimitives]:
        """Make a function that loads primitives for what is known now."""
        localization = perception.localization
        knowledge, obj = localization.knowledge, localization.obj
        belief = FrictionBelief(friction_center(obj), obj.contact_friction_coefficient,
                                knowledge.center_deviation, knowledge.contact_friction_deviation)
        settings = cost_settings(self._control, self.supervision, self._drive, self._robot)
        return functools.partial(load_primitives, self._obj, self._robot, settings, belief)

    def _with_present_uncertainty(self, target: PushTrajectory,
                                  perception: TaskPerception) -> ControlSettings:
        localization = perception.localization
        distance_to_center = distance(contact_start_point(target), localization.friction_center)
        center_std_ratio = localization.knowledge.center_deviation / distance_to_center
        heading_std = localization.standard_deviations[2]
        return dataclasses.replace(
            self._control, center_std_ratio=math.hypot(CENTER_STD_RATIO, center_std_ratio),
            push_direction_std=math.hypot(PUSH_DIRECTION_STD, heading_std))


def cost_settings(control: ControlSettings, supervision: SupervisionSettings,
                  drive: DriveSettings, robot: RoundRobot) -> CostSettings:
    """State what a task counts as its costs; on them depend the primitives that it loads."""
    position_tolerance, heading_tolerance = aimed_tolerances(control, supervision)
    return CostSettings(
        position_tolerance=position_tolerance, heading_tolerance=heading_tolerance,
        robot_speed=drive.limited_to(robot).speed, drive=robot.drive)


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


def _rehearsal_map() -> OccupancyMap:
    """Make a small map with a wall between robot and goal."""
    cells = np.zeros(MAP_SHAPE, bool)
    cells[WALL_ROWS, WALL_COLUMN] = True
    return OccupancyMap(MAP_RESOLUTION, MAP_CORNER, cells)
