"""
The controller between configuring and cleaning up: from a measurement to a command.

Each measurement is received, its stamp is checked, the supervisor decides on a command, the safety
layer guards it, and it is sent.
"""

from typing import Any, Callable

from builtin_interfaces.msg import Time
from push_control.events import TaskEvent
from push_control.goal import GoalOutcome
from push_control.ros.base_check import BaseCheck, BaseFault
from push_control.ros.command_gate import AnyMeasurement, CommandGate
from push_control.ros.commands import CommandPublisher
from push_control.ros.exclusion_zones import ExclusionZones
from push_control.ros.goal_entry import GoalEntry
from push_control.ros.measurements import LatestMeasurements, OdometryState
from push_control.ros.other_commanders import OtherCommanders
from push_control.ros.parameters import ControllerParameters, OBJECT_NAME, OBJECT_PREFIX
from push_control.ros.push_action import GoalReceiver, ObjectSelector, PushActionServer
from push_control.ros.robot_placing import RobotPlacing
from push_control.ros.scene import ScenePublisher
from push_control.ros.start_state import StartState
from push_model.events import AnyReport, EventReport, PushEvent
from push_model.parameters import PushedObject
from push_model.signals import ObjectPose, Odometry, STOP, Twist
from push_ros.conversions.map import map_reader
from push_ros.conversions.measurements import (
    from_object_pose_message, from_odometry_message, from_relative_pose_message,
)
from push_ros.conversions.primitives import MessageRefused, seconds
from push_ros.diagnostics import ERROR, OK, WARN
from push_ros.lifecycle import ManagedNode
from push_ros.node import ServiceAnswer
from push_ros.object_catalogue import ObjectCatalogue
from push_ros.push_interfaces import ACTION, import_push_interfaces
from push_ros.qos import QUEUE_DEPTH
from push_ros.topic_watch import TopicWatch
from push_ros.transforms.world import Handlers, WorldFrame
from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.timer import Timer

# Period at which missing odometry is looked for [s]; chosen: a fifth of the default time-out.
WATCHDOG_PERIOD = 0.05
DEACTIVATED = TaskEvent.DEACTIVATED.report()


class ActiveController:
    """
    Answers measurements with commands while it pursues a goal.

    ``pursuit``: the ``GoalPursuit``. ``goals``: the ``GoalEntry``.
    """

    def __init__(self, node: ManagedNode, parameters: ControllerParameters, world: WorldFrame,
                 catalogue: ObjectCatalogue) -> None:
        """
        Make the pursuit of goals, which reads what was learned of the object.

        :param catalogue: ``ObjectCatalogue`` of the objects that goals may name.
        :raises ValueError: where ``knowledge_file`` cannot be read, or the collision monitor
            cannot be asked to ignore the object.
        """
        # Imported here: it takes a while, and the node reports before.
        from push_control.ros.pursuit import GoalPursuit
        options, frames = parameters.options, parameters.frames
        self._node = node
        self._reporter = node.reporter
        self._parameters = parameters
        self._world = world
        self._catalogue = catalogue
        self._scene = ScenePublisher(node, parameters)
        self._placing = RobotPlacing(parameters, world)
        self.pursuit = GoalPursuit(node, parameters, self._scene, self._placing)
        self.goals = GoalEntry(node, self.pursuit, frames.world_frame,
                               is_lockstep=options.lockstep)
        self._others = OtherCommanders(node, stamped=options.enable_stamped_cmd_vel)
        self._commands = CommandPublisher(node, frames.base_frame, options, self._others)
        self._base = BaseCheck(node, parameters.base)
        self._gate = CommandGate(node, parameters, self._others)
        self._zones = ExclusionZones(node, parameters.collision_monitor, frames.object_frame,
                                     self._object_to_hide)
        self._action = self._make_action(catalogue)
        self._latest = LatestMeasurements()
        # Why a measurement was refused since the last odometry, or None.
        self._refusal: EventReport | None = None
        # Stamps of measurements that wait for a plan.
        self._unanswered: list[Time] = []
        # While the node is active.
        self._timer: Timer | None = None
        self._topics: TopicWatch | None = None

    def _make_action(self, catalogue: ObjectCatalogue) -> PushActionServer | None:
        node = self._node
        interfaces = import_push_interfaces()
        if interfaces is None:
            node.get_logger().info(f'push_control_msgs is not installed: no action {ACTION}; '
                                   'goals come on goal_pose')
            return None
        action = PushActionServer(node, self.goals, interfaces, self._receive_goal,
                                  is_active=lambda: node.is_active, check_base=self._base.run,
                                  objects=ObjectSelector(catalogue.find, self._use_object))
        action.set_object(self._parameters.named_object[0])
        return action

    # The lifecycle.

    def activate(self) -> None:
        """Subscribe, and wait for a goal."""
        node, world, frames = self._node, self._world, self._parameters.frames
        # Messages are taken in this order: a touch counts with the odometry of its time.
        node.subscribe('bumper', self.on_bumper, real_time=True)
        node.subscribe('odom', self.on_odometry, real_time=True)
        for name in [entry.name for entry in self._parameters.options.objects] or ['']:
            node.subscribe(
                'object_pose', self._pose_receiver(name), real_time=True, object_name=name,
                with_covariance=self._parameters.options.object_pose_with_covariance,
                frame=frames.world_frame)
        self._subscribe_place()
        node.subscribe('push_plan', self.on_plan, real_time=True)
        node.subscribe('goal_pose', world.receiver('goal_pose', Handlers(
            self._on_goal, self._refuse_goal, self.goals.move, is_offer=True)))
        node.subscribe('map', world.receiver('map', Handlers(
            lambda message: self._handle(self.pursuit.on_map, message), self._refuse_map,
            self.pursuit.move_map, is_latched=True)), read=map_reader(self._parameters.map))
        # Simulated time may stand still: whoever published it may have died.
        self._timer = node.create_timer(WATCHDOG_PERIOD, node.guarded(self._check_odometry),
                                        clock=Clock(clock_type=ClockType.STEADY_TIME))
        if self.pursuit.start_state is StartState.STOPPED:
            self._reporter.report(WARN, str(TaskEvent.STOPPED_BY_USER.report()))
        else:
            self._reporter.report(OK, 'waits for a goal')
        self._topics = TopicWatch(node, self._awaited_topics)
        self._report_status()
        self._base.run(self._report_base)

    def _pose_receiver(self, name: str) -> Callable[[Any], None]:
        """
        Make what receives the poses of an object; where others are, scans have to know at most.

        :param name: of one of several objects; empty where there is but one.
        """
        topic = f'object_pose of {name}' if name else 'object_pose'
        receive = self._world.receiver(topic, Handlers(
            self.on_object_pose, self._refuse_measurement,
            accept_relative=self.on_relative_pose))
        note = self._standing_receiver(topic, name) if self._placing.sees_objects else None

        def receive_named(message: Any) -> None:
            if name == self._parameters.named_object[0]:
                receive(message)
            elif note is not None:
                note(message)
        return receive_named if name else receive

    def _standing_receiver(self, topic: str, name: str) -> Callable[[Any], None] | None:
        """Make what receives the poses of an object that is not pushed; None of an unknown one."""
        try:
            obj = self._catalogue.find(name)
        except ValueError as error:
            self._node.get_logger().warning(f'scans take {name!r} for walls: {error}')
            return None

        def note(message: Any) -> None:
            pose = from_object_pose_message(
                message, self._parameters.frames.world_frame, topic).pose
            self._placing.note_standing(name, obj, pose)
        return self._world.receiver(topic, Handlers(
            lambda message: self._handle(note, message),
            lambda error, _: self._reporter.report(ERROR, str(error))))

    def _subscribe_place(self) -> None:
        """Subscribe to what measures the place of the robot in the map, if anything does."""
        node, world, source = self._node, self._world, self._parameters.place.source
        if source == 'scan':
            node.subscribe('scan', self.on_scan, real_time=True)
        elif source == 'place':
            node.subscribe('place', world.receiver('place', Handlers(
                self.on_place, self._refuse_measurement)), real_time=True,
                frame=self._parameters.frames.world_frame)

    def deactivate(self) -> None:
        """Stop the robot, and forget the goal."""
        if self._timer is not None:
            self._node.destroy_timer(self._timer)
        if self._topics is not None:
            self._topics.destroy()
        self._base.interrupt(str(DEACTIVATED))
        self._commands.flush()
        self.goals.interrupt(GoalOutcome.INTERRUPTED, DEACTIVATED)
        self.pursuit.cancel(DEACTIVATED)
        self._forget_measurements()
        self._zones.remove()

    def destroy(self) -> None:
        """Forget what was learned of the object, but for what is in its file."""
        if self._action is not None:
            self._action.destroy()
        self._scene.destroy()
        self._zones.destroy()
        self._base.destroy()
        self._others.destroy()

    # From a measurement to a command.

    def on_odometry(self, message: Any) -> None:
        """
        Answer odometry.

        :param message: ``nav_msgs/Odometry``, or values with its attributes.
        """
        self._world.take()
        self._on_measurement(message, from_odometry_message)

    def on_object_pose(self, message: Any) -> None:
        """
        Answer an object pose.

        :param message: ``geometry_msgs/PoseStamped`` or ``PoseWithCovarianceStamped`` in the world
            frame, or values with their attributes.
        """
        self._on_measurement(message, from_object_pose_message)

    def on_relative_pose(self, message: Any) -> None:
        """
        Answer an object pose that is relative to the robot.

        :param message: as of ``on_object_pose``, in the base frame.
        """
        base_frame = self._parameters.frames.base_frame
        self._on_measurement(
            message, lambda relative, _: from_relative_pose_message(relative, base_frame))

    def on_bumper(self, message: Any) -> None:
        """
        Note whether the bumper is pressed; the next odometry is answered with that.

        :param message: ``std_msgs/Bool``.
        """
        self._latest.add_bumper(message.data)

    def on_scan(self, message: Any) -> None:
        """
        Answer a scan of the lidar.

        :param message: ``sensor_msgs/LaserScan``.
        """
        self._world.take()
        self._on_measurement(message, lambda scan, _: self._placing.read_scan(scan))

    def on_place(self, message: Any) -> None:
        """
        Answer a place of the robot in the map.

        :param message: ``geometry_msgs/PoseWithCovarianceStamped`` in the world frame, or values
            with its attributes.
        """
        self._on_measurement(message, lambda place, _: self._placing.read_place(place))

    def _on_measurement(self, message: Any,
                        receive: Callable[[Any, str], AnyMeasurement]) -> None:
        """Receive, check, decide, guard, send."""
        try:
            measured = receive(message, self._parameters.frames.world_frame)
            has_gap = self._check(measured, message)
        except MessageRefused as error:
            self._refuse_measurement(error, message)
            return
        command = self._decide_guarded(measured, has_gap=has_gap)
        self._send(command, message.header.stamp)
        self._report()

    def _check(self, measured: AnyMeasurement, message: Any) -> bool:
        """
        Refuse a stamp that is off; start over where time went back, go on where it went ahead.

        :return: whether nothing had come for long, so that the robot was stopped.
        """
        news = self._gate.check(measured, message)
        if news.has_gap:
            # What was sent meanwhile may be lost.
            self.pursuit.renew_request()
        if news.went_back:
            self._start_over(WARN, TaskEvent.TIME_WENT_BACK.report())
        if news.ahead:
            for each in (self._latest, self.goals, self.pursuit):
                each.on_time_ahead(news.ahead)
        return news.has_gap

    def _decide_guarded(self, measured: AnyMeasurement, *, has_gap: bool) -> Twist:
        """
        Let the pursuit decide between the two sides of the guard.

        :param has_gap: as of ``_check``.
        """
        dt = 0.0
        if isinstance(measured, (Odometry, ObjectPose)):
            dt = self._latest.add(measured)
        if has_gap:
            # The robot has driven for no longer.
            dt = min(dt, self._parameters.options.watchdog_timeout)
        self._placing.update(measured, self._latest.object_pose)
        self.goals.update(self._latest.time)
        observation = self._latest.observation
        if observation is None:
            return STOP
        protection = self._placing.protection(observation.odometry)
        self._gate.limit_speed(protection.speed_limit)
        self.pursuit.protect(protection.report)
        command = self._gate.guard(self.pursuit, observation._replace(
            place=self._placing.newest, refusal=self._refusal), dt)
        if isinstance(measured, Odometry):
            self._refusal = None
        return command

    def _send(self, command: Twist, stamp: Time) -> None:
        """Send a command; in lockstep not before the plan that a measurement waits for."""
        if self._parameters.options.lockstep and self.pursuit.awaits_plan:
            self._unanswered.append(stamp)
            return
        self._answer_waiting()
        self._commands.answer(command, stamp, is_commanding=self._is_commanding)

    def _report(self) -> None:
        self.pursuit.report(self._latest.time)
        self._report_status()

    @property
    def _is_commanding(self) -> bool:
        """Tell whether this node commands the base (a stop counts), yielding to nobody."""
        return self.pursuit.is_commanding and not self._gate.yields

    def _answer_waiting(self) -> None:
        """Answer the measurements that waited for a plan, once it is there: the robot stood."""
        if not self.pursuit.awaits_plan:
            for stamp in self._unanswered:
                self._commands.answer(STOP, stamp, is_commanding=True)
            self._unanswered = []

    def refuse_unreadable(self, reason: str) -> None:
        """
        Stop the robot for a measurement that cannot be read, as for one that is refused.

        :param reason: one sentence.
        """
        self._commands.stop()
        self._note_refusal(reason)

    def _refuse_measurement(self, error: MessageRefused, message: Any) -> None:
        """Stop the robot, which goes on with good measurements, and say why."""
        self._commands.answer(STOP, message.header.stamp, is_commanding=self._is_commanding)
        self._note_refusal(error)

    def _note_refusal(self, error: MessageRefused | str) -> None:
        self._refusal = PushEvent.MEASUREMENT_REFUSED.report(error=error)
        self.pursuit.report_again()
        self._reporter.report(ERROR, f'{error}; stopped')

    # Plans, goals and maps.

    def on_plan(self, message: Any) -> None:
        """Hand on a plan; the robot stops where it is refused."""
        self._handle(self.pursuit.on_plan, message, stops_on_refusal=True)

    def _on_goal(self, message: Any, follow: Callable[[], None]) -> None:
        """Start with a goal from a topic, once the base is ready for it."""
        def start(fault: BaseFault | None) -> None:
            self._report_base(fault)
            if fault is None:
                self._catch_up()
                try:
                    self.goals.on_message(message, follow)
                except MessageRefused as error:
                    self._refuse_goal(error, message)
                self._follow_up()
        self._base.run(start)

    def _catch_up(self) -> None:
        """Take in the measurements that have come already: they are from before the goal."""
        # In lockstep goals hold from the time of their stamps on.
        for _ in range(0 if self._parameters.options.lockstep else QUEUE_DEPTH):
            if not self._node.poll():
                break

    def _receive_goal(self, name: str, message: Any, receiver: GoalReceiver) -> None:
        """Hand on a goal pose in the world frame."""
        self._catch_up()
        self._world.receive(name, message, Handlers(receiver.accept, receiver.refuse,
                                                    self.goals.move, is_offer=True))

    def _refuse_goal(self, error: MessageRefused, message: Any) -> None:
        """Report a goal that cannot be used; the previous one stays."""
        self._reporter.report(ERROR, str(error))
        if self.goals.is_idle:
            self.pursuit.note_refused_goal(TaskEvent.GOAL_REFUSED.report(error=error))
        self._follow_up()

    def _refuse_map(self, error: MessageRefused, message: Any) -> None:
        """Report a map that cannot be used, without which there is no task."""
        self.pursuit.refuse_map(str(error))
        self._reporter.report(ERROR, str(error))
        self._follow_up()

    def _handle(self, handler: Callable[[Any], None], message: Any,
                stops_on_refusal: bool = False) -> None:
        """Hand on a message, and report where it is refused."""
        try:
            handler(message)
        except MessageRefused as error:
            text = str(error)
            if stops_on_refusal:
                self._commands.stop()
                text = f'{error}; stopped'
            self._reporter.report(ERROR, text)
        self._follow_up()

    def _follow_up(self) -> None:
        """Answer and report what a message or a service has changed."""
        self._answer_waiting()
        self.pursuit.report(self._latest.time)

    # Services.

    def start(self) -> ServiceAnswer:
        """Start, or lift a stop."""
        missing = [*self._missing_topics, *filter(None, [self.pursuit.missing_input])]
        is_stopped = self.pursuit.start_state is StartState.STOPPED
        if missing and not is_stopped:
            return ServiceAnswer(False, f'has received no {" and no ".join(missing)} yet')
        has_goal = self.pursuit.is_set
        self.pursuit.start()
        self._follow_up()
        if not is_stopped:
            return ServiceAnswer(True, 'started')
        if not has_goal:
            return ServiceAnswer(True, 'the stop is lifted; waits for a goal')
        return ServiceAnswer(True, 'the stop is lifted; goes on to the goal of before')

    @property
    def _missing_topics(self) -> list[str]:
        """Topics without which no task begins: an object that is out of view is looked for."""
        is_limited = self._parameters.supervision.has_limited_view
        return [topic for topic in self._latest.missing
                if not (is_limited and topic == 'object_pose')]

    def stop(self) -> ServiceAnswer:
        """Stop the robot, and refuse goals until ``start``."""
        cause = TaskEvent.STOPPED_BY_USER.report()
        self._base.interrupt(str(cause))
        self.pursuit.stop()
        self._commands.stop()
        self.goals.interrupt(GoalOutcome.CANCELLED, cause)
        self._follow_up()
        return ServiceAnswer(True, 'stopped: goals are refused until controller/start')

    def pause(self) -> ServiceAnswer:
        """Stand until ``resume``."""
        answer = self.pursuit.pause()
        self._follow_up()
        return answer

    def resume(self) -> ServiceAnswer:
        """Go on after a pause, or after a stop of the base."""
        answer = self.pursuit.resume()
        self._follow_up()
        return answer

    # Parameters and objects.

    def set_parameters(self, parameters: ControllerParameters) -> None:
        """
        Let movements use other settings from the next one on, or turn to another object.

        :param parameters: ``ControllerParameters``, with the robot of before.
        """
        previous, self._parameters = self._parameters, parameters
        self._gate.set_settings(parameters.control)
        if parameters.named_object == previous.named_object:
            self.pursuit.set_parameters(parameters)
        else:
            self._turn_to_object()

    def _use_object(self, name: str, obj: PushedObject) -> None:
        """Set the parameters of another object."""
        parameters = self._node.parameters
        parameters.assign({OBJECT_NAME: name, **parameters.section_values(OBJECT_PREFIX, obj)})

    def _turn_to_object(self) -> None:
        """Push another object from now on; its pose has not come yet."""
        name, obj = self._parameters.named_object
        self.pursuit.set_object(self._parameters)
        self._gate.set_object(obj)
        self._placing.set_object(name, obj)
        self._scene.set_object(obj)
        self._latest.forget_object()
        if self._action is not None:
            self._action.set_object(name)
        self._reporter.report(OK, f'turns to the object {name!r}' if name
                              else 'turns to the object of the parameters')

    def _object_to_hide(self) -> PushedObject | None:
        """Return the object while a goal is pursued, for the collision monitor to ignore."""
        is_idle = not self._node.is_active or self.goals.is_idle
        return None if is_idle else self._parameters.object

    # What goes wrong, and what is awaited.

    def recover(self, error: Exception) -> None:
        """
        Stop the robot, and forget everything measured.

        :param error: that a callback has raised.
        """
        self._commands.flush()
        self._start_over(ERROR, TaskEvent.INTERNAL_ERROR.report(error=error))

    def _start_over(self, level: bytes, cause: AnyReport) -> None:
        """Forget everything measured, as for a simulator that was reset; keep the goal."""
        self.goals.interrupt(GoalOutcome.INTERRUPTED, cause)
        self._forget_measurements()
        self.pursuit.interrupt(cause)
        self._reporter.report(level, f'stopped: {cause}; waits for a goal, or controller/start')

    def _forget_measurements(self) -> None:
        self.pursuit.reset()
        self._world.reset()
        self._latest = LatestMeasurements()
        self._placing.reset()
        self._gate.reset()
        self._unanswered = []
        self._refusal = None

    def _check_odometry(self) -> None:
        """Stop the robot where odometry has stopped, and publish zeros that are left."""
        # What has come already is not missing, however late this node gets round to it.
        self._node.poll()
        check = self._gate.check_odometry()
        is_missing = check.state is not OdometryState.PRESENT
        if not self.pursuit.is_commanding or is_missing:
            self._commands.stop()
        if self.pursuit.is_commanding and is_missing:
            self.pursuit.report_again()
            if check.is_news:
                level = ERROR if check.state is OdometryState.LOST else WARN
                self._reporter.report(level, f'no odometry for {check.age:.2f} s; stopped')
        if self._latest.odometry is None:
            self._report_status()
        # Before the first odometry, too; in lockstep time waits for it.
        is_lost = check.state is OdometryState.LOST or self._latest.odometry is None
        if is_lost and not self._parameters.options.lockstep:
            self.goals.on_odometry_lost()

    def _report_status(self) -> None:
        """Publish ``push_status``, also before the first measurement."""
        if self._action is not None:
            is_measured = self._latest.odometry is not None
            self._action.update(
                self._latest.time if is_measured else seconds(self._node.now()),
                '' if self._topics is None else self._topics.text)

    def _report_base(self, fault: BaseFault | None) -> None:
        if fault is not None and not fault.is_interrupted:
            self._reporter.report(ERROR, f'the base is not ready to push: {fault.reason}')

    def _awaited_topics(self) -> list[str]:
        """Name the topics on which something has to come before the robot can go on."""
        awaited = self._latest.missing
        if self.pursuit.awaits_map:
            awaited.append('map')
        # A localization in the map sends nothing while the robot stands.
        if self._placing.awaits_scan:
            awaited.append('scan')
        # A planner that is there may take its time.
        if self.pursuit.has_open_request and self._node.count_publishers('push_plan') == 0:
            awaited.append('push_plan')
        return awaited
