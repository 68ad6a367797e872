"""Launch files as ``ros2 launch`` runs them; launch is not on the package index."""

import os
import signal

from helpers.launched import launch_file, Launched, NODES, TIMEOUT
from push_scenario.dds.private_network import private_domain
import pytest

launch = pytest.importorskip('launch', reason='launch is not installed: there is no ROS 2 here')
pytest.importorskip('launch_ros', reason='launch_ros is not installed: there is no ROS 2 here')

pytestmark = [pytest.mark.dds, pytest.mark.slow]

ARGUMENTS = {'namespace', 'params_file', 'use_sim_time', 'log_level', 'object', 'robot', 'task',
             'map', 'autostart', 'rviz', 'record', 'respawn', 'wait_for_start',
             'enable_stamped_cmd_vel', 'odom', 'object_pose', 'goal_pose', 'cmd_vel', 'tracker',
             'mocap', 'robot_pose', 'object_pose_with_covariance', 'scan', 'place', 'tidy'}


@pytest.fixture
def launched(tmp_path):
    """Give a domain of its own to a test."""
    with private_domain() as domain:
        launched = Launched(domain, tmp_path)
        yield launched
        launched.close()


@pytest.mark.parametrize('name', ['simulation', 'robot', 'turtlebot4_simulation'])
def test_the_arguments_that_users_expect_are_there(name):
    source = launch.launch_description_sources.AnyLaunchDescriptionSource(str(launch_file(name)))
    described = source.get_launch_description(launch.LaunchContext())
    assert ARGUMENTS <= {argument.name for argument in described.get_launch_arguments()}


def test_two_robots_side_by_side_by_the_namespace_alone(launched):
    """Ctrl-C ends each with exit status 0, and nothing is left; one needs no RViz."""
    processes = [launched.start('simulation', 'namespace:=robot1', 'rviz:=false')[0],
                 launched.start('simulation', 'namespace:=robot2', 'object:=bin', 'rviz:=false',
                                'use_sim_time:=true')[0]]
    launched.wait_for({f'/robot{i}/{name}' for i in (1, 2) for name in NODES})
    for process in processes:
        process.send_signal(signal.SIGINT)
    assert [process.wait(TIMEOUT) for process in processes] == [0, 0], launched.log()
    launched.wait_for(set())
    assert 'Traceback' not in launched.log()


def test_where_one_node_ends_all_end(launched):
    """Unless it is to be started again."""
    process, _ = launched.start('robot', 'params_file:=/does/not/exist')
    assert process.wait(TIMEOUT) == 1
    process, path = launched.start('simulation', 'rviz:=false', 'robot:=disc_017')
    launched.wait_for({f'/{name}' for name in NODES})
    pid, = {line.split('pid [')[1].split(']')[0] for line in path.read_text().splitlines()
            if '[sim-1]: process started' in line}
    os.kill(int(pid), signal.SIGINT)
    process.wait(TIMEOUT)
    launched.wait_for(set())


@pytest.mark.parametrize('arguments, text', [
    (['object:=sofa'], "object: got 'sofa'"), (['task:=maybe'], 'task'),
    (['map:=/no/map.yaml'], 'map: got'),
    (['params_file:=/no.yaml'], "params_file: got '/no.yaml'"),
    (['tracker:=/no/tags.yaml'], "tracker: got '/no/tags.yaml'"),
    (['tracker:=tags.yaml', 'simulation:=true'], 'tracker: got'),
    (['mocap:=/no/mocap.yaml'], "mocap: got '/no/mocap.yaml'"),
    (['mocap:=mocap.yaml', 'simulation:=true'], 'mocap: got')])
def test_a_wrong_argument_is_an_error_before_anything_is_started(launched, arguments, text):
    process, path = launched.start('robot', *arguments)
    assert process.wait(TIMEOUT) == 1
    assert text in path.read_text() and 'process started' not in path.read_text()
