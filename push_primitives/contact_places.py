"""Places on the outline of an object where a push may begin."""

import math
from typing import NamedTuple

import numpy as np
from push_model.parameters import PushedObject

# Shortest face that is pushed at [m], chosen: the places below leave a third of it for errors of
# placement.
MIN_FACE_LENGTH = 0.15
# Distance of the outermost places from the vertices [m], chosen: about two deviations of where a
# localized robot touches.
VERTEX_DISTANCE = 0.015
# Places of a face and of a disc, chosen: 26 mm apart on a face of 0.4 m, which is less than the
# effect of a push changes noticeably over, and 7.5 degrees apart on a disc, which
# rolls off along the normal however it is pushed: at 15 degrees it gets stuck beside walls.
PLACES_PER_FACE = 15
PLACES_OF_DISC = 48
# A disc has no faces; these many sectors of it count as such.
DISC_SECTORS = 4


class ContactPlace(NamedTuple):
    """
    A place on the outline where a push may begin, in the object frame.

    :param face: number of the face among those that are pushed at, from 0; of the sector of a
        disc.
    :param point: (x, y) on the outline [m].
    :param normal: angle of the inward contact normal [rad].
    :param offset: distance along the face from its middle, counter-clockwise about the object
        [m]; on a disc the angle of the point times the radius.
    """

    face: int
    point: tuple[float, float]
    normal: float
    offset: float


def contact_places(obj: PushedObject) -> tuple[ContactPlace, ...]:
    """
    List the places where a push may begin, face by face, counter-clockwise.

    :param obj: the ``PushedObject``.
    :return: ``ContactPlace`` of every face of at least 0.15 m, or round a disc.
    :raises ValueError: where all faces are shorter.
    """
    if obj.radius > 0.0:
        return tuple(_place_on_disc(obj.radius, number) for number in range(PLACES_OF_DISC))
    places: list[ContactPlace] = []
    longest = 0.0
    for (x0, y0), (x1, y1) in zip(obj.outline, (*obj.outline[1:], obj.outline[0])):
        length = math.hypot(x1 - x0, y1 - y0)
        longest = max(longest, length)
        if length < MIN_FACE_LENGTH:
            continue
        face = places[-1].face + 1 if places else 0
        along = ((x1 - x0) / length, (y1 - y0) / length)
        half = 0.5 * length - VERTEX_DISTANCE
        for offset in np.linspace(-half, half, PLACES_PER_FACE).tolist():
            point = (0.5 * (x0 + x1) + offset * along[0], 0.5 * (y0 + y1) + offset * along[1])
            places.append(ContactPlace(face, point, math.atan2(along[0], -along[1]), offset))
    if not places:
        raise ValueError(f'PushedObject.outline: got faces of at most {longest:g} m, expected one '
                         f'of at least {MIN_FACE_LENGTH:g} m')
    return tuple(places)


def _place_on_disc(radius: float, number: int) -> ContactPlace:
    angle = 2.0 * math.pi * number / PLACES_OF_DISC
    point = (radius * math.cos(angle), radius * math.sin(angle))
    return ContactPlace(number * DISC_SECTORS // PLACES_OF_DISC, point,
                        math.remainder(angle + math.pi, 2.0 * math.pi), angle * radius)
