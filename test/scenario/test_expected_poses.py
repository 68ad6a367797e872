"""What the controller is told of a camera: it never expects poses where the camera has none."""

import dataclasses

import numpy as np
from push_control.perception.view import View
from push_model.contact import robot_gap
from push_model.files.parameter_files import named_file
from push_model.geometry import Pose
from push_scenario import load_scenario
from push_scenario.definition.expected_poses import with_sensors
from push_scenario.definition.loader import read_sensors
from push_sim_node.camera import Camera, CameraSettings
from push_sim_node.sensors import SensorSettings
import pytest

SCENARIO = load_scenario('task_demo')
OBJECT, ROBOT = SCENARIO.object, SCENARIO.robot
CAMERAS = [read_sensors(named_file('sensors', name)) for name in ('own_camera', 'near')]
TURNED = SensorSettings(camera=CameraSettings(
    place='robot', mount_x=0.05, mount_heading=0.2, half_angle=0.6, nearest=0.2, farthest=1.5))


@pytest.mark.parametrize('sensors', [*CAMERAS, TURNED])
def test_the_camera_sees_the_object_where_poses_are_expected(sensors):
    """From any place, with the margins of the view."""
    view = View.from_settings(with_sensors(SCENARIO, sensors).task.supervision)
    camera = Camera(sensors.camera, OBJECT, ROBOT.radius)
    draws = np.random.default_rng(3)
    seen = 0
    for _ in range(600):
        robot, obj = (Pose(*draws.uniform(-1.5, 1.5, 2), draws.uniform(-3.0, 3.0))
                      for _ in range(2))
        gap = robot_gap(OBJECT, obj, robot, ROBOT.radius)
        if gap > 0.0 and view.expects(robot, obj, gap):
            seen += 1
            assert camera.sees(obj, robot)
    assert seen > 10


def test_without_a_camera_the_view_has_no_limits():
    sensors = SensorSettings(pose_rate=10.0, pose_latency=0.2)
    task = with_sensors(SCENARIO, sensors)
    assert not task.task.supervision.has_limited_view
    assert task.sensors == sensors and task.control.pose_timeout == pytest.approx(0.5)


def test_single_pushes_have_no_other_sensors_this_way():
    with pytest.raises(ValueError, match='expected a task'):
        with_sensors(dataclasses.replace(SCENARIO, task=None), TURNED)
