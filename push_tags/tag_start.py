"""Poses of an object that a single tag allows, to start a fit from."""

from typing import Any

import numpy as np
from push_model.geometry import Pose
from push_model.rigid_transform import RigidTransform
from push_tags.camera import CameraIntrinsics
from push_tags.detection import TagDetection
from push_tags.tag_layout import ObjectTag


def poses_of_tag(tag: ObjectTag, detection: TagDetection, camera: CameraIntrinsics,
                 optical_pose: RigidTransform) -> list[Pose]:
    """
    Compute both poses that a square may have (IPPE: Collins and Bartoli 2014).

    From afar, or of a small tag, they differ by the sign of its tilt against the line of sight,
    and both fit the image.

    :param tag: on the object.
    :param detection: of that tag.
    :param camera: that took the image.
    :param optical_pose: of the camera, in the frame of object poses.
    :return: of the object on the floor, that which fits better first.
    """
    import cv2
    half = 0.5 * tag.size
    square = np.array([(-half, half, 0.0), (half, half, 0.0), (half, -half, 0.0),
                       (-half, -half, 0.0)])
    # OpenCV states no type for what it returns here.
    solver: Any = cv2.solvePnPGeneric
    _, rotations, positions, _ = solver(square, camera.directions(detection.corners), np.eye(3),
                                        None, flags=cv2.SOLVEPNP_IPPE_SQUARE)
    poses: list[Pose] = []
    for rotation, position in zip(rotations, positions):
        in_camera = _transform(np.ravel(rotation).tolist(), np.ravel(position).tolist())
        if in_camera is not None:
            poses.append((optical_pose @ in_camera @ tag.pose.inverse()).planar)
    return poses


def _transform(rotation: list[float], position: list[float]) -> RigidTransform | None:
    """Make a transform of a rotation vector and a position; None where they are no numbers."""
    angle = float(np.linalg.norm(rotation))
    if not np.isfinite((angle, *position)).all():
        return None
    scale = np.sin(0.5 * angle) / angle if angle > 0.0 else 0.5
    return RigidTransform.from_parts(position, [*(scale * part for part in rotation),
                                                float(np.cos(0.5 * angle))])
