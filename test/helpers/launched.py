"""Launch files under way, as ``ros2 launch`` runs them, on a domain of their own."""

import os
from pathlib import Path
import signal
import subprocess
import sys
import time

from ament_index_python.packages import get_package_share_directory, PackageNotFoundError
from push_scenario.dds.private_network import private_environment
import pytest
import rclpy
from rclpy.context import Context

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
        self.environment = private_environment(domain)
        self._folder = folder
        self._processes = []
        self._context = Context()
        rclpy.init(args=[], context=self._context, domain_id=domain)
        self._node = rclpy.create_node('probe', context=self._context)

    def start(self, name, *arguments):
        """Start a launch file; its output goes to a file."""
        path = self._folder / f'{len(self._processes)}.log'
        with open(path, 'wb') as log:
            process = subprocess.Popen(
                [sys.executable, '-c', SCRIPT, str(launch_file(name)), *arguments],
                stdin=subprocess.DEVNULL, stdout=log, stderr=subprocess.STDOUT,
                env=self.environment, start_new_session=True)
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
