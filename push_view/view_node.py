"""ROS node of the page: it shows a robot, and commands it where that is asked for."""

import argparse
from collections.abc import Callable, Mapping, Sequence
import dataclasses
import secrets
import sys
from typing import Any

from push_control.perception.view import View
from push_control.task.status import TaskState
from push_model.base_knowledge import BaseKnowledge
from push_model.geometry import Pose
from push_model.parameters import PushedObject, RoundRobot
from push_model.plan_request import PlanFailure
from push_model.quantity import check, quantity
from push_navigation.settings import MapSettings
from push_planner.refusal_marks import RefusalMarks
from push_ros.conversions.map import from_map_message, map_reader
from push_ros.conversions.measurements import from_object_pose_message, from_odometry_message
from push_ros.conversions.plan import from_plan_message, plan_failure
from push_ros.conversions.primitives import from_pose_message, MessageRefused, seconds
from push_ros.diagnostics import ERROR, FAILURE, OK, status_values, WARN
from push_ros.executor import BAD_PARAMETER, run
from push_ros.node import PushNode
from push_ros.node_settings import Frames
from push_ros.topic_watch import TopicWatch
from push_ros.topics import CONTROLLER, PLANNER
from push_ros.transforms.world import Handlers, WorldFrame
from push_view.live.robot_record import RobotRecorder
from push_view.messages import controls_message
from push_view.ros.relay import CommandRelay
from push_view.server.address import checked_origin
from push_view.server.commands import CALLS
from push_view.server.message_log import MessageLog

NAME = 'push_view'
LOCAL = '127.0.0.1'
ROS_ARGUMENTS = '--ros-args'


@dataclasses.dataclass(frozen=True)
class ViewOptions:
    """Whom the page is served to, and what they may do."""

    control: bool = quantity('let the page set goals and start, stop, pause and resume',
                             default=False)
    host: str = quantity('address for other machines, with the logged token; empty: this machine '
                         'alone', default='')
    origin: str = quantity('address of the page behind a proxy, as https://robot.example; empty: '
                           'no proxy', default='')
    port: int = quantity('port of the page; 0: any free one', '', 0, 65535, default=8643)
    object_pose_with_covariance: bool = quantity(
        'object_pose is PoseWithCovarianceStamped, else PoseStamped', default=False)
    transform_timeout: float = quantity('longest wait of a message for its transform', 's', 0.0,
                                        10.0, default=0.3)

    def __post_init__(self) -> None:
        """Validate the fields."""
        check(self)
        if self.origin:
            checked_origin(self.origin)


SECTIONS = (('object.', PushedObject), ('robot.', RoundRobot), ('', Frames), ('', ViewOptions))


class ViewNode(PushNode):
    """
    Serves the page, live from the topics of a robot or of the simulator.

    It shows object and robot as they are measured, the goal, the plan of each push and of those
    that follow, the map, and the state that the controller reports on ``/diagnostics``; and there
    why the planner has no plan. It is read only unless it was started with ``--control``.

    Publishers
        with ``--control``, ``goal_pose`` (PoseStamped), in ``world_frame``; ``/diagnostics``
        (DiagnosticArray).

    Subscribers
        ``odom`` (Odometry) and ``object_pose`` (PoseStamped, or PoseWithCovarianceStamped), best
        effort; ``goal_pose`` (PoseStamped); ``push_plan`` (JointTrajectory, latched);
        ``planned_path`` (Path, latched); ``map`` (OccupancyGrid, latched); ``contact_wrench``
        (WrenchStamped), of the simulator; ``/diagnostics`` (DiagnosticArray); once something comes
        in another frame, ``/tf`` and ``/tf_static``, where tf2_msgs is installed.

    Clients, with ``--control``
        ``controller/start``, ``controller/stop``, ``controller/pause``, ``controller/resume``
        (Trigger).

    ROS parameters
        ``object.*`` and ``robot.*``, nominal; ``world_frame``, ``object_frame``, ``base_frame``;
        and those of ``ViewOptions``.

    Frames
        Odometry and plans must be in ``world_frame``. Object poses, goals and maps are brought
        there, goals and maps again as their frame drifts. What cannot be brought there is not
        shown, and reported.
    """

    def __init__(self) -> None:
        super().__init__(NAME, SECTIONS)
        obj, robot, self._frames, options = self.settings
        self._options = options
        self._log = MessageLog()
        title = f'robot {self.get_namespace()}'.rstrip(' /')
        self._record = RobotRecorder(self._log, title, obj, robot)
        self._world = WorldFrame(self, self._frames.world_frame, options.transform_timeout)
        self._relay = CommandRelay(self, self._log, self._frames.world_frame, options.control)
        self._controller = f'{self.get_namespace()}/{CONTROLLER}'.lstrip('/')
        self._planner = f'{self.get_namespace()}/{PLANNER}'.lstrip('/')
        self._log.replace(controls_message(('goal',) if options.control else (),
                                           calls=CALLS if options.control else ()))
        self._log.replace({'type': 'run', 'paused': False, 'speed': 1.0, 'achieved': None})
        self.subscribe('odom', self._shown(self._on_odometry))
        self.subscribe('object_pose', self._in_world('object_pose', self._on_object_pose),
                       with_covariance=options.object_pose_with_covariance)
        self.subscribe('goal_pose', self._in_world('goal_pose', self._on_goal,
                                                   self._record.move_goal))
        self.subscribe('push_plan', self._shown(self._on_plan))
        self.subscribe('planned_path', self._shown(self._on_planned_path))
        self.subscribe('map', self._in_world('map', self._on_map, self._record.move_map),
                       read=map_reader(MapSettings()))
        self.subscribe('contact_wrench', self._on_contact_wrench)
        self.subscribe('diagnostics', self._on_diagnostics)
        # Both are there once a message has been shown.
        self._missing = {'odom', 'object_pose'}
        self._topics = TopicWatch(self, lambda: self._missing)

    def start(self) -> None:
        """Serve the page: called once, before the first callback."""
        # Imported here, as it comes with an extra.
        try:
            from push_view.server.page_server import Access, Callbacks
            from push_view.server.page_thread import PageThread
            self._page = PageThread()
            control, host = self._options.control, self._options.host
            origin = checked_origin(self._options.origin) if self._options.origin else None
            # Other users of this machine may not command the robot either.
            token = secrets.token_urlsafe() if control or host or origin else None
            url = self._page.start(
                NAME, self._log, Callbacks(self._relay.handle), host=host or LOCAL,
                port=self._options.port, access=Access(token, origin))
        except (ModuleNotFoundError, OSError) as error:
            self.refuse_to_start(f'{error}, expected aiohttp (python3-aiohttp) and a free port')
        self.reporter.report(OK, f'the page is at {url}')

    def close(self) -> None:
        """Shut down: called once, while publishers are still valid."""
        self._topics.destroy()
        self._page.stop()

    def _shown(self, show: Callable[[Any], None]) -> Callable[[Any], None]:
        """Make a callback that reports a message which is refused."""
        def on_message(message: Any) -> None:
            try:
                show(message)
            except MessageRefused as refusal:
                self._refuse(refusal, message)
        return on_message

    def _in_world(self, topic: str, show: Callable[[Any], None],
                  move: Callable[[Pose], None] | None = None) -> Callable[[Any], None]:
        """Make one that brings the message to the world frame first; ``move`` as it drifts."""
        return self._world.receiver(topic, Handlers(
            self._shown(show), self._refuse, move, is_latched=topic == 'map'))

    def _refuse(self, refusal: MessageRefused, _: Any) -> None:
        self.reporter.report(WARN, str(refusal))

    def _on_contact_wrench(self, message: Any) -> None:
        force = message.wrench.force
        self._record.on_contact_force((force.x, force.y))

    def _on_odometry(self, message: Any) -> None:
        self._record.on_odometry(from_odometry_message(message, self._frames.world_frame))
        self._missing.discard('odom')

    def _on_object_pose(self, message: Any) -> None:
        self._record.on_object_pose(from_object_pose_message(message, self._frames.world_frame))
        self._missing.discard('object_pose')

    def _on_goal(self, message: Any) -> None:
        self._record.on_goal(from_object_pose_message(message, self._frames.world_frame,
                                                      'goal_pose').pose)

    def _on_plan(self, message: Any) -> None:
        # Why there is no plan its diagnostics tell better.
        if plan_failure(message) is None:
            self._record.on_plan(from_plan_message(message, self._frames.world_frame),
                                 seconds(message.header.stamp))

    def _on_planned_path(self, message: Any) -> None:
        poses = [from_pose_message(stamped.pose, 'planned_path') for stamped in message.poses]
        self._record.on_planned_path(poses, seconds(message.header.stamp))

    def _on_map(self, message: Any) -> None:
        self._record.on_map(from_map_message(message, self._frames.world_frame))

    def _on_diagnostics(self, message: Any) -> None:
        for status in message.status:
            if status.name == self._planner:
                self._on_planner_status(status)
            values = status_values(status) if status.name == self._controller else {}
            if 'state' in values:
                self._record.on_state(TaskState(values['state']), values.get('reason', ''))
            base = base_knowledge(values)
            if base is not None:
                self._record.on_base(base)
            view = View.from_report(values)
            if view is not None:
                self._record.on_view(view)

    def _on_planner_status(self, status: Any) -> None:
        """Show why the planner has no plan; nothing is wrong where none is needed."""
        values = status_values(status)
        name = values.get(FAILURE, '')
        if status.level != ERROR or name not in PlanFailure.__members__:
            self._record.forget_refusal()
            return
        self._record.on_refusal(PlanFailure[name], status.message,
                                RefusalMarks.from_report(values))


def base_knowledge(values: Mapping[str, str]) -> BaseKnowledge | None:
    """
    Read what a controller reports of its base.

    :param values: of its diagnostic, by name.
    :return: the ``BaseKnowledge``; None where nothing is reported of it.
    """
    names = [name for name in BaseKnowledge._fields if name in values]
    try:
        return BaseKnowledge(**{name: float(values[name]) for name in names}) if names else None
    except ValueError:
        return None


def main(arguments: Sequence[str] | None = None) -> int:
    """
    Run the page.

    :param arguments: words after the command's name; None for those of the process.
    :return: exit status.
    """
    words = list(sys.argv[1:] if arguments is None else arguments)
    end = words.index(ROS_ARGUMENTS) if ROS_ARGUMENTS in words else len(words)
    try:
        options = make_parser().parse_args(words[:end])
    except SystemExit as finished:
        return BAD_PARAMETER if finished.code else 0
    parameters = [f'{name}:={value}' for name, value in vars(options).items() if value is not None]
    flags = [word for pair in parameters for word in ('-p', pair)]
    return run(ViewNode, [*(words[end:] or [ROS_ARGUMENTS]), *flags])


def make_parser() -> argparse.ArgumentParser:
    """Make the parser of the command line."""
    parser = argparse.ArgumentParser(
        prog='push view', allow_abbrev=False, description='Serve a page that shows the robot. '
        'Options stand for the parameters of the same names; others follow --ros-args.')
    parser.add_argument('--control', action='store_const', const='true',
                        help='let the page set goals and call start, stop, pause and resume')
    parser.add_argument('--port', type=int, help='port of the page, 0 for any that is free')
    parser.add_argument('--host',
                        help='serve other machines too, at this address of ours (0.0.0.0 for '
                        'all); they need the token that is logged')
    parser.add_argument('--origin', help='address of the page behind a proxy, as '
                        'https://robot.example; it needs the token too')
    return parser


if __name__ == '__main__':
    sys.exit(main())
