"""What a controller has to know of the poses that sensors give: noise, age, bias, view."""

import dataclasses
import math
from typing import Any, NamedTuple

from push_control.settings import ControlSettings
from push_control.supervision_settings import SupervisionSettings
from push_localization.settings import PlaceSettings
from push_model.quantity import MIN_NOISE, MIN_VALUES
from push_scenario.definition.scenario import Scenario
from push_sim_node.camera import CameraSettings
from push_sim_node.lidar import LidarSensorSettings
from push_sim_node.sensors import SensorSettings

# Periods of poses after which one is missed, beyond their latency; chosen: two may be lost.
TIMEOUT_PERIODS = 3.0
# Gaps within which a camera in the room may miss the object, and one that is blind in contact does
# [m]; chosen: the robot in front of an object hides it until it is well beside it; and rounding.
ROOM_NEAREST = 0.15
CONTACT_NEAREST = 0.01


class ExpectedPoses(NamedTuple):
    """
    Settings of the controller that follow from sensors.

    :param control: values of ``ControlSettings`` by field.
    :param supervision: values of ``SupervisionSettings`` by field.
    """

    control: dict[str, float]
    supervision: dict[str, Any]


def expected_poses(sensors: SensorSettings, robot_radius: float) -> ExpectedPoses:
    """
    Compute what the controller has to know of poses, and of where the object is seen.

    With the latency L, the rate f, a bias by view of at most b (``ViewBias``) and outliers of
    standard deviation j:

        pose_timeout = L + 3 / f,   pose_bias = b / sqrt(8),   heading_bias = b_heading / 2,
        moved_distance = max(2 b, j),    moved_angle = max(2 b_heading, j_heading)

    and never less than the defaults. Noise and the reference of odometry are as they are; the view
    is that of ``expected_view``.

    :param robot_radius: [m].
    """
    control, supervision, camera = ControlSettings(), SupervisionSettings(), sensors.camera
    jump, heading_jump = 0.0, 0.0
    if sensors.pose_jump_probability > 0.0:
        jump, heading_jump = sensors.pose_jump, sensors.pose_heading_jump
    return ExpectedPoses({
        'pose_timeout': max(control.pose_timeout,
                            sensors.pose_latency + TIMEOUT_PERIODS / sensors.pose_rate),
        'pose_noise': max(control.pose_noise, sensors.pose_noise),
        'heading_noise': max(control.heading_noise, sensors.pose_heading_noise),
        'pose_noise_per_distance': camera.noise_per_distance,
        'heading_noise_per_distance': camera.heading_noise_per_distance,
        'pose_bias': max(control.pose_bias, sensors.pose_bias / math.sqrt(8.0)),
        'heading_bias': max(control.heading_bias, 0.5 * sensors.pose_heading_bias),
    }, {
        **expected_view(camera, robot_radius),
        'odometry_reference': sensors.odometry_reference,
        'moved_distance': max(supervision.moved_distance, 2.0 * sensors.pose_bias, jump),
        'moved_angle': max(supervision.moved_angle, 2.0 * sensors.pose_heading_bias,
                           heading_jump)})


def expected_view(camera: CameraSettings, robot_radius: float) -> dict[str, float]:
    """
    Compute the view that the controller has to expect of a camera.

    With a lens at (x, y) on a robot of radius R that looks along an angle a, with half the angle
    of view h, the nearest distance n and the farthest f:

        view_angle = h - |a|,   view_nearest = n + x - R,   view_farthest = f - |(x, y)|

    which hold for an object straight ahead. A camera in the room misses the object where the robot
    stands in front of it; there poses are not expected near the object.

    :param robot_radius: [m].
    :return: values of ``SupervisionSettings`` by field; empty without a camera.
    """
    if camera.place == 'none':
        return {}
    if camera.place == 'room':
        return {'view_nearest': ROOM_NEAREST}
    mount = camera.mount
    nearest = camera.nearest + mount.x - robot_radius if camera.nearest > 0.0 else 0.0
    if camera.is_blind_in_contact:
        nearest = max(nearest, CONTACT_NEAREST)
    return {'view_angle': max(camera.half_angle - abs(mount.theta), MIN_VALUES['rad']),
            'view_nearest': max(nearest, 0.0),
            'view_farthest': camera.farthest - math.hypot(mount.x, mount.y)}


def with_sensors(scenario: Scenario, sensors: SensorSettings) -> Scenario:
    """
    Let a task have other sensors, of which the controller knows what ``expected_poses`` says.

    :param scenario: of a task.
    :param sensors: of the simulator.
    :raises ValueError: where the scenario is a single push.
    """
    task = scenario.task
    if task is None:
        raise ValueError(f'scenario.task: got none in {scenario.name}, expected a task')
    control, supervision = expected_poses(sensors, scenario.robot.radius)
    return dataclasses.replace(
        scenario, sensors=sensors, control=dataclasses.replace(scenario.control, **control),
        task=dataclasses.replace(
            task, place=expected_place(task.place, sensors.lidar),
            supervision=dataclasses.replace(task.supervision, **supervision)))


def expected_place(place: PlaceSettings, lidar: LidarSensorSettings) -> PlaceSettings:
    """
    Return what the controller has to know of a lidar: its mounting and noise.

    :param place: ``PlaceSettings`` for the rest.
    :return: settings that use no scans where there is no lidar.
    """
    if lidar.rate == 0.0:
        return dataclasses.replace(place, source='none')
    return dataclasses.replace(
        place, source='scan', mount='stated', mount_x=lidar.mount_x, mount_y=lidar.mount_y,
        mount_heading=lidar.mount_heading, noise=max(lidar.noise, MIN_NOISE),
        sees_object=lidar.sees_object)
