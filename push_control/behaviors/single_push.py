"""A single steered push: planned from where the robot stands, and planned again under way."""

from push_control.behaviors.behavior import Behavior, BehaviorContext, MeasurementNeed
from push_control.behaviors.steered_push import SteeredPush
from push_control.goal import TaskGoal
from push_control.perception.measurement_watch import MeasurementWatch
from push_control.perception.raw_perception import RawPerception
from push_control.steered.controller import WAITING_TIME_LIMIT
from push_control.steered.estimation.contact_site import SAME_PUSH_DISTANCE, SAME_PUSH_ROTATION
from push_control.steered.plan_check import PoseRegion
from push_control.steered.status import Phase
from push_model.events import EventReport, PushEvent
from push_model.geometry import Pose
from push_model.observation import Observation
from push_model.plan_request import GoalTolerances, PlanRequest, RequestKind
from push_model.signals import ObjectEstimate, ObjectPose, STOP, Twist
from push_model.trajectory import PushTrajectory
from push_safety.status import SafetyReport


def request_plan(context: BehaviorContext, observation: Observation, goal: Pose,
                 tolerances: GoalTolerances) -> PlanRequest | None:
    """
    Request a plan from where object and robot are measured.

    :param tolerances: how near to the goal the object has to come.
    :return: ``PlanRequest``; None before the first object pose.
    """
    if observation.object_pose is None:
        return None
    return PlanRequest(observation.object_pose.pose, observation.odometry.pose, goal, context.obj,
                       position_tolerance=tolerances.position,
                       heading_tolerance=tolerances.heading, kind=RequestKind.STEERED_PUSH)


def is_measured_since(goal: TaskGoal, perception: RawPerception) -> bool:
    """Tell whether it is known where the object has been since a goal came."""
    return (perception.observation.pose_rejection is None
            and perception.has_pose_after(goal.since))


class PromptPlan(Behavior[RawPerception]):
    """
    Stands, and requests a plan as soon as the object was measured since the goal came.

    Where the object is put elsewhere before the plan comes, another one is requested.
    """

    measurement_need = MeasurementNeed.NONE
    handles_stops = True

    def __init__(self, context: BehaviorContext, goal: TaskGoal) -> None:
        """Start."""
        super().__init__()
        self._context = context
        self._goal = goal
        self._watch = MeasurementWatch()
        self._fault: EventReport | None = None

    @property
    def waiting_cause(self) -> EventReport | None:
        """What the request waits for; None where it does not take long."""
        return self._fault

    def move_goal(self, pose: Pose) -> None:
        """Move the goal for the next request."""
        self._goal = self._goal._replace(pose=pose)

    def pause(self) -> None:
        """Forget for how long measurements were awaited."""
        self._watch = MeasurementWatch()

    def step(self, perception: RawPerception, dt: float) -> Twist:
        """Stand, and request a plan."""
        observation, request = perception.observation, self.plan_request
        if request is not None and self._is_outdated(request, observation):
            self.plan_request = None
        if self.plan_request is None and is_measured_since(self._goal, perception):
            self.plan_request = request_plan(self._context, observation, self._goal.pose,
                                             self._context.control.tolerances)
        if observation.object_pose is not None:
            self._watch_measurements(perception)
        return STOP

    def _watch_measurements(self, perception: RawPerception) -> None:
        """Give up where measurements have ceased, after as long as in a push."""
        fault = None
        if self.plan_request is None:
            fault = perception.measurement_fault(needs_object=True)
        self._fault = self._watch.update(fault, perception.time)
        if self._fault is not None and self._watch.waited(perception.time) > WAITING_TIME_LIMIT:
            self.failure = PushEvent.GAVE_UP_WAITING.report(limit=WAITING_TIME_LIMIT,
                                                            reason=self._fault)

    def _is_outdated(self, request: PlanRequest, observation: Observation) -> bool:
        """Tell whether the object seems to be elsewhere than where the plan was requested from."""
        measured = observation.object_pose
        start = PoseRegion(request.object_pose, *self.start_limits)
        return (observation.pose_rejection is not None
                or measured is not None and not start.contains(measured.pose))


class SinglePush(SteeredPush):
    """
    Follows a plan, and changes over to another one without a stop where that starts at this push.

    It requests one for another goal, and where the push has left its path. Where there is none for
    another goal it goes on to the present one. Its controller waits by itself.
    """

    handles_stops = True

    def __init__(self, context: BehaviorContext, target: PushTrajectory,
                 goal: Pose | None = None) -> None:
        """
        Start.

        :param goal: ``Pose`` that was asked for; None for the end of the plan.
        """
        super().__init__(context, target)
        self._goal = self._pursued(goal)
        self._next_tolerances = GoalTolerances()
        self._time = 0.0

    @property
    def awaits_resume(self) -> bool:
        """Tell whether it waits until somebody lets the robot go on."""
        return self._controller.awaits_resume

    def on_safety_report(self, fault: SafetyReport | None, stop: SafetyReport | None) -> None:
        """Let the controller wait where the robot is stopped."""
        self._controller.on_safety_report(fault, stop)

    def resume(self) -> bool:
        """Go on after a stop of the base."""
        self._controller.resume()
        return True

    @property
    def start_limits(self) -> tuple[float, float]:
        """Distance and rotation up to which an object is at the start of a plan [m, rad]."""
        if self._controller.phase is Phase.IDLE or self._controller.phase.has_ended:
            return super().start_limits
        # Under way the object is elsewhere by the time the plan comes.
        return SAME_PUSH_DISTANCE, SAME_PUSH_ROTATION

    def take_goal(self, goal: TaskGoal, tolerances: GoalTolerances) -> bool:
        """Request a plan to another goal; until it comes the present one is pursued."""
        self.next_goal = goal
        self._next_tolerances = tolerances
        self.plan_request = None
        self._controller.resume()
        return True

    def move_goal(self, pose: Pose) -> None:
        """Move a goal that waits for its plan; a plan is followed where it was planned."""
        if self.next_goal is not None:
            self.next_goal = self.next_goal._replace(pose=pose)

    def take_plan(self, trajectory: PushTrajectory) -> bool:
        """Go on with another plan, from rest where it does not start at this push."""
        goal = self._goal if self.next_goal is None else self.next_goal.pose
        self._target = trajectory
        self._goal = self._pursued(goal)
        self.next_goal = self.plan_request = None
        return True

    def _pursued(self, goal: Pose | None) -> Pose:
        """Return the goal if the plan leads there, else where the plan ends."""
        end = Pose(*self._target.object_poses[-1].tolist())
        if goal is not None and self._context.control.tolerances.contain(end, goal):
            return goal
        return end

    def goes_on_without_plan(self) -> bool:
        """Give another goal up to which there is no plan; return whether there was one."""
        has_goal = self.next_goal is not None
        self.next_goal = self.plan_request = None
        return has_goal

    @property
    def object_estimate(self) -> ObjectEstimate | None:
        """``ObjectEstimate`` of the controller; None before the push has begun."""
        status = self._controller.status
        if status.phase not in (Phase.PUSHING, Phase.WAITING):
            return None
        return ObjectEstimate(self._time, status.object_pose, None, status.friction_center)

    def step(self, perception: RawPerception, dt: float) -> Twist:
        """Compute the command, and request a plan where one is needed."""
        self._perception = perception
        observation, controller = perception.observation, self._controller
        self._time = observation.time
        command = controller.step(self._target, observation, dt)
        if self.plan_request is None:
            self.plan_request = self._needed_plan(perception)
        self.finished = controller.phase is Phase.DONE
        if controller.phase is Phase.FAILED and not controller.replan_requested:
            self.failure = controller.event
        elif self._context.occupancy_map is not None:
            self.failure = self._near_obstacle(controller.status)
        return command if self.failure is None else STOP

    def _needed_plan(self, perception: RawPerception) -> PlanRequest | None:
        """Request a plan to another goal, or from where the push has left its path."""
        context, observation = self._context, perception.observation
        if self.next_goal is not None:
            if not is_measured_since(self.next_goal, perception):
                return None
            return request_plan(context, observation, self.next_goal.pose, self._next_tolerances)
        if not self._controller.replan_requested:
            return None
        # From the estimate: a single pose that is off may lie at the goal. Not to the end of the
        # last plan: that is off by a tolerance, and so would be the next one.
        estimate = ObjectPose(observation.time, self._controller.status.object_pose)
        observation = observation._replace(object_pose=estimate)
        return request_plan(context, observation, self._goal, context.control.tolerances)
