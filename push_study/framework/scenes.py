"""Objects that several studies push."""

from push_model.parameters import PushedObject, Support
from push_study.framework.study import Parameter

BOX = (Parameter('box_length', 'm', 'length of the box, along its x axis'),
       Parameter('box_width', 'm', 'width of the box'),
       Parameter('mass', 'kg', 'mass of the box'),
       Parameter('friction_coefficient', '', 'friction of every support on the floor'),
       Parameter('contact_friction', '', 'friction coefficient between robot and object'))


def corners(length, width):
    """
    Corners of a rectangle about the origin, counter-clockwise from behind on the right.

    :param length: along x [m].
    :param width: along y [m].
    :return: tuple of (x, y) [m].
    """
    x, y = 0.5 * length, 0.5 * width
    return ((-x, -y), (x, -y), (x, y), (-x, y))


def box(values, **changes):
    """
    Make the box of the parameters ``BOX``, on four supports at its corners.

    Face 3 is behind (its normal is +x), vertex 0 behind on the right.

    :param values: ``Values`` with those parameters.
    :param changes: fields of ``PushedObject`` that differ.
    :return: ``PushedObject``.
    """
    outline = corners(values.box_length, values.box_width)
    fields = {'mass': values.mass, 'outline': outline,
              'supports': tuple(Support(x, y, values.friction_coefficient) for x, y in outline),
              'contact_friction_coefficient': values.contact_friction}
    return PushedObject(**{**fields, **changes})
