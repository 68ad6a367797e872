"""ROS node of the controller."""

import sys
from typing import Any, Callable, Mapping

from builtin_interfaces.msg import Time
from push_control.goal import GoalOutcome
from push_control.ros.base_check import BaseCheck, BaseFault
from push_control.ros.command_gate import CommandGate
from push_control.ros.commands import CommandPublisher
from push_control.ros.goal_entry import GoalEntry
from push_control.ros.measurements import LatestMeasurements, OdometryState
from push_control.ros.mode import ControllerParameters, Mode
from push_control.ros.objects.catalogue import ObjectCatalogue
from push_control.ros.other_commanders import OtherCommanders
from push_control.ros.push_action import GoalReceiver, ObjectSelector, PushActionServer
from push_control.ros.scene import ScenePublisher
from push_control.settings import ControlSettings
from push_control.task.settings import SupervisionSettings
from push_model.files.flat_values import parameter_specs
from push_model.parameters import PushedObject, RoundRobot
from push_model.signals import ObjectPose, Odometry, STOP
from push_navigation.settings import DriveSettings, MapSettings
from push_ros.conversions.measurements import from_object_pose_message, from_odometry_message
from push_ros.conversions.primitives import MessageRefused
from push_ros.diagnostics import ERROR, OK, WARN
from push_ros.executor import run
from push_ros.lifecycle import ManagedNode
from push_ros.node import ServiceAnswer
from push_ros.node_settings import BaseSettings, ControllerOptions, Frames
from push_ros.parameters import DYNAMIC, IDLE
from push_ros.push_interfaces import ACTION, import_push_interfaces
from push_ros.topics import CONTROLLER
from push_ros.transforms.world import Handlers, WorldFrame
from rclpy.clock import Clock
from rclpy.clock_type import ClockType

SECTIONS = (('object.', PushedObject), ('robot.', RoundRobot), ('control.', ControlSettings),
            ('drive.', DriveSettings), ('supervision.', SupervisionSettings),
            ('map.', MapSettings), ('base.', BaseSettings), ('', Frames),
            ('', ControllerOptions))
DYNAMIC_GROUPS = ('control.', 'drive.', 'supervision.')
# What the filter of robot and object is made with, and what was learned is kept with.
FILTER_PARAMETERS = {
    'control.pose_noise', 'control.heading_noise', 'control.heading_count',
    'supervision.motion_gate_sigmas',
    'supervision.max_averaging_time', 'supervision.odometry_reference',
    'supervision.odometry_scale', 'supervision.odometry_drift', 'supervision.odometry_walk',
    'supervision.odometry_heading_walk', 'supervision.center_walk',
    'supervision.contact_friction_walk'}
OBJECT_PREFIX, OBJECT_NAME = 'object.', 'object_name'
OBJECT_PARAMETERS = {OBJECT_NAME, *(spec.name for spec in parameter_specs(PushedObject,
                                                                          OBJECT_PREFIX))}
SETTABLE = {**{spec.name: DYNAMIC for prefix, cls in SECTIONS if prefix in DYNAMIC_GROUPS
               for spec in parameter_specs(cls, prefix) if spec.name not in FILTER_PARAMETERS},
            **dict.fromkeys(OBJECT_PARAMETERS, IDLE)}
# Period at which missing odometry is looked for [s]; chosen: a fifth of the default time-out.
WATCHDOG_PERIOD = 0.05


class ControllerNode(ManagedNode):
    """
    Answers measurements with commands while it pursues a goal.

    With ``task`` false it requests one plan for each ``goal_pose``, and follows it. A plan that
    starts at the push under way replaces it without a stop; any other starts from rest, and only
    where the robot stands at its start. A plan that is refused stops the push. Where a push has
    left its path, another plan is requested.

    With ``task`` true it brings the object to ``goal_pose`` with as many pushes as that takes, and
    requests a plan for each.

    The command is zero for a measurement that is refused (not finite, in a frame without a
    transform to ``world_frame``) or stale, and where odometry stops for ``watchdog_timeout`` on
    the node's clock. When the goal is reached or abandoned, at the end of the node and when it is
    deactivated some zeros follow, then nothing is published. With ``lockstep`` every measurement
    is answered, with its stamp, and in a task not until a requested plan is there.

    Publishers
        ``cmd_vel`` (TwistStamped, or Twist), in ``base_frame``; ``push_request`` (JointTrajectory,
        latched), in ``world_frame``; ``/diagnostics`` (DiagnosticArray); ``markers``
        (MarkerArray); ``plan_markers`` (MarkerArray, latched); ``footprint`` (PolygonStamped), in
        ``base_frame``; with ``publish_tf`` the transform from ``world_frame`` to ``object_frame``
        on ``/tf``, where tf2_msgs is installed.

    Subscribers, while active
        ``odom`` (Odometry) and ``object_pose`` (PoseStamped, or PoseWithCovarianceStamped), best
        effort; ``push_plan`` (MultiDOFJointTrajectory, latched); ``goal_pose`` (PoseStamped);
        ``map`` (OccupancyGrid, latched); ``/tf`` and ``/tf_static`` (TFMessage) as soon as one of
        these comes in another frame; ``cmd_vel`` while somebody else publishes it.

    Action, where ``push_control_msgs`` is installed
        ``push_object`` (PushObject), with the topic ``push_status`` (PushStatus, latched).

    Services
        ``controller/start``, ``controller/stop``, ``controller/pause``, ``controller/resume``
        (Trigger), and those of the lifecycle.

    ROS parameters
        ``object.*`` and ``robot.*``, nominal; ``control.*``; ``drive.*`` and ``supervision.*`` of
        a task; ``map.*``, how maps are read; ``base.*``, what the base's own node must be set to;
        ``world_frame``,
        ``object_frame``, ``base_frame``; and those of ``ControllerOptions``. ``SETTABLE`` says
        which may be set, and when: those of the object and its name while no goal is pursued.

    Frames
        Poses are brought to ``world_frame`` at their stamps, goals and maps again where their
        frame drifts; odometry is in it. Commands are in ``base_frame``.
    """

    _mode: Mode
    _goals: GoalEntry
    _commands: CommandPublisher
    _gate: CommandGate
    _others: OtherCommanders
    _scene: ScenePublisher
    _base: BaseCheck
    _action: PushActionServer | None = None

    def __init__(self) -> None:
        super().__init__(CONTROLLER, SECTIONS, SETTABLE)
        *_, self._map_settings, self._base_settings, self._frames, self._options = self.settings
        self._catalogue = ObjectCatalogue(self._options.object_folder)
        self._catalogue.remember(*self._present_object)
        self._object = self._present_object
        self._world = WorldFrame(self, self._frames.world_frame, self._options.transform_timeout)
        self._latest = LatestMeasurements()
        # Stamps of measurements that wait for a plan.
        self._unanswered: list[Time] = []
        self.serve_active_trigger('controller/start', self._start)
        self.serve_active_trigger('controller/stop', self._stop)
        self.serve_active_trigger('controller/pause', lambda: self._change(self._mode.pause))
        self.serve_active_trigger('controller/resume', lambda: self._change(self._mode.resume))

    @property
    def is_autostarted(self) -> bool:
        """Whether the node configures and activates itself."""
        return self._options.autostart

    @property
    def goals(self) -> GoalEntry:
        """The ``GoalEntry``, from configuring on."""
        return self._goals

    def configure(self) -> None:
        """
        Make the mode, which reads what was learned of the object.

        :raises ValueError: where ``knowledge_file`` cannot be read, or there is no
            ``object_folder``.
        """
        self._catalogue.check_folder()
        parameters = self._present_parameters
        self._scene = ScenePublisher(self, parameters.object, parameters.robot, self._frames,
                                     self._options)
        self._mode = self._make_mode(parameters)
        self._goals = GoalEntry(self, self._mode, self._frames.world_frame,
                                is_lockstep=self._options.lockstep)
        self._others = OtherCommanders(self, stamped=self._options.enable_stamped_cmd_vel)
        self._commands = CommandPublisher(self, self._frames.base_frame, self._options,
                                          self._others)
        self._base = BaseCheck(self, self._base_settings)
        self._gate = CommandGate(self, self._mode, parameters, self._options, self._others)
        self._action = self._make_action()

    def activate(self) -> None:
        """Subscribe, and wait for a goal."""
        self.subscribe('odom', self._on_odometry, real_time=True)
        self.subscribe('object_pose', self._world.receiver('object_pose', Handlers(
            self._on_object_pose, self._refuse_measurement)), real_time=True,
            with_covariance=self._options.object_pose_with_covariance,
            frame=self._frames.world_frame)
        self.subscribe('push_plan', self._on_plan, real_time=True)
        self.subscribe('goal_pose', self._world.receiver('goal_pose', Handlers(
            self._on_goal, self._refuse, self._goals.move)))
        self.subscribe('map', self._world.receiver('map', Handlers(
            lambda message: self._handle(self._mode.on_map, message), self._refuse_map,
            self._mode.move_map, is_latched=True)))
        # Simulated time may stand still: whoever published it may have died.
        self._timer = self.create_timer(WATCHDOG_PERIOD, self.guarded(self._check_odometry),
                                        clock=Clock(clock_type=ClockType.STEADY_TIME))
        self.reporter.report(OK, 'waits for a goal')
        self._base.run(self._report_base)

    def deactivate(self) -> None:
        """Stop the robot, and forget the goal."""
        self.destroy_timer(self._timer)
        self._base.interrupt('the controller was deactivated')
        self._commands.flush()
        self._goals.interrupt(GoalOutcome.INTERRUPTED, 'the controller was deactivated')
        self._mode.cancel('the controller was deactivated')
        self._forget_measurements()

    def clean_up(self) -> None:
        """Forget what was learned of the object, but for what is in its file."""
        if self._action is not None:
            self._action.destroy()
        self._scene.destroy()
        self._base.destroy()
        self._others.destroy()
        del self._mode, self._goals, self._commands, self._gate, self._others
        del self._action, self._scene, self._base

    def further_parameters(self, values: Mapping[str, Any]) -> Mapping[str, Any]:
        """
        Find the parameters of the object whose name is set.

        :param values: parameters that are being set, by name.
        :return: further ones by name.
        """
        if not _names_object_only(values):
            return {}
        try:
            obj = self._catalogue.find(values[OBJECT_NAME])
        except ValueError:
            # ``parameter_refusal`` reports it.
            return {}
        return self.parameters.section_values(OBJECT_PREFIX, obj)

    def parameter_refusal(self, values: Mapping[str, Any]) -> str:
        """
        Find out why the object cannot be changed.

        :param values: parameters that are being set, by name.
        :return: one sentence; empty where it can.
        """
        names = sorted(OBJECT_PARAMETERS.intersection(values))
        if names and hasattr(self, '_goals') and not self._goals.is_idle:
            return (f'{names[0]}: got another value while a goal is pursued, expected it before '
                    'or after')
        if _names_object_only(values):
            try:
                self._catalogue.find(values[OBJECT_NAME])
            except ValueError as error:
                return str(error)
        return ''

    def on_settings_changed(self) -> None:
        """Let movements use other settings from the next one on, or turn to another object."""
        *_, self._options = self.settings
        former, self._object = self._object, self._present_object
        if self._object != former:
            self._catalogue.remember(*self._object)
        if not hasattr(self, '_mode'):
            return
        if self._object == former:
            self._mode.set_parameters(self._present_parameters)
        else:
            self._turn_to_object()

    def _make_mode(self, parameters: ControllerParameters) -> Mode:
        # Imported here: either takes a while, and one is enough.
        given = self, parameters, self._frames.world_frame, self._options, self._scene
        if self._options.task:
            from push_control.ros.task import TaskMode
            return TaskMode(*given, map_settings=self._map_settings)
        from push_control.ros.single_push import SinglePushMode
        return SinglePushMode(*given)

    def _make_action(self) -> PushActionServer | None:
        interfaces = import_push_interfaces()
        if interfaces is None:
            self.get_logger().info(f'push_control_msgs is not installed: no action {ACTION}; '
                                   'goals come on goal_pose')
            return None
        action = PushActionServer(self, self._goals, interfaces, self._receive_goal,
                                  is_active=lambda: self.is_active, check_base=self._base.run,
                                  objects=ObjectSelector(self._catalogue.find, self._use_object))
        action.set_object(*self._present_object)
        return action

    def _report_base(self, fault: BaseFault | None) -> None:
        if fault is not None and not fault.is_interrupted:
            self.reporter.report(ERROR, f'the base is not ready to push: {fault.reason}')

    def _on_goal(self, message: Any) -> None:
        """Begin with a goal from a topic, once the base is ready for it."""
        def begin(fault: BaseFault | None) -> None:
            self._report_base(fault)
            if fault is None:
                self._handle(self._goals.on_message, message)
        self._base.run(begin)

    def _receive_goal(self, name: str, message: Any, receiver: GoalReceiver) -> None:
        """Hand on a goal pose in the world frame."""
        self._world.receive(name, message, Handlers(receiver.accept, receiver.refuse,
                                                    self._goals.move))

    @property
    def _present_object(self) -> tuple[str, PushedObject]:
        obj, *_, options = self.settings
        return options.object_name, obj

    def _use_object(self, name: str, obj: PushedObject) -> None:
        """Set the parameters of another object."""
        self.parameters.assign({OBJECT_NAME: name,
                                **self.parameters.section_values(OBJECT_PREFIX, obj)})

    def _turn_to_object(self) -> None:
        """Push another object from now on; its pose has not come yet."""
        name, obj = self._object
        self._mode.set_object(self._present_parameters)
        self._gate.set_object(obj)
        self._scene.set_object(obj)
        self._latest.object_pose = None
        if self._action is not None:
            self._action.set_object(name, obj)
        self.reporter.report(OK, f'turns to the object {name!r}' if name
                             else 'turns to the object of the parameters')

    @property
    def _present_parameters(self) -> ControllerParameters:
        *sections, _, _, _, _ = self.settings
        return ControllerParameters(*sections)

    def _on_odometry(self, message: Any) -> None:
        self._world.take()
        self._on_measurement(message, from_odometry_message)

    def _on_object_pose(self, message: Any) -> None:
        self._on_measurement(message, from_object_pose_message)

    def _on_measurement(self, message: Any,
                        convert: Callable[[Any, str], Odometry | ObjectPose]) -> None:
        """Answer a measurement with a command."""
        stamp = message.header.stamp
        try:
            measured = convert(message, self._frames.world_frame)
            if self._gate.accept(measured, message):
                self._start_over(WARN, 'time went back')
        except MessageRefused as error:
            self._refuse_measurement(error, message)
            return
        dt = self._latest.add(measured)
        self._goals.update(self._latest.time)
        observation = self._latest.observation
        command = STOP if observation is None else self._gate.step(observation, dt)
        if self._options.lockstep and self._mode.awaits_plan:
            self._unanswered.append(stamp)
        else:
            self._answer_waiting()
            self._commands.answer(command, stamp, is_commanding=self._gate.is_commanding)
        self._mode.report(stamp, self._latest.time)
        if self._action is not None:
            self._action.update(self._latest.time)

    def _refuse_measurement(self, error: MessageRefused, message: Any) -> None:
        """Stop the robot, and say why."""
        self._commands.answer(STOP, message.header.stamp,
                              is_commanding=self._gate.is_commanding)
        self._mode.report_again()
        self.reporter.report(ERROR, f'{error}; stopped')

    def _refuse(self, error: MessageRefused, message: Any) -> None:
        """Report a goal or a map that cannot be used; the former one stays."""
        self.reporter.report(ERROR, str(error))
        self._follow_up()

    def _refuse_map(self, error: MessageRefused, message: Any) -> None:
        """Report a map that cannot be used, without which there is no task."""
        self._mode.refuse_map(str(error))
        self._refuse(error, message)

    def _answer_waiting(self) -> None:
        """Answer the measurements that waited for a plan, once it is there: the robot stood."""
        if not self._mode.awaits_plan:
            for stamp in self._unanswered:
                self._commands.answer(STOP, stamp, is_commanding=True)
            self._unanswered = []

    def _on_plan(self, message: Any) -> None:
        self._handle(self._mode.on_plan, message, self._mode.stops_on_refused_plan)

    def _handle(self, handler: Callable[[Any], None], message: Any,
                stops_on_refusal: bool = False) -> None:
        """Hand a message to the mode, and report where it is refused."""
        try:
            handler(message)
        except MessageRefused as error:
            text = str(error)
            if stops_on_refusal:
                self._commands.stop()
                text = f'{error}; stopped'
            self.reporter.report(ERROR, text)
        self._follow_up()

    def _follow_up(self) -> None:
        """Answer and report what a message or a service has changed."""
        self._answer_waiting()
        if self._mode.reports_events:
            self._mode.report(self.now(), self._latest.time)

    def _start(self) -> ServiceAnswer:
        received = {'odom': self._latest.odometry is not None,
                    'object_pose': self._latest.object_pose is not None,
                    self._mode.required_topic: self._mode.is_set}
        missing = [name for name, is_there in received.items() if not is_there]
        if missing:
            return ServiceAnswer(False, f'has received no {" and no ".join(missing)} yet')
        self._mode.start()
        self._follow_up()
        return ServiceAnswer(True, 'started')

    def _stop(self) -> ServiceAnswer:
        self._base.interrupt('stopped')
        self._mode.stop()
        self._commands.stop()
        self._goals.interrupt(GoalOutcome.CANCELLED, 'stopped')
        self._follow_up()
        return ServiceAnswer(True, 'stopped')

    def _change(self, action: Callable[[], ServiceAnswer]) -> ServiceAnswer:
        answer = action()
        self._follow_up()
        return answer

    def on_unexpected_error(self, error: Exception) -> None:
        """
        Stop the robot, and forget everything measured.

        :param error: that a callback has raised.
        """
        super().on_unexpected_error(error)
        if self.is_active:
            self._commands.flush()
            self._start_over(ERROR, f'internal error: {error!r:.200}')

    def _start_over(self, level: bytes, reason: str) -> None:
        """Forget everything measured, as for a simulator that was reset; keep the goal."""
        self._goals.interrupt(GoalOutcome.INTERRUPTED, reason)
        self._forget_measurements()
        self._mode.interrupt(reason)
        self.reporter.report(level, f'stopped: {reason}; waits for a goal, or controller/start')

    def _forget_measurements(self) -> None:
        self._mode.reset()
        self._world.reset()
        self._latest = LatestMeasurements()
        self._gate.reset()
        self._unanswered = []

    def _check_odometry(self) -> None:
        """Stop the robot where odometry has stopped, and publish zeros that are left."""
        # What has come already is not missing, however late this node gets round to it.
        self.poll()
        check = self._gate.check_odometry()
        is_missing = check.state is not OdometryState.PRESENT
        if not self._mode.is_commanding or is_missing:
            self._commands.stop()
        if self._mode.is_commanding and is_missing:
            self._mode.report_again()
            if check.is_news:
                level = ERROR if check.state is OdometryState.LOST else WARN
                self.reporter.report(level, f'no odometry for {check.age:.2f} s; stopped')
        # Before the first odometry, too; in lockstep time waits for it.
        is_lost = check.state is OdometryState.LOST or self._latest.odometry is None
        if is_lost and not self._options.lockstep:
            self._goals.on_odometry_lost()


def _names_object_only(values: Mapping[str, Any]) -> bool:
    """Tell whether an object is named, and none of its parameters given with it."""
    # What is no text is refused for that.
    return (isinstance(values.get(OBJECT_NAME), str)
            and not any(name.startswith(OBJECT_PREFIX) for name in values))


if __name__ == '__main__':
    sys.exit(run(ControllerNode))
