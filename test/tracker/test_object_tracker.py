"""Laws of the tracker: poses of tags are those of the object, averaged and gated."""

import math

import numpy as np
from push_model.geometry import Pose, wrap_angle
from push_model.rigid_transform import RigidTransform
from push_tracker.object_tracker import ObjectTracker, TagSighting
from push_tracker.settings import MountedTag, TrackerSettings
import pytest

# On top, and on two sides: those stand upright, with their z axis out of the face.
TOP = MountedTag('top', x=0.1, y=-0.05, z=0.3, yaw=0.4)
FRONT = MountedTag('front', x=0.2, z=0.15, roll=math.pi / 2, yaw=math.pi / 2)
LEFT = MountedTag('left', y=0.2, z=0.15, roll=math.pi / 2, yaw=math.pi)
TAGS = (TOP, FRONT, LEFT)
SETTINGS = TrackerSettings(tags=TAGS, position_noise=0.002, distance_noise=0.0,
                           heading_noise=0.02)
PERIOD = 0.1
RNG = np.random.default_rng(4)


def sighting(tag, pose, distance=1.0, error=(0.0, 0.0, 0.0)):
    """See a tag of an object at a pose, with an error of its place and yaw."""
    in_world = RigidTransform.from_angles((pose.x, pose.y, 0.0), (0.0, 0.0, pose.theta)) @ tag.pose
    turned = RigidTransform.from_angles((0.0, 0.0, 0.0), (0.0, 0.0, error[2]))
    rotation = turned @ in_world._replace(x=0.0, y=0.0, z=0.0)
    return TagSighting(tag.frame, rotation._replace(
        x=in_world.x + error[0], y=in_world.y + error[1], z=in_world.z), distance)


def noise(settings=SETTINGS):
    """Draw the errors of one tag."""
    return RNG.normal(size=3) * (settings.position_noise, settings.position_noise,
                                 settings.heading_noise)


@pytest.mark.parametrize('tag', TAGS)
def test_each_tag_tells_the_pose_of_the_object(tag):
    """Wherever it is mounted, and however it is turned."""
    pose = Pose(1.2, -0.7, 2.9)
    found = ObjectTracker(SETTINGS).update(0.0, [sighting(tag, pose)])
    assert found.object_pose.pose == pytest.approx(pose)
    assert found.outliers == ()


@pytest.mark.parametrize('tags', [TAGS[:1], TAGS[:2], TAGS])
def test_the_stated_covariance_is_that_of_the_errors(tags):
    """The squared Mahalanobis distances of many poses average to the number of coordinates."""
    pose = Pose(0.3, 0.2, -3.1)
    settings = TrackerSettings(tags=TAGS, distance_noise=0.0, gate_sigmas=20.0)
    squares = []
    for _ in range(400):
        found = ObjectTracker(settings).update(
            0.0, [sighting(tag, pose, error=noise()) for tag in tags]).object_pose
        error = np.array([found.pose.x - pose.x, found.pose.y - pose.y,
                          wrap_angle(found.pose.theta - pose.theta)])
        squares.append(error @ np.linalg.solve(found.covariance.matrix, error))
    assert np.mean(squares) == pytest.approx(3.0, abs=0.4)


def test_more_tags_and_nearer_ones_are_more_certain():
    """Neither place nor heading gets worse."""
    pose = Pose(0.0, 0.0, 0.0)
    settings = TrackerSettings(tags=TAGS)

    def deviations(*sightings):
        covariance = ObjectTracker(settings).update(0.0, sightings).object_pose.covariance
        return np.array((covariance.position_deviation, covariance.heading_deviation))
    near, far = (deviations(sighting(TOP, pose, distance)) for distance in (0.5, 3.0))
    both = deviations(sighting(TOP, pose, 0.5), sighting(FRONT, pose, 3.0))
    assert (both <= near).all() and near[0] < far[0]


def test_the_first_tag_sets_no_direction():
    """Headings on both sides of the seam of angles are averaged across it."""
    found = ObjectTracker(SETTINGS).update(0.0, [
        sighting(TOP, Pose(0.0, 0.0, math.pi - 0.005)),
        sighting(LEFT, Pose(0.0, 0.0, -math.pi + 0.005))]).object_pose
    assert abs(wrap_angle(found.pose.theta - math.pi)) < 0.006


def test_a_misread_tag_among_others_is_left_out():
    """One that is tilted, and one that the others contradict; the pose is that of the rest."""
    pose = Pose(0.5, 0.5, 1.0)
    tilted = RigidTransform.from_angles((0.5, 0.5, 0.0), (0.6, 0.0, 1.0)) @ FRONT.pose
    found = ObjectTracker(SETTINGS).update(0.0, [
        sighting(TOP, pose), TagSighting('front', tilted, 1.0), sighting(LEFT, pose)])
    assert found.outliers == ('front',)
    assert found.object_pose.pose == pytest.approx(pose)
    found = ObjectTracker(SETTINGS).update(0.0, [
        sighting(TOP, pose), sighting(FRONT, pose, error=(0.2, 0.0, 0.0)), sighting(LEFT, pose)])
    assert found.outliers == ('front',)
    assert found.object_pose.pose == pytest.approx(pose)


def test_jumps_are_outliers_and_moves_are_followed():
    """What the greatest speed allows is followed at once; what it does not is left out."""
    tracker = ObjectTracker(SETTINGS)
    pose = Pose(0.0, 0.0, 0.0)
    for count in range(20):
        time = count * PERIOD
        pose = Pose(SETTINGS.max_speed * time, 0.0, SETTINGS.max_yaw_rate * time)
        assert tracker.update(time, [sighting(TOP, pose, error=noise())]).object_pose is not None
    jump = sighting(TOP, pose, error=(0.0, 0.3, 0.0))
    assert tracker.update(2.0, [jump]).object_pose is None
    assert tracker.update(2.1, [sighting(TOP, pose)]).object_pose is not None


def test_an_object_that_was_moved_is_found_again():
    """After as many outliers as are needed, in agreement; scattered ones never get there."""
    tracker = ObjectTracker(SETTINGS)
    tracker.update(0.0, [sighting(TOP, Pose(0.0, 0.0, 0.0))])
    for count in range(1, 30):
        scattered = Pose(5.0 * count, 0.0, 0.0)
        assert tracker.update(0.01 * count, [sighting(TOP, scattered)]).object_pose is None
    elsewhere = Pose(-40.0, 2.0, 1.0)
    found = [tracker.update(0.3 + 0.01 * count, [sighting(TOP, elsewhere)]).object_pose
             for count in range(SETTINGS.confirmations)]
    assert found[:-1] == [None] * (SETTINGS.confirmations - 1)
    assert found[-1].pose == pytest.approx(elsewhere)
    tracker.reset()
    assert tracker.update(0.0, [sighting(TOP, Pose(9.0, 9.0, 0.0))]).object_pose is not None


@pytest.mark.parametrize('tags, text', [
    ((), 'expected at least one'), ((TOP, TOP), 'each of them once')])
def test_tags_that_cannot_be_told_apart_are_refused(tags, text):
    """No tag, or the same frame twice."""
    with pytest.raises(ValueError, match=rf'TrackerSettings.tags: .*{text}'):
        TrackerSettings(tags=tags)


def test_a_leading_slash_does_not_belong_to_a_frame():
    """Transforms come without it."""
    assert MountedTag('/top').frame == 'top'
    with pytest.raises(ValueError, match='MountedTag.frame'):
        MountedTag('/')
