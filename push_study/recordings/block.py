"""
Recorded pushes of a three-footed block.

J. Zhou, R. Paolini, J. A. Bagnell and M. T. Mason, "A convex polynomial force-motion model for
planar sliding: identification and application", ICRA 2016. Public repository
robinzhoucmu/MLab_EXP, folder PushExp/sensor_log (Apache-2.0).

A file holds the number of pushes, and for each: pose before, pose after (x y z [mm], quaternion
w x y z), number of force rows, rows ``t f_x f_y`` [s, N], number of pusher rows, rows
``t x y z qw qx qy qz`` [s, mm]. Its name states floor and feet: ``FLOOR_x1_x2_x3_y1_y2_y3``, with
the places of the feet in the body frame [mm].
"""

import lzma
import math
from pathlib import Path
from typing import Iterator, NamedTuple

import numpy as np
from push_control.identification.recorded_push import gap_at, RecordedPush
from push_model.analysis.slow_push import Shape
from push_model.geometry import FloatArray, Pose
from push_model.parameters import PushedObject, Support

OUTLINE = ((0.0, 0.0), (0.15, 0.0), (0.0, 0.15))
CENTER_OF_MASS = (0.05, 0.05)
MASS = 1.518
GRAVITY = 9.81
# Floor -> friction of the whole block [N], as the authors state.
FLOOR_FRICTION = {'hardboard': 4.2, 'wood': 5.0}
# Chosen: contact friction that is believed before, as of metal on metal or plastic.
CONTACT_FRICTION = 0.25
# The rod of the pusher; anything from 1 to 3 mm gives the same to a hundredth of a millimetre.
ROD_RADIUS = 0.002
MILLIMETRE = 1e-3
# Chosen: a force above this is contact [N], ten times the noise; the mean of the first rows is
# that without contact, and the first part of a contact is left out of the mean force [s].
TOUCH_FORCE = 0.5
ROWS_BEFORE = 60
SETTLING_TIME = 0.5
# From the axes of the force sensor, with the sign of the force on the block, to those of the tool,
# which holds the rod, turns with every push and has x along it: by 45 degrees, and mirrored.
SENSOR_TO_TOOL = -np.array([[1.0, 1.0], [1.0, -1.0]]) / math.sqrt(2.0)


class BlockPush(NamedTuple):
    """
    One recorded push.

    :param motion: from the first touch on; the path of the pusher is shifted along the contact
        normal so that it touches the block where the force begins.
    :param force: of the pusher on the block, mean, world axes (x, y) [N].
    :param duration: from the first touch to the end [s].
    """

    motion: RecordedPush
    force: FloatArray
    duration: float


class BlockRecording(NamedTuple):
    """
    One file.

    :param name: of the file.
    :param floor: one of ``FLOOR_FRICTION``.
    :param object: the block, with what is believed before.
    :param pushes: in the order of the file.
    """

    name: str
    floor: str
    object: PushedObject
    pushes: tuple[BlockPush, ...]


def read_recordings(folder: Path) -> tuple[BlockRecording, ...]:
    """
    Read all recordings of a folder.

    :param folder: with files ``*.txt`` or ``*.txt.xz``.
    :return: recordings by name.
    :raises ValueError: where there are none, or a file is not such a recording.
    """
    paths = sorted([*folder.glob('*.txt'), *folder.glob('*.txt.xz')])
    if not paths:
        raise ValueError(f'folder: got {folder}, without files *.txt or *.txt.xz, expected the '
                         'recordings of the block')
    return tuple(_read(path) for path in paths)


def _read(path: Path) -> BlockRecording:
    name = path.name.partition('.')[0]
    floor, *places = name.split('_')
    if floor not in FLOOR_FRICTION or len(places) != 6:
        raise ValueError(f'{path.name}: expected FLOOR_x1_x2_x3_y1_y2_y3.txt with a floor of '
                         f'{", ".join(FLOOR_FRICTION)}')
    numbers = [MILLIMETRE * float(place) for place in places]
    friction = FLOOR_FRICTION[floor] / (MASS * GRAVITY)
    obj = PushedObject(MASS, outline=OUTLINE, center_of_mass=CENTER_OF_MASS,
                       contact_friction_coefficient=CONTACT_FRICTION,
                       supports=tuple(Support(x, y, friction)
                                      for x, y in zip(numbers[:3], numbers[3:])))
    opener = lzma.open if path.suffix == '.xz' else open
    with opener(path, 'rt', encoding='utf-8') as stream:
        rows = iter(stream.read().splitlines())
    try:
        pushes = tuple(_push(rows, obj) for _ in range(int(next(rows))))
    except (StopIteration, ValueError, IndexError) as error:
        raise ValueError(f'{path.name}: expected pushes with poses, forces and pusher rows: '
                         f'{error}') from None
    return BlockRecording(name, floor, obj, pushes)


def _table(rows: Iterator[str]) -> FloatArray:
    return np.array([next(rows).split() for _ in range(int(next(rows)))], dtype=float)


def _push(rows: Iterator[str], obj: PushedObject) -> BlockPush:
    start, end = (_planar(np.array(next(rows).split(), dtype=float)) for _ in range(2))
    forces, pusher = _table(rows), _table(rows)
    forces[:, 1:] -= forces[:ROWS_BEFORE, 1:].mean(axis=0)
    touch = forces[int(np.argmax(np.hypot(*forces[:, 1:].T) > TOUCH_FORCE)), 0]
    times = np.append(touch, pusher[pusher[:, 0] > touch, 0])
    path = np.column_stack([MILLIMETRE * np.interp(times, pusher[:, 0], column)
                            for column in (pusher[:, 1], pusher[:, 2])] + [np.zeros(len(times))])
    gap, normal = gap_at(Shape.of(obj), ROD_RADIUS, start, path[0])
    path[:, :2] += gap * normal
    steady = forces[:, 0] > touch + SETTLING_TIME
    _, _, tool = _planar(pusher[-1, 1:])
    force = _rotation(tool) @ SENSOR_TO_TOOL @ forces[steady, 1:].mean(axis=0)
    return BlockPush(RecordedPush(start, end, path), force, float(times[-1] - times[0]))


def _rotation(angle: float) -> FloatArray:
    return np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])


def _planar(row: FloatArray) -> FloatArray:
    """Take (x, y, heading) [m, rad] of a pose."""
    w, x, y, z = row[3:7]
    heading = math.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
    return np.array(Pose(MILLIMETRE * row[0], MILLIMETRE * row[1], heading))
