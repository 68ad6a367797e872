"""Tags on an object, as the camera of a simulation sees them."""

from push_mujoco.appearance import Picture
from push_tags.tag_layout import TagLayout  # pyright: ignore
from push_tags.tag_pattern import CELLS, MARGIN, tag_pattern  # pyright: ignore


def tag_pictures(layout: TagLayout) -> tuple[Picture, ...]:
    """
    Draw the tags of an object, each with its white margin.

    :param layout: ``TagLayout`` of the object.
    """
    return tuple(Picture(f'tag{tag.id}', tag.size * (CELLS + 2 * MARGIN) / CELLS, tag.pose,
                         tag_pattern(tag.id)) for tag in layout.tags)
