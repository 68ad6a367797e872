"""Tags are those of the AprilTag library, and are detected to a tenth of a pixel."""

import dataclasses
import math

from helpers.extras import import_extra
from helpers.tag_images import draw_tags, object_in_camera
import numpy as np
from push_model.files.strict_yaml import ParameterFileError
from push_model.geometry import Pose
from push_tags.camera import CameraIntrinsics, CameraMounting
from push_tags.detection import TagDetector
from push_tags.tag_layout import ObjectTag, read_tag_layout, TagLayout
from push_tags.tag_pattern import tag_pattern
import pytest

import_extra('cv2', 'vision')
LAYOUT = read_tag_layout('box_04')
CAMERA = CameraIntrinsics.from_view_angle(320, 240, math.radians(60.0))
LENS = dataclasses.replace(CAMERA, k_1=-0.3, k_2=0.1, p_1=0.002, p_2=-0.001, k_3=-0.01)
MOUNTING = CameraMounting(x=0.1, z=0.25, pitch=0.1)
# Code words of the first two tags as the library has them.
CODE_WORDS = 0xd7e00984b, 0xdda664ca7


def code_word(pattern):
    """Read the code word: each quarter of the cells by rows, clockwise from the upper left one."""
    cells = pattern[2:8, 2:8]
    word = 0
    for _ in range(4):
        for row in range(3):
            for column in range(row, 5 - row):
                word = 2 * word + int(cells[row, column] > 0)
        cells = np.rot90(cells)
    return word


def corners_in_image(camera, in_camera, number):
    """Project the corners of a tag."""
    points = [in_camera.rotate(point) for point in LAYOUT.corners(number)]
    return camera.project(np.array(points) + in_camera[:3])


def test_tags_have_the_code_words_of_the_library_upright() -> None:
    """As OpenCV draws them they are upside down, and everybody prints those of the library."""
    for number, word in enumerate(CODE_WORDS):
        assert code_word(tag_pattern(number)) == word


@pytest.mark.parametrize('camera', [CAMERA, LENS])
def test_corners_are_detected_to_a_tenth_of_a_pixel(camera) -> None:
    """By rays that know no projection; upper left stays upper left, whatever the lens bends."""
    detector = TagDetector(camera)
    errors = []
    for quarter in range(2):
        pose = Pose(0.85, 0.1, 0.4 + 0.5 * math.pi * quarter)
        in_camera = object_in_camera(pose, MOUNTING.optical_pose)
        detections = detector.detect(draw_tags(LAYOUT, camera, in_camera, noise=2.0))
        assert detections
        errors += [tag.corners - corners_in_image(camera, in_camera, tag.id)
                   for tag in detections]
    assert np.sqrt(np.mean(np.square(errors))) < 0.1


def test_the_corners_of_slanted_tags_are_sharp_or_the_tag_is_refused() -> None:
    """Seen at 60 to 80 degrees, the upper and lower edge are short and run askew."""
    detector, errors = TagDetector(CAMERA), []
    for distance, heading in ((0.6, 0.6), (0.9, 0.6), (0.9, -0.6), (0.9, 0.4)):
        in_camera = object_in_camera(Pose(distance, 0.0, heading), MOUNTING.optical_pose)
        detections = detector.detect(draw_tags(LAYOUT, CAMERA, in_camera, noise=2.0))
        errors += [tag.corners - corners_in_image(CAMERA, in_camera, tag.id)
                   for tag in detections if np.ptp(tag.corners[:, 0]) < 31.0]
    assert len(errors) >= 3
    assert np.abs(errors).max() < 0.15


def test_the_gradient_is_that_of_the_projection_and_directions_invert_it() -> None:
    points = np.random.default_rng(3).uniform((-0.4, -0.3, 0.8), (0.4, 0.3, 2.0), (9, 3))
    gradient = LENS.projection_gradient(points)
    for axis, step in enumerate(1e-6 * np.eye(3)):
        difference = (LENS.project(points + step) - LENS.project(points - step)) / 2e-6
        assert gradient[:, :, axis] == pytest.approx(difference, rel=1e-5, abs=1e-4)
    assert LENS.directions(LENS.project(points)) == pytest.approx(
        points[:, :2] / points[:, 2:], abs=1e-9)


def test_what_is_no_image_of_the_camera_is_refused() -> None:
    detector = TagDetector(CAMERA)
    for image in (np.zeros((240, 320, 3), np.uint8), np.zeros((320, 240), np.uint8),
                  np.zeros((240, 320))):
        with pytest.raises(ValueError, match='image: got'):
            detector.detect(image)
    assert detector.detect(np.full((240, 320), 128, np.uint8)) == []


def test_a_layout_names_each_tag_once(tmp_path) -> None:
    with pytest.raises(ValueError, match='TagLayout.tags'):
        TagLayout((ObjectTag(1, 0.1), ObjectTag(1, 0.1)))
    path = tmp_path / 'tags.yaml'
    path.write_text('tags:\n  - {id: 587, size: 0.1}\n')
    with pytest.raises(ParameterFileError, match=r'tags\[0\].id: got 587'):
        read_tag_layout(path)
