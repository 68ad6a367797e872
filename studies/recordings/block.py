"""
Recorded pushes of a three-footed block.

J. Zhou, R. Paolini, J. A. Bagnell and M. T. Mason, "A convex polynomial force-motion model for
planar sliding: identification and application", ICRA 2016. Public repository
robinzhoucmu/MLab_EXP, folder PushExp/sensor_log (Apache-2.0).

A folder ``[FLOOR_]x1_x2_x3_y1_y2_y3`` states floor (hardboard where none) and places of the feet
in the body frame [mm]; ``patch`` is the block without feet. It holds a set of fifty pushes, and
some shorter trials. A file holds the number of pushes, and for each: pose before, pose after
(x y z [mm], quaternion w x y z), number of force rows, rows ``t f_x f_y`` [s, N], number of pusher
rows, rows ``t x y z qw qx qy qz`` [s, mm].
"""

import dataclasses
import lzma
import math
from pathlib import Path
from typing import Iterator, NamedTuple, Sequence

import numpy as np
from push_control.identification.recorded_push import gap_at, RecordedPush
from push_model.analysis.slow_push import Shape
from push_model.geometry import FloatArray, Pose
from push_model.parameters import GRAVITY, PushedObject, Support

OUTLINE = ((0.0, 0.0), (0.15, 0.0), (0.0, 0.15))
CENTER_OF_MASS = (0.05, 0.05)
MASS = 1.518
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
# Pushes that identify: every so many of a file of fifty; the others test.
SELECTED = 10
# Sets that identify nothing: chosen before they were read, as a test of what the others identify.
HELD_BACK = ('hardboard_30_63.33_43.33_30_43.33_63.33', 'wood_10_90_10_10_30_130',
             'wood_30_63.33_43.33_30_43.33_63.33', 'hardboard_patch', 'wood_patch')
PATCH = 'patch'
# The block without feet stands on the middles of equal triangles, so many along a leg. Chosen:
# ends differ by less than 0.1 mm from those with twice as many.
PATCH_TRIANGLES = 6
SUFFIXES = ('.txt', '.txt.xz')


class BlockPush(NamedTuple):
    """
    One recorded push.

    :param motion: from the first touch on; the path of the pusher is shifted along the contact
        normal so that it touches the block there.
    :param force: of the pusher on the block, mean, world axes (x, y) [N].
    :param duration: from the first touch to the end [s].
    """

    motion: RecordedPush
    force: FloatArray
    duration: float


class BlockRecording(NamedTuple):
    """
    One set of pushes.

    :param name: floor and places of the feet [mm], or ``PATCH``.
    :param floor: one of ``FLOOR_FRICTION``.
    :param object: the block, with what is believed before.
    :param pushes: in the order of the file.
    :param delay: of the force behind the path of the pusher, of all files together [s].
    """

    name: str
    floor: str
    object: PushedObject
    pushes: tuple[BlockPush, ...]
    delay: float

    @property
    def identifying(self) -> tuple[BlockPush, ...]:
        """Pushes that identify."""
        return () if self.name in HELD_BACK else self.pushes[::SELECTED]

    @property
    def tested(self) -> tuple[BlockPush, ...]:
        """Pushes that are predicted: as many of each set."""
        return tuple(push for index, push in enumerate(self.pushes) if index % SELECTED)


class _RawPush(NamedTuple):
    """Poses (3,) [m, rad], forces (n, 3) [s, N] and rows of the pusher (m, 8) of one push."""

    start: FloatArray
    end: FloatArray
    forces: FloatArray
    pusher: FloatArray

    @property
    def touch(self) -> float:
        """Time at which the force begins [s]."""
        return float(self.forces[int(np.argmax(np.hypot(*self.forces[:, 1:].T) > TOUCH_FORCE)), 0])

    def path_after(self, time: float) -> tuple[FloatArray, FloatArray]:
        """Return times (k,) [s] and places (k, 3) of the pusher from a time on [m, m, 0]."""
        times = np.append(time, self.pusher[self.pusher[:, 0] > time, 0])
        return times, np.column_stack(
            [MILLIMETRE * np.interp(times, self.pusher[:, 0], column)
             for column in (self.pusher[:, 1], self.pusher[:, 2])] + [np.zeros(len(times))])


class _RawFile(NamedTuple):
    """A file as it is read."""

    name: str
    floor: str
    object: PushedObject
    pushes: tuple[_RawPush, ...]


def read_recordings(folder: Path) -> tuple[BlockRecording, ...]:
    """
    Read all recordings of a folder.

    :param folder: as published, with a folder for each set; or with files named as these folders,
        ``*.txt`` or ``*.txt.xz``.
    :return: recordings by name.
    :raises ValueError: where there are none, or a file is not such a recording.
    """
    paths = _named_paths(folder)
    if not paths:
        raise ValueError(f'folder: got {folder}, without files *.txt or *.txt.xz, expected the '
                         'recordings of the block')
    files = [_read(name, path) for name, path in sorted(paths.items())]
    delay = _force_delay(files)
    return tuple(BlockRecording(one.name, one.floor, one.object,
                                tuple(_push(raw, one.object, delay) for raw in one.pushes), delay)
                 for one in files)


def with_contact_friction(obj: PushedObject, contact_friction: float) -> PushedObject:
    """Return a block with another mu_c."""
    return dataclasses.replace(obj, contact_friction_coefficient=contact_friction)


def _named_paths(folder: Path) -> dict[str, Path]:
    """Find the file of each set; of the files of a folder that with the most pushes."""
    paths = {_set_name(path.name): path for path in _recordings_in(folder)}
    for inner in sorted(path for path in folder.iterdir() if path.is_dir()):
        files = [path for path in _recordings_in(inner) if _is_set(inner.name)]
        if files:
            paths[_set_name(inner.name)] = max(files, key=_push_count)
    return paths


def _recordings_in(folder: Path) -> list[Path]:
    return sorted(path for suffix in SUFFIXES for path in folder.glob(f'*{suffix}'))


def _set_name(name: str) -> str:
    for suffix in reversed(SUFFIXES):
        name = name.removesuffix(suffix)
    return f'hardboard_{name}' if name[:1].isdigit() or name == PATCH else name


def _is_set(name: str) -> bool:
    """Say whether a folder's name has a floor, if any, and feet or none."""
    floor, *feet = _set_name(name).split('_')
    return floor in FLOOR_FRICTION and (feet == [PATCH] or len(feet) == 6)


def _lines(path: Path) -> Iterator[str]:
    opener = lzma.open if path.suffix == '.xz' else open
    with opener(path, 'rt', encoding='utf-8') as stream:
        yield from stream


def _push_count(path: Path) -> int:
    first = next(_lines(path), '').strip()
    return int(first) if first.isdigit() else 0


def _read(name: str, path: Path) -> _RawFile:
    if not _is_set(name):
        raise ValueError(f'{path.name}: expected FLOOR_x1_x2_x3_y1_y2_y3.txt with a floor of '
                         f'{", ".join(FLOOR_FRICTION)}, or FLOOR_patch.txt')
    floor, *feet = name.split('_')
    friction = FLOOR_FRICTION[floor] / (MASS * GRAVITY)
    places = _patch() if feet == [PATCH] else [
        (MILLIMETRE * float(x), MILLIMETRE * float(y)) for x, y in zip(feet[:3], feet[3:])]
    obj = PushedObject(MASS, outline=OUTLINE, center_of_mass=CENTER_OF_MASS,
                       contact_friction_coefficient=CONTACT_FRICTION,
                       supports=tuple(Support(x, y, friction) for x, y in places))
    rows = _lines(path)
    try:
        pushes = tuple(_raw_push(rows) for _ in range(int(next(rows))))
    except (StopIteration, ValueError, IndexError) as error:
        raise ValueError(f'{path.name}: expected pushes with poses, forces and pusher rows: '
                         f'{error}') from None
    return _RawFile(name, floor, obj, pushes)


def _patch() -> list[tuple[float, float]]:
    """Middles of the equal triangles of the base, of either way up [m]."""
    side = OUTLINE[1][0] / PATCH_TRIANGLES
    upright = [(i + 1.0 / 3.0, j + 1.0 / 3.0) for i in range(PATCH_TRIANGLES)
               for j in range(PATCH_TRIANGLES - i)]
    turned = [(i + 2.0 / 3.0, j + 2.0 / 3.0) for i in range(PATCH_TRIANGLES - 1)
              for j in range(PATCH_TRIANGLES - 1 - i)]
    return [(side * x, side * y) for x, y in upright + turned]


def _table(rows: Iterator[str]) -> FloatArray:
    return np.array([next(rows).split() for _ in range(int(next(rows)))], dtype=float)


def _raw_push(rows: Iterator[str]) -> _RawPush:
    start, end = (_planar(np.array(next(rows).split(), dtype=float)) for _ in range(2))
    forces, pusher = _table(rows), _table(rows)
    forces[:, 1:] -= forces[:ROWS_BEFORE, 1:].mean(axis=0)
    return _RawPush(start, end, forces, pusher)


def _force_delay(files: Sequence[_RawFile]) -> float:
    """
    Find by how much the force is recorded behind the pusher [s].

    Rod and block touch at the beginning of the force as at the end of the push, so that the gap
    between them, as the two recorded poses have it, must be the same. That it is not, but smaller
    at the beginning by the same time at all speeds along the normal, is the clocks.
    """
    delays: list[float] = []
    for one in files:
        shape = Shape.of(one.object)
        for raw in one.pushes[::SELECTED]:
            times, path = raw.path_after(raw.touch)
            first, normal = gap_at(shape, ROD_RADIUS, raw.start, path[0])
            last, _ = gap_at(shape, ROD_RADIUS, raw.end, path[-1])
            speed = float((path[-1, :2] - path[0, :2]) @ normal) / (times[-1] - times[0])
            delays.append((last - first) / speed)
    return max(0.0, float(np.median(delays)))


def _push(raw: _RawPush, obj: PushedObject, delay: float) -> BlockPush:
    times, path = raw.path_after(raw.touch - delay)
    gap, normal = gap_at(Shape.of(obj), ROD_RADIUS, raw.start, path[0])
    path[:, :2] += gap * normal
    steady = raw.forces[:, 0] > raw.touch + SETTLING_TIME
    _, _, tool = _planar(raw.pusher[-1, 1:])
    force = _rotation(tool) @ SENSOR_TO_TOOL @ raw.forces[steady, 1:].mean(axis=0)
    return BlockPush(RecordedPush(raw.start, raw.end, path), force, float(times[-1] - times[0]))


def _rotation(angle: float) -> FloatArray:
    return np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])


def _planar(row: FloatArray) -> FloatArray:
    """Take (x, y, heading) [m, rad] of a pose."""
    w, x, y, z = row[3:7]
    heading = math.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
    return np.array(Pose(MILLIMETRE * row[0], MILLIMETRE * row[1], heading))
