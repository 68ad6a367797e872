"""What users of ``ros2`` type, against the nodes of the launch file; it is not on the index."""

import importlib.util
import os
import shutil
import signal
import subprocess
import time

from helpers.launched import Launched, NODES, TIMEOUT
from push_scenario.dds.private_network import private_domain
import pytest

pytest.importorskip('launch_ros', reason='launch_ros is not installed: there is no ROS 2 here')
ROS2 = shutil.which('ros2')
if ROS2 is None:
    pytest.skip('ros2cli is not installed: there is no ROS 2 here', allow_module_level=True)

pytestmark = [pytest.mark.dds, pytest.mark.slow]

CONTROLLER = '/push_controller'
POSE = '{header: {frame_id: odom}, pose: {position: {x: %g, y: 0.5}, orientation: {w: 1.0}}}'
# Wall time in which a command that asks no daemon meets the nodes [s]; it is waited for anyhow.
DISCOVERY_TIME = '5'
# Far enough that nobody is there before the goal is cancelled [m].
FAR = 20.0


@pytest.fixture(scope='module')
def launched(tmp_path_factory):
    """Start the simulation once for all commands."""
    with private_domain() as domain:
        launched = Launched(domain, tmp_path_factory.mktemp('launched'))
        process, _ = launched.start('simulation', 'rviz:=false')
        launched.wait_for({f'/{name}' for name in NODES})
        yield launched
        process.send_signal(signal.SIGINT)
        status = process.wait(TIMEOUT)
        launched.close()
        assert status == 0, launched.log()


def ros2(launched, *words, expected=0):
    """Run ``ros2`` and return what it printed."""
    done = subprocess.run([ROS2, *words], env=launched.environment, text=True, timeout=TIMEOUT,
                          stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT)
    assert done.returncode == expected, done.stdout
    return done.stdout


def wait_for_log(launched, text):
    """Wait until the nodes have printed something."""
    end = time.monotonic() + TIMEOUT
    while text not in launched.log():
        assert time.monotonic() < end, launched.log()
        time.sleep(0.2)


def test_a_goal_is_published_once_and_taken(launched):
    """With one subscriber in all, ``--once`` waits for the right one."""
    wait_for_log(launched, 'task: idle')
    ros2(launched, 'topic', 'pub', '--once', '/goal_pose', 'geometry_msgs/msg/PoseStamped',
         POSE % FAR)
    wait_for_log(launched, f'has a goal at {FAR:.3f} m')


def test_parameters_are_set_described_and_refused(launched):
    assert 'successful' in ros2(launched, 'param', 'set', CONTROLLER, 'drive.speed', '0.2')
    assert '0.2' in ros2(launched, 'param', 'get', CONTROLLER, 'drive.speed')
    assert '[m/s]' in ros2(launched, 'param', 'describe', CONTROLLER, 'drive.speed')
    assert 'read-only' in ros2(launched, 'param', 'set', CONTROLLER, 'robot.radius', '0.2')


def test_services_and_graph(launched):
    called = ros2(launched, 'service', 'call', '/controller/stop', 'std_srvs/srv/Trigger')
    assert 'success=True' in called
    graph = ('--no-daemon', '--spin-time', DISCOVERY_TIME)
    assert CONTROLLER in ros2(launched, 'node', 'list', *graph).split()
    assert 'TwistStamped' in ros2(launched, 'node', 'info', *graph, CONTROLLER)


def test_the_lifecycle_goes_down_and_up(launched):
    for transition, state in (('deactivate', 'inactive'), ('cleanup', 'unconfigured'),
                              ('configure', 'inactive'), ('activate', 'active')):
        assert 'successful' in ros2(launched, 'lifecycle', 'set', CONTROLLER, transition)
        assert ros2(launched, 'lifecycle', 'get', CONTROLLER).startswith(state)


@pytest.mark.skipif(importlib.util.find_spec('push_control_msgs') is None,
                    reason='push_control_msgs is not installed')
def test_ctrl_c_of_the_client_cancels_its_goal(launched):
    """Whatever it prints: that of Jazzy has no context any more when the answer comes."""
    client = subprocess.Popen(
        [ROS2, 'action', 'send_goal', '--feedback', 'push_object',
         'push_control_msgs/action/PushObject', '{goal_pose: %s}' % (POSE % -FAR)],
        env={**launched.environment, 'PYTHONUNBUFFERED': '1'}, text=True,
        stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    try:
        for line in client.stdout:
            if line.startswith('Feedback'):
                break
        os.kill(client.pid, signal.SIGINT)
        client.communicate(timeout=TIMEOUT)
    finally:
        client.kill()
    wait_for_log(launched, 'cancelled')
