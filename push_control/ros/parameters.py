"""Parameters of the controller's node."""

from typing import NamedTuple

from push_control.settings import ControlSettings
from push_control.supervision_settings import SupervisionSettings
from push_model.parameters import PushedObject, RoundRobot
from push_navigation.settings import DriveSettings, MapSettings
from push_ros.node_settings import BaseSettings, ControllerOptions, Frames

OBJECT_PREFIX, OBJECT_NAME = 'object.', 'object_name'
# Prefix and class of each field of ``ControllerParameters``, in their order.
SECTIONS = ((OBJECT_PREFIX, PushedObject), ('robot.', RoundRobot), ('control.', ControlSettings),
            ('drive.', DriveSettings), ('supervision.', SupervisionSettings),
            ('map.', MapSettings), ('base.', BaseSettings), ('', Frames), ('', ControllerOptions))


class ControllerParameters(NamedTuple):
    """
    Parameters of the controller, by section.

    :param object: nominal.
    :param robot: nominal.
    :param drive: for tasks.
    :param supervision: for tasks.
    :param map: how maps are read.
    :param base: what the base's own node must be set to.
    :param options: how the node behaves.
    """

    object: PushedObject
    robot: RoundRobot
    control: ControlSettings
    drive: DriveSettings
    supervision: SupervisionSettings
    map: MapSettings
    base: BaseSettings
    frames: Frames
    options: ControllerOptions

    @property
    def named_object(self) -> tuple[str, PushedObject]:
        """Name of the object, or empty, and the object."""
        return self.options.object_name, self.object
