"""Place of the robot in the map: by scans of its lidar, or by another localization."""

import math
from typing import Any

import numpy as np
from push_control.ros.parameters import ControllerParameters
from push_localization.localizer import LidarLocalizer
from push_localization.place_noise import PlaceNoise
from push_localization.scan_points import LidarMount
from push_localization.wall_field import WallField
from push_model.geometry import Pose
from push_model.parameters import PushedObject
from push_model.rigid_transform import RigidTransform
from push_model.signals import LidarScan, ObjectPose, Odometry, RobotPlace
from push_ros.conversions.lidar import from_place_message, from_scan_message
from push_ros.conversions.map import map_origin
from push_ros.conversions.primitives import MAX_TILT, MessageRefused
from push_ros.transforms.world import WorldFrame
from push_safety.protective_field import Protection, ProtectiveField


# Mean fit of scans below which they are of another map, or much has changed; measured: 0.67 at
# least with ten unmapped things about.
MIN_MEAN_FIT = 0.65


class RobotPlacing:
    """
    Reads scans or places, as ``place.source`` says, and finds the robot by scans.

    ``newest``: the newest ``RobotPlace``, or None. ``awaits_scan``: whether no scan has come that
    is to place the robot.
    """

    def __init__(self, parameters: ControllerParameters, world: WorldFrame) -> None:
        """
        Wait for a map.

        :param world: ``WorldFrame``, which knows how the lidar is mounted.
        """
        self._settings = parameters.place
        self._base_frame = parameters.frames.base_frame.lstrip('/')
        self._world_frame = parameters.frames.world_frame
        self._threshold = parameters.map.lethal_cost_threshold
        self._world = world
        self._map_std = 0.0
        self._noise = PlaceNoise()
        self._mount = LidarMount(self._settings.mount_pose)
        self._localizer: LidarLocalizer | None = None
        # Objects that are not pushed, and their poses, by name.
        self._standing: dict[str, tuple[PushedObject, Pose]] = {}
        if self._settings.source == 'scan':
            self._localizer = LidarLocalizer(self._settings, parameters.object)
        self._radius = parameters.robot.radius
        self._protective_field = self._make_field()
        self._has_scan = self._has_warned = False
        self.newest: RobotPlace | None = None

    @property
    def awaits_scan(self) -> bool:
        """Tell whether scans place the robot, and none has come."""
        return self._localizer is not None and not self._has_scan

    @property
    def sees_objects(self) -> bool:
        """Tell whether scans place the robot that see objects, too."""
        return self._localizer is not None and self._settings.sees_object

    def _make_field(self) -> ProtectiveField | None:
        if self._localizer is None or self._settings.slow_distance == 0.0:
            return None
        return ProtectiveField(self._settings, self._radius)

    def protection(self, odometry: Odometry) -> Protection:
        """
        Tell whether what scans show slows or stops the robot.

        :param odometry: the newest ``Odometry``.
        """
        if self._localizer is None or self._protective_field is None:
            return Protection()
        return self._protective_field.decide(self._localizer.unexplained, odometry)

    def reset(self) -> None:
        """Forget what was measured; the map stays."""
        self._protective_field = self._make_field()
        self.newest = None
        self._noise = PlaceNoise()
        if self._localizer is not None:
            self._localizer.reset()

    def set_object(self, name: str, obj: PushedObject) -> None:
        """
        Push another object.

        :param name: its name, or empty.
        """
        if self._localizer is not None:
            self._localizer.set_object(obj)
            self._standing.pop(name, None)
            self._localizer.set_standing(list(self._standing.values()))

    def note_standing(self, name: str, obj: PushedObject, pose: Pose) -> None:
        """
        Note where an object is that is not pushed: scans see it, and the map does not have it.

        :param name: its name.
        :param pose: its ``Pose`` in the world.
        """
        if self._localizer is not None:
            self._standing[name] = obj, pose
            self._localizer.set_standing(list(self._standing.values()))

    # The map.

    def set_map(self, message: Any) -> None:
        """
        Take the walls of a map; unknown cells are none.

        :param message: ``nav_msgs/OccupancyGrid`` in the world frame, which was read already.
        """
        info = message.info
        self._map_std = self._settings.map_noise * info.resolution
        if self._localizer is None:
            return
        cells = np.asarray(message.data).reshape(info.height, info.width)
        walls = cells >= self._threshold
        self._has_warned = False
        self._localizer.set_field(WallField(info.resolution, map_origin(message), walls,
                                            self._settings.wall_offset))

    def set_map_origin(self, origin: Pose) -> None:
        """
        Let the same map lie elsewhere.

        :param origin: ``Pose`` in the world of the outer corner of its first cell.
        """
        if self._localizer is not None:
            self._localizer.move_field(origin)

    # Measurements.

    def fit_warning(self) -> str:
        """Say once that scans hardly fit the map; empty else."""
        fit = None if self._localizer is None else self._localizer.mean_fit
        if fit is None or fit >= MIN_MEAN_FIT or self._has_warned:
            return ''
        self._has_warned = True
        return (f'scan: only {fit:.0%} of the beams end at walls of the map, expected '
                f'{MIN_MEAN_FIT:.0%} at least: is it the map of another place?')

    def read_scan(self, message: Any) -> LidarScan:
        """
        Read a scan, and how its lidar is mounted.

        :param message: ``sensor_msgs/LaserScan``.
        :raises MessageRefused: naming what is wrong with it.
        """
        scan = from_scan_message(message)
        self._mount = self._mount_of(message.header.frame_id)
        self._has_scan = True
        return scan

    def read_place(self, message: Any) -> RobotPlace:
        """
        Read a place of another localization; it errs by a part of a cell and of a degree at least.

        :param message: ``geometry_msgs/PoseWithCovarianceStamped`` in the world frame.
        :raises MessageRefused: naming what is wrong with it.
        """
        settings = self._settings
        place = from_place_message(message, self._world_frame, settings.covariance_factor)
        return with_least_deviation(place, self._map_std, settings.min_heading_std)

    def update(self, measured: Odometry | ObjectPose | LidarScan | RobotPlace,
               object_pose: ObjectPose | None) -> None:
        """
        Take in a measurement, and find the robot where a scan can be matched.

        :param object_pose: the newest ``ObjectPose``, or None.
        """
        if isinstance(measured, Odometry):
            self._noise.add_odometry(measured)
        elif isinstance(measured, RobotPlace):
            self.newest = self._noise.widened(measured)
        localizer = self._localizer
        if localizer is None:
            return
        if isinstance(measured, Odometry):
            localizer.add_odometry(measured)
        elif isinstance(measured, LidarScan):
            localizer.add_scan(measured, self._mount)
        self.newest = localizer.locate(object_pose) or self.newest

    def _mount_of(self, frame: str) -> LidarMount:
        """Return how the lidar is mounted whose scans are in a frame."""
        if self._settings.mount == 'stated':
            return LidarMount(self._settings.mount_pose)
        if frame.lstrip('/') == self._base_frame:
            return LidarMount()
        transform = self._world.fixed_to_base(frame)
        if transform is None:
            raise MessageRefused(
                f'scan: got frame {frame!r}, expected one with a static transform to '
                f'{self._base_frame!r}, or place.mount: stated')
        return mount_of(transform)


def mount_of(transform: RigidTransform) -> LidarMount:
    """
    Return the mounting of a lidar in the plane.

    :param transform: pose of the lidar in the frame of the robot.
    :raises MessageRefused: where its beams do not lie in the plane.
    """
    tilt = min(transform.tilt, math.pi - transform.tilt)
    if tilt > MAX_TILT:
        raise MessageRefused(f'scan: got a lidar whose axis is tilted by {tilt:.2f} rad, expected '
                             f'one that points up or down (within {MAX_TILT:g} rad)')
    return LidarMount(transform.planar, bool(transform.rotation_matrix[2, 2] < 0.0))


def with_least_deviation(place: RobotPlace, position: float, heading: float) -> RobotPlace:
    """
    Return a place that errs by a deviation at least, as walls of a map do.

    :param position: standard deviation of x and of y [m].
    :param heading: the same of the heading [rad].
    """
    covariance = place.covariance
    return place._replace(covariance=covariance._replace(
        x_x=max(covariance.x_x, position ** 2), y_y=max(covariance.y_y, position ** 2),
        theta_theta=max(covariance.theta_theta, heading ** 2)))
