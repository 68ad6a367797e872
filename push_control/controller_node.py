"""ROS node of the controller."""

import sys
from typing import Any, Mapping

from push_control.ros.active_controller import ActiveController
from push_control.ros.command_gate import TOPIC_OF
from push_control.ros.parameters import (
    ControllerParameters, OBJECT_NAME, OBJECT_PREFIX, SECTIONS,
)
from push_model.files.flat_values import parameter_specs
from push_model.parameters import PushedObject
from push_ros.diagnostics import WARN
from push_ros.executor import run
from push_ros.lifecycle import ManagedNode
from push_ros.object_catalogue import ObjectCatalogue
from push_ros.parameters import DYNAMIC, dynamic_parameters, IDLE
from push_ros.topics import CONTROLLER
from push_ros.transforms.world import WorldFrame

OBJECT_PARAMETERS = {OBJECT_NAME, *(spec.name for spec in parameter_specs(PushedObject,
                                                                          OBJECT_PREFIX))}
SETTABLE = {**dict.fromkeys(dynamic_parameters(SECTIONS, 'control.', 'drive.', 'supervision.'),
                            DYNAMIC),
            **dict.fromkeys(OBJECT_PARAMETERS, IDLE)}


class ControllerNode(ManagedNode):
    """
    Answers measurements with commands while it pursues a goal.

    With ``task`` false it requests one plan for each ``goal_pose``, and follows it. A plan that
    starts at the push under way replaces it without a stop; any other starts from rest, and only
    where the robot stands at its start. A plan that is refused stops the push; one that was not
    requested is reported, and nothing else. Where a push has left its path, another plan is
    requested.

    With ``task`` true it brings the object to ``goal_pose`` with as many pushes as that takes, and
    requests a plan for each.

    The command is zero for a measurement that is refused (unreadable, not finite, in a frame
    without a transform to ``world_frame``) or stale, and where odometry stops for
    ``watchdog_timeout`` on the node's clock. When the goal is reached or abandoned, at the end of
    the node and when it is deactivated some zeros follow, then nothing is published. With
    ``lockstep`` every measurement is answered, with its stamp, and in a task not until a requested
    plan is there.

    After ``controller/stop`` goals are refused until ``controller/start``.

    Publishers
        ``cmd_vel`` (TwistStamped, or Twist), in ``base_frame``; ``push_request`` (JointTrajectory,
        latched), in ``world_frame``; ``/diagnostics`` (DiagnosticArray); ``markers``
        (MarkerArray); ``plan_markers`` (MarkerArray, latched); ``footprint`` (PolygonStamped), in
        ``base_frame``; with ``publish_tf`` the transform from ``world_frame`` to ``object_frame``
        on ``/tf``, where tf2_msgs is installed.

    Subscribers, while active
        ``odom`` (Odometry) and ``object_pose`` (PoseStamped, or PoseWithCovarianceStamped), best
        effort; ``push_plan`` (JointTrajectory, latched); ``goal_pose`` (PoseStamped);
        ``map`` (OccupancyGrid, latched); with ``place.source``, ``scan`` (LaserScan) or ``place``
        (PoseWithCovarianceStamped); ``/tf`` and ``/tf_static`` (TFMessage) as soon as one of
        these comes in another frame; ``cmd_vel`` while somebody else publishes it.

    Action, where ``push_control_msgs`` is installed
        ``push_object`` (PushObject), with the topic ``push_status`` (PushStatus, latched) from
        activation on.

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
        frame drifts; odometry is in it. Object poses in ``base_frame``, or in a frame that static
        transforms fix to it, are taken as relative to the robot. Commands are in ``base_frame``.
    """

    def __init__(self) -> None:
        super().__init__(CONTROLLER, SECTIONS, SETTABLE)
        parameters = self._present_parameters
        self._options = parameters.options
        self._object = parameters.named_object
        self._catalogue = ObjectCatalogue(self._options.object_folder)
        self._catalogue.remember(*self._object)
        self._world = WorldFrame(self, parameters.frames.world_frame,
                                 self._options.transform_timeout,
                                 parameters.frames.base_frame)
        # From configuring to cleaning up.
        self._controller: ActiveController | None = None
        self.serve_active_trigger('controller/start', lambda: self.controller.start())
        self.serve_active_trigger('controller/stop', lambda: self.controller.stop())
        self.serve_active_trigger('controller/pause', lambda: self.controller.pause())
        self.serve_active_trigger('controller/resume', lambda: self.controller.resume())

    @property
    def is_autostarted(self) -> bool:
        """Tell whether the node configures and activates itself."""
        return self._options.autostart

    @property
    def controller(self) -> ActiveController:
        """
        The ``ActiveController``.

        :raises RuntimeError: before configuring, and after cleaning up.
        """
        if self._controller is None:
            raise RuntimeError('controller: got none, expected a configured node')
        return self._controller

    def configure(self) -> None:
        """
        Make the controller, which reads what was learned of the object, and rehearse.

        The rehearsal compiles what a push needs: an active controller is never deaf for that.

        :raises ValueError: where ``knowledge_file`` cannot be read, there is no
            ``object_folder``, or a collision monitor cannot be asked to ignore the object.
        """
        self._catalogue.check_folder()
        # Imported here: it takes a while, and the node reports before.
        from push_control.unused_settings import unused_settings
        parameters = self._present_parameters
        for unused in unused_settings(parameters.object, parameters.robot, parameters.control,
                                      parameters.supervision, is_task=parameters.options.task):
            self.reporter.log(WARN, str(unused))
        parameters = self._present_parameters
        parameters.check()
        self._controller = ActiveController(self, parameters, self._world, self._catalogue)
        self._controller.pursuit.rehearse()

    def activate(self) -> None:
        """Subscribe, and wait for a goal."""
        self.controller.activate()

    def deactivate(self) -> None:
        """Stop the robot, and forget the goal."""
        self.controller.deactivate()

    def clean_up(self) -> None:
        """Forget what was learned of the object, but for what is in its file."""
        self.controller.destroy()
        self._controller = None

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
        if names and self._controller is not None and not self._controller.goals.is_idle:
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
        parameters = self._present_parameters
        previous, self._object = self._object, parameters.named_object
        if self._object != previous:
            self._catalogue.remember(*self._object)
        if self._controller is not None:
            self._controller.set_parameters(parameters)

    @property
    def _present_parameters(self) -> ControllerParameters:
        return ControllerParameters(*self.settings)

    def on_unreadable(self, topic: str, reason: str) -> None:
        """
        Report a message that cannot be read, and stop the robot for a measurement.

        :param topic: its topic in the list.
        :param reason: one sentence.
        """
        if self.is_active and topic in TOPIC_OF.values():
            self.controller.refuse_unreadable(reason)
        else:
            super().on_unreadable(topic, reason)

    def on_unexpected_error(self, error: Exception) -> None:
        """
        Stop the robot, and forget everything measured.

        :param error: that a callback has raised.
        """
        super().on_unexpected_error(error)
        if self.is_active:
            self.controller.recover(error)


def _names_object_only(values: Mapping[str, Any]) -> bool:
    """Tell whether an object is named, and none of its parameters given with it."""
    # What is no text is refused for that.
    return (isinstance(values.get(OBJECT_NAME), str)
            and not any(name.startswith(OBJECT_PREFIX) for name in values))


if __name__ == '__main__':
    sys.exit(run(ControllerNode))
