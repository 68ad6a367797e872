"""Camera that sees the object only now and then: on the robot, or in the room behind it."""

import dataclasses
import math
from typing import get_args, Literal, TypeAlias

from push_model.contact import contact_point, face_normal, robot_gap
from push_model.geometry import Coordinates, distance, Pose, wrap_angle
from push_model.parameters import Contact, PushedObject
from push_model.quantity import check, quantity

# Where the camera is: nowhere, so that object poses come from everywhere; on the robot; or in the
# room, where the robot may stand in front of the object.
CameraMount: TypeAlias = Literal['none', 'robot', 'room']
# What object poses are relative to: the world, as where something else tells the place of the
# camera, or the robot.
PoseReference: TypeAlias = Literal['world', 'robot']
# Gap below which robot and object are in contact [m]; chosen: above the rounding of the plant.
CONTACT_GAP = 1e-3


@dataclasses.dataclass(frozen=True)
class CameraSettings:
    """
    Pose and range of the camera; without one the object is always seen.

    Distances are from the lens, in the plane: the nearest to the outline of the object, the
    farthest and that of noise to its origin. Angles are between the optical axis, which is the x
    axis of the mount, and the direction to the origin.
    """

    place: CameraMount = quantity('where the camera is; none: poses come from everywhere',
                                  choices=get_args(CameraMount), default='none')
    reference: PoseReference = quantity(
        'what poses are relative to: world, or the robot that the camera is on',
        choices=get_args(PoseReference), default='world')
    mount_x: float = quantity('position of the lens, robot frame if on it, else world', 'm',
                              -100.0, 100.0, default=0.0)
    mount_y: float = quantity('the same, y', 'm', -100.0, 100.0, default=0.0)
    mount_heading: float = quantity('direction of the optical axis in the same frame', 'rad',
                                    -math.pi, math.pi, default=0.0)
    half_angle: float = quantity('half of the horizontal angle of view', 'rad', above=0.0,
                                 high=math.pi, default=math.pi)
    nearest: float = quantity('least distance from lens to outline that is seen', 'm', 0.0, 10.0,
                              default=0.0)
    farthest: float = quantity('largest distance from lens to origin that is seen', 'm',
                               above=0.0, high=100.0, default=100.0)
    is_blind_in_contact: bool = quantity('whether the robot hides the object that it touches',
                                         default=False)
    noise_per_distance: float = quantity('growth of the position std per axis with the distance',
                                         'm/m', 0.0, 1.0, default=0.0)
    heading_noise_per_distance: float = quantity('growth of the heading std with the distance',
                                                 'rad/m', 0.0, 1.0, default=0.0)

    def __post_init__(self) -> None:
        """Validate the fields."""
        check(self)
        if self.reference == 'robot' and self.place != 'robot':
            raise ValueError(f'CameraSettings.reference: got robot with a camera at the place '
                             f'{self.place}, expected a camera on the robot')

    @property
    def mount(self) -> Pose:
        """``Pose`` of the camera, robot frame if it is on the robot, else world."""
        return Pose(self.mount_x, self.mount_y, self.mount_heading)

    @property
    def is_relative(self) -> bool:
        """Tell whether poses are relative to the robot."""
        return self.reference == 'robot'


class Camera:
    """
    Camera that sees one object; one in the room sees no object behind the robot.

    Everything is in the plane: a camera in the room looks past the robot, never over it.

    :param settings: ``CameraSettings``.
    :param obj: the ``PushedObject``.
    :param robot_radius: of the robot [m]; one that is infinite hides nothing.
    """

    def __init__(self, settings: CameraSettings, obj: PushedObject, robot_radius: float) -> None:
        self._settings = settings
        self._obj = obj
        self._robot_radius = robot_radius

    def pose(self, robot_pose: Pose) -> Pose:
        """
        Compute where the camera is.

        :param robot_pose: true ``Pose`` of the robot in the world.
        :return: ``Pose`` in the world, the optical axis along x.
        """
        mount = self._settings.mount
        return mount if self._settings.place == 'room' else robot_pose @ mount

    def distance(self, object_pose: Pose, robot_pose: Pose) -> float:
        """
        Compute the distance from the lens to the origin of the object [m]; 0 without a camera.

        :param object_pose: true ``Pose`` of the object in the world.
        :param robot_pose: true ``Pose`` of the robot in the world.
        """
        if self._settings.place == 'none':
            return 0.0
        return distance(self.pose(robot_pose), object_pose)

    def sees(self, object_pose: Pose, robot_pose: Pose) -> bool:
        """
        Tell whether the camera sees the object.

        :param object_pose: true ``Pose`` of the object in the world.
        :param robot_pose: true ``Pose`` of the robot in the world.
        """
        settings = self._settings
        if settings.place == 'none':
            return True
        camera = self.pose(robot_pose)
        if not self._is_in_view(camera, object_pose):
            return False
        if settings.is_blind_in_contact and self._is_touching(object_pose, robot_pose):
            return False
        return settings.place == 'robot' or not self._is_hidden(camera, object_pose, robot_pose)

    def _is_in_view(self, camera: Pose, object_pose: Pose) -> bool:
        """Tell whether angle and distances are within those of the camera."""
        settings = self._settings
        x, y = camera.inverse().transform(object_pose[:2])
        if abs(math.atan2(y, x)) > settings.half_angle or math.hypot(x, y) > settings.farthest:
            return False
        return robot_gap(self._obj, object_pose, camera, 0.0) >= settings.nearest

    def _is_touching(self, object_pose: Pose, robot_pose: Pose) -> bool:
        return robot_gap(self._obj, object_pose, robot_pose, self._robot_radius) < CONTACT_GAP

    def _is_hidden(self, camera: Pose, object_pose: Pose, robot_pose: Pose) -> bool:
        """Tell whether the line from the lens to the origin of the object crosses the robot."""
        if math.isinf(self._robot_radius):
            return False
        closest = _closest_on_line(camera[:2], object_pose[:2], robot_pose[:2])
        return distance(closest, robot_pose) < self._robot_radius


def mirrored_tilt(obj: PushedObject, bearing: float) -> Pose:
    """
    Compute where an object seems to be whose tag is seen with its tilt mirrored.

    Every side has a tag in its middle, of which the one is seen that faces the camera most. Its
    normal is mirrored at the line of sight. A round object has its tag where the camera is.

    :param bearing: direction from the object to the camera, in the object frame [rad].
    :return: ``Pose`` of the object as it is seen, relative to the true one.
    """
    sides = range(len(obj.outline))
    if not sides:
        return Pose(0.0, 0.0, 0.0)
    angles = {side: wrap_angle(bearing - face_normal(obj, side) - math.pi) for side in sides}
    side = min(sides, key=lambda index: abs(angles[index]))
    tag = Pose(*contact_point(obj, Contact('face', side)), 0.0)
    return tag @ Pose(0.0, 0.0, 2.0 * angles[side]) @ tag.inverse()


def relative_pose(object_pose: Pose, robot_pose: Pose) -> Pose:
    """
    Compute the pose of the object in the frame of the robot, its heading in [-pi, pi].

    :param object_pose: ``Pose`` in the world.
    :param robot_pose: ``Pose`` in the world.
    """
    x, y, theta = robot_pose.inverse() @ object_pose
    return Pose(x, y, wrap_angle(theta))


def _closest_on_line(start: Coordinates, end: Coordinates,
                     point: Coordinates) -> tuple[float, float]:
    """Return the point (x, y) of a line segment that is closest to another one [m]."""
    d_x, d_y = end[0] - start[0], end[1] - start[1]
    squared = d_x * d_x + d_y * d_y
    along = 0.0
    if squared > 0.0:
        along = ((point[0] - start[0]) * d_x + (point[1] - start[1]) * d_y) / squared
    along = min(1.0, max(0.0, along))
    return start[0] + along * d_x, start[1] + along * d_y
