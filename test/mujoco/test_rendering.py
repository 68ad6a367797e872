"""Images of a scene show things where the camera's own equation has them."""

import dataclasses
import math

from helpers.extras import import_extra, skip_without_graphics
import numpy as np
from numpy.typing import NDArray
from push_model.files.parameter_files import read_object
from push_model.geometry import Pose
from push_model.rigid_transform import RigidTransform
from push_mujoco.camera import SimulatedCamera
from push_mujoco.simulated_robot import read_simulated_robot
import pytest

rendering = import_extra('mujoco', 'mujoco', 'push_mujoco.rendering')
appearance = import_extra('mujoco', 'mujoco', 'push_mujoco.appearance')
import_extra('cv2', 'vision')
BOX, ROBOT = read_object('box_04'), read_simulated_robot('turtlebot4')
# A black picture in a white frame, upright in the middle of the face towards -x.
EDGE = 0.2
FACE = RigidTransform.from_angles((-0.2, 0.0, 0.15), (math.pi / 2, 0.0, -math.pi / 2))
# Its upper right quarter, as one looks at it, is white.
PIXELS = np.zeros((8, 8), dtype=np.uint8)
PIXELS[:4, 4:] = 255
SCENE = (ROBOT, BOX, (appearance.Picture('picture', EDGE, FACE, PIXELS),))
ON_ROBOT = dataclasses.replace(ROBOT.camera, noise=0.0)


def image_of(camera: SimulatedCamera, object_pose: Pose, robot_pose: Pose,
             noise: np.random.Generator | None = None) -> NDArray[np.uint8]:
    """Draw the scene."""
    skip_without_graphics()
    return rendering.render_camera(rendering.TaggedScene(*SCENE), camera, object_pose, robot_pose,
                                   noise=noise)


def on_picture(points: list[tuple[float, float]], object_pose: Pose) -> NDArray[np.float64]:
    """Compute where points of the picture, in edges from its middle, are in the world."""
    places = []
    for x, y in points:
        in_object = np.add((FACE.x, FACE.y, FACE.z), FACE.rotate((x * EDGE, y * EDGE, 0.0)))
        places.append((*object_pose.transform(in_object[:2]), in_object[2]))
    return np.array(places)


@pytest.mark.parametrize('camera', [
    ON_ROBOT, dataclasses.replace(ON_ROBOT, place='room', x=0.2, y=-0.4, z=0.9, heading=0.6,
                                  pitch=0.7, width=400, height=320)])
def test_quarters_of_a_picture_are_where_they_are_projected(camera) -> None:
    """Dark and light points lie at least a tenth of the edge off every border."""
    object_pose, robot_pose = Pose(1.0, 0.1, 0.25), Pose(0.05, -0.1, 0.1)
    image = image_of(camera, object_pose, robot_pose)
    assert image.shape == (camera.height, camera.width, 3)
    for points, is_light in (([(0.1, 0.1), (0.4, 0.4), (0.1, 0.4), (0.4, 0.1)], True),
                             ([(-0.1, 0.1), (-0.4, 0.4), (0.1, -0.1), (-0.4, -0.4)], False)):
        pixels = camera.project(on_picture(points, object_pose), robot_pose)
        columns, rows = np.rint(pixels).astype(int).T
        assert ((image[rows, columns].mean(axis=1) > 100.0) == is_light).all()


def test_an_edge_is_where_it_is_projected_to_a_tenth_of_a_pixel() -> None:
    """
    The border of white and black crosses a row where half of the contrast is reached.

    To the right of it, the same sum of light is there as of an edge at that column.
    """
    object_pose, robot_pose = Pose(0.9, 0.0, 0.0), Pose(0.0, 0.0, 0.0)
    image = image_of(ON_ROBOT, object_pose, robot_pose).mean(axis=2)
    (column, row), = ON_ROBOT.project(on_picture([(0.0, 0.25)], object_pose), robot_pose)
    first, last = int(column) - 12, int(column) + 12
    profile = image[round(row), first:last + 1]
    dark, light = profile[:5].mean(), profile[-5:].mean()
    assert light - dark > 80.0
    lit = ((profile - dark) / (light - dark)).sum()
    assert last + 0.5 - lit == pytest.approx(column, abs=0.1)


def test_pixels_have_the_noise_that_is_stated() -> None:
    camera = dataclasses.replace(ON_ROBOT, noise=3.0, width=160, height=120)
    poses = Pose(0.9, 0.0, 0.0), Pose(0.0, 0.0, 0.0)
    clean = image_of(camera, *poses).astype(float)
    noisy = image_of(camera, *poses, np.random.default_rng(1)).astype(float)
    again = image_of(camera, *poses, np.random.default_rng(1)).astype(float)
    middle = (clean > 20.0) & (clean < 235.0)
    assert np.std((noisy - clean)[middle]) == pytest.approx(3.0, rel=0.05)
    assert (noisy == again).all()


def test_what_is_behind_the_lens_has_no_place_in_the_image() -> None:
    pixels = ON_ROBOT.project(np.array([(-1.0, 0.0, 0.2), (1.0, 0.0, 0.244)]),
                              Pose(0.0, 0.0, 0.0))
    assert np.isnan(pixels[0]).all()
    assert pixels[1] == pytest.approx((319.5, 239.5))
