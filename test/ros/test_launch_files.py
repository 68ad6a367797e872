"""Launch files as ``ros2 launch`` runs them; launch is not on the package index."""

import os
from pathlib import Path
import signal
import subprocess
import sys
import time

from ament_index_python.packages import get_package_share_directory, PackageNotFoundError
from push_scenario.dds.processes import private_domain
from push_scenario.dds.replay_client import local_discovery
import pytest
import rclpy
from rclpy.context import Context

launch = pytest.importorskip('launch', reason='launch is not installed: there is no ROS 2 here')
pytest.importorskip('launch_ros', reason='launch_ros is not installed: there is no ROS 2 here')

pytestmark = [pytest.mark.dds, pytest.mark.slow]

# What ``ros2 launch`` does with a file and its arguments.
SCRIPT = """
import sys
from launch import LaunchDescription, LaunchService
from launch.actions import IncludeLaunchDescription
from launch.launch_description_sources import AnyLaunchDescriptionSource
path, *words = sys.argv[1:]
service = LaunchService(argv=words, noninteractive=True)
service.include_launch_description(LaunchDescription([IncludeLaunchDescription(
    AnyLaunchDescriptionSource(path),
    launch_arguments=[tuple(word.split(':=', 1)) for word in words])]))
sys.exit(service.run())
"""
NODES = {'push_sim', 'push_planner', 'push_controller'}
ARGUMENTS = {'namespace', 'params_file', 'use_sim_time', 'log_level', 'object', 'robot', 'task',
             'map', 'autostart', 'rviz', 'record', 'respawn', 'wait_for_start',
             'enable_stamped_cmd_vel', 'odom', 'object_pose', 'goal_pose', 'cmd_vel', 'tracker',
             'object_pose_with_covariance'}
TIMEOUT = 300.0


def launch_file(name):
    """Return the path of an installed launch file."""
    try:
        share = get_package_share_directory('push_control')
    except (PackageNotFoundError, EnvironmentError):
        pytest.skip('push_control is not installed in a sourced workspace')
    return Path(share) / 'launch' / f'{name}_launch.py'


class Launched:
    """Launch files under way on one domain, and a node that sees what they have started."""

    def __init__(self, domain, folder):
        self._environment = {**os.environ, 'ROS_DOMAIN_ID': str(domain),
                             'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST'}
        self._folder = folder
        self._processes = []
        self._context = Context()
        with local_discovery():
            rclpy.init(args=[], context=self._context, domain_id=domain)
        self._node = rclpy.create_node('probe', context=self._context)

    def start(self, name, *arguments):
        """Start a launch file; its output goes to a file."""
        path = self._folder / f'{len(self._processes)}.log'
        with open(path, 'wb') as log:
            process = subprocess.Popen(
                [sys.executable, '-c', SCRIPT, str(launch_file(name)), *arguments],
                stdin=subprocess.DEVNULL, stdout=log, stderr=subprocess.STDOUT,
                env=self._environment, start_new_session=True)
        self._processes.append((process, path))
        return process, path

    def nodes(self):
        """Full names of the nodes of this package that are there."""
        return {f'{namespace.rstrip("/")}/{name}' for name, namespace
                in self._node.get_node_names_and_namespaces() if name in NODES}

    def wait_for(self, names):
        """Wait until exactly these nodes are there."""
        end = time.monotonic() + TIMEOUT
        while self.nodes() != names:
            assert time.monotonic() < end, (self.nodes(), self.log())
            time.sleep(0.2)

    def log(self):
        """Read the output of all."""
        return '\n'.join(path.read_text() for _, path in self._processes)

    def close(self):
        """End whatever has been left."""
        for process, _ in self._processes:
            if process.poll() is None:
                os.killpg(process.pid, signal.SIGKILL)
                process.wait()
        self._node.destroy_node()
        rclpy.shutdown(context=self._context)


@pytest.fixture
def launched(tmp_path):
    """Give a domain of its own to a test."""
    with private_domain() as domain:
        launched = Launched(domain, tmp_path)
        yield launched
        launched.close()


@pytest.mark.parametrize('name', ['simulation', 'robot'])
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
    (['object:=sofa'], 'sofa: got no such file'), (['task:=maybe'], 'task'),
    (['map:=/no/map.yaml'], 'map: got'), (['record:=bag', 'params_file:=/no.yaml'], '/no.yaml'),
    (['tracker:=/no/tags.yaml'], '/no/tags.yaml'),
    (['tracker:=tags.yaml', 'simulation:=true'], 'tracker: got')])
def test_a_wrong_argument_is_an_error_before_anything_is_started(launched, arguments, text):
    process, path = launched.start('robot', *arguments)
    assert process.wait(TIMEOUT) == 1
    assert text in path.read_text() and 'process started' not in path.read_text()
