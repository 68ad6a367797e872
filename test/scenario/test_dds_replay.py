"""Whole replays over Fast DDS: three nodes in three processes each."""

from collections import Counter
from concurrent.futures import ThreadPoolExecutor
import dataclasses
import os
from pathlib import Path
import signal
import subprocess
import sys
import time

from helpers.extras import import_extra
import numpy as np
from push_control.settings import LAWS
from push_model.geometry import distance
from push_model.parameters import CONTACT_KINDS, DRIVES
from push_ros.topics import CONTROLLER, PLANNER, SIM
from push_scenario.dds import bag_playback, parameter_files
from push_scenario.dds.bag_playback import play_back
from push_scenario.dds.processes import NodeDied, NodeProcesses
from push_scenario.dds.replay import run_over_dds
from push_scenario.dds.replay_client import ReplayFailed
from push_scenario.definition.loader import load_scenario
from push_scenario.evaluation.metrics import is_as_expected
from push_scenario.simulation.loop import SETTLE_TIME, simulate
from push_scenario.simulation.result import Outcome
import pytest

# Until when pushes are replayed that need not arrive [s].
PART = 4.0
# How long a recorder stands still [s]: some seconds of simulated time.
SUSPENSION = 0.5
# Only keeps a suite from hanging [s].
TIMEOUT = 400.0
ROOT = Path(__file__).resolve().parents[2]
AnyReader = import_extra('rosbags', 'record', 'rosbags.highlevel').AnyReader
make_reader = import_extra('mcap', 'test', 'mcap.reader').make_reader
pytestmark = [pytest.mark.dds, pytest.mark.slow]


def scenario(name, **changes):
    """Load a scenario of the package, and change some of it."""
    return dataclasses.replace(load_scenario(name), **changes)


@pytest.fixture(scope='module')
def progress():
    """Collect what the first replay tells of its progress."""
    return []


@pytest.fixture(scope='module')
def side_by_side(tmp_path_factory, progress):
    """Replay a push with poor sensors, and at the same time a part of it with Twist commands."""
    folders = [tmp_path_factory.mktemp(name) for name in ('stamped', 'plain')]
    scenarios = (scenario('corner_push_mismatch'),
                 scenario('corner_push_mismatch', time_limit=PART))
    with ThreadPoolExecutor(2) as pool:
        runs = [pool.submit(run_over_dds, one, 'feedback', folder, stamped=stamped,
                            progress=told)
                for one, folder, stamped, told in zip(
                    scenarios, folders, (True, False), (progress.append, None))]
        return [run.result() for run in runs]


def test_replays_side_by_side_do_not_interfere(side_by_side):
    """
    The push reaches its goal as if it were alone, with noise, latency, losses and all.

    Without stamps a command may count for the next measurement, so that the tapes are not equal.
    """
    assert is_as_expected(side_by_side[0])
    assert side_by_side[1].duration == PART
    first, second = (run.tape.poses('object')[run.tape['time'] < 0.5 * PART]
                     for run in side_by_side)
    assert np.hypot(*(first - second)[:, :2].T).max() < 2e-3


def test_a_push_over_dds_goes_as_in_process(side_by_side):
    """The same push, but for what conversion to quaternions and stamps rounds."""
    expected = simulate(scenario('corner_push_mismatch'), 'feedback')
    assert distance(side_by_side[0].tape.poses('object')[-1],
                    expected.tape.poses('object')[-1]) < 1e-3
    assert side_by_side[0].duration == pytest.approx(expected.duration, abs=0.1)
    assert np.abs(side_by_side[0].plan.object_poses - expected.plan.object_poses).max() < 1e-6


def test_timing_is_measured(side_by_side):
    """Every pose was answered; how fast depends on the machine."""
    for result in side_by_side:
        assert result.timing.speed_up > 0.0
        assert 0.0 < result.timing.latency_median <= result.timing.latency_p99 < np.inf


def test_progress_is_told(side_by_side, progress):
    """In order of time, to the end of the push."""
    times = [item.time for item in progress]
    assert times == sorted(times) and times[-1] >= side_by_side[0].duration
    assert [*dict.fromkeys(item.stage for item in progress)][-2:] == ['pushing', 'settling']


DISTURBED = {'friction_shift': 'mpc', 'bin_round': 'feedback'}
# When friction changes that does [s].
SHIFT = 1.0


def disturbed_part(name):
    """Load the first part of a scenario, in which friction changes early."""
    part = scenario(name, time_limit=PART)
    changes = tuple(dataclasses.replace(change, start=SHIFT)
                    for change in part.simulation.friction_changes)
    return dataclasses.replace(part, simulation=dataclasses.replace(part.simulation,
                                                                    friction_changes=changes))


@pytest.fixture(scope='module')
def disturbed(tmp_path_factory):
    """Replay scenarios side by side."""
    folders = {name: tmp_path_factory.mktemp(name) for name in DISTURBED}
    with ThreadPoolExecutor(2) as pool:
        runs = {name: pool.submit(run_over_dds, disturbed_part(name), law, folders[name],
                                  record=False)
                for name, law in DISTURBED.items()}
        return {name: run.result() for name, run in runs.items()}


@pytest.mark.parametrize('name', DISTURBED)
def test_a_disturbed_push_goes_as_in_process(disturbed, name):
    """Over DDS too, under the law that is asked for; later, feedback makes more of rounding."""
    result = disturbed[name]
    assert result.control_law == DISTURBED[name]
    expected = simulate(disturbed_part(name), DISTURBED[name])
    assert result.outcome is expected.outcome is Outcome.TIME_LIMIT
    assert (result.duration, result.bag) == (PART, None)
    assert result.tape['time'][-1] == pytest.approx(PART + SETTLE_TIME)
    first, second = (run.tape.poses('object')[run.tape['time'] < 0.5 * PART]
                     for run in (result, expected))
    assert np.hypot(*(first - second)[:, :2].T).max() < 1e-3


def test_pushes_cover_what_there_is(disturbed, side_by_side):
    """Both drives, all contact kinds, both laws; friction that changes, and that does not."""
    scenarios = [result.scenario for result in (*disturbed.values(), *side_by_side)]
    assert {one.robot.drive for one in scenarios} == set(DRIVES)
    assert {one.start.contact.kind for one in scenarios} == set(CONTACT_KINDS)
    assert set(DISTURBED.values()) == set(LAWS) - {'open_loop'}
    assert {bool(one.simulation.friction_changes) for one in scenarios} == {False, True}


def test_a_refused_push_overwrites_an_interrupted_recording_and_nothing_else(
        tmp_path: Path) -> None:
    """
    One that was killed has no index; a folder with anything else stays as it is.

    The planner's reason arrives.
    """
    task = scenario('unreachable_goal')
    bag = tmp_path / f'{task.name}_{task.control.control_law}_bag'
    bag.mkdir()
    recorded, notes = bag / f'{bag.name}.mcap', bag / 'notes.txt'
    recorded.write_bytes(b'half')
    notes.write_bytes(b'mine')
    with pytest.raises(ReplayFailed, match='expected a recording that may be overwritten'):
        run_over_dds(task, None, tmp_path)
    assert (recorded.read_bytes(), notes.read_bytes()) == (b'half', b'mine')
    notes.unlink()
    result = run_over_dds(task, None, tmp_path)
    assert (result.outcome, result.tape, result.plan) == (Outcome.REFUSED, None, None)
    known = simulate(task)
    assert (result.reason, result.codes) == (known.reason, known.codes) and result.codes
    assert result.bag == bag
    assert (bag / 'metadata.yaml').is_file() and recorded.read_bytes() != b'half'


def test_the_recording_opens_in_another_reader(side_by_side):
    """What Foxglove needs: ROS 2 messages as CDR, with their definitions, in order of time."""
    for result in side_by_side:
        with next(result.bag.glob('*.mcap')).open('rb') as file:
            reader = make_reader(file)
            assert reader.get_header().profile == 'ros2'
            summary = reader.get_summary()
            times = [message.log_time for _, _, message in reader.iter_messages()]
        assert times == sorted(times) and len(times) == summary.statistics.message_count > 500
        assert {'/odom', '/object_pose', '/cmd_vel', '/push_plan'} <= {
            channel.topic for channel in summary.channels.values()}
        for channel in summary.channels.values():
            schema = summary.schemas[channel.schema_id]
            assert channel.message_encoding == 'cdr' and schema.data
            assert schema.encoding in ('ros2msg', 'ros2idl')


def test_the_recording_reads_back(side_by_side):
    """All topics, with simulated time; one command for each measurement."""
    for result, command in zip(side_by_side, ('TwistStamped', 'Twist')):
        assert (result.bag / 'metadata.yaml').is_file() and list(result.bag.glob('*.mcap'))
        with AnyReader([result.bag]) as reader:
            counts = {topic: info.msgcount for topic, info in reader.topics.items()}
            assert reader.topics['/cmd_vel'].msgtype == f'geometry_msgs/msg/{command}'
            stamps, commands = _read(reader)
        for topic in ('/push_plan', '/planned_path', '/goal_pose'):
            assert counts[topic] == 1
        for topic in ('/diagnostics', '/markers', '/contact_wrench', '/clock'):
            assert counts[topic] > 5
        rate = result.scenario.sensors.odometry_rate
        assert set(range(int(result.duration * rate))) <= {round(t * rate) for t in stamps}
        if command == 'TwistStamped':
            # What is measured while the nodes end is not always answered.
            assert commands >= {stamp for stamp in stamps if stamp <= result.duration}
        else:
            assert counts['/cmd_vel'] > 0


def test_a_recording_that_is_played_back_commands_the_same(side_by_side):
    """To the byte; another gain shows."""
    recorded, bag = side_by_side[0].scenario, side_by_side[0].bag
    result = play_back(recorded, bag)
    assert result.commands > 500 and result.differences == ()
    changed = dataclasses.replace(recorded, control=dataclasses.replace(
        recorded.control, lateral_gain=1.01 * recorded.control.lateral_gain))
    differences = play_back(changed, bag).differences
    assert differences and differences[0].recorded != differences[0].computed
    with pytest.raises(ValueError, match='no folder'):
        play_back(recorded, bag / 'elsewhere')


def test_a_recorder_that_stands_still_loses_nothing(tmp_path):
    """For a moment that is a long way of the push: what it has missed is sent again."""
    name = 'corner_push_mismatch'
    command = [sys.executable, '-m', 'push_scenario.cli', name, '--no-pictures', '--out',
               str(tmp_path)]
    with subprocess.Popen(command, stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True,
                          env={**os.environ, 'PYTHONPATH': str(ROOT)}) as process:
        errors = []
        for line in process.stderr:
            errors.append(line)
            if 'pushing' in line:
                process.send_signal(signal.SIGSTOP)
                time.sleep(SUSPENSION)
                process.send_signal(signal.SIGCONT)
                break
        errors += process.communicate(timeout=TIMEOUT)[1]
    assert process.returncode == 0, ''.join(errors)
    result = play_back(load_scenario(name), next(tmp_path.glob('*_bag')))
    assert result.commands > 500 and result.differences == ()


def test_a_recording_that_lacks_a_measurement_is_refused(side_by_side, monkeypatch):
    """It is no proof that the controller has changed."""
    def with_a_gap(bag):
        messages = read(bag)
        poses = messages['object_pose']
        # A busy machine offers again what was not answered in time: then one may be missing.
        counts = Counter((topic, message.stamp) for topic in ('odom', 'object_pose')
                         for message in messages[topic])
        lost = next(pose.stamp for pose in poses[200:]
                    if counts['object_pose', pose.stamp] == 1 >= counts['odom', pose.stamp])
        messages['object_pose'] = [pose for pose in poses if pose.stamp != lost]
        return messages
    read = bag_playback.read_messages
    monkeypatch.setattr(bag_playback, 'read_messages', with_a_gap)
    with pytest.raises(ValueError, match='1 commands whose measurements are missing, the first'):
        play_back(side_by_side[0].scenario, side_by_side[0].bag)


def _read(reader):
    stamps = {'/odom': set(), '/cmd_vel': set()}
    for connection, log_time, data in reader.messages():
        if connection.topic in stamps:
            message = reader.deserialize(data, connection.msgtype)
            if hasattr(message, 'header'):
                stamp = message.header.stamp
                assert log_time == stamp.sec * 10 ** 9 + stamp.nanosec
            stamps[connection.topic].add(log_time / 1e9)
    return stamps['/odom'], stamps['/cmd_vel']


def _is_gone(pid):
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return True
    return False


@pytest.mark.parametrize('victim, number, error, text', [
    (CONTROLLER, signal.SIGKILL, NodeDied, f'{CONTROLLER} ended unexpectedly with signal SIGKILL'),
    (CONTROLLER, signal.SIGSTOP, ReplayFailed, f'{SIM}: no command for 15 s')])
def test_a_node_that_dies_or_hangs_ends_the_replay(monkeypatch, tmp_path, victim, number, error,
                                                   text):
    """With its name and what happened; no process is left."""
    monkeypatch.setattr(parameter_files, 'ANSWER_TIMEOUT', 15.0)
    pids = []

    def strike(nodes):
        pids.extend(nodes.pid(name) for name in (SIM, PLANNER, CONTROLLER))
        os.kill(nodes.pid(victim), number)

    with pytest.raises(error, match=text):
        run_over_dds(scenario('corner_push_mismatch'), None, tmp_path, on_start=strike)
    assert len(pids) == 3 and all(map(_is_gone, pids))


def test_a_node_that_ends_by_itself_is_noticed(tmp_path):
    """Though its exit status is 0; any module will do. What it printed last is quoted."""
    with NodeProcesses(1, tmp_path) as nodes:
        nodes.start(SIM, 'this', tmp_path / 'none.yaml')
        os.waitid(os.P_PID, nodes.pid(SIM), os.WEXITED | os.WNOWAIT)
        with pytest.raises(NodeDied, match=f'{SIM} ended unexpectedly with exit status 0; its '
                                           'last lines:(.|\\n)*Namespaces are'):
            nodes.check()


@pytest.fixture
def default_signals():
    """Let signals act as in a foreground process: a suite in the background ignores SIGINT."""
    before = {signal.SIGINT: signal.signal(signal.SIGINT, signal.default_int_handler),
              signal.SIGTERM: signal.signal(signal.SIGTERM, signal.SIG_DFL)}
    yield
    for number, handler in before.items():
        signal.signal(number, handler)


@pytest.mark.parametrize('number, ending', [(signal.SIGINT, KeyboardInterrupt),
                                            (signal.SIGTERM, SystemExit)])
@pytest.mark.usefixtures('default_signals')
def test_an_interrupt_leaves_no_process_and_a_readable_recording(tmp_path, number, ending):
    """Ctrl-C or a polite kill, in the middle of a run."""
    pids = []

    def interrupt(nodes):
        pids.extend(nodes.pid(name) for name in (SIM, PLANNER, CONTROLLER))
        os.kill(os.getpid(), number)

    with pytest.raises(ending):
        run_over_dds(scenario('straight_push'), None, tmp_path, on_start=interrupt)
    assert len(pids) == 3 and all(map(_is_gone, pids))
    assert signal.getsignal(signal.SIGTERM) == signal.SIG_DFL
    with AnyReader([tmp_path / 'straight_push_feedback_bag']) as reader:
        assert reader.topics['/push_plan'].msgcount == 1


def test_a_scenario_on_the_wall_clock(tmp_path):
    """Real time takes its time, at least, and still arrives."""
    task = scenario('straight_push')
    task = dataclasses.replace(task, goal=dataclasses.replace(task.goal, x=0.3))
    result = run_over_dds(task, None, tmp_path, real_time=True, record=False)
    assert is_as_expected(result)
    assert 0.0 < result.timing.speed_up < 1.1
