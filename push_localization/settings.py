"""Settings of the robot's place: where it comes from, and how scans are matched."""

import dataclasses
import math
from typing import get_args, Literal, TypeAlias

from push_model.geometry import Pose
from push_model.quantity import check, MIN_NOISE, quantity

# What measures the place of the robot in the map, besides contacts: nothing, its own lidar, or a
# localization that runs elsewhere.
PlaceSource: TypeAlias = Literal['none', 'scan', 'place']
# Where the pose of the lidar on the robot comes from: transforms, or these settings.
MountSource: TypeAlias = Literal['tf', 'stated']


@dataclasses.dataclass(frozen=True)
class PlaceSettings:
    """Source of the robot's place in the map, and how scans are matched to it."""

    source: PlaceSource = quantity(
        'what measures the place of a robot with drifting odometry: nothing, scans, or another '
        "localization's poses on place", choices=get_args(PlaceSource), is_dynamic=False,
        is_basic=True, default='none')
    mount: MountSource = quantity(
        'pose of the lidar on the robot: by tf, or as stated here', choices=get_args(MountSource),
        is_dynamic=False, default='tf')
    mount_x: float = quantity('position of the lidar, robot frame', 'm', -10.0, 10.0,
                              is_dynamic=False, default=0.0)
    mount_y: float = quantity('the same, y', 'm', -10.0, 10.0, is_dynamic=False, default=0.0)
    mount_heading: float = quantity('direction of its angle 0 in the same frame', 'rad', -math.pi,
                                    math.pi, is_dynamic=False, default=0.0)
    beams: int = quantity('beams of a scan that are used, at most', '', 40, 10_000,
                          is_dynamic=False, default=180)
    noise: float = quantity('std of ranges', 'm', MIN_NOISE, 1.0, is_dynamic=False, default=0.02)
    map_noise: float = quantity('std of walls about where the map has them, in cells', '', 0.0,
                                10.0, is_dynamic=False, default=0.3)
    wall_offset: float = quantity('depth of walls behind the faces of their cells, in cells', '',
                                  -0.5, 0.5, is_dynamic=False, default=0.25)
    wall_length: float = quantity('length of a wall whose beams err by the same', 'm', above=0.0,
                                  high=10.0, is_dynamic=False, default=0.7)
    robust: float = quantity('distance from walls at which a beam counts half', 'm', above=0.0,
                             high=10.0, is_dynamic=False, default=0.1)
    sees_object: bool = quantity('the lidar sees the pushed object, else it looks over it',
                                 is_dynamic=False, default=True)
    object_margin: float = quantity('margin about the object within which beams are left out',
                                    'm', 0.0, 1.0, is_dynamic=False, default=0.05)
    start_position: float = quantity('std of the first place, per axis', 'm', above=0.0, high=10.0,
                                     is_dynamic=False, default=0.1)
    start_heading: float = quantity('std of the first heading', 'rad', above=0.0, high=math.pi,
                                    is_dynamic=False, default=0.1)
    covariance_factor: float = quantity("factor of the covariance that another localization's "
                                        'poses state', '', 1.0, 1000.0, is_dynamic=False,
                                        default=3.0)
    min_heading_std: float = quantity("least std of the heading of another localization's poses, "
                                      'which are often surer than they may be', 'rad', 0.0, 1.0,
                                      is_dynamic=False, default=0.01)
    slow_distance: float = quantity(
        'distance of the hull from what scans show in neither map nor object, within which the '
        'robot is slow; 0: scans neither slow nor stop it', 'm', 0.0, 10.0, is_dynamic=False,
        default=0.0)
    slow_speed: float = quantity('its speed then', 'm/s', above=0.0, high=1.0, is_dynamic=False,
                                 default=0.08)
    stop_distance: float = quantity('the same distance on the way of the robot, within which it '
                                    'stands', 'm', 0.0, 10.0, is_dynamic=False, default=0.5)
    restart_time: float = quantity(
        'time for which the way has to be clear before it goes on by itself; 0: it waits for '
        'controller/resume or a goal', 's', 0.0, 1e6, is_dynamic=False, default=0.0)

    def __post_init__(self) -> None:
        """Validate the fields."""
        check(self)

    @property
    def mount_pose(self) -> Pose:
        """``Pose`` of the lidar in the robot frame, as stated."""
        return Pose(self.mount_x, self.mount_y, self.mount_heading)
