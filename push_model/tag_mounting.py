"""Pose of a tag in the frame of the object that it is fixed to."""

import dataclasses

from push_model.quantity import check, quantity
from push_model.rigid_transform import RigidTransform


@dataclasses.dataclass(frozen=True, kw_only=True)
class TagMounting:
    """
    Position of the middle of a tag, and its rotation about the axes of the object.

    Looked at from in front the frame of a tag has x to the right, y up and z out of it, as that of
    ``apriltag_ros``.
    """

    x: float = quantity('centre of the tag in the object frame, x', 'm', -10.0, 10.0, default=0.0)
    y: float = quantity('centre of the tag in the object frame, y', 'm', -10.0, 10.0, default=0.0)
    z: float = quantity('centre of the tag in the object frame, z', 'm', -10.0, 10.0, default=0.0)
    roll: float = quantity('rotation about the x axis of the object, first', 'rad', -7.0, 7.0,
                           default=0.0)
    pitch: float = quantity('rotation about the y axis of the object, second', 'rad', -7.0, 7.0,
                            default=0.0)
    yaw: float = quantity('rotation about the z axis of the object, third', 'rad', -7.0, 7.0,
                          default=0.0)

    def __post_init__(self) -> None:
        """Validate the fields."""
        check(self)

    @property
    def pose(self) -> RigidTransform:
        """``RigidTransform`` of the tag in the frame of the object."""
        return RigidTransform.from_angles((self.x, self.y, self.z),
                                          (self.roll, self.pitch, self.yaw))
