"""Parameters of the controller's node."""

from typing import NamedTuple

from push_control.settings import ControlSettings
from push_control.supervision_settings import SupervisionSettings
from push_localization.settings import PlaceSettings
from push_model.parameters import PushedObject, RoundRobot
from push_navigation.settings import DriveSettings, MapSettings
from push_ros.node_settings import (
    BaseSettings, CollisionMonitorSettings, ControllerOptions, Frames,
)

OBJECT_PREFIX, OBJECT_NAME = 'object.', 'object_name'
# Prefix and class of each field of ``ControllerParameters``, in their order.
SECTIONS = ((OBJECT_PREFIX, PushedObject), ('robot.', RoundRobot), ('control.', ControlSettings),
            ('drive.', DriveSettings), ('supervision.', SupervisionSettings),
            ('map.', MapSettings), ('place.', PlaceSettings), ('base.', BaseSettings),
            ('collision_monitor.', CollisionMonitorSettings), ('', Frames),
            ('', ControllerOptions))


class ControllerParameters(NamedTuple):
    """
    Parameters of the controller, by section.

    :param object: nominal.
    :param robot: nominal.
    :param drive: for tasks.
    :param supervision: for tasks.
    :param map: how maps are read.
    :param place: what measures the place of the robot in the map.
    :param base: what the base's own node must be set to.
    :param collision_monitor: which monitor ignores the object while it is pushed.
    :param options: how the node behaves.
    """

    object: PushedObject
    robot: RoundRobot
    control: ControlSettings
    drive: DriveSettings
    supervision: SupervisionSettings
    map: MapSettings
    place: PlaceSettings
    base: BaseSettings
    collision_monitor: CollisionMonitorSettings
    frames: Frames
    options: ControllerOptions

    @property
    def named_object(self) -> tuple[str, PushedObject]:
        """Name of the object, or empty, and the object."""
        return self.options.object_name, self.object

    def check(self) -> None:
        """
        Check what sections have to do with each other.

        :raises ValueError: where an exclusion zone has no frame to hang on.
        """
        monitor, frame = self.collision_monitor.node, self.frames.object_frame
        if monitor and not self.options.publish_tf:
            raise ValueError(f'publish_tf: got false, expected true, as {monitor} is to ignore '
                             f'the object by its frame {frame}')
