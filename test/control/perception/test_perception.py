"""Perception of a task: the object at rest, and a robot that is not where it is localized."""

import dataclasses
import math

from helpers.objects import bin_, box
from helpers.push_problems import HOLONOMIC
import numpy as np
from push_control.events import PerceptionEvent
from push_control.perception.ensemble.members import SCALE
from push_control.perception.object_at_rest import (
    has_moved, MIN_COMMON, NOISE_POSES, StationarityWindow, Tap)
from push_control.perception.perception import TaskPerception
from push_control.settings import ControlSettings
from push_control.supervision_settings import SupervisionSettings
from push_model.contact import find_contact
from push_model.geometry import distance, Pose, wrap_angle
from push_model.observation import Observation
from push_model.signals import ObjectPose, Odometry, PoseCovariance, STOP
import pytest

CONTROL, SUPERVISION = ControlSettings(), SupervisionSettings()
ORIGIN = Pose(0.0, 0.0, 0.0)
PLACE = Pose(1.0, -2.0, math.pi)


def noisy(rng, pose, count):
    """Yield measurements of a pose, at 20 Hz."""
    for i in range(count):
        x, y, rotation = rng.normal(0.0, (CONTROL.pose_noise, CONTROL.pose_noise,
                                          CONTROL.heading_noise))
        yield ObjectPose(0.05 * i, Pose(pose.x + x, pose.y + y, wrap_angle(pose.theta + rotation)))


def test_the_average_of_poses_at_rest_has_its_standard_errors():
    """Errors of many averages spread as these, across the seam of angles too."""
    scores = []
    for seed in range(200):
        window = StationarityWindow(CONTROL, SUPERVISION)
        for measured in noisy(np.random.default_rng(seed), PLACE, 20):
            window.add(measured)
        found = window.object_at_rest
        scores.append(((found.pose.x - PLACE.x) / found.position_error,
                       (found.pose.y - PLACE.y) / found.position_error,
                       wrap_angle(found.pose.theta - PLACE.theta) / found.heading_error))
    assert np.mean(np.square(scores), axis=0) == pytest.approx([1.0] * 3, abs=0.3)


def test_noise_of_the_heading_is_averaged_until_it_is_a_part_of_the_tolerance():
    """Over 300 poses for 3 degrees, not only those of the last two seconds; then old ones go."""
    control = dataclasses.replace(CONTROL, heading_noise=math.radians(3.0))
    window, rng = StationarityWindow(control, SUPERVISION), np.random.default_rng(0)
    for i in range(800):
        window.add(ObjectPose(0.05 * i, Pose(0.0, 0.0, rng.normal(0.0, control.heading_noise))))
        found = window.object_at_rest
        if found.duration > 17.0:
            assert SUPERVISION.is_precise(found.position_error, found.heading_error)
            assert found.heading_error > 0.9 * SUPERVISION.precise_errors[1]
    assert abs(found.pose.theta) < 4.0 * found.heading_error


@pytest.mark.parametrize('common_part', [0.0, 0.9, 1.0])
def test_what_poses_state_and_do_not_show_is_an_error_that_all_have_alike(common_part) -> None:
    """As of a camera that is mounted amiss; poses without a covariance of their own have none."""
    stated = PoseCovariance.from_deviations(CONTROL.pose_noise, CONTROL.heading_noise)
    scatter, common = math.sqrt(1.0 - common_part ** 2), common_part * CONTROL.pose_noise
    errors: list[float] = []
    for seed in range(100):
        windows = StationarityWindow(CONTROL, SUPERVISION), StationarityWindow(CONTROL,
                                                                               SUPERVISION)
        for measured in noisy(np.random.default_rng(seed), ORIGIN, 20):
            pose = ObjectPose(measured.time, Pose(*(scatter * part for part in measured.pose)))
            windows[0].add(pose._replace(covariance=stated))
            windows[1].add(pose)
        with_covariance, without = (window.object_at_rest for window in windows)
        assert not without.has_common_errors
        errors.append(with_covariance.common_position_error)
    assert np.median(errors) == pytest.approx(common, rel=0.05)
    assert np.percentile(errors, 95.0) < common + 0.05 * CONTROL.pose_noise


@pytest.mark.parametrize('count', [MIN_COMMON, 10, 20])
def test_independent_errors_of_few_poses_seldom_seem_alike(count: int) -> None:
    """In one average of twenty, of the heading and of the position."""
    stated = PoseCovariance.from_deviations(CONTROL.pose_noise, CONTROL.heading_noise)
    rng, common = np.random.default_rng(count), list[tuple[bool, bool]]()
    for _ in range(400):
        window = StationarityWindow(CONTROL, SUPERVISION)
        for measured in noisy(rng, ORIGIN, count):
            window.add(measured._replace(covariance=stated))
        found = window.object_at_rest
        common.append((found.common_position_error > 0.0, found.common_heading_error > 0.0))
    assert np.mean(common, axis=0).max() < 0.08


@pytest.mark.parametrize('correlation', [0.6, 0.9])
def test_correlated_errors_of_poses_are_averaged_for_longer(correlation):
    """The average of a tracker that filters its poses is about as uncertain as it says."""
    noise = math.radians(3.0)
    control, scores = dataclasses.replace(CONTROL, heading_noise=noise), []
    for seed in range(60):
        window, rng = StationarityWindow(control, SUPERVISION), np.random.default_rng(seed)
        errors = rng.normal(0.0, noise, 200)
        for i in range(1, len(errors)):
            errors[i] = (correlation * errors[i - 1]
                         + math.sqrt(1.0 - correlation ** 2) * errors[i])
        for i, error in enumerate(errors.tolist()):
            window.add(ObjectPose(0.05 * i, PLACE._replace(theta=PLACE.theta + error)))
        found = window.object_at_rest
        scores.append(wrap_angle(found.pose.theta - PLACE.theta) / found.heading_error)
    assert np.sqrt(np.mean(np.square(scores))) == pytest.approx(1.0, abs=0.35)


def test_the_average_starts_over_where_the_object_has_moved():
    """Nothing of where it was enters it; a pose that came before is not used twice."""
    window = StationarityWindow(CONTROL, SUPERVISION)
    for i in range(10):
        window.add(ObjectPose(0.05 * i, PLACE))
    moved = PLACE._replace(x=PLACE.x + 0.02)
    for i in range(10, 15):
        window.add(ObjectPose(0.05 * i, moved))
        window.add(ObjectPose(0.05 * (i - 3), PLACE))
    assert window.object_at_rest.pose == pytest.approx(moved)
    assert window.object_at_rest.duration == pytest.approx(0.2)


@pytest.mark.parametrize('speed, yaw_rate', [(0.1, 0.0), (1.0, 0.0), (0.0, 0.2)])
@pytest.mark.parametrize('noise', [1.0, 3.0])
def test_an_object_that_moves_is_told_from_one_with_noisy_poses(speed, yaw_rate, noise):
    """The speed is named, and where it stands the noise that is there, whatever is stated."""
    rng, moving, standing = np.random.default_rng(0), *(
        StationarityWindow(CONTROL, SUPERVISION) for _ in range(2))
    for measured in noisy(rng, PLACE, 2 * NOISE_POSES):
        x, y, theta = (noise * np.subtract(measured.pose, PLACE)).tolist()
        time = measured.time
        there = Pose(PLACE.x + x, PLACE.y + y, wrap_angle(PLACE.theta + wrap_angle(theta)))
        standing.add(measured._replace(pose=there))
        moving.add(measured._replace(pose=Pose(
            there.x + speed * time, there.y, wrap_angle(there.theta + yaw_rate * time))))
    moves, rests = moving.motion_report(), standing.motion_report()
    assert moves.code is PerceptionEvent.OBJECT_MOVES and rests.code is not moves.code
    assert moves.values['speed'] == pytest.approx(speed, abs=0.03)
    assert math.radians(moves.values['yaw_rate']) == pytest.approx(yaw_rate, abs=0.03)
    assert rests.values['position'] == pytest.approx(1e3 * noise * CONTROL.pose_noise, rel=0.4)


def seen(obj, robot_pose, object_pose, deviation):
    """Look at robot and object at rest for half a second."""
    perception = TaskPerception(obj, HOLONOMIC, CONTROL, SUPERVISION)
    for time in np.arange(11) * 0.05:
        perception.update(Observation(time, Odometry(time, robot_pose, STOP),
                                      ObjectPose(time, object_pose)))
    perception.localization.inflate_covariance(deviation)
    return perception


def test_motion_while_stamps_stand_still_is_made_up_for_by_the_next_that_is_newer() -> None:
    """The robot is where odometry has it, however many messages repeated one stamp meanwhile."""
    perception = seen(box(), Pose(-0.6, 0.0, 0.0), ORIGIN, 0.01)
    way = [Pose(-0.6 - 0.02 * i, 0.01 * i, 0.1 * i) for i in range(11)]
    before = perception.robot_pose
    for pose in way:
        perception.update(Observation(0.5, Odometry(0.5, pose, STOP), ObjectPose(0.5, ORIGIN)))
    perception.update(Observation(2.5, Odometry(2.5, way[-1], STOP), ObjectPose(2.5, ORIGIN)))
    step, driven = before.inverse() @ perception.robot_pose, way[0].inverse() @ way[-1]
    assert distance(step, driven) < 0.02
    assert wrap_angle(step.theta - driven.theta) == pytest.approx(0.0, abs=0.05)


@pytest.mark.parametrize('deviation', [0.01, 0.1])
@pytest.mark.parametrize('obj', [box(), bin_()])
def test_a_robot_does_not_stand_inside_the_object(obj, deviation):
    """It is placed beside it, the nearest way, and so is every member of the ensemble."""
    perception = seen(obj, Pose(-0.31, 0.04, 1.0), ORIGIN, deviation)
    perception.correct_overlap(obj, HOLONOMIC, 0.001)
    # Those that would overlap are moved out, the others not in: the mean is clear by some of it.
    assert -2e-3 < perception.gap < 2e-3 + 0.1 * deviation
    assert 0.03 < distance(perception.robot_pose, (-0.31, 0.04)) < 0.07 + 0.1 * deviation
    members = perception.localization.members
    gaps = [find_contact(obj, Pose(*there), robot[:2], HOLONOMIC.radius).gap
            for there, robot in zip(members.object_poses, members.robot_poses)]
    assert min(gaps) > -1e-6


@pytest.mark.parametrize('obj', [box(), bin_()])
def test_a_robot_that_is_clear_of_the_object_is_left_alone(obj):
    """There is nothing to correct."""
    perception = seen(obj, Pose(-0.40, 0.04, 1.0), ORIGIN, 0.01)
    before = perception.localization.members.states.copy()
    perception.correct_overlap(obj, HOLONOMIC, 0.001)
    assert np.array_equal(perception.localization.members.states, before)


@pytest.mark.parametrize('angle', [0.0, 0.4, 2.0, -2.9])
def test_what_moves_an_object_twice_is_the_robot_behind_it(angle):
    """The first time it may be somebody else, and again after a push that went well."""
    pose = Pose(0.06 * math.cos(angle), 0.06 * math.sin(angle), 0.25)
    believed = Pose(1.6 * math.cos(angle + 2.0), 1.6 * math.sin(angle + 2.0), 0.5)
    perception = seen(box(), believed, pose, 0.01)
    for moves in (1, 1, 2):
        if moves == 1:
            perception.on_push_succeeded()
        assert perception.robot_pose == pytest.approx(believed, abs=1e-9)
        perception.on_object_moved(ORIGIN)
    back = Pose(0.0, 0.0, -angle).rotate(np.subtract(perception.robot_pose, pose)[:2])
    # About a radius is not known, and no member is inside the object.
    assert back[0] < -0.3 and abs(back[1]) < 0.05
    assert 0.0 <= perception.gap < 0.15
    assert perception.localization.position_deviation < 0.2


def look(perception, robot_pose, object_pose, count):
    """Let some measurements of robot and object come, at 20 Hz."""
    for time in perception.time + 0.05 * np.arange(1, count + 1):
        perception.update(Observation(time, Odometry(time, robot_pose, STOP),
                                      ObjectPose(time, object_pose)))


def tap(perception: TaskPerception, pushed: float) -> Tap:
    """Return a push along x from now on, negative backwards."""
    return Tap(perception.object_at_rest, abs(pushed), (pushed, 0.0), (-0.2, 0.0), 0.01,
               perception.localization.remember_robot())


@pytest.mark.parametrize('shift', [(0.3, 0.0, 0.5), (-0.2, 0.2, -0.5)])
def test_what_a_mistake_of_the_tracker_meant_is_forgotten_once_it_is_over(shift):
    """Neither does it place the robot, nor is what contacts meanwhile seemed to say kept."""
    robot_pose = Pose(-0.5, 0.1, 0.3)
    perception = seen(box(), robot_pose, ORIGIN, 0.0)
    for _ in range(3):
        look(perception, robot_pose, Pose(*shift), 20)
        perception.on_object_moved(ORIGIN)
        # The object seems to stand on the robot.
        perception.localization.update_along(0.0, -0.3, 0.01)
        assert distance(perception.robot_pose, robot_pose) > 0.2
        look(perception, robot_pose, ORIGIN, 20)
        perception.on_object_moved(Pose(*shift))
        assert distance(perception.robot_pose, robot_pose) < 0.03
    assert perception.localization.position_deviation < 0.05
    assert perception.object_at_rest.pose == pytest.approx(ORIGIN, abs=1e-3)


def test_single_outliers_do_not_move_an_object_at_rest():
    """Neither is its average begun anew, nor is it seen elsewhere."""
    perception, rng = seen(box(), Pose(-0.5, 0.1, 0.3), ORIGIN, 0.0), np.random.default_rng(0)
    duration = perception.object_at_rest.duration
    for _ in range(20):
        x, y, theta = (rng.choice([-1.0, 1.0], 3) * rng.uniform(0.03, 0.12, 3)).tolist()
        look(perception, Pose(-0.5, 0.1, 0.3), Pose(x, y, theta), 1)
        assert perception.object_pose.pose == pytest.approx(ORIGIN, abs=1e-9)
        look(perception, Pose(-0.5, 0.1, 0.3), ORIGIN, 2)
    assert perception.object_at_rest.duration >= min(duration + 2.5, 1.9)
    assert perception.object_at_rest.pose == pytest.approx(ORIGIN, abs=1e-3)


def test_pushes_that_do_not_move_the_object_put_the_robot_in_doubt():
    """From the second in a row on; one that moves it by two millimetres is none."""
    robot_pose = Pose(-0.5, 0.1, 0.3)
    perception = seen(box(), robot_pose, ORIGIN, 0.0)

    def deviation_after(push):
        perception.on_tapped(tap(perception, 0.02))
        perception.restart_averaging(perception.time)
        look(perception, robot_pose, push, 20)
        perception.evaluate_push()
        return perception.localization.position_deviation
    certain = perception.localization.position_deviation
    moved = Pose(0.002, 0.0, 0.0)
    for pose in (ORIGIN, moved, moved, ORIGIN, ORIGIN):
        assert deviation_after(pose) == pytest.approx(certain, abs=1e-3)
    assert deviation_after(ORIGIN) > 0.03
    # Nothing was pushed since.
    before = perception.localization.position_deviation
    perception.evaluate_push()
    assert perception.localization.position_deviation == before


def is_lost_after(pushes, degrees):
    """Push an object that does not move, with a noise of its heading that is stated."""
    control = dataclasses.replace(CONTROL, heading_noise=math.radians(degrees))
    perception = TaskPerception(box(), HOLONOMIC, control, SUPERVISION)
    for pushed in pushes:
        look(perception, Pose(-0.5, 0.1, 0.3), ORIGIN, 10)
        perception.on_tapped(tap(perception, pushed))
        perception.restart_averaging(perception.time)
        look(perception, Pose(-0.5, 0.1, 0.3), ORIGIN, 10)
        perception.evaluate_push()
        perception.evaluate_push()
    return perception.is_lost


@pytest.mark.parametrize('degrees, pushed, is_lost', [
    (3.0, 0.01, False), (3.0, 0.15, True), (0.3, 0.01, True)])
def test_a_push_that_noise_hides_tells_nothing(degrees, pushed, is_lost):
    """Of one that would have been seen, two in a row show that the robot is elsewhere."""
    assert is_lost_after(2 * [pushed], degrees) == is_lost


@pytest.mark.parametrize('pushed', [0.005, 0.01, 0.02])
def test_pushes_that_noise_hides_add_up_to_one_that_it_does_not(pushed):
    """What counts is how far they should have moved the object, and not how many they are."""
    assert not is_lost_after(round(0.04 / pushed) * [pushed], 3.0)
    assert is_lost_after(round(0.08 / pushed) * [pushed], 3.0)
    # Those from opposite sides should have left it where it was.
    assert not is_lost_after(round(0.08 / pushed) * [pushed, -pushed], 3.0)


def test_a_push_that_moves_the_object_ends_the_sum_of_those_that_noise_has_hidden():
    """It is evident that the robot was there."""
    control = dataclasses.replace(CONTROL, heading_noise=math.radians(3.0))
    perception = TaskPerception(box(), HOLONOMIC, control, SUPERVISION)
    for k in range(20):
        pose = Pose(0.02 * (k // 2), 0.0, 0.0)
        look(perception, Pose(-0.5, 0.1, 0.3), pose, 20)
        perception.evaluate_push()
        perception.on_tapped(tap(perception, 0.012))
        perception.restart_averaging(perception.time)
    assert perception.pose_inconsistency is None


@pytest.mark.parametrize('angle, moves', [(0.11, False), (0.3, True)])
def test_a_noisy_pose_does_not_say_that_the_object_was_moved(angle, moves):
    """Within its noise; a pose without noise does."""
    pose = ORIGIN._replace(theta=angle)
    noise = PoseCovariance.from_deviations(0.002, math.radians(3.0))
    assert has_moved(ORIGIN, pose, SUPERVISION)
    assert has_moved(ORIGIN, pose, SUPERVISION, noise) == moves


def test_a_contact_tells_no_more_than_the_pose_that_it_was_seen_by():
    """A noisy heading puts the contact at a corner of the object elsewhere."""
    deviations = []
    for degrees in (0.3, 3.0):
        control = dataclasses.replace(CONTROL, heading_noise=math.radians(degrees))
        perception = TaskPerception(box(), HOLONOMIC, control, SUPERVISION)
        look(perception, Pose(-0.4, 0.14, 0.0), ORIGIN, 10)
        perception.localization.inflate_covariance(0.03)
        perception.update_from_contact(box(), HOLONOMIC, 0.002)
        deviations.append(perception.localization.standard_deviations[0])
    assert deviations[1] > deviations[0] + 0.001


def move_object_twice(perception, before):
    """Let the object move by itself; the first time that tells nothing of the robot."""
    heading = perception.robot_pose.theta
    perception.on_object_moved(before)
    assert perception.robot_pose.theta == pytest.approx(heading)
    perception.on_object_moved(before)


def run_into_object(perception, before):
    """Let the object move by itself, and then move with the robot next to it."""
    perception.on_object_moved(before)
    perception.on_unexpected_contact()


def touch_after_misses(perception, _):
    """Push twice in vain, and touch the object at last."""
    perception.on_push_without_effect()
    assert not perception.is_lost
    perception.on_push_without_effect()
    assert perception.is_lost
    perception.on_lost_robot_touched()
    assert not perception.is_lost


@pytest.mark.parametrize('was_displaced', [False, True])
@pytest.mark.parametrize('touch', [move_object_twice, run_into_object, touch_after_misses])
def test_a_robot_whose_wheels_slipped_as_it_turned_knows_its_heading_when_it_touches(
        was_displaced, touch):
    """By the path that led it there; not where an object that had jumped told where it began."""
    angles, distances = np.arange(0.0, 2.7, 0.05), np.arange(0.02, 0.6, 0.02)
    true_heading, odometry_heading = 1.35, 2.7
    start, bin_radius = Pose(0.0, 0.0, 0.0), bin_().radius
    reach = float(distances[-1]) + HOLONOMIC.radius + bin_radius
    object_pose = Pose(reach * math.cos(true_heading), reach * math.sin(true_heading), 0.0)
    first_pose = object_pose._replace(y=object_pose.y + 0.5 * was_displaced)
    perception = seen(bin_(), start, first_pose, 0.0)
    look(perception, start, object_pose, 50)
    perception.on_push_succeeded()
    for theta in angles.tolist():
        look(perception, Pose(0.0, 0.0, theta), object_pose, 1)
    for x in distances.tolist():
        look(perception, Pose(0.0, 0.0, odometry_heading) @ Pose(x, 0.0, 0.0), object_pose, 1)
    before = object_pose._replace(y=object_pose.y - 0.06)
    assert wrap_angle(perception.robot_pose.theta - odometry_heading) == pytest.approx(0, abs=0.1)
    touch(perception, before)
    heading = odometry_heading if was_displaced else true_heading
    assert wrap_angle(perception.robot_pose.theta - heading) == pytest.approx(0, abs=0.5)
    assert was_displaced or abs(perception.gap) < 0.1


def test_poses_that_have_jumped_to_where_no_push_finds_the_object_are_named():
    """Until they are back."""
    robot_pose = Pose(-0.5, 0.1, 0.3)
    perception = seen(box(), robot_pose, ORIGIN, 0.0)
    look(perception, robot_pose, Pose(0.3, 0.0, 0.5), 10)
    assert perception.pose_inconsistency is None
    perception.on_push_without_effect()
    report = perception.pose_inconsistency
    assert report.code is PerceptionEvent.POSES_JUMPED_ELSEWHERE
    assert report.values['distance'] == pytest.approx(0.3, abs=0.005)
    assert math.radians(report.values['rotation']) == pytest.approx(0.5, abs=0.01)
    look(perception, robot_pose, ORIGIN, 10)
    assert perception.pose_inconsistency is None


def test_odometry_that_means_more_than_the_robot_moves_is_named():
    """By what the contacts have shown; a scale within its deviation is none."""
    perception = seen(box(), Pose(-1.0, 0.0, 0.0), Pose(0.0, 0.0, 0.0), 0.0)
    assert perception.odometry_inconsistency is None
    perception.localization.members.parameters[:, SCALE] += 0.15
    report = perception.odometry_inconsistency
    assert report.code is PerceptionEvent.ODOMETRY_TOO_LARGE
    assert report.values['percentage'] == pytest.approx(15.0, abs=0.5)


def test_poses_that_are_one_to_the_last_digit_are_known():
    """Once there are enough; noise ends that."""
    window = StationarityWindow(ControlSettings(), SupervisionSettings())
    for i in range(NOISE_POSES):
        assert not window.repeats_pose
        window.add(ObjectPose(0.05 * i, Pose(1.0, 2.0, 0.3)))
    assert window.repeats_pose
    window.add(ObjectPose(10.0, Pose(1.0, 2.0, 0.3 + 1e-9)))
    assert not window.repeats_pose
