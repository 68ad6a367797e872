"""Sensor of object poses that takes images, in place of one that draws its errors."""

from typing import Callable, NamedTuple

import numpy as np
from numpy.typing import NDArray
from push_model.geometry import Pose
from push_model.signals import ObjectPose, PoseCovariance
from push_mujoco.camera import SimulatedCamera
from push_mujoco.rendering import Renderer
from push_mujoco.wheeled_robot import WheeledPlant
from push_sim_node.sensors import PoseSensor, SensorSettings, Sighting


class DetectedPose(NamedTuple):
    """
    Pose of an object as an image shows it, in the frame that the camera is fixed to.

    :param pose: ``Pose`` of the object.
    :param covariance: ``PoseCovariance`` of it, along the axes of that frame.
    """

    pose: Pose
    covariance: PoseCovariance


# Finds the object at a time [s] in grey values, shape (rows, columns); None where it is not seen.
Detector = Callable[[float, NDArray[np.uint8]], DetectedPose | None]


class Eye(NamedTuple):
    """
    A camera, and what finds the object in its images.

    :param camera: ``SimulatedCamera``.
    :param detect: ``Detector``.
    """

    camera: SimulatedCamera
    detect: Detector


class PixelSensor(PoseSensor):
    """
    Draws an image for each measurement, and detects the object in it.

    Losses are those of ``SensorSettings``; the other errors are those of the pixels.

    :param settings: as of ``PoseSensor``.
    :param noise: ``numpy.random.Generator`` of the noise of the pixels.
    :param losses: as of ``PoseSensor``.
    :param outliers: likewise; no pose is drawn by it.
    :param eye: ``Eye``.
    :param plant: ``WheeledPlant`` that is seen.
    """

    def __init__(self, settings: SensorSettings, noise: np.random.Generator,
                 losses: np.random.Generator, outliers: np.random.Generator, *,
                 eye: Eye, plant: WheeledPlant) -> None:
        super().__init__(settings, noise, losses, outliers)
        self._eye = eye
        self._plant = plant
        self._renderer = Renderer(plant.model, eye.camera, noise)

    def measure(self, time: float, pose: Pose, sighting: Sighting = Sighting(), *,
                certain: bool = False) -> ObjectPose | None:
        """
        Take one image, and detect the object in it.

        :param time: now [s].
        :param pose: true ``Pose`` of the object, which no pixel knows.
        :param sighting: not looked at.
        :param certain: not looked at.
        :return: ``ObjectPose`` in the world; None where the object is not seen or the pose lost.
        """
        if self.is_lost(time):
            return None
        robot_pose = self._plant.pose
        image = self._renderer.render(self._plant.data, robot_pose)
        grey = image.astype(np.float32).mean(axis=2).round().astype(np.uint8)
        detected = self._eye.detect(time, grey)
        if detected is None:
            return None
        is_fixed = self._eye.camera.place == 'room'
        return ObjectPose(time, detected.pose if is_fixed else robot_pose @ detected.pose,
                          detected.covariance)
