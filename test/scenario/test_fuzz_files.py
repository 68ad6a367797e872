"""Whatever a file holds, it is read, or refused with the name of what is wrong."""

from helpers.fuzzing import hypothesis, NUMBERS, settings, st, STEPS, TEXTS
from push_model.files.parameter_files import read_object, read_robot
from push_model.files.strict_yaml import MAX_DEPTH, ParameterFileError, parse_yaml
from push_scenario.definition.loader import read_scenario
import pytest
import yaml

SCALARS = st.one_of(NUMBERS, st.integers(), TEXTS, st.booleans(), st.none())
VALUES = st.recursive(SCALARS, lambda inner: st.one_of(
    st.lists(inner, max_size=4), st.dictionaries(TEXTS, inner, max_size=4)), max_leaves=12)
OBJECT = {'mass': 5.0, 'outline': [[-0.2, -0.2], [0.2, -0.2], [0.2, 0.2], [-0.2, 0.2]],
          'supports': [{'x': 0.0, 'y': 0.0, 'friction_coefficient': 0.3}],
          'center_of_mass': [0.0, 0.0], 'contact_friction_coefficient': 0.5}
ROBOT = {'radius': 0.17, 'drive': 'differential', 'max_speed': 0.5}
SCENARIO = {'description': 'a push', 'object': {'file': 'box_04.yaml'},
            'robot': {'file': 'disc_017.yaml'}, 'start': {'object': {'theta_deg': -45},
                                                          'contact': {'kind': 'vertex'}},
            'goal': {'x': 1.9, 'y': 1.3, 'theta_deg': 15}, 'sensors': {'pose_noise': 0.002},
            'simulation': {'seed': 1}, 'time_limit': 60}


@pytest.fixture(scope='module')
def path(tmp_path_factory):
    """Name a file."""
    return tmp_path_factory.mktemp('fuzz') / 'file.yaml'


def spoilt(content, changes, keys):
    """Replace values of a file, at any depth, by others; add a key."""
    for number, value in changes:
        place = content
        while True:
            items = list(place if isinstance(place, dict) else range(len(place)))
            key = items[number % len(items)]
            if isinstance(place[key], (dict, list)) and place[key] and number % 3:
                place = place[key]
                continue
            place[key] = value
            break
    content.update(keys)
    return content


@pytest.mark.parametrize('read, content', [(read_object, OBJECT), (read_robot, ROBOT),
                                           (read_scenario, SCENARIO)])
@settings(STEPS // 2)
@hypothesis.given(changes=st.lists(st.tuples(st.integers(0, 50), VALUES), max_size=3),
                  keys=st.dictionaries(TEXTS, SCALARS, max_size=1))
def test_files_are_read_or_refused(read, content, path, changes, keys):
    """With the name of the file."""
    copy = yaml.safe_load(yaml.safe_dump(content))
    path.write_text(yaml.safe_dump(spoilt(copy, changes, keys), allow_unicode=True))
    try:
        read(path)
    except ParameterFileError as error:
        assert str(path.name) in str(error) or 'yaml' in str(error)


@settings()
@hypothesis.given(st.text(st.characters(exclude_categories=['Cs']), max_size=60))
def test_any_text_is_read_or_refused(text):
    """As YAML."""
    try:
        assert isinstance(parse_yaml(text, 'text'), dict)
    except ParameterFileError as error:
        assert 'text' in str(error)


@pytest.mark.parametrize('text', ['[' * 3000, 'a: ' + '[' * 3000 + ']' * 3000,
                                  '\n'.join(f'{" " * i}a:' for i in range(3000))])
def test_depth_is_refused(text):
    """And does not end the program."""
    with pytest.raises(ParameterFileError, match=f'more than {MAX_DEPTH} levels'):
        parse_yaml(text, 'deep')
