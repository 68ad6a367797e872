"""
The planner between configuring and cleaning up: from a request to its plan.

A request is read, waits for measurements or for the primitives of its object, is planned by its
kind, and answered.
"""

import contextlib
from typing import Any, Callable, Mapping, NamedTuple, Sequence, TYPE_CHECKING

from builtin_interfaces.msg import Time
from push_model.geometry import distance, Pose
from push_model.plan_request import PlanFailure, PlanRequest, RequestKind
from push_model.signals import ObjectPose, Odometry, STOP
from push_model.trajectory import PushTrajectory
from push_planner.problem import check_solver, PlanningFailed
from push_planner.ros.parameters import PlannerParameters
from push_planner.ros.requested_object import OverruledParameters
from push_planner.ros.task_requests import TaskRequestHandler
from push_ros.conversions.map import map_reader, map_text
from push_ros.conversions.measurements import from_object_pose_message, from_odometry_message
from push_ros.conversions.plan import no_plan_message, to_path_message, to_plan_message
from push_ros.conversions.primitives import MessageRefused, nanoseconds, seconds
from push_ros.diagnostics import ERROR, FAILURE, HAS_MAP, OK, WARN
from push_ros.lifecycle import INACTIVE, ManagedNode
from push_ros.node import NewestMessage, ServiceAnswer
from push_ros.node_settings import PlannerOptions
from push_ros.topic_watch import TopicWatch
from push_ros.transforms.world import Handlers, WorldFrame
from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.timer import Timer

if TYPE_CHECKING:  # Imported where it is first used: tasks may need no steered push.
    from push_planner.steered.plan import Plan
    from push_planner.steered.site_selection import SiteChoice

# Period at which a request looks for what it waits for [s]; chosen: that of slow object poses.
WAIT_PERIOD = 0.05
# Longest wait of ``planner/replan`` for measurements [s]; chosen: on a busy machine it takes some
# tenths of a second until publishers have been met.
DISCOVERY_WAIT = 1.0
# Distance between the object poses of a request and of the planner at which those of the planner
# are outdated [m]; chosen: as far off the controller refuses plans.
MAX_DISAGREEMENT = 0.25
# What is reported while a request is waited for, and while one would have to wait.
WAITS = 'waits for a request'
PREPARES = 'finds out what pushes do to the object; the first time this takes a minute or two'
# Period at which a planner that prepares looks whether it is ready [s]; chosen: short to wait.
READY_PERIOD = 0.2
# Period at which a map is looked for that is being read [s]; chosen: short for who waits for it.
MAP_PERIOD = 0.1


class _MeasurementTopics(NamedTuple):
    """Newest messages of the topics of measurements."""

    odom: NewestMessage
    object_pose: NewestMessage

    @property
    def missing(self) -> Sequence[str]:
        """Topics on which nothing has come yet."""
        return [topic for topic, newest in self._asdict().items() if newest.message is None]


class ActivePlanner:
    """Answers requests with plans, in the map that has come last."""

    def __init__(self, node: ManagedNode, parameters: PlannerParameters, options: PlannerOptions,
                 world: WorldFrame, frame: str) -> None:
        """
        Start to compile what tasks need, and to load what pushes do; requests are read meanwhile.

        :param frame: its id.
        """
        self._node = node
        self._parameters = parameters
        self._options = options
        self._world = world
        self._frame = frame
        self._plans = node.publisher('push_plan')
        self._paths = node.publisher('planned_path')
        self._markers = node.publisher('planning_markers')
        self._tasks = TaskRequestHandler(parameters, self._frame)
        self._overruled = OverruledParameters(parameters.object)
        # They run while something is waited for.
        self._timer = self._make_timer(WAIT_PERIOD, self._plan_when_possible)
        self._map_timer = self._make_timer(MAP_PERIOD, self._take_map)
        self._ready_timer = self._make_timer(READY_PERIOD, self._look_whether_ready)
        # What was reported last.
        self._reported = ''
        # While the node is active.
        self._topics: TopicWatch | None = None
        self._measured: _MeasurementTopics | None = None
        self._forget()

    def activate(self) -> None:
        """Subscribe, and wait for a request."""
        # As long as it may be asked for a single push: what comes in between is not repeated.
        self._listen()
        # The map first: a request that has come with it is planned with it.
        self._node.subscribe('map', self._world.receiver('map', Handlers(
            self._on_map, self._refuse_map, self._tasks.move_map, is_latched=True)),
            real_time=True, read=map_reader(self._parameters.map_settings))
        self._node.subscribe('push_request', self._on_request, real_time=True)
        if self._tasks.clearing.is_enabled:
            self._record_footprints()
        self._topics = TopicWatch(self._node, self._awaited_topics)
        self._report_readiness()

    def deactivate(self) -> None:
        """Forget what was requested."""
        self._timer.cancel()
        self._map_timer.cancel()
        self._ready_timer.cancel()
        if self._topics is not None:
            self._topics.destroy()
        self._measured = None
        self._forget()

    def destroy(self) -> None:
        """Forget the map."""
        for timer in (self._timer, self._map_timer, self._ready_timer):
            self._node.destroy_timer(timer)

    def set_parameters(self, parameters: PlannerParameters) -> None:
        """Plan with other settings from the next request on."""
        self._parameters = parameters
        self._tasks.set_parameters(parameters)

    def answer_after_error(self) -> None:
        """Answer the request in whose planning an unexpected error has come, if any."""
        stamp, self._answering, self._pending = self._answering, None, None
        if stamp is not None:
            self._plans.publish(no_plan_message(PlanFailure.INTERNAL_ERROR, stamp, self._frame))

    def _make_timer(self, period: float, callback: Callable[[], None]) -> Timer:
        timer = self._node.create_timer(period, self._node.guarded(callback),
                                        clock=Clock(clock_type=ClockType.STEADY_TIME))
        timer.cancel()
        return timer

    def _listen(self) -> _MeasurementTopics:
        """Subscribe to measurements, where that is not done; each wakes up a thread."""
        if self._measured is None:
            self._measured = _MeasurementTopics(
                self._node.subscribe_newest('odom'), self._node.subscribe_newest(
                    'object_pose', with_covariance=self._options.object_pose_with_covariance))
        return self._measured

    def _stop_listening(self) -> None:
        """End subscriptions to measurements, which cost time and tasks do not need."""
        if self._measured is not None:
            for newest in self._measured:
                self._node.unsubscribe_newest(newest)
            self._measured = None

    def _awaited_topics(self) -> Sequence[str]:
        """Name the topics on which something has to come for the request that waits."""
        if self._pending is None or self._pending[0].kind is RequestKind.TASK_PUSH:
            return []
        return self._listen().missing

    def _forget(self) -> None:
        # A request that waits for measurements or for the primitives of its object, and its stamp.
        self._pending: tuple[PlanRequest, Time] | None = None
        # Stamp of the request that is being answered, or None.
        self._answering: Time | None = None
        self._last_request: PlanRequest | None = None
        self._previous_plan: Plan | None = None

    def _on_map(self, message: Any) -> None:
        self._tasks.on_map(message)
        self._take_map()

    def _report_readiness(self) -> None:
        """Report that a request is waited for, or what one would have to wait for."""
        if self._tasks.is_ready:
            self._report(OK, WAITS)
        else:
            self._report(OK, PREPARES)
            self._ready_timer.reset()

    def _look_whether_ready(self) -> None:
        """Report readiness, unless there has been something else to report."""
        if self._reported != PREPARES or self._pending is not None:
            self._ready_timer.cancel()
        elif self._tasks.is_ready:
            self._ready_timer.cancel()
            self._report(OK, WAITS)

    def _take_map(self) -> None:
        """Use a map that was read, or look again a little later."""
        try:
            message = self._tasks.take_map()
        except MessageRefused as error:
            self._report(ERROR, str(error))
        else:
            if message is not None:
                self._report(OK, map_text(message), {HAS_MAP: True})
        if self._tasks.reads_map:
            self._map_timer.reset()
        else:
            self._map_timer.cancel()

    def _refuse_map(self, error: MessageRefused, message: Any) -> None:
        self._tasks.refuse_map(str(error))
        self._report(ERROR, str(error))

    def _record_footprints(self) -> None:
        """Follow object and robot, whose footprints are cleared from maps."""
        clearing = self._tasks.clearing

        # The controller reports what it cannot use of the same topics.
        def on_object_pose(message: Any) -> None:
            with contextlib.suppress(MessageRefused):
                measured = from_object_pose_message(message, self._frame)
                clearing.record(seconds(message.header.stamp), measured.pose, None)

        def on_odometry(message: Any) -> None:
            with contextlib.suppress(MessageRefused):
                odometry = from_odometry_message(message, self._frame)
                clearing.record(seconds(message.header.stamp), None, odometry.pose)

        self._node.subscribe('odom', on_odometry)
        self._node.subscribe('object_pose', self._world.receiver('object_pose', Handlers(
            on_object_pose, lambda error, message: None)),
            with_covariance=self._options.object_pose_with_covariance)

    def _on_request(self, message: Any) -> None:
        stamp = message.header.stamp
        try:
            request = self._tasks.read(message)
        except MessageRefused as error:
            self._plans.publish(no_plan_message(PlanFailure.INVALID_REQUEST, stamp,
                                                self._frame))
            self._report(ERROR, str(error), {FAILURE: PlanFailure.INVALID_REQUEST.name})
            return
        self._node.get_logger().debug(f'plans to the goal {request.goal}')
        overruled = self._overruled.note(request.obj)
        if overruled:
            self._node.reporter.log(WARN, overruled)
        if request.kind is RequestKind.TASK_PUSH:
            self._stop_listening()
        self._last_request = request
        self._pending = request, stamp
        self._plan_when_possible()

    def _plan_when_possible(self) -> None:
        """Plan what was requested, or look again a little later."""
        if self._pending is None:
            self._timer.cancel()
            return
        request, stamp = self._pending
        if self._waits(request):
            self._timer.reset()
            return
        self._pending = None
        is_task = request.kind is RequestKind.TASK_PUSH
        plan = self._plan_task_push if is_task else self._plan_push
        self._answer(stamp, lambda: plan(request, stamp))

    def _waits(self, request: PlanRequest) -> bool:
        """Report what a request has to wait for, if anything."""
        if request.kind is RequestKind.STEERED_PUSH:
            missing = self._listen().missing
            if missing:
                self._report(WARN, f'has a goal and waits for {" and ".join(missing)}')
            return bool(missing)
        is_waiting = self._tasks.prepares(request)
        if is_waiting:
            self._report(OK, PREPARES)
        return is_waiting

    async def replan(self) -> ServiceAnswer:
        """Plan again to the goal of the last request, from the newest measurements."""
        if self._last_request is not None:
            await self._node.wait_until(
                lambda: not self._node.is_active or not self._listen().missing,
                WAIT_PERIOD, DISCOVERY_WAIT)
        if not self._node.is_active:
            return INACTIVE
        if self._last_request is None:
            return ServiceAnswer(False, 'has received no request yet')
        missing = self._listen().missing
        if missing:
            return ServiceAnswer(False, f'has received no {" and no ".join(missing)} yet')
        request = self._last_request
        stamps = [newest.message.header.stamp for newest in self._listen()]
        stamp = max(stamps, key=nanoseconds)
        return self._answer(stamp, lambda: self._plan_from_measurements(request, stamp),
                            publishes_failure=False)

    def _answer(self, stamp: Time, plan: Callable[[], str], *,
                publishes_failure: bool = True) -> ServiceAnswer:
        """Plan and publish; return whether there is a plan, and what was reported."""
        self._answering = stamp if publishes_failure else None
        refusal: PlanningFailed | None = None
        try:
            text = plan()
            self._answering = None
            return ServiceAnswer(True, text)
        except MessageRefused as error:
            code, text = PlanFailure.INVALID_VALUE, self._report(ERROR, str(error))
        except PlanningFailed as failure:
            code, text, refusal = failure.code, self._report_failure(failure), failure
        self._answering = None
        if publishes_failure:
            self._plans.publish(no_plan_message(code, stamp, self._frame))
        if refusal is not None:
            self._markers.publish(self._tasks.refusal_markers(self._last_request, refusal, stamp))
        return ServiceAnswer(False, text)

    def _plan_from_measurements(self, request: PlanRequest, stamp: Time) -> str:
        measured, odometry = self._measurements()
        if request.kind is RequestKind.STEERED_PUSH:
            return self._plan_push(request._replace(
                object_pose=measured.pose, robot_pose=odometry.pose), stamp)
        return self._plan_task_push(PlanRequest(measured.pose, odometry.pose, request.goal,
                                                request.obj), stamp)

    def _measurements(self) -> tuple[ObjectPose, Odometry]:
        topics = self._listen()
        odometry = from_odometry_message(topics.odom.message, self._frame)
        message = self._world.in_world('object_pose', topics.object_pose.message)
        return from_object_pose_message(message, self._frame), odometry

    def _plan_push(self, request: PlanRequest, stamp: Time) -> str:
        """Plan one push from the newest measurements, and publish it."""
        check_solver()
        from push_planner.steered.replanning import plan_from_measurements, stated_trajectory
        self._pending = None
        parameters, (measured, odometry) = self._parameters, self._measurements()
        is_outdated = measured.time < seconds(stamp)
        if is_outdated and distance(measured.pose, request.object_pose) > MAX_DISAGREEMENT:
            # The object was put elsewhere a moment ago.
            measured = measured._replace(pose=request.object_pose)
            odometry = odometry._replace(pose=request.robot_pose, twist=STOP)
        choice = plan_from_measurements(request.obj, parameters.robot, measured, odometry,
                                        request.goal, parameters.planner,
                                        previous=self._previous_plan,
                                        tolerances=request.tolerances)
        self._previous_plan = choice.plan
        return self._publish(choice, stated_trajectory(choice.plan, request.tolerances),
                             odometry.pose, stamp)

    def _plan_task_push(self, request: PlanRequest, stamp: Time) -> str:
        """Plan the next push of a task, and publish it."""
        self._tasks.wait_for_map()
        self._take_map()
        task_plan = self._tasks.plan(request)
        messages = self._tasks.messages(task_plan, stamp)
        self._plans.publish(messages.plan)
        self._paths.publish(messages.path)
        text = self._report(OK, *messages.description)
        # Who waits for the plan does not wait for its picture.
        self._markers.publish(self._tasks.markers(request, task_plan, stamp))
        return text

    def _publish(self, choice: 'SiteChoice', trajectory: PushTrajectory, robot_pose: Pose,
                 stamp: Time) -> str:
        plan = choice.plan
        self._plans.publish(to_plan_message(trajectory, stamp, self._frame))
        self._paths.publish(to_path_message(trajectory.object_poses.tolist(), stamp,
                                            self._frame))
        start = Pose(*trajectory.robot_poses[0].tolist())
        text = (f'has planned a push of {trajectory.duration:.1f} s and '
                f'{trajectory.path_length:.2f} m')
        level = OK
        if distance(start, robot_pose) > self._parameters.planner.contact_tolerance:
            level = WARN
            text += f' for a robot at {start.x:.3f} m, {start.y:.3f} m, {start.theta:.3f} rad'
        outlook = {} if trajectory.outlook is None else trajectory.outlook.values()
        return self._report(level, text, {
            **plan.report, **outlook, 'robot_start': start,
            'present_speed': plan.problem.motion.speed, **_one_line_per_site(choice.candidates)})

    def _report(self, level: bytes, text: str, values: Mapping[str, Any] | None = None) -> str:
        """Report, and return the text."""
        self._reported = text
        self._node.reporter.report(level, text, values)
        return text

    def _report_failure(self, failure: PlanningFailed) -> str:
        values = dict(failure.report)
        sites = values.pop('sites', ())
        # Nothing is wrong where nothing needs to be done.
        level = OK if failure.code is PlanFailure.AT_GOAL else ERROR
        return self._report(level, failure.reason, {
            FAILURE: failure.code.name, **values, **_one_line_per_site(sites)})


def _one_line_per_site(sites: Sequence[Any]) -> Mapping[str, Any]:
    return {f'site {index}': site for index, site in enumerate(sites, 1)}
