"""Whatever a map file holds, it is read as cells, or refused by name."""

from helpers.fuzzing import hypothesis, NUMBERS, settings, st, TEXTS
import numpy as np
from push_model.files.strict_yaml import ParameterFileError
from push_navigation.map_file import read_map
import pytest
import yaml

FIELDS = {'image': 'map.pgm', 'resolution': 0.05, 'origin': [0.0, 0.0, 0.0], 'negate': 0,
          'occupied_thresh': 0.65, 'free_thresh': 0.2, 'mode': 'trinary'}
VALUES = st.one_of(NUMBERS, st.integers(), TEXTS, st.none(), st.booleans(),
                   st.lists(st.one_of(NUMBERS, TEXTS), max_size=4))
HEADERS = st.builds(
    b'%s %d %d %d\n'.__mod__,
    st.tuples(st.sampled_from([b'P2', b'P5']), st.integers(0, 5), st.integers(0, 5),
              st.sampled_from([0, 1, 255, 65535, 10 ** 400])))
PIXELS = st.one_of(st.binary(max_size=60), st.lists(
    st.one_of(st.integers(-3, 300), st.just(10 ** 400)), max_size=25).map(
        lambda numbers: ' '.join(map(str, numbers)).encode()))
IMAGES = st.one_of(st.tuples(HEADERS, PIXELS).map(b''.join), st.binary(max_size=40),
                   st.binary(max_size=40).map(b'\x89PNG\r\n\x1a\n'.__add__))


@pytest.fixture(scope='module')
def folder(tmp_path_factory):
    """Return a folder for a map."""
    return tmp_path_factory.mktemp('map')


@settings()
@hypothesis.given(changes=st.dictionaries(st.sampled_from(list(FIELDS)), VALUES, max_size=2),
                  image=IMAGES)
@hypothesis.example(changes={}, image=b'P2 1 1 255\n-5')
@hypothesis.example(changes={}, image=b'P2 1 1 255\n' + b'9' * 400)
@hypothesis.example(changes={}, image=b'P5 ' + b'9' * 5000 + b' 1 255\n\0')
def test_maps_are_read_or_refused(folder, changes, image):
    """All cells are free, occupied or unknown, or values of ROS."""
    (folder / 'map.yaml').write_text(yaml.safe_dump({**FIELDS, **changes}), encoding='utf-8')
    (folder / 'map.pgm').write_bytes(image)
    try:
        found = read_map(folder / 'map.yaml')
    except ParameterFileError as error:
        assert 'expected' in str(error) or 'map' in str(error)
        return
    assert found.cells.size and set(np.unique(found.cells)) <= set(range(-1, 101))
    assert found.resolution > 0.0 and found.origin.is_finite()
