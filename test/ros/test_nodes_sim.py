"""The simulator's node over Fast DDS, with a controller that the test plays."""

import math
import signal

from geometry_msgs.msg import PoseWithCovarianceStamped, TwistStamped
from helpers.build_interfaces import available_tf2_msgs
from helpers.node_bench import bench
from nav_msgs.msg import Odometry
import numpy as np
from push_model.files.flat_values import to_parameter_values
from push_model.geometry import Pose
from push_ros.conversions.measurements import from_object_pose_message
from push_ros.conversions.primitives import nanoseconds, seconds, to_pose_message
from push_ros.diagnostics import status_values, WARN
from push_ros.topics import CONTROLLER, SIM
from push_scenario.definition.catalogue import find_scenario
from push_scenario.definition.loader import read_scenario
import pytest
from rcl_interfaces.srv import SetParametersAtomically
from rclpy.parameter import Parameter

pytestmark = [pytest.mark.dds, pytest.mark.slow]

MODULE = 'push_sim_node.sim_node'
SCENARIO = read_scenario(find_scenario('straight_push'))
PHYSICS = {**to_parameter_values(SCENARIO.object, 'object.'),
           **to_parameter_values(SCENARIO.robot, 'robot.')}
AWAY = {'robot_start': [-2.0, 0.0, 0.0]}
PERIOD = 0.02


@pytest.fixture(scope='module')
def sim(tmp_path_factory):
    """Start the simulator on the wall clock, which starts by itself."""
    parameters = {**PHYSICS, **AWAY, 'autostart': True}
    with bench(tmp_path_factory.mktemp('sim'), SIM, MODULE, parameters) as b:
        for topic in ('odom', 'object_pose', 'diagnostics'):
            b.subscribe(topic)
        b.wait_until(lambda: len(b.received['odom']) > 5)
        yield b


def test_it_moves_as_commanded_and_stops_without_commands(sim):
    """On the wall clock, with stamps of it."""
    command = TwistStamped()
    command.twist.linear.x = 0.1

    def speed():
        return sim.received['odom'][-1].twist.twist.linear.x

    sim.repeat_until(lambda: sim.publish('cmd_vel', command),
                     lambda: speed() == pytest.approx(0.1, abs=0.02), period=PERIOD)
    stamp = seconds(sim.received['odom'][-1].header.stamp)
    assert abs(1e-9 * sim.node.get_clock().now().nanoseconds - stamp) < 500.0
    sim.wait_until(lambda: speed() < 1e-3)
    steps = np.diff([seconds(m.header.stamp) for m in sim.received['odom']])
    # Longer where the machine held the simulator up.
    assert np.median(steps) == pytest.approx(PERIOD, abs=1e-6)
    assert steps.min() > PERIOD - 1e-6
    sim.wait_until(lambda: any('no command for 0.5 s: the robot stands' in status.message
                               for message in sim.received['diagnostics']
                               for status in message.status))


def test_commands_reach_a_simulator_that_was_suspended(sim):
    """As soon as it goes on: none waits until one that was lost meanwhile is sent again."""
    command = TwistStamped()
    command.twist.linear.x = 0.1
    # The newest odometry alone: what has come before a command does not count for it.
    newest = []
    subscription = sim.node.create_subscription(Odometry, 'odom', newest.append, 1)
    sim.wait_until(lambda: newest)

    def speed():
        return newest[-1].twist.twist.linear.x

    def commands_until_it_moves():
        count = 0
        while speed() < 0.08:
            count += 1
            sim.publish('cmd_vel', command)
            seen = len(newest)
            sim.wait_until(lambda: len(newest) > seen)
        return count

    counts = []
    for _ in range(3):
        commands_until_it_moves()
        sim.processes.send(SIM, signal.SIGSTOP)
        # Until it does not read what it gets.
        sim.spin(1.5)
        for _ in range(10):
            sim.publish('cmd_vel', TwistStamped())
        sim.spin(1.5)
        sim.processes.send(SIM, signal.SIGCONT)
        # By a command, or without.
        sim.wait_until(lambda: speed() < 0.02)
        counts.append(commands_until_it_moves())
    sim.node.destroy_subscription(subscription)
    # At 50 Hz; what waits for a command that was lost waits for 3 s.
    assert max(counts) < 50, counts


def test_stamps_of_a_simulator_that_was_held_up_are_right_again(sim):
    """It stands: after many halts, each too short to be skipped, stamps are those of the clock."""
    def lag():
        count = len(sim.received['odom'])
        sim.wait_until(lambda: len(sim.received['odom']) > count)
        now = 1e-9 * sim.node.get_clock().now().nanoseconds
        return now - seconds(sim.received['odom'][-1].header.stamp)

    for _ in range(10):
        sim.processes.send(SIM, signal.SIGSTOP)
        sim.spin(0.35)
        sim.processes.send(SIM, signal.SIGCONT)
        sim.spin(0.05)
    sim.wait_until(lambda: lag() < 0.3)
    values = [status_values(status) for message in sim.received['diagnostics']
              for status in message.status]
    assert 'stamp_lag' in values[-1]


def test_it_starts_over_while_a_controller_repeats_its_stop(sim):
    """An initial pose puts the object elsewhere; a reset puts it back, and time runs on."""
    timer = sim.node.create_timer(0.05, lambda: sim.publish('cmd_vel', TwistStamped()))
    place = PoseWithCovarianceStamped()
    place.header.frame_id = 'odom'
    place.pose.pose = to_pose_message((1.0, 2.0, 0.5))
    sim.publish('initialpose', place)
    wait_for_object(sim, Pose(1.0, 2.0, 0.5))
    assert sim.call('sim/reset').success
    wait_for_object(sim, Pose(0.0, 0.0, 0.0))
    count = len(sim.received['odom'])
    sim.wait_until(lambda: len(sim.received['odom']) > count + 20)
    timer.cancel()


def wait_for_object(b, pose):
    """Wait until the object is measured at a pose."""
    b.wait_until(lambda: from_object_pose_message(
        b.received['object_pose'][-1], 'odom').pose == pytest.approx(pose, abs=1e-6))


def test_it_holds_time_until_it_is_started(tmp_path):
    """In lockstep it offers its first measurements again and again, and then waits."""
    with bench(tmp_path, SIM, MODULE, {**PHYSICS, **AWAY, 'lockstep': True}) as b:
        for topic in ('odom', 'object_pose', 'clock'):
            b.subscribe(topic)
        b.wait_until(lambda: len(b.received['odom']) > 2 and len(b.received['object_pose']) > 2)
        assert {nanoseconds(m.header.stamp) for m in b.received['odom']} == {0}
        assert b.call('sim/start').success and b.call('sim/start').success
        times = set()
        for _ in range(20):
            count = len(b.received['odom']) + len(b.received['object_pose'])
            b.wait_until(lambda: len(b.received['odom']) + len(b.received['object_pose']) > count)
            newest = max((m[-1] for m in (b.received['odom'], b.received['object_pose'])),
                         key=lambda m: nanoseconds(m.header.stamp))
            times.add(nanoseconds(newest.header.stamp))
            b.publish('cmd_vel', TwistStamped(header=newest.header))
        assert max(times) > 0
        assert b.call('sim/reset').success
        count = len(b.received['odom'])
        b.wait_until(lambda: len(b.received['odom']) > count + 1)
        assert nanoseconds(b.received['odom'][-1].header.stamp) == 0


def test_clock_and_speed_of_time(tmp_path):
    """The clock goes on between measurements; a speed that cannot be reached is a warning."""
    parameters = {**PHYSICS, **AWAY, 'autostart': True, 'publish_clock': True, 'time_scale': 0.1}
    with bench(tmp_path, SIM, MODULE, parameters) as b:
        b.subscribe('clock')
        b.wait_until(lambda: len(b.received['clock']) > 20)
        times = [seconds(message.clock) for message in b.received['clock']]
        assert times == sorted(times)
        assert min(later - time for time, later in zip(times, times[1:])) < 0.0101
        assert b.call('sim/reset').success
        count = len(b.received['clock'])
        b.wait_until(lambda: len(b.received['clock']) > count + 20)
        times = [seconds(message.clock) for message in b.received['clock']]
        assert times == sorted(times), 'a reset lets the clock fall back'
        refused, accepted = set_parameters(b, time_scale=1000.0), set_parameters(b, time_scale=100)
        assert not refused.successful and 'time_scale' in refused.reason, refused
        assert accepted.successful
        b.subscribe('diagnostics')

        def warnings():
            return [status for message in b.received['diagnostics']
                    for status in message.status
                    if status.level == WARN and 'time_scale asks for 100' in status.message]

        b.wait_until(warnings)
        values = {item.key: item.value for item in warnings()[0].values}
        assert 0.0 < float(values['speed']) < 100.0


def set_parameters(b, **values):
    """Set parameters of the simulator as ``ros2 param set`` does; return the result."""
    request = SetParametersAtomically.Request(parameters=[
        Parameter(name, value=value).to_parameter_msg() for name, value in values.items()])
    return b.request(SetParametersAtomically, f'{SIM}/set_parameters_atomically', request).result


def test_odometry_states_its_covariance(sim):
    """Of pose and velocity, as motion filters need them."""
    sim.wait_until(lambda: sim.received['odom'])
    odometry = sim.received['odom'][-1]
    for covariance in (odometry.pose.covariance, odometry.twist.covariance):
        assert all(covariance[place] > 0.0 for place in (0, 7, 35))


def test_tf_is_odometry_and_the_truth_has_frames_of_its_own(tmp_path):
    """Odometry begins with a wrong heading here."""
    with available_tf2_msgs():
        from tf2_msgs.msg import TFMessage
        parameters = {**PHYSICS, **AWAY, 'autostart': True,
                      'sensors.odometry_heading_offset': 0.3}
        with bench(tmp_path, SIM, MODULE, parameters) as b:
            yaws = {}

            def on_tf(message):
                for transform in message.transforms:
                    assert transform.header.frame_id == 'odom'
                    rotation = transform.transform.rotation
                    yaws[transform.child_frame_id] = 2.0 * math.atan2(rotation.z, rotation.w)
            b.node.create_subscription(TFMessage, '/tf', on_tf, 100)
            b.wait_until(lambda: len(yaws) >= 3)
            assert yaws == pytest.approx(
                {'base_link': 0.3, 'truth/base_link': 0.0, 'truth/object': 0.0}, abs=1e-6)


def test_a_signal_ends_a_node_that_still_compiles(tmp_path, monkeypatch):
    """With an empty cache of machine code; it ends in order, and without a traceback."""
    monkeypatch.setenv('NUMBA_CACHE_DIR', str(tmp_path / 'cache'))
    with bench(tmp_path, CONTROLLER, 'push_control.controller_node', PHYSICS) as b:
        b.wait_until(lambda: (CONTROLLER, '/') in b.node.get_node_names_and_namespaces())
        b.processes.stop(CONTROLLER)
    assert 'Traceback' not in (tmp_path / f'{CONTROLLER}.log').read_text()
