"""The command calibrate, as a new user runs it: over DDS, and without ROS."""

import contextlib
import dataclasses
import io
from pathlib import Path
import signal
import subprocess
import sys
import time

from geometry_msgs.msg import PoseStamped, PoseWithCovarianceStamped
from helpers.extras import import_extra
from helpers.node_bench import bench, REACTION_TIMEOUT
from push_base.calibration.program import CalibrationProgram
from push_base.calibration.recording_file import to_csv
from push_model.files.flat_values import to_parameter_values
from push_model.files.parameter_files import read_robot
from push_model.geometry import Pose
from push_model.signals import Odometry, STOP
from push_ros import qos
from push_ros.topics import SIM
from push_scenario import load_scenario, simulate
from push_scenario.calibration import cli
from push_scenario.calibration.ros.calibrator import Calibrator
from push_scenario.dds.private_network import private_domain, private_environment
from push_scenario.simulation.loop import make_simulation
from push_scenario.simulation.result import Outcome
from push_scenario.terminal_line import TerminalLine
import pytest
import rclpy
import yaml

pytestmark = pytest.mark.slow
SCENARIO = load_scenario('task_tap')
# What a wheel does below it, and when it follows.
LEAST, DEAD_TIME = 0.06, 0.14
TRUE_ROBOT = dataclasses.replace(SCENARIO.robot, min_speed=LEAST, dead_time=DEAD_TIME)
FILES = {'robot.yaml', 'sensors.yaml', 'params.yaml', 'report.txt', 'calibration.png',
         'recording.csv'}


@pytest.fixture
def network(tmp_path_factory):
    """Start a simulated base in lockstep, out of reach of its object; return its bench."""
    parameters = {**to_parameter_values(SCENARIO.object, 'object.'),
                  **to_parameter_values(TRUE_ROBOT, 'robot.'), 'lockstep': True, 'autostart': True,
                  'robot_start': [-4.0, 0.0, 0.3]}
    with bench(tmp_path_factory.mktemp('sim'), SIM, 'push_sim_node.sim_node', parameters) as b:
        yield b


# The command, with a wait for odometry that is no longer than a test needs [s].
PATIENCE = 10.0
IMPATIENT = f"""
import sys
from push_scenario.calibration import cli
from push_scenario.calibration.ros import calibrator
calibrator.LOCKSTEP_TIMEOUT = {PATIENCE}
sys.exit(cli.main())
"""


@contextlib.contextmanager
def started(network, folder, *program):
    """Start the command, or a program for it, with the robot as its user states it."""
    path = folder / 'my.yaml'
    path.write_text(yaml.safe_dump({'/**': {'ros__parameters': {
        **to_parameter_values(SCENARIO.object, 'object.'),
        **to_parameter_values(SCENARIO.robot, 'robot.'), 'lockstep': True}}}))
    with subprocess.Popen(
            [sys.executable, *(program or ('-m', 'push_scenario.calibration.cli')), '--out',
             str(folder / 'out'), '--ros-args', '--params-file', str(path)],
            env=private_environment(network.node.context.get_domain_id()), text=True,
            stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        try:
            yield process
        finally:
            process.kill()


@pytest.mark.dds
def test_interrupted_over_dds_it_writes_what_it_has(network, tmp_path):
    """Ctrl-C while it drives: the base gets zeros, and there is a report."""
    with started(network, tmp_path) as process:
        for line in process.stderr:
            if line.startswith('steps'):
                process.send_signal(signal.SIGINT)
                break
        output, _ = process.communicate(timeout=120)
        assert process.returncode == cli.INTERRUPTED
    assert 'Ended early: it was interrupted' in output
    assert {path.name for path in (tmp_path / 'out').iterdir()} == FILES


@pytest.mark.dds
def test_where_the_simulator_ends_it_ends_and_writes_what_it_has(network, tmp_path):
    """Nobody interrupts it: nothing comes any more, and it waits no longer."""
    with started(network, tmp_path, '-c', IMPATIENT) as process:
        for line in process.stderr:
            if line.startswith('steps'):
                network.processes.stop(SIM)
                break
        output, _ = process.communicate(timeout=240)
    assert 'Ended early: odometry ceased' in output
    assert {path.name for path in (tmp_path / 'out').iterdir()} == FILES


@pytest.mark.dds
def test_over_dds_the_base_is_measured_and_its_files_do_a_task(network, tmp_path):
    """A base that is late and has a dead band does a task as it is measured."""
    with started(network, tmp_path) as process:
        output, errors = process.communicate(timeout=400)
    assert process.returncode == cli.DONE, errors
    assert 'lines' in errors
    robot = read_robot(tmp_path / 'out' / 'robot.yaml')
    assert robot.min_speed == pytest.approx(LEAST, abs=0.01)
    assert robot.dead_time == pytest.approx(DEAD_TIME, abs=0.02)
    result = simulate(dataclasses.replace(SCENARIO, robot=robot, true_robot=TRUE_ROBOT))
    assert result.outcome is Outcome.DONE


@pytest.mark.dds
@pytest.mark.parametrize('kind', [PoseStamped, PoseWithCovarianceStamped])
def test_object_poses_of_both_types_are_recorded(kind: type, tmp_path: Path) -> None:
    """Those with a covariance where the parameter says so, as for the other nodes."""
    path = tmp_path / 'my.yaml'
    path.write_text(yaml.safe_dump({'/**': {'ros__parameters': {
        **to_parameter_values(SCENARIO.object, 'object.'),
        **to_parameter_values(SCENARIO.robot, 'robot.'),
        'object_pose_with_covariance': kind is PoseWithCovarianceStamped, 'lockstep': True}}}))
    message = kind()
    message.header.frame_id = 'odom'
    programs: list[CalibrationProgram] = []
    with private_domain() as domain, contextlib.ExitStack() as stack:
        rclpy.init(args=['--ros-args', '--params-file', str(path)], domain_id=domain)
        stack.callback(rclpy.shutdown)
        node = Calibrator(programs.append, lambda _: None)
        stack.callback(node.destroy_node)
        publisher = node.create_publisher(kind, 'object_pose', qos.MEASUREMENT)
        end = time.monotonic() + REACTION_TIMEOUT
        while publisher.get_subscription_count() == 0 and time.monotonic() < end:
            time.sleep(0.01)
        publisher.publish(message)
        while not node._program.recording.object_poses and time.monotonic() < end:
            node.poll()
            time.sleep(0.01)
        node.close()
    assert len(programs[0].recording.object_poses) == 1


def test_it_drives_the_robot_in_the_engine_of_the_scenario() -> None:
    """As its runs do."""
    import_extra('mujoco', 'mujoco')
    scenario = dataclasses.replace(SCENARIO, engine='mujoco')
    plant = cli._simulation(scenario, has_touch=False).plant
    assert type(plant) is type(make_simulation(scenario).plant)
    assert type(plant) is not type(make_simulation(SCENARIO).plant)


def test_without_ros_it_calibrates_the_robot_of_a_scenario(tmp_path, capsys):
    """With all files, and the true values of the scenario's robot."""
    assert cli.main(['--sim', 'task_tap', '--out', str(tmp_path)]) == cli.DONE
    assert {path.name for path in tmp_path.iterdir()} == FILES
    robot = read_robot(tmp_path / 'robot.yaml')
    true = SCENARIO.true_robot
    assert robot.time_constant == pytest.approx(true.time_constant, rel=0.2)
    assert robot.dead_time < 0.02
    assert 'dead time' in capsys.readouterr().out
    # What was recorded says the same when it is read again.
    again = tmp_path / 'again'
    assert cli.main(['--from', str(tmp_path / 'recording.csv'), '--out', str(again)]) == cli.DONE
    for name in ('robot.yaml', 'sensors.yaml', 'params.yaml', 'report.txt'):
        assert (again / name).read_text() == (tmp_path / name).read_text()


@pytest.fixture
def recording(tmp_path):
    """Write a recording of a robot that stands."""
    program = CalibrationProgram(SCENARIO.robot)
    for k in range(200):
        program.step(0.02 * k, Odometry(0.02 * k, Pose(0.0, 0.0, 0.0), STOP))
    path = tmp_path / 'own.csv'
    path.write_text(to_csv(program.recording))
    return path


@pytest.mark.parametrize('broken, missing', [
    ('push_scenario.plots.calibration.draw_calibration', {'calibration.png'}),
    ('push_scenario.calibration.cli.estimate', FILES),
    ('push_base.calibration.report.sensor_entries', {'sensors.yaml'})])
def test_a_product_that_fails_is_named_and_the_others_are_written(
        broken, missing, recording, tmp_path, capsys, monkeypatch):
    """With the reason; the exit status says so."""
    def fail(*_):
        raise ZeroDivisionError('as planted')

    monkeypatch.setattr(broken, fail)
    assert cli.main(['--from', str(recording), '--out', str(tmp_path / 'out')]) == cli.FAILED
    written = {path.name for path in (tmp_path / 'out').iterdir()}
    assert written == FILES - {'recording.csv'} - missing
    assert 'failed: ZeroDivisionError: as planted' in capsys.readouterr().err


def test_what_was_recorded_is_written_before_it_is_evaluated(tmp_path, monkeypatch, capsys):
    """Even where Ctrl-C ends the evaluation."""
    def interrupt(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(cli, 'estimate', interrupt)
    monkeypatch.setattr('push_scenario.calibration.simulated.run_program', interrupt)
    assert cli.main(['--sim', 'task_tap', '--out', str(tmp_path)]) == cli.INTERRUPTED
    assert {path.name for path in tmp_path.iterdir()} == {'recording.csv'}
    assert '--from' in capsys.readouterr().err


class Terminal(io.StringIO):
    """Text stream that says it is a terminal."""

    def isatty(self):
        return True


@pytest.mark.parametrize('columns', [3, 12, 20, 40, 80, 200])
def test_the_progress_fits_into_the_terminal(columns, monkeypatch):
    """Whatever its width: nothing wraps, and the bar gives way to the words."""
    monkeypatch.setattr(TerminalLine, 'columns', columns)
    stream = Terminal()
    bar, program = cli.ProgressBar(stream), CalibrationProgram(SCENARIO.robot)
    for title in ('waits for odometry', 'steps of rotation', 'stops'):
        program.title = title
        bar(program)
        shown = stream.getvalue().rsplit('\r', 1)[1]
        assert len(shown) <= columns
        assert title in shown or len(title) > columns


def test_what_it_cannot_use_is_named(tmp_path, capsys):
    """A scenario that does not exist."""
    assert cli.main(['--sim', 'no_such', '--out', str(tmp_path)]) == cli.MISUSE
    assert 'no_such' in capsys.readouterr().err
