"""
Errors of object poses from images of tags.

MuJoCo draws the box with its tags as the camera of a TurtleBot 4 sees it, at every heading and
within 15 degrees of its axis. The table has the errors against the truth, and what the
covariances state: a ratio of 1 is an error as stated.
"""

import dataclasses
import math
from typing import NamedTuple

import numpy as np
from push_model.files.parameter_files import read_object
from push_model.geometry import Pose, wrap_angle
from push_model.rigid_transform import RigidTransform
from push_mujoco.appearance import looks_of
from push_mujoco.camera import SimulatedCamera
from push_mujoco.rendering import Renderer
from push_mujoco.simulated_robot import DEFAULT_ROBOTS, read_simulated_robot
from push_mujoco.tags import tag_pictures
from push_mujoco.wheeled_robot import WheeledPlant
from push_tags.camera import CameraIntrinsics, CameraMounting
from push_tags.detection import TagDetector
from push_tags.pose_fit import View
from push_tags.settings import DetectorSettings
from push_tags.tag_layout import read_tag_layout, TagLayout
from push_tags.tagged_object import TaggedObject

OBJECT = 'box_04'
# From the lens to the middle of the object [m].
DISTANCES = 0.5, 0.7, 1.0, 2.0, 3.0
MAX_BEARING = math.radians(15.0)
MILLIMETRES = 1e3


class Errors(NamedTuple):
    """Errors of the poses at a distance, and what was stated for them, shape (n,) each."""

    position: list[float]
    heading: list[float]
    stated_position: list[float]
    stated_heading: list[float]
    squares: list[float]


def measure(distance: float, count: int, seed: int) -> Errors:
    """
    Draw images at a distance, and compare what is detected with the truth.

    :param distance: from the lens to the middle of the object [m].
    :param count: of images.
    :param seed: of headings, bearings and pixels.
    :return: ``Errors`` of the images that told a pose.
    """
    camera, layout = SimulatedCamera(), read_tag_layout(OBJECT)
    plant = WheeledPlant(read_simulated_robot(DEFAULT_ROBOTS['differential']),
                         obj=read_object(OBJECT), looks=looks_of(tag_pictures(layout)))
    lens = CameraIntrinsics.from_view_angle(camera.width, camera.height, camera.view_angle)
    detector, settings = TagDetector(lens), DetectorSettings()
    rng = np.random.default_rng(seed)
    errors = Errors([], [], [], [], [])
    with Renderer(plant.model, camera, rng) as renderer:
        for _ in range(count):
            bearing = rng.uniform(-MAX_BEARING, MAX_BEARING)
            truth = Pose(camera.x + distance * math.cos(bearing), distance * math.sin(bearing),
                         rng.uniform(-math.pi, math.pi))
            plant.show_object(truth)
            image = renderer.render(plant.data, Pose(0.0, 0.0, 0.0))
            grey = np.rint(image @ (0.299, 0.587, 0.114)).astype(np.uint8)
            view = View(lens, _mounted_amiss(camera, settings, rng))
            tagged = TaggedObject(_glued_amiss(layout, settings, rng), settings)
            located = tagged.locate(0.0, detector.detect(grey), view).object_pose
            if located is not None and located.covariance is not None:
                _add(errors, truth, located.pose, located.covariance)
    return errors


def _glued_amiss(layout: TagLayout, settings: DetectorSettings,
                 rng: np.random.Generator) -> TagLayout:
    """Take the tags to be glued as badly as the detector expects."""
    shifts = settings.tag_deviation * rng.standard_normal((len(layout.tags), 3))
    return TagLayout(tuple(dataclasses.replace(tag, x=tag.x + x, y=tag.y + y, z=tag.z + z)
                           for tag, (x, y, z) in zip(layout.tags, shifts.tolist())))


def _mounted_amiss(camera: SimulatedCamera, settings: DetectorSettings,
                   rng: np.random.Generator) -> RigidTransform:
    """Take the camera to be mounted as badly as the detector expects."""
    height = settings.height_deviation * rng.standard_normal()
    roll, pitch = settings.tilt_deviation * rng.standard_normal(2)
    return CameraMounting(x=camera.x, y=camera.y, z=camera.z + height, yaw=camera.heading,
                          roll=roll, pitch=camera.pitch + pitch).optical_pose


def _add(errors, truth, pose, covariance) -> None:
    error = np.array((pose.x - truth.x, pose.y - truth.y, wrap_angle(pose.theta - truth.theta)))
    errors.position.append(math.hypot(*error[:2]))
    errors.heading.append(abs(error[2]))
    errors.stated_position.append(math.sqrt(covariance.x_x + covariance.y_y))
    errors.stated_heading.append(covariance.heading_deviation)
    errors.squares.append(float(error @ np.linalg.solve(covariance.matrix, error)))


def row(distance: float, count: int, errors: Errors) -> str:
    """Format the errors at a distance as a row of a Markdown table."""
    position, heading = MILLIMETRES * np.array(errors.position), np.degrees(errors.heading)
    ratio = math.sqrt(np.mean(errors.squares) / 3.0)
    return (f'| {distance:g} m | {len(errors.position)} of {count} '
            f'| {np.median(position):.1f}, {np.percentile(position, 95):.1f} mm '
            f'| {MILLIMETRES * np.median(errors.stated_position):.1f} mm '
            f'| {np.median(heading):.2f}, {np.percentile(heading, 95):.2f} degrees '
            f'| {np.degrees(np.median(errors.stated_heading)):.2f} degrees | {ratio:.2f} |')


def table(count: int, seed: int = 1) -> str:
    """
    Measure at all distances; return a table in Markdown.

    :param count: of images at each distance.
    :param seed: as of ``measure``.
    """
    rows = ['| distance | poses | position: median, 95 % | stated | heading: median, 95 % '
            '| stated | error over stated |\n| --- | --- | --- | --- | --- | --- | --- |']
    for distance in DISTANCES:
        errors = measure(distance, count, seed)
        if errors.position:
            rows.append(row(distance, count, errors))
    return '\n'.join(rows)
