"""Files of a calibration: nothing that was recorded or stated is lost."""

import dataclasses
import math

from benchmarks.calibration.bases import calibrate, draw_base
import numpy as np
from push_base.calibration import estimation
from push_base.calibration.drive_fit import Signals
from push_base.calibration.estimation import BaseCalibration, estimate
from push_base.calibration.findings import find_faults, Finding
from push_base.calibration.recording import (
    Interruption, Purpose, ReceivedOdometry, ReceivedPose, Recording, SentCommand,
)
from push_base.calibration.recording_file import from_csv, to_csv
from push_base.calibration.report import files, pose_timeout
from push_base.calibration.topics import topic_times
from push_model.files.mapping import from_mapping, Location
from push_model.geometry import Pose
from push_model.parameters import RoundRobot
from push_model.signals import ObjectPose, Odometry, Twist
import pytest
import yaml

ROBOT = RoundRobot(0.17, max_push_force=14.0, identify_base=False, track=0.2)


def of_times(rate, jitter, seed, age=0.01, topic='odometry_times'):
    """Return a calibration of which only the times of a topic are known."""
    rng = np.random.default_rng(seed)
    stamps = np.arange(400) / rate + rng.uniform(-jitter, jitter, 400)
    recording = Recording(ROBOT, odometry=[
        ReceivedOdometry(t, Odometry(t, Pose(0.0, 0.0, 0.0), Twist())) for t in stamps])
    times = {'odometry_times': None, 'object_times': None, 'robot_times': None,
             topic: topic_times(stamps + age + rng.exponential(0.002, 400), stamps)}
    return BaseCalibration(recording, Signals.of(recording, by_stamp=True), True, None, None,
                           None, None, None, full_recording=recording, **times)


@pytest.mark.parametrize('seed', range(10))
def test_a_rate_that_is_just_reached_is_enough(seed):
    """Periods jitter by a millisecond; a rate well below is named."""
    assert Finding.SLOW_ODOMETRY not in find_faults(of_times(20.0, 1e-3, seed))
    assert Finding.SLOW_ODOMETRY in find_faults(of_times(17.0, 1e-3, seed))


@pytest.mark.parametrize('robot', [
    ROBOT, RoundRobot(math.inf), RoundRobot(0.2, drive='holonomic', min_yaw_rate=0.1)])
def test_what_was_stated_of_the_robot_is_kept(robot):
    """Where nothing was measured, the files state the same robot."""
    texts = files(estimate(Recording(robot)))
    parameters = yaml.safe_load(texts['params.yaml'])['/**']['ros__parameters']['robot']
    for values in (yaml.safe_load(texts['robot.yaml']), parameters):
        assert from_mapping(RoundRobot, values, Location('robot.yaml')) == robot


@pytest.mark.slow
def test_what_cannot_be_measured_is_kept():
    """Pushing force, track, and whether the base is identified."""
    base = draw_base(0)
    stated = dataclasses.replace(base.nominal, max_push_force=14.0, identify_base=False,
                                 track=0.22)
    values = yaml.safe_load(files(calibrate(base._replace(nominal=stated)))['robot.yaml'])
    robot = from_mapping(RoundRobot, values, Location('robot.yaml'))
    assert (robot.max_push_force, robot.identify_base, robot.track) == (14.0, False, 0.22)


def test_the_time_out_of_poses_is_their_age_and_three_periods():
    """Of nearly all poses, with an interval; of another clock, nothing is stated."""
    calibration = of_times(20.0, 1e-3, 0, age=0.08, topic='object_times')
    timeout = pose_timeout(calibration.object_times)
    assert timeout.low <= timeout.value <= timeout.high
    assert timeout.value == pytest.approx(0.08 + 0.002 * math.log(100.0) + 0.15, abs=0.01)
    text = files(calibration)['params.yaml']
    controller = yaml.safe_load(text)['/**/push_controller']['ros__parameters']['control']
    assert controller['pose_timeout'] == pytest.approx(timeout.value, abs=1e-4)
    assert '95 %' in text[text.index('pose_timeout'):].splitlines()[0]
    assert pose_timeout(of_times(20.0, 1e-3, 0, age=-1.0, topic='object_times').object_times) is (
        None)


def random_recording(seed):
    """Return a recording with one of everything, of any numbers."""
    rng = np.random.default_rng(seed)

    def pose():
        return Pose(*rng.standard_normal(3).tolist())

    def twist():
        return Twist(*rng.standard_normal(3).tolist())

    times = rng.uniform(0.0, 2e9, len(Purpose)).tolist()
    return Recording(
        ROBOT, [SentCommand(times[k], twist(), k, purpose) for k, purpose in enumerate(Purpose)],
        [ReceivedOdometry(t, Odometry(t - 0.1, pose(), twist())) for t in times],
        [ReceivedPose(t, ObjectPose(t - 0.2, pose())) for t in times],
        [ReceivedPose(t, ObjectPose(t - 0.3, pose())) for t in times],
        [None, *Interruption][seed])


@pytest.mark.parametrize('seed', range(len(Interruption) + 1))
def test_a_recording_is_read_as_it_was_written(seed):
    """To the last digit."""
    recording = random_recording(seed)
    assert from_csv(to_csv(recording)) == recording


@pytest.mark.parametrize('change, problem', [
    (lambda text: '', 'line 1'), (lambda text: text.replace('# robot: ', ''), 'line 1'),
    (lambda text: text.replace('odometry,', 'odometer,', 1), "got 'odometer,"),
    (lambda text: text + 'command,1.0\n', "got 'command,1.0'")])
def test_what_is_no_recording_is_named(change, problem):
    """By file and line."""
    with pytest.raises(ValueError, match=f'own.csv: .*{problem}'):
        from_csv(change(to_csv(random_recording(0))), 'own.csv')


def test_a_part_that_fails_does_not_take_the_others_along(monkeypatch):
    """The report says which one, and why."""
    def fail(*_):
        raise ZeroDivisionError('as planted')

    monkeypatch.setattr(estimation, 'fit_drive', fail)
    calibration = estimate(of_times(20.0, 1e-3, 0).recording)
    assert calibration.odometry_times is not None
    report = files(calibration)['report.txt']
    assert 'fit of the drive: ZeroDivisionError: as planted' in report
