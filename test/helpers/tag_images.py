"""Images of tags on an object, by rays from each pixel: independent of what detects them."""

import numpy as np
from numpy.typing import NDArray
from push_model.geometry import Pose
from push_model.rigid_transform import RigidTransform
from push_tags.camera import CameraIntrinsics
from push_tags.tag_layout import TagLayout
from push_tags.tag_pattern import CELLS, MARGIN, tag_pattern

# Rays along an edge of a pixel; grey of floor and object.
SAMPLES = 3
GREY = 128.0


def object_in_camera(pose: Pose, optical_pose: RigidTransform) -> RigidTransform:
    """Return the pose of an upright object on the floor in the optical frame."""
    on_floor = RigidTransform.from_angles((pose.x, pose.y, 0.0), (0.0, 0.0, pose.theta))
    return optical_pose.inverse() @ on_floor


def draw_tags(layout: TagLayout, camera: CameraIntrinsics, in_camera: RigidTransform,
              noise: float = 0.0, seed: int = 0) -> NDArray[np.uint8]:
    """
    Draw an image, in which every tag is seen that faces the camera.

    :param in_camera: pose of the object in the optical frame.
    :param noise: standard deviation of grey values.
    :return: grey values, shape (height, width).
    """
    columns, rows = np.meshgrid(_samples(camera.width), _samples(camera.height))
    rays = _rays(camera, columns.ravel(), rows.ravel())
    grey = np.full(len(rays), GREY)
    nearest = np.full(len(rays), np.inf)
    for tag in layout.tags:
        _draw(tag, in_camera @ tag.pose, rays, grey, nearest)
    image = grey.reshape(camera.height, SAMPLES, camera.width, SAMPLES).mean((1, 3))
    image += np.random.default_rng(seed).normal(0.0, 1.0, image.shape) * noise
    return np.clip(np.round(image), 0, 255).astype(np.uint8)


def _samples(count):
    """Places of rays along an edge of an image, the middle of the first pixel being 0."""
    return (np.arange(count * SAMPLES) + 0.5) / SAMPLES - 0.5


def _rays(camera, columns, rows):
    """Invert the distortion by fixed-point iteration; rays have a depth of 1."""
    seen = np.stack(((columns - camera.c_x) / camera.f_x, (rows - camera.c_y) / camera.f_y), 1)
    a, b = seen.T
    for _ in range(20 if np.any(camera.distortion) else 0):
        square = a * a + b * b
        radial = 1.0 + camera.k_1 * square + camera.k_2 * square ** 2 + camera.k_3 * square ** 3
        d_a = 2.0 * camera.p_1 * a * b + camera.p_2 * (square + 2.0 * a * a)
        d_b = camera.p_1 * (square + 2.0 * b * b) + 2.0 * camera.p_2 * a * b
        a, b = (seen[:, 0] - d_a) / radial, (seen[:, 1] - d_b) / radial
    return np.stack((a, b, np.ones_like(a)), 1)


def _draw(tag, in_camera, rays, grey, nearest):
    """Draw a tag with its margin, where nothing nearer is."""
    axes = in_camera.rotation_matrix
    middle = np.array(in_camera[:3])
    if axes[:, 2] @ middle > -1e-9:
        return
    depth = (axes[:, 2] @ middle) / (rays @ axes[:, 2])
    on_tag = (depth[:, None] * rays - middle) @ axes[:, :2]
    cell = tag.size / CELLS
    count = CELLS + 2 * MARGIN
    column = np.floor(on_tag[:, 0] / cell + 0.5 * count).astype(int)
    row = np.floor(0.5 * count - on_tag[:, 1] / cell).astype(int)
    is_hit = ((0.0 < depth) & (depth < nearest) & (0 <= column) & (column < count)
              & (0 <= row) & (row < count))
    grey[is_hit] = tag_pattern(tag.id)[row[is_hit], column[is_hit]]
    nearest[is_hit] = depth[is_hit]
