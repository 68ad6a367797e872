"""The node of the simulator in MuJoCo over DDS, and its messages."""

from geometry_msgs.msg import TwistStamped
from helpers.extras import skip_without_graphics
from helpers.node_bench import bench
import numpy as np
from push_model.files.flat_values import to_parameter_values
from push_model.files.parameter_files import read_object, read_robot
from push_mujoco.camera import SimulatedCamera
from push_mujoco.ros.images import to_camera_info, to_image_message
from push_mujoco.settings import MujocoSettings
from push_ros.topics import SIM
import pytest
from std_msgs.msg import Header

CAMERA = SimulatedCamera(width=64, height=48)
PARAMETERS = {**to_parameter_values(read_object('box_04'), 'object.'),
              **to_parameter_values(read_robot('create3'), 'robot.'),
              'object_start': [0.45, 0.0, 0.0], 'autostart': True, 'publish_clock': True,
              'sensors.bumper_force': 1.5,
              'mujoco.image_width': 64, 'mujoco.image_height': 48,
              'mujoco.publish_object_pose': False}


def test_an_image_is_written_row_by_row() -> None:
    pixels = np.arange(48 * 64 * 3, dtype=np.uint32).astype(np.uint8).reshape(48, 64, 3)
    message = to_image_message(pixels, Header(frame_id='lens'))
    assert (message.height, message.width, message.encoding) == (48, 64, 'rgb8')
    read = np.frombuffer(bytes(message.data), np.uint8).reshape(message.height, -1)
    assert message.step == read.shape[1]
    assert (read.reshape(pixels.shape) == pixels).all()


def test_the_camera_info_projects_as_the_camera_does() -> None:
    info = to_camera_info(CAMERA, Header())
    point = np.array([0.3, -0.2, 1.7, 1.0])
    column, row, depth = np.reshape(info.p, (3, 4)) @ point
    expected = CAMERA.matrix @ point[:3]
    assert (column, row, depth) == pytest.approx(tuple(expected))
    assert np.reshape(info.k, (3, 3)) == pytest.approx(CAMERA.matrix)


@pytest.mark.parametrize('room_camera', [(1.0, 2.0), (0.0, 0.0, -1.0, 0.0, 0.0)])
def test_a_lens_that_cannot_be_is_refused(room_camera) -> None:
    with pytest.raises(ValueError, match='room_camera|SimulatedCamera.z'):
        MujocoSettings(room_camera=room_camera)


@pytest.mark.dds
@pytest.mark.slow
def test_it_publishes_images_odometry_and_the_bumper(tmp_path) -> None:
    """The robot drives on to the box, and the bumper closes."""
    skip_without_graphics()
    with bench(tmp_path, SIM, 'push_mujoco.mujoco_node', PARAMETERS) as sim:
        for topic in ('odom', 'image_raw', 'camera_info', 'bumper', 'object_pose'):
            sim.subscribe(topic)
        sim.wait_until(lambda: len(sim.received['image_raw']) > 1)
        command = TwistStamped()
        command.twist.linear.x = 0.2
        assert not sim.received['bumper'][0].data
        sim.repeat_until(lambda: sim.publish('cmd_vel', command),
                         lambda: sim.received['bumper'][-1].data, period=0.02)
        first = sim.received['image_raw'][0]
        assert sim.received['camera_info'][0].header == first.header
        assert (first.width, first.height) == (64, 48)
        stamps = {str(message.header.stamp) for message in sim.received['odom']}
        assert str(sim.received['image_raw'][1].header.stamp) in stamps
        assert sim.received['object_pose'] == []
