"""Map files of nav2_map_server: modes, thresholds, negation, origin, and what may be wrong."""

import math

import numpy as np
from push_model.files.strict_yaml import ParameterFileError
from push_navigation.map_file import read_map
import pytest

FIELDS = {'image': 'floor.pgm', 'resolution': 0.05, 'origin': [1.0, -2.0, 0.5], 'negate': 0,
          'occupied_thresh': 0.65, 'free_thresh': 0.25}
# White is free, black occupied, grey as map_saver writes it unknown.
GREYS = np.array([[254, 0, 205], [128, 100, 20]], dtype=np.uint8)


def written(folder, greys=GREYS, **changes):
    """Write a binary PGM with a comment, and the YAML file beside it."""
    fields = {key: value for key, value in {**FIELDS, **changes}.items() if value is not None}
    path = folder / 'floor.yaml'
    path.write_text('\n'.join(f'{key}: {value}' for key, value in fields.items()))
    header = f'P5\n# made by a map saver\n{greys.shape[1]} {greys.shape[0]}\n255\n'
    (folder / 'floor.pgm').write_bytes(header.encode() + greys.tobytes())
    return path


def by_hand(grey, mode, negate, occupied=0.65, free=0.25):
    """Interpret one pixel."""
    p = grey / 255 if negate else 1 - grey / 255
    if mode == 'raw':
        return grey if grey <= 100 else -1
    if p > occupied:
        return 100
    if p < free:
        return 0
    return -1 if mode == 'trinary' else round((p - free) / (occupied - free) * 100)


@pytest.mark.parametrize('negate', [0, 1])
@pytest.mark.parametrize('mode', ['trinary', 'scale', 'raw'])
def test_pixels_are_read_as_by_map_server(tmp_path, mode, negate):
    """All greys, pixel by pixel; the lowest row of the image is the first of the map."""
    greys = np.arange(256, dtype=np.uint8).reshape(8, 32)
    grid = read_map(written(tmp_path, greys, mode=mode, negate=negate))
    expected = [[by_hand(int(grey), mode, negate) for grey in row] for row in greys[::-1]]
    assert grid.cells.tolist() == expected and grid.cells.dtype == np.int8
    assert (grid.resolution, tuple(grid.origin)) == (0.05, (1.0, -2.0, 0.5))


def test_without_a_mode_it_is_trinary(tmp_path):
    """As maps of slam_toolbox are: grey 205 is unknown with the threshold of its saver."""
    grid = read_map(written(tmp_path, negate=None, free_thresh=0.196))
    assert grid.cells.tolist() == [[-1, -1, 100], [0, 100, -1]]


def test_text_and_sixteen_bits_hold_the_same(tmp_path):
    """P2, and P5 with two bytes for each pixel, the greater first."""
    path = written(tmp_path)
    expected = read_map(path).cells.tolist()
    numbers = ' '.join(map(str, GREYS.ravel().tolist()))
    (tmp_path / 'floor.pgm').write_text(f'P2 3 2 # size\n255\n{numbers}\n')
    assert read_map(path).cells.tolist() == expected
    deep = (GREYS.astype('>u2') * 257).tobytes()
    (tmp_path / 'floor.pgm').write_bytes(b'P5 3 2 65535\n' + deep)
    assert read_map(path).cells.tolist() == expected


def test_a_png_holds_the_same_and_what_is_transparent_is_unknown_in_mode_scale(tmp_path):
    """In mode trinary opacity counts as a fourth colour: opaque black has p = 0.75."""
    image = pytest.importorskip('PIL.Image')
    path = written(tmp_path, image='floor.png')
    image.fromarray(GREYS).save(tmp_path / 'floor.png')
    assert read_map(path).cells.tolist() == read_map(written(tmp_path)).cells.tolist()
    colors = np.zeros((1, 2, 4), dtype=np.uint8)
    colors[0, 0, 3] = 255
    image.fromarray(colors).save(tmp_path / 'floor.png')
    for mode, threshold, expected in (('scale', 0.65, [[100, -1]]),
                                      ('trinary', 0.65, [[100, 100]]),
                                      ('trinary', 0.8, [[-1, 100]])):
        path = written(tmp_path, image='floor.png', mode=mode, occupied_thresh=threshold)
        assert read_map(path).cells.tolist() == expected


@pytest.mark.parametrize('changes, text', [
    ({'image': None}, 'image: got None, expected the name'),
    ({'image': 'none.pgm'}, 'none.pgm: No such file'),
    ({'image': 'floor.yaml'}, "begins with b'imag', expected an image: PGM"),
    ({'resolution': 0}, 'resolution: got 0, expected a length from 0.001 to 10 m'),
    ({'resolution': '.inf'}, 'resolution: got inf'),
    ({'origin': '[0, 0]'}, r'origin: got \[0, 0\], expected three finite numbers'),
    ({'mode': 'grey'}, "mode: got 'grey', expected trinary, scale or raw"),
    ({'negate': 2}, 'negate: got 2, expected 0 or 1'),
    ({'occupied_thresh': 65}, 'occupied_thresh: got 65, expected a number from 0 to 1'),
    ({'free_thresh': 0.7}, 'free_thresh: got 0.7, expected a number from 0 to occupied_thresh')])
def test_a_file_that_is_wrong_is_refused_by_field(tmp_path, changes, text):
    """With the file, what came and what was expected."""
    with pytest.raises(ParameterFileError, match=f'floor.*{text}|{text}'):
        read_map(written(tmp_path, **changes))


@pytest.mark.parametrize('data, text', [
    (b'P5\n3 2\n', 'got the header'), (b'P5 3 0 255\n', '3 columns, 0 rows'),
    (b'P5 3 2 255\nabc', 'got 3 pixels, expected 3 times 2'), (b'P2 1 1 255 x', 'no whole num')])
def test_a_broken_image_is_refused(tmp_path, data, text):
    """As one whose end was lost."""
    path = written(tmp_path)
    (tmp_path / 'floor.pgm').write_bytes(data)
    with pytest.raises(ParameterFileError, match=text):
        read_map(path)


def test_angles_and_sizes_are_finite(tmp_path):
    """A yaw that is not a number names the field."""
    with pytest.raises(ParameterFileError, match='origin'):
        read_map(written(tmp_path, origin='[0, 0, .nan]'))
    assert math.isfinite(read_map(written(tmp_path)).origin.theta)
