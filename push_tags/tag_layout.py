"""
Tags on an object: their numbers, sizes and places, as a file in ``config/tags`` has them.

A tag is of the family 36h11.
"""

import dataclasses
from pathlib import Path

import numpy as np
from push_model.files.mapping import from_mapping, Location
from push_model.files.parameter_files import named_file
from push_model.files.strict_yaml import load_yaml
from push_model.geometry import FloatArray
from push_model.quantity import check, quantity
from push_model.tag_mounting import TagMounting

# Tags of the family 36h11.
TAG_COUNT = 587


@dataclasses.dataclass(frozen=True)
class ObjectTag(TagMounting):
    """A tag, and its pose in the frame of the object, whose origin is on the floor."""

    id: int = quantity('number of the tag in its family', '', 0, TAG_COUNT - 1)
    size: float = quantity('edge of its black square', 'm', above=0.0, high=2.0)

    @property
    def corners(self) -> FloatArray:
        """
        Corners of the black square in the frame of the object, shape (4, 3) [m].

        They go clockwise from the upper left one, as one looks at the tag.
        """
        half = 0.5 * self.size
        pose = self.pose
        square = ((-half, half), (half, half), (half, -half), (-half, -half))
        rotated = np.array([pose.rotate((x, y, 0.0)) for x, y in square])
        return rotated + (pose.x, pose.y, pose.z)


@dataclasses.dataclass(frozen=True)
class TagLayout:
    """The tags of an object."""

    tags: tuple[ObjectTag, ...] = quantity('the tags of the object')

    def __post_init__(self) -> None:
        """Validate the fields."""
        check(self)
        ids = [tag.id for tag in self.tags]
        if not ids or len(set(ids)) < len(ids):
            raise ValueError(f'TagLayout.tags: got the numbers {ids}, expected at least one, each '
                             'of them once')

    def corners(self, tag_id: int) -> FloatArray | None:
        """
        Look up the corners of a tag in the frame of the object.

        :param tag_id: its number.
        :return: as ``ObjectTag.corners``; None for a tag that is not on the object.
        """
        return next((tag.corners for tag in self.tags if tag.id == tag_id), None)


def read_tag_layout(name: str | Path) -> TagLayout:
    """
    Read the tags of an object by path, or by name among those of the package.

    :param name: path of a file, or name such as ``box_04``.
    :raises ParameterFileError: naming file and key, what came and what was expected.
    """
    path = named_file('tags', name)
    return from_mapping(TagLayout, load_yaml(path), Location(path))
