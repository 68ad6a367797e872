"""Tags on an object: how a simulated camera sees them, and what tells the object by them."""

import numpy as np
from numpy.typing import NDArray
from push_mujoco.appearance import Picture
from push_mujoco.camera import SimulatedCamera
from push_mujoco.pixel_sensor import DetectedPose, Eye
from push_tags.camera import CameraIntrinsics, CameraMounting
from push_tags.detection import TagDetector
from push_tags.pose_fit import View
from push_tags.settings import DetectorSettings
from push_tags.tag_layout import TagLayout
from push_tags.tag_pattern import CELLS, MARGIN, tag_pattern
from push_tags.tagged_object import TaggedObject


def tag_pictures(layout: TagLayout) -> tuple[Picture, ...]:
    """
    Draw the tags of an object, each with its white margin.

    :param layout: ``TagLayout`` of the object.
    """
    return tuple(Picture(f'tag{tag.id}', tag.size * (CELLS + 2 * MARGIN) / CELLS, tag.pose,
                         tag_pattern(tag.id)) for tag in layout.tags)


def tag_eye(camera: SimulatedCamera, layout: TagLayout,
            settings: DetectorSettings = DetectorSettings()) -> Eye:
    """
    Make a camera that knows an object by its tags.

    :param camera: ``SimulatedCamera``.
    :param layout: ``TagLayout`` of the object.
    :param settings: ``DetectorSettings``.
    """
    detector = TagDetector(CameraIntrinsics.from_view_angle(camera.width, camera.height,
                                                            camera.view_angle))
    mounting = CameraMounting(x=camera.x, y=camera.y, z=camera.z, pitch=camera.pitch,
                              yaw=camera.heading)
    view, tagged = View(detector.camera, mounting.optical_pose), TaggedObject(layout, settings)

    def detect(time: float, image: NDArray[np.uint8]) -> DetectedPose | None:
        located = tagged.locate(time, detector.detect(image), view).object_pose
        if located is None or located.covariance is None:
            return None
        return DetectedPose(located.pose, located.covariance)

    return Eye(camera, detect)
