"""Laws of object poses from tags: exact without noise, calibrated with it, never mirrored."""

import dataclasses
import math

from helpers.extras import import_extra
from helpers.tag_images import object_in_camera
import numpy as np
from push_model.geometry import Pose, wrap_angle
from push_model.rigid_transform import RigidTransform
from push_tags.camera import CameraIntrinsics, CameraMounting
from push_tags.detection import TagDetection
from push_tags.pose_fit import View
from push_tags.settings import DetectorSettings
from push_tags.tag_layout import ObjectTag, read_tag_layout, TagLayout
from push_tags.tagged_object import PoseFailure, TaggedObject, TagPose
import pytest

import_extra('cv2', 'vision')
LAYOUT = read_tag_layout('box_04')
CAMERA = CameraIntrinsics(640, 480, 460.0, 462.0, 319.0, 241.0, k_1=-0.2, k_2=0.05, p_1=0.001)
VIEW = View(CAMERA, CameraMounting(x=0.1, z=0.25, pitch=0.1).optical_pose)
SETTINGS = DetectorSettings()
# Two sides and the top are seen of it.
POSE = Pose(1.1, 0.1, 0.7)
# 95 % of the squares of three coordinates are below it, in units of their covariance.
CHI_SQUARE_95 = 7.815


def see(pose, view=VIEW, layout=LAYOUT, noise=0.0, rng=None) -> list[TagDetection]:
    """Project the corners of all tags that face the camera."""
    in_camera = object_in_camera(pose, view.optical_pose)
    detections = []
    for tag in layout.tags:
        in_image = in_camera @ tag.pose
        if np.dot(in_image.rotate((0.0, 0.0, 1.0)), in_image[:3]) < -0.05:
            corners = np.array([in_camera.rotate(point) for point in tag.corners])
            pixels = view.camera.project(corners + in_camera[:3])
            if noise:
                pixels = pixels + rng.normal(0.0, noise, pixels.shape)
            detections.append(TagDetection(tag.id, pixels))
    return detections


def glued_amiss(rng, layout=LAYOUT) -> TagLayout:
    """Return where tags really are: each off its place as the settings expect."""
    return TagLayout(tuple(
        dataclasses.replace(tag, x=tag.x + shift[0], y=tag.y + shift[1], z=tag.z + shift[2])
        for tag in layout.tags
        for shift in [SETTINGS.tag_deviation * rng.standard_normal(3)]))


def locate(detections, view=VIEW, layout=LAYOUT) -> TagPose:
    """Estimate a pose at once."""
    return TaggedObject(layout, SETTINGS).locate(0.0, detections, view)


@pytest.mark.parametrize('pose', [POSE, Pose(0.8, -0.2, -2.0), Pose(2.5, 0.4, 3.1)])
def test_without_noise_the_pose_is_the_true_one(pose) -> None:
    estimate = locate(see(pose))
    assert estimate.failure is None
    assert estimate.object_pose.pose == pytest.approx(pose, abs=1e-6)


@pytest.mark.parametrize('layout', [LAYOUT, TagLayout((ObjectTag(2, 0.16, x=-0.2, z=0.15, roll=(
    math.pi / 2), yaw=-math.pi / 2),))])
def test_the_stated_covariance_is_that_of_the_errors(layout) -> None:
    """Of several tags and of one: 90 to 99 of 100 poses are within the ellipsoid of 95 %."""
    rng = np.random.default_rng(7)
    inside = 0
    for _ in range(100):
        detections = see(POSE, layout=glued_amiss(rng, layout), noise=SETTINGS.corner_noise,
                         rng=rng)
        estimate = locate(detections, layout=layout).object_pose
        error = np.subtract(estimate.pose, POSE)
        inside += error @ np.linalg.solve(estimate.covariance.matrix, error) < CHI_SQUARE_95
    assert 90 <= inside <= 99


def test_a_camera_that_is_mounted_amiss_errs_as_stated() -> None:
    """By as much as the settings say: its tilt moves the object by its height times that."""
    rng = np.random.default_rng(11)
    squares: list[float] = []
    for _ in range(60):
        roll, pitch = SETTINGS.tilt_deviation * rng.standard_normal(2)
        lens = 0.1, 0.0, 0.25 + SETTINGS.height_deviation * rng.standard_normal()
        amiss = View(CAMERA, RigidTransform.from_angles(lens, (roll, pitch, 0.0))
                     @ CameraMounting(pitch=0.1).optical_pose)
        pose = Pose(0.7, 0.1, float(rng.uniform(-3.0, 3.0)))
        seen = see(pose, amiss, glued_amiss(rng), SETTINGS.corner_noise, rng)
        estimate = locate(seen).object_pose
        error = np.subtract(estimate.pose, pose)
        squares.append(float(error @ np.linalg.solve(estimate.covariance.matrix, error)) / 3.0)
    assert 0.7 < math.sqrt(np.mean(squares)) < 1.3


def test_tags_that_fit_badly_state_larger_errors() -> None:
    """As a lens that is calibrated badly shows them, three times as noisy as expected."""
    rng = np.random.default_rng(5)
    fits = [locate(see(POSE, noise=noise * SETTINGS.corner_noise, rng=rng)).object_pose
            for noise in (0.5, 3.0) for _ in range(10)]
    good, bad = (np.median([fit.covariance.heading_deviation for fit in part])
                 for part in (fits[:10], fits[10:]))
    assert bad > 1.5 * good


@pytest.mark.parametrize('shift, is_named', [(0.003, False), (0.012, True)])
def test_a_tag_glued_amiss_is_named_from_a_centimetre_on(shift: float, is_named: bool) -> None:
    """Or all are that contradict each other; what less of it moves the pose is stated larger."""
    rng = np.random.default_rng(9)
    view = View(CAMERA, CameraMounting(z=0.8, pitch=0.6).optical_pose)
    for _ in range(20):
        pose = Pose(rng.uniform(0.5, 1.0), 0.05, rng.uniform(-math.pi, math.pi))
        amiss = see(pose, view)[0].id
        error = rng.standard_normal(3)
        x, y, z = shift / np.linalg.norm(error) * error
        layout = TagLayout(tuple(
            dataclasses.replace(tag, x=tag.x + x, y=tag.y + y, z=tag.z + z)
            if tag.id == amiss else tag for tag in glued_amiss(rng).tags))
        located = locate(see(pose, view, layout, SETTINGS.corner_noise, rng), view)
        assert (amiss in located.outliers) == is_named
        if located.object_pose is not None:
            found = located.object_pose
            assert math.dist(found.pose[:2], pose[:2]) < 5.0 * found.covariance.position_deviation


def test_a_rotation_of_the_world_rotates_pose_and_covariance() -> None:
    turn = Pose(0.0, 0.0, 2.0)
    turned = View(CAMERA, RigidTransform.from_angles((0.0, 0.0, 0.0), (0.0, 0.0, turn.theta))
                  @ VIEW.optical_pose)
    detections = see(POSE, noise=0.1, rng=np.random.default_rng(3))
    before, after = (locate(detections, view).object_pose for view in (VIEW, turned))
    expected = turn @ before.pose
    assert after.pose[:2] == pytest.approx(expected[:2], abs=1e-7)
    assert wrap_angle(after.pose.theta - expected.theta) == pytest.approx(0.0, abs=1e-7)
    rotation = np.eye(3)
    rotation[:2, :2] = [(math.cos(2.0), -math.sin(2.0)), (math.sin(2.0), math.cos(2.0))]
    assert after.covariance.matrix == pytest.approx(
        rotation @ before.covariance.matrix @ rotation.T, rel=1e-4, abs=1e-12)


def test_a_tag_that_contradicts_others_is_left_out() -> None:
    view = View(CAMERA, CameraMounting(z=0.8, pitch=0.6).optical_pose)
    detections = see(POSE, view)
    assert len(detections) == 3
    detections[0] = detections[0]._replace(corners=detections[0].corners + (8.0, 0.0))
    estimate = locate(detections, view)
    assert estimate.outliers == (detections[0].id,)
    assert estimate.object_pose.pose == pytest.approx(POSE, abs=1e-6)
    assert locate(detections[:2], view).failure is PoseFailure.INCONSISTENT
    assert locate([]).failure is PoseFailure.NO_TAG
    assert locate([TagDetection(77, detections[0].corners)]).failure is PoseFailure.NO_TAG


def test_a_small_tag_that_may_be_mirrored_is_refused_until_motion_tells() -> None:
    """Level with the lens and far away, the floor does not tell its two solutions apart."""
    layout = TagLayout((ObjectTag(2, 0.05, x=-0.2, z=0.25, roll=math.pi / 2, yaw=-math.pi / 2),))
    view = View(CAMERA, CameraMounting(z=0.25).optical_pose)
    far, near = Pose(2.5, 0.0, 0.7), Pose(0.8, 0.0, 0.7)
    tagged = TaggedObject(layout, DetectorSettings(max_yaw_rate=0.2))
    detections = see(far, view, layout)
    assert tagged.locate(0.0, detections, view).failure is PoseFailure.AMBIGUOUS
    assert tagged.locate(1.0, see(near, view, layout), view).failure is None
    located = tagged.locate(2.0, detections, view)
    assert located.object_pose.pose == pytest.approx(far, abs=1e-4)
    tagged.reset()
    assert tagged.locate(2.1, detections, view).failure is PoseFailure.AMBIGUOUS
