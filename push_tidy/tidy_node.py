"""ROS node that brings several objects to their goals."""

import functools
import sys
import time
from typing import Any, Callable

from push_model.parameters import RoundRobot
from push_navigation.settings import DriveSettings, MapSettings
from push_ros.conversions.map import map_reader, map_text
from push_ros.conversions.measurements import from_object_pose_message, from_odometry_message
from push_ros.conversions.primitives import MessageRefused
from push_ros.diagnostics import ERROR, OK
from push_ros.executor import run
from push_ros.node import PushNode
from push_ros.node_settings import Frames, TidyOptions
from push_ros.push_interfaces import import_push_interfaces
from push_ros.topics import TIDY
from push_ros.transforms.world import Handlers, WorldFrame
from push_tidy.ros.room_map import RoomMap
from push_tidy.ros.single_moves import SingleMoves
from push_tidy.ros.tidy_action import TidyActionServer, TidyParameters
from push_tidy.ros.tidy_run import RoomInputs, RunPorts
from rclpy.clock import Clock
from rclpy.clock_type import ClockType

SECTIONS = (('robot.', RoundRobot), ('drive.', DriveSettings), ('map.', MapSettings),
            ('', Frames), ('', TidyOptions))
# Period at which controller and measurements are looked after [s]; chosen: soon for a person.
WATCH_PERIOD = 0.5


class TidyNode(PushNode):
    """
    Brings several objects to their goals, one after the other.

    It plans the order from where all objects are measured at rest, publishes the map with those
    that stand, and sends the controller the goal of one. After each of these moves it plans the
    order again. The controller takes its ``map`` from this node, its object poses from
    ``objects/NAME/object_pose``.

    Publishers
        ``map`` (OccupancyGrid, latched), objects in it as unknown cells; ``/diagnostics``
        (DiagnosticArray).

    Subscribers
        ``objects/NAME/object_pose`` (PoseStamped, or PoseWithCovarianceStamped) of each object,
        and ``odom`` (Odometry), best effort; ``room_map`` (OccupancyGrid, latched), without the
        objects; ``/tf`` and ``/tf_static`` (TFMessage) as soon as one of these comes in another
        frame.

    Action, for which ``push_control_msgs`` must be installed
        ``push_objects`` (PushObjects); a client of ``push_object`` (PushObject).

    ROS parameters
        ``robot.*``, ``drive.*`` and ``map.*`` as the planner has them, ``world_frame``, and those
        of ``TidyOptions``.

    Frames
        Poses and maps are brought to ``world_frame``; goals are in it.
    """

    def __init__(self) -> None:
        super().__init__(TIDY, SECTIONS)
        robot, drive, self._map_settings, frames, options = self.settings
        self._frame: str = frames.world_frame
        interfaces = import_push_interfaces()
        if interfaces is None:
            self.refuse_to_start('push_control_msgs is not installed')
        self._inputs = RoomInputs()
        moves = SingleMoves(self, interfaces)
        publish_map = self.publisher('map').publish

        def make_ports(on_change: Callable[[], None]) -> RunPorts:
            return RunPorts(self, self._frame, moves, publish_map, on_change)
        self._server = TidyActionServer(self, TidyParameters(robot, drive, options), interfaces,
                                        self._inputs, make_ports)
        self._subscribe(options)
        self.create_timer(WATCH_PERIOD, self.guarded(self._watch),
                          clock=Clock(clock_type=ClockType.STEADY_TIME))
        self.reporter.report(OK, 'waits for a goal')

    def close(self) -> None:
        """End the goal."""
        self._server.close()

    def _subscribe(self, options: TidyOptions) -> None:
        world = WorldFrame(self, self._frame, options.transform_timeout)
        self.subscribe('odom', self._on_odometry)
        self.subscribe('room_map', world.receiver('room_map', Handlers(
            self._on_map, self._refuse, is_latched=True)), read=map_reader(self._map_settings))
        for entry in options.objects:
            self.subscribe(
                'object_pose', world.receiver(f'object_pose of {entry.name}', Handlers(
                    functools.partial(self._on_pose, entry.name), self._refuse)),
                with_covariance=options.object_pose_with_covariance, object_name=entry.name)

    def _on_odometry(self, message: Any) -> None:
        try:
            self._inputs.on_odometry(from_odometry_message(message, self._frame).pose)
        except MessageRefused as error:
            self._refuse(error, message)

    def _on_map(self, message: Any) -> None:
        try:
            self._inputs.room_map = RoomMap(message, self._frame, self._map_settings)
        except MessageRefused as error:
            self._refuse(error, message)
            return
        self.reporter.report(OK, map_text(message))

    def _on_pose(self, name: str, message: Any) -> None:
        run = self._server.run
        if run is None:
            return
        try:
            measured = from_object_pose_message(message, self._frame, f'object_pose of {name}')
        except MessageRefused as error:
            self._refuse(error, message)
            return
        run.on_pose(name, measured.pose, measured.time)

    def _refuse(self, error: MessageRefused, message: Any) -> None:
        self.reporter.report(ERROR, str(error))

    def _watch(self) -> None:
        if self._server.run is not None:
            self._server.run.check(time.monotonic())


if __name__ == '__main__':
    sys.exit(run(TidyNode))
