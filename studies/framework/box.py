"""The box that most studies push, on four support points."""

from typing import Any

from push_model.parameters import PushedObject, Support
from studies.framework.parameters import Parameter, Values

BOX_LENGTH = Parameter('box_length', 'm', 'length of the box, along its x axis')
BOX_WIDTH = Parameter('box_width', 'm', 'width of the box')
MASS = Parameter('mass', 'kg', 'mass of the box')
FRICTION = Parameter('friction_coefficient', '', 'friction of every support point on the floor')
CONTACT_FRICTION = Parameter('contact_friction', '',
                             'friction coefficient between robot and object')
BOX = (BOX_LENGTH, BOX_WIDTH, MASS, FRICTION, CONTACT_FRICTION)
# Number of the face behind, whose normal is along +x.
REAR_FACE = 3

Outline = tuple[tuple[float, float], ...]


def rectangle(length: float, width: float) -> Outline:
    """
    List the corners of a rectangle about the origin, counter-clockwise from the rear right one.

    :param length: along x [m].
    :param width: along y [m].
    :return: four points (x, y) [m].
    """
    x, y = 0.5 * length, 0.5 * width
    return ((-x, -y), (x, -y), (x, y), (-x, y))


def box(values: Values, **changes: Any) -> PushedObject:
    """
    Make the box with the parameters ``BOX``, on four support points at its corners.

    :param values: with those parameters.
    :param changes: fields of ``PushedObject`` that differ.
    :return: the box, its frame in its middle.
    """
    outline = rectangle(values.box_length, values.box_width)
    supports = tuple(Support(x, y, values.friction_coefficient) for x, y in outline)
    fields: dict[str, Any] = {
        'mass': values.mass, 'outline': outline, 'supports': supports,
        'contact_friction_coefficient': values.contact_friction}
    return PushedObject(**{**fields, **changes})


def supports_of_two_frictions(values: Values) -> tuple[Support, ...]:
    """
    Make support points at the corners, with another friction on the right (y < 0).

    :param values: with ``box_length``, ``box_width``, ``friction_coefficient`` and
        ``friction_right``.
    :return: four support points, object frame.
    """
    return tuple(
        Support(x, y, values.friction_right if y < 0.0 else values.friction_coefficient)
        for x, y in rectangle(values.box_length, values.box_width))
