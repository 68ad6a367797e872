"""ROS node of the planner."""

import contextlib
import sys
from typing import Any, Callable, Mapping, NamedTuple, Sequence, TYPE_CHECKING

from builtin_interfaces.msg import Time
from push_model.files.flat_values import parameter_specs
from push_model.geometry import distance, Pose
from push_model.parameters import PushedObject, RoundRobot
from push_model.plan_request import PlanFailure, PlanRequest
from push_model.signals import ObjectPose, Odometry
from push_navigation.settings import DriveSettings, MapSettings
from push_planner.ros.parameters import PlannerParameters
from push_planner.settings import PlannerSettings, TaskSettings
from push_ros.conversions.map import map_text
from push_ros.conversions.measurements import from_object_pose_message, from_odometry_message
from push_ros.conversions.plan import no_plan_message, to_path_message, to_plan_message
from push_ros.conversions.primitives import MessageRefused, nanoseconds, seconds
from push_ros.diagnostics import ERROR, FAILURE, HAS_MAP, OK, WARN
from push_ros.executor import BackgroundGroup, run
from push_ros.lifecycle import INACTIVE, ManagedNode
from push_ros.node import NewestMessage, ServiceAnswer
from push_ros.node_settings import Frames, PlannerOptions
from push_ros.parameters import DYNAMIC
from push_ros.topics import PLANNER
from push_ros.transforms.world import Handlers, WorldFrame
from rclpy.clock import Clock
from rclpy.clock_type import ClockType

if TYPE_CHECKING:  # What plans is imported where it is first used, behind the first report.
    from push_planner.plan import Plan
    from push_planner.problem import PlanningFailed
    from push_planner.ros.sequence_planner import SequenceRequestHandler
    from push_planner.single_push.site_selection import SiteChoice

SECTIONS = (('object.', PushedObject), ('robot.', RoundRobot), ('planner.', PlannerSettings),
            ('drive.', DriveSettings), ('task.', TaskSettings), ('map.', MapSettings),
            ('', Frames), ('', PlannerOptions))
DYNAMIC_GROUPS = ('planner.', 'drive.', 'task.')
SETTABLE = {spec.name: DYNAMIC for prefix, cls in SECTIONS if prefix in DYNAMIC_GROUPS
            for spec in parameter_specs(cls, prefix)}
# Period at which a request looks for what it waits for [s]; chosen: that of slow object poses.
WAIT_PERIOD = 0.05
# Longest wait of ``planner/replan`` for measurements [s]; chosen: on a busy machine it takes some
# tenths of a second until publishers have been met.
DISCOVERY_WAIT = 1.0
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


class PlannerNode(ManagedNode):
    """
    Answers each request with a plan: of one push, or of the first of a sequence of pushes.

    A request brings the object that is to be pushed. The object of the parameters is the one for
    which the node prepares itself at its start; for another one that takes a while when its first
    request comes, unless it was done in former runs. Others are answered meanwhile.

    The plan of one push starts from the newest measurements, for which a request waits; while the
    robot pushes it starts from the present motion, at the site where it pushes. With
    ``planner.site`` at ``best`` the plan of a robot at rest starts at the quickest site of the
    object; the diagnostics say where the robot must stand for it, warn where it does not, and list
    all sites. With ``planner.site`` at ``sequence`` the plan starts from the poses of the request,
    and keeps clear of the obstacles of the ``map``, if there is one; after a map that is refused
    there is no plan until another one comes.

    The answer has the stamp of the request; where there is no plan, or the request is refused, it
    has no points and its only joint name is the code of the reason, which is an error on
    ``/diagnostics`` as well.

    Publishers
        ``push_plan`` (MultiDOFJointTrajectory, latched); ``planned_path`` (Path, latched);
        ``/diagnostics`` (DiagnosticArray).

    Subscribers, while active
        ``odom`` (Odometry) and ``object_pose`` (PoseStamped, or PoseWithCovarianceStamped), best
        effort, with ``planner.site`` at ``sequence`` from ``planner/replan`` on; ``map``
        (OccupancyGrid, latched); ``push_request`` (JointTrajectory, latched); ``/tf`` and
        ``/tf_static`` (TFMessage) as soon as one of these comes in another frame.

    Services
        ``planner/replan`` (Trigger): plans again to the goal of the last request, from the newest
        measurements, for which it waits a second at most; and those of the lifecycle.

    ROS parameters
        ``object.*`` and ``robot.*``, nominal; ``planner.*``; ``drive.*``, ``task.*`` and ``map.*``
        of sequences; ``world_frame``, ``object_frame``, ``base_frame``; and those of
        ``PlannerOptions``. Those of ``DYNAMIC_GROUPS`` may be set at any time.

    Frames
        Object poses and maps are brought to ``world_frame``, maps again where their frame drifts;
        everything else is in it.
    """

    _sequences: 'SequenceRequestHandler'
    _measured: _MeasurementTopics | None = None

    def __init__(self) -> None:
        super().__init__(PLANNER, SECTIONS, SETTABLE)
        *_, frames, self._options = self.settings
        self._world_frame: str = frames.world_frame
        self._world = WorldFrame(self, frames.world_frame, self._options.transform_timeout)
        self._plans = self.publisher('push_plan')
        self._paths = self.publisher('planned_path')
        self._forget()
        # In a group of its own: other services are answered while it waits.
        self.serve_active_trigger('planner/replan', self._replan, BackgroundGroup())

    @property
    def is_autostarted(self) -> bool:
        """Whether the node configures and activates itself."""
        return self._options.autostart

    def configure(self) -> None:
        """Compile the planner of sequences, and load what pushes do, where they are planned."""
        from push_planner.ros.sequence_planner import SequenceRequestHandler
        self._sequences = SequenceRequestHandler(self._present_parameters, self._world_frame)

    def activate(self) -> None:
        """Subscribe, and wait for a request."""
        if not self._plans_sequences:
            self._listen()
        # The map first: a request that has come with it is planned with it.
        self.subscribe('map', self._world.receiver('map', Handlers(
            self._on_map, self._refuse_map, self._sequences.move_map, is_latched=True)),
            real_time=True)
        self.subscribe('push_request', self._on_request, real_time=True)
        self._timer = self.create_timer(WAIT_PERIOD, self.guarded(self._plan_when_possible),
                                        clock=Clock(clock_type=ClockType.STEADY_TIME))
        self._timer.cancel()
        self._map_timer = self.create_timer(MAP_PERIOD, self.guarded(self._take_map),
                                            clock=Clock(clock_type=ClockType.STEADY_TIME))
        self._map_timer.cancel()
        if self._sequences.clearing.is_enabled:
            self._record_footprints()
        self.reporter.report(OK, 'waits for a request')

    def deactivate(self) -> None:
        """Forget what was requested."""
        self.destroy_timer(self._timer)
        self.destroy_timer(self._map_timer)
        self._measured = None
        self._forget()

    def clean_up(self) -> None:
        """Forget the map."""
        del self._sequences

    def on_settings_changed(self) -> None:
        """Plan with other settings from the next request on."""
        if hasattr(self, '_sequences'):
            self._sequences.set_parameters(self._present_parameters)

    @property
    def _present_parameters(self) -> PlannerParameters:
        *sections, _, _ = self.settings
        return PlannerParameters(*sections)

    @property
    def _plans_sequences(self) -> bool:
        return self._present_parameters.planner.site == 'sequence'

    def _listen(self) -> _MeasurementTopics:
        """Subscribe to measurements, where that is not done; each wakes up a thread."""
        if self._measured is None:
            self._measured = _MeasurementTopics(
                self.subscribe_newest('odom'), self.subscribe_newest(
                    'object_pose', with_covariance=self._options.object_pose_with_covariance))
        return self._measured

    def _forget(self) -> None:
        # A request that waits for measurements or for the primitives of its object, and its stamp.
        self._pending: tuple[PlanRequest, Time] | None = None
        # Stamp of the request that is being answered, or None.
        self._answering: Time | None = None
        self._last_request: PlanRequest | None = None
        self._former_plan: Plan | None = None

    def _on_map(self, message: Any) -> None:
        self._sequences.on_map(message)
        self._take_map()

    def _take_map(self) -> None:
        """Use a map that was read, or look again a little later."""
        try:
            message = self._sequences.take_map()
        except MessageRefused as error:
            self._report(ERROR, str(error))
        else:
            if message is not None:
                self._report(OK, map_text(message), {HAS_MAP: True})
        if self._sequences.reads_map:
            self._map_timer.reset()
        else:
            self._map_timer.cancel()

    def _refuse_map(self, error: MessageRefused, message: Any) -> None:
        self._sequences.refuse_map(str(error))
        self._report(ERROR, str(error))

    def _record_footprints(self) -> None:
        """Follow object and robot, whose footprints are cleared from maps."""
        clearing = self._sequences.clearing

        # The controller reports what it cannot use of the same topics.
        def on_object_pose(message: Any) -> None:
            with contextlib.suppress(MessageRefused):
                measured = from_object_pose_message(message, self._world_frame)
                clearing.record(seconds(message.header.stamp), measured.pose, None)

        def on_odometry(message: Any) -> None:
            with contextlib.suppress(MessageRefused):
                odometry = from_odometry_message(message, self._world_frame)
                clearing.record(seconds(message.header.stamp), None, odometry.pose)

        self.subscribe('odom', on_odometry)
        self.subscribe('object_pose', self._world.receiver('object_pose', Handlers(
            on_object_pose, lambda error, message: None)),
            with_covariance=self._options.object_pose_with_covariance)

    def on_unexpected_error(self, error: Exception) -> None:
        """
        Answer the request that it belongs to, if any, and go on.

        :param error: that a callback has raised.
        """
        super().on_unexpected_error(error)
        stamp, self._answering, self._pending = self._answering, None, None
        if stamp is not None:
            self._plans.publish(no_plan_message(PlanFailure.INTERNAL_ERROR, stamp,
                                                self._world_frame))
        self._report(ERROR, f'internal error: {error!r:.200}',
                     {FAILURE: PlanFailure.INTERNAL_ERROR.name})

    def _on_request(self, message: Any) -> None:
        stamp = message.header.stamp
        try:
            request = self._sequences.read(message)
        except MessageRefused as error:
            self._plans.publish(no_plan_message(PlanFailure.INVALID_REQUEST, stamp,
                                                self._world_frame))
            self._report(ERROR, str(error), {FAILURE: PlanFailure.INVALID_REQUEST.name})
            return
        self.get_logger().debug(f'plans to the goal {request.goal}')
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
        plan = self._plan_sequence if self._plans_sequences else self._plan_push
        self._answer(stamp, lambda: plan(request, stamp))

    def _waits(self, request: PlanRequest) -> bool:
        """Report what a request has to wait for, if anything."""
        if not self._plans_sequences:
            missing = self._listen().missing
            if missing:
                self._report(WARN, f'has a goal and waits for {" and ".join(missing)}')
            return bool(missing)
        is_waiting = self._sequences.prepares(request)
        if is_waiting:
            self._report(OK, 'finds out what pushes do to the object; the first time this takes '
                             'a minute or two')
        return is_waiting

    async def _replan(self) -> ServiceAnswer:
        if self._last_request is not None:
            await self.wait_until(lambda: not self.is_active or not self._listen().missing,
                                  WAIT_PERIOD, DISCOVERY_WAIT)
        if not self.is_active:
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
        from push_planner.problem import PlanningFailed
        self._answering = stamp if publishes_failure else None
        try:
            text = plan()
            self._answering = None
            return ServiceAnswer(True, text)
        except MessageRefused as error:
            code, text = PlanFailure.INVALID_VALUE, self._report(ERROR, str(error))
        except PlanningFailed as failure:
            code, text = failure.code, self._report_failure(failure)
        self._answering = None
        if publishes_failure:
            self._plans.publish(no_plan_message(code, stamp, self._world_frame))
        return ServiceAnswer(False, text)

    def _plan_from_measurements(self, request: PlanRequest, stamp: Time) -> str:
        if not self._plans_sequences:
            return self._plan_push(request, stamp)
        measured, odometry = self._measurements()
        return self._plan_sequence(PlanRequest(measured.pose, odometry.pose, request.goal,
                                               request.obj), stamp)

    def _measurements(self) -> tuple[ObjectPose, Odometry]:
        topics = self._listen()
        odometry = from_odometry_message(topics.odom.message, self._world_frame)
        message = self._world.in_world('object_pose', topics.object_pose.message)
        return from_object_pose_message(message, self._world_frame), odometry

    def _plan_push(self, request: PlanRequest, stamp: Time) -> str:
        """Plan one push from the newest measurements, and publish it."""
        from push_planner.single_push.replanning import plan_from_measurements
        self._pending = None
        parameters, (measured, odometry) = self._present_parameters, self._measurements()
        choice = plan_from_measurements(request.obj, parameters.robot, measured, odometry,
                                        request.goal, parameters.planner,
                                        previous=self._former_plan)
        self._former_plan = choice.plan
        return self._publish(choice, odometry.pose, stamp)

    def _plan_sequence(self, request: PlanRequest, stamp: Time) -> str:
        """Plan a sequence of pushes, and publish the first."""
        self._sequences.wait_for_map()
        self._take_map()
        task_plan = self._sequences.plan(request)
        messages = self._sequences.messages(task_plan, stamp)
        self._plans.publish(messages.plan)
        self._paths.publish(messages.path)
        return self._report(OK, *messages.description)

    def _publish(self, choice: 'SiteChoice', robot_pose: Pose, stamp: Time) -> str:
        plan, trajectory = choice.plan, choice.plan.trajectory
        self._plans.publish(to_plan_message(trajectory, stamp, self._world_frame))
        self._paths.publish(to_path_message(trajectory.object_poses.tolist(), stamp,
                                            self._world_frame))
        start = Pose(*trajectory.robot_poses[0].tolist())
        text = (f'has planned a push of {trajectory.duration:.1f} s and '
                f'{trajectory.path_length:.2f} m')
        level = OK
        if distance(start, robot_pose) > self._present_parameters.planner.contact_tolerance:
            level = WARN
            text += f' for a robot at {start.x:.3f} m, {start.y:.3f} m, {start.theta:.3f} rad'
        return self._report(level, text, {
            **plan.report, 'robot_start': start,
            'present_speed': plan.problem.motion.speed, **_one_line_per_site(choice.candidates)})

    def _report(self, level: bytes, text: str, values: Mapping[str, Any] | None = None) -> str:
        """Report, and return the text."""
        self.reporter.report(level, text, values)
        return text

    def _report_failure(self, failure: 'PlanningFailed') -> str:
        values = dict(failure.report)
        sites = values.pop('sites', ())
        return self._report(ERROR, failure.reason, {
            FAILURE: failure.code.name, **values, **_one_line_per_site(sites)})


def _one_line_per_site(sites: Sequence[Any]) -> Mapping[str, Any]:
    return {f'site {number}': site for number, site in enumerate(sites, 1)}


if __name__ == '__main__':
    sys.exit(run(PlannerNode))
