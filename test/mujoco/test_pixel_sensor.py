"""Poses from images: frames, losses, and the draws that decide about them."""

import dataclasses

from helpers.extras import import_extra, skip_without_graphics
import numpy as np
from push_model.files.parameter_files import read_object
from push_model.geometry import Pose
from push_model.signals import ObjectPose, PoseCovariance
from push_mujoco.simulated_robot import read_simulated_robot
from push_sim_node.sensors import SensorSettings
import pytest

pixel_sensor = import_extra('mujoco', 'mujoco', 'push_mujoco.pixel_sensor')
wheeled_robot = import_extra('mujoco', 'mujoco', 'push_mujoco.wheeled_robot')
BOX, ROBOT = read_object('box_04'), read_simulated_robot('turtlebot4')
OBJECT_POSE, ROBOT_POSE = Pose(0.9, 0.2, 0.3), Pose(0.1, -0.1, 0.2)
COVARIANCE = PoseCovariance.from_deviations(0.002, 0.01)


def measurements(place: str, settings: SensorSettings) -> list[ObjectPose | None]:
    """Measure five times where the box is, by what sees an image and knows the truth."""
    skip_without_graphics()
    plant = wheeled_robot.WheeledPlant(ROBOT, obj=BOX, object_pose=OBJECT_POSE,
                                       robot_pose=ROBOT_POSE)
    camera = dataclasses.replace(ROBOT.camera, place=place, width=64, height=48)

    def detect(_, image):
        assert image.shape == (48, 64) and image.std() > 5.0
        base = ROBOT_POSE if place == 'robot' else Pose(0.0, 0.0, 0.0)
        return pixel_sensor.DetectedPose(base.inverse() @ OBJECT_POSE, COVARIANCE)

    noise, losses, outliers = map(np.random.default_rng, range(3))
    sensor = pixel_sensor.PixelSensor(settings, noise, losses, outliers, plant=plant,
                                      eye=pixel_sensor.Eye(camera, detect))
    return [sensor.measure(0.1 * index, OBJECT_POSE) for index in range(5)]


@pytest.mark.parametrize('place', ['robot', 'room'])
def test_a_pose_in_the_frame_of_the_camera_is_brought_to_the_world(place) -> None:
    for index, measured in enumerate(measurements(place, SensorSettings())):
        assert measured.time == pytest.approx(0.1 * index)
        assert measured.pose == pytest.approx(OBJECT_POSE, abs=1e-5)
        assert measured.covariance == COVARIANCE


def test_losses_are_those_of_the_settings() -> None:
    settings = SensorSettings(pose_dropouts=((0.05, 0.25),))
    assert [pose is None for pose in measurements('room', settings)] == [
        False, True, True, False, False]
