"""Poses as scenario files write them."""

import dataclasses

from push_model.geometry import Pose
from push_model.quantity import check, MAX_ANGLE, quantity


@dataclasses.dataclass(frozen=True)
class Placement:
    """A pose in the plane."""

    x: float = quantity('position, x', 'm', default=0.0)
    y: float = quantity('position, y', 'm', default=0.0)
    theta: float = quantity('orientation', 'rad', -MAX_ANGLE, MAX_ANGLE, default=0.0)

    def __post_init__(self) -> None:
        """Validate the fields."""
        check(self)

    @property
    def pose(self) -> Pose:
        """The same as a ``Pose``."""
        return Pose(self.x, self.y, self.theta)
