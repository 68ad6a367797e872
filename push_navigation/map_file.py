"""
Map files of ``nav2_map_server``: YAML that names an image (PGM or PNG).

With the lightness of a pixel, 0 to 1, the occupancy is ``p = 1 - lightness``, or the lightness
where ``negate`` is set. The modes make the values of ``nav_msgs/OccupancyGrid`` of it:

    trinary   100 where p > occupied_thresh, 0 where p < free_thresh, else -1
    scale     the same, but between the thresholds 100 (p - free_thresh) /
              (occupied_thresh - free_thresh); -1 where the pixel is not opaque
    raw       the lightness of 0 to 255 as it is, -1 above 100

As there, opacity counts as one more colour in mode trinary, and the first row of the image has the
largest y. See https://docs.nav2.org/configuration/packages/configuring-map-server.html and
``MapMode`` of https://docs.ros.org/en/jazzy/p/nav2_map_server.
"""

import dataclasses
import enum
import math
from pathlib import Path
import re
from typing import Any, cast, NamedTuple, TypeGuard

import numpy as np
from numpy.typing import NDArray
from push_model.files.strict_yaml import load_yaml, ParameterFileError
from push_model.geometry import FloatArray, Pose
from push_navigation.occupancy_map import (
    MAX_RESOLUTION, MIN_RESOLUTION, RESOLUTION_RANGE,
)

UNKNOWN = -1
FREE = 0
OCCUPIED = 100
# Lightness of white in eight bits.
WHITE = 255.0
# Header of a PGM: P2 (text) or P5 (binary), columns, rows, largest value, each behind white space
# and comments; one white space ends it.
_SPACE = rb'(?:\s+|#[^\n]*\n)+'
PGM_HEADER = re.compile(rb'(P[25])' + 3 * (_SPACE + rb'(\d{1,9})') + rb'\s')
MAX_PGM_VALUE = 65535
PGM_PIXEL = re.compile(rb'\d{1,9}')


class MapMode(enum.Enum):
    """Mode in which the pixels of a map are read."""

    TRINARY = 'trinary'
    SCALE = 'scale'
    RAW = 'raw'


@dataclasses.dataclass(frozen=True, eq=False)
class GridMap:
    """
    A map as a file has it.

    :param resolution: side of a cell [m].
    :param origin: ``Pose`` of the outer corner of the first cell.
    :param cells: values of ``nav_msgs/OccupancyGrid``, shape (rows, columns), least y first.
    """

    resolution: float
    origin: Pose
    cells: NDArray[np.int8]


class _Image(NamedTuple):
    """Lightness and opacity of pixels, 0 to 1; opacity None where the image has none."""

    colors: FloatArray
    opacity: FloatArray | None = None


class _Fields:
    """Fields of the YAML file, read with errors that name them."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._values = load_yaml(path)

    def error(self, name: str, expected: str) -> ParameterFileError:
        return ParameterFileError(
            f'{self._path}: {name}: got {self._values.get(name)!r}, expected {expected}')

    def text(self, name: str) -> str:
        value = self._values.get(name)
        if not isinstance(value, str) or not value:
            raise self.error(name, 'the name of a file')
        return value

    def number(self, name: str, low: float, high: float, expected: str) -> float:
        value = self._values.get(name)
        if not _is_number(value) or not low <= float(value) <= high:
            raise self.error(name, expected)
        return float(value)

    def origin(self) -> Pose:
        value = self._values.get('origin')
        if (not isinstance(value, list) or len(cast(list[Any], value)) != 3
                or not all(map(_is_number, cast(list[Any], value)))):
            raise self.error('origin', 'three finite numbers: x [m], y [m], yaw [rad]')
        x, y, yaw = cast(list[float], value)
        return Pose(float(x), float(y), float(yaw))

    def switch(self, name: str) -> bool:
        value = self._values.get(name, False)
        if value not in (0, 1):
            raise self.error(name, '0 or 1')
        return bool(value)

    def mode(self) -> MapMode:
        try:
            return MapMode(self._values.get('mode', MapMode.TRINARY.value))
        except ValueError:
            raise self.error('mode', 'trinary, scale or raw') from None


def read_map(path: str | Path) -> GridMap:
    """
    Read a map.

    :param path: the YAML file; the image may be given relative to it.
    :raises ParameterFileError: naming file and field, what came and what was expected.
    """
    path = Path(path)
    fields = _Fields(path)
    resolution = fields.number('resolution', MIN_RESOLUTION, MAX_RESOLUTION,
                               RESOLUTION_RANGE)
    occupied = fields.number('occupied_thresh', 0.0, 1.0, 'a number from 0 to 1')
    free = fields.number('free_thresh', 0.0, occupied,
                         f'a number from 0 to occupied_thresh, {occupied:g}')
    origin, mode, negate = fields.origin(), fields.mode(), fields.switch('negate')
    image = _read_image(path.parent / fields.text('image'))
    cells = _CELLS[mode](image, negate, occupied, free)
    return GridMap(resolution, origin, np.ascontiguousarray(cells[::-1].astype(np.int8)))


def _is_number(value: object) -> TypeGuard[float]:
    return (isinstance(value, (int, float)) and not isinstance(value, bool)
            and math.isfinite(value))


def _lightness(image: _Image) -> FloatArray:
    return cast(FloatArray, image.colors.mean(axis=-1))


def _occupancy(lightness: FloatArray, negate: bool) -> FloatArray:
    return lightness if negate else 1.0 - lightness


def _trinary(image: _Image, negate: bool, occupied: float, free: float) -> FloatArray:
    if image.opacity is not None:
        image = _Image(np.concatenate((image.colors, image.opacity[..., None]), axis=-1))
    occupancy = _occupancy(_lightness(image), negate)
    return np.where(occupancy > occupied, OCCUPIED,
                    np.where(occupancy < free, FREE, UNKNOWN)).astype(float)


def _scale(image: _Image, negate: bool, occupied: float, free: float) -> FloatArray:
    occupancy = _occupancy(_lightness(image), negate)
    between = (occupancy - free) / max(occupied - free, math.ulp(1.0))
    cells = np.rint(np.clip(between, 0.0, 1.0) * OCCUPIED)
    return cells if image.opacity is None else np.where(image.opacity < 1.0, UNKNOWN, cells)


def _raw(image: _Image, negate: bool, occupied: float, free: float) -> FloatArray:
    values = np.round(WHITE * _lightness(image))
    return np.where(values <= OCCUPIED, values, UNKNOWN)


_CELLS = {MapMode.TRINARY: _trinary, MapMode.SCALE: _scale, MapMode.RAW: _raw}


def _read_image(path: Path) -> _Image:
    try:
        data = path.read_bytes()
    except OSError as error:
        raise ParameterFileError(f'{path}: {error.strerror}, expected an image, PGM or PNG'
                                 ) from error
    if data.startswith((b'P2', b'P5')):
        return _read_pgm(path, data)
    if data.startswith(b'\x89PNG'):
        return _read_png(path)
    raise ParameterFileError(f'{path}: got a file that begins with {data[:4]!r}, expected an '
                             'image: PGM (P2 or P5) or PNG')


def _read_pgm(path: Path, data: bytes) -> _Image:
    header = PGM_HEADER.match(data)
    if header is None:
        raise ParameterFileError(f'{path}: got the header {data[:20]!r}, expected P2 or P5, '
                                 'columns, rows and largest value')
    columns, rows, largest = map(int, header.groups()[1:])
    if not (columns and rows and 0 < largest <= MAX_PGM_VALUE):
        raise ParameterFileError(
            f'{path}: got {columns} columns, {rows} rows and the largest value {largest}, '
            f'expected at least 1 of each, and {MAX_PGM_VALUE} at most')
    if header.group(1) == b'P2':
        values = np.array(_pgm_numbers(path, data[header.end():]), dtype=float)
    else:
        kind = np.dtype(np.uint8) if largest <= WHITE else np.dtype('>u2')
        whole = (len(data) - header.end()) // kind.itemsize
        values = np.frombuffer(data, kind, min(whole, columns * rows), header.end())
    if len(values) != columns * rows:
        raise ParameterFileError(f'{path}: got {len(values)} pixels, expected {columns} times '
                                 f'{rows}')
    return _Image(np.minimum(1.0, values / largest).reshape(rows, columns, 1))


def _pgm_numbers(path: Path, text: bytes) -> list[int]:
    words = re.sub(rb'#[^\n]*', b'', text).split()
    if not all(PGM_PIXEL.fullmatch(word) for word in words):
        raise ParameterFileError(f'{path}: got pixels that are no whole numbers of 0 to '
                                 f'{MAX_PGM_VALUE}, expected those of a P2 file')
    return [int(word) for word in words]


def _read_png(path: Path) -> _Image:
    try:
        from PIL import Image
    except ImportError as error:
        raise ParameterFileError(f'{path}: got a PNG without Pillow, expected that it is '
                                 'installed (python3-pil), or a PGM') from error
    try:
        with Image.open(path) as image:
            is_deep = image.mode.startswith('I')
            has_opacity = 'A' in image.mode or 'transparency' in image.info
            # Eight bits of each colour, or sixteen of grey.
            values = np.asarray(image if is_deep else image.convert(
                'RGBA' if has_opacity else 'RGB'), dtype=float)
    except OSError as error:
        raise ParameterFileError(f'{path}: {error}, expected a readable PNG') from error
    if is_deep:
        return _Image(values[..., None] / MAX_PGM_VALUE)
    values = values / WHITE
    return _Image(values[..., :3], values[..., 3] if has_opacity else None)
