"""What was learned of a base is kept in a file, and none keeps a node from starting."""

import dataclasses
import math

from helpers.disk import full_disk
from helpers.objects import box
from push_control.ros.base_memory import BaseMemory
from push_model.base_knowledge import BaseKnowledge, PULSE, robot_key
from push_model.parameters import RoundRobot
from push_safety.layer import SafetyLayer
import pytest

ROBOT = RoundRobot(0.17, max_acceleration=0.9)
KNOWN = BaseKnowledge(0.2 + 1e-17, 0.1 / 3.0, 0.0, PULSE, 0.35 * 0.9, math.inf)


def test_what_is_kept_is_recalled_by_another_process(tmp_path):
    """To the last bit, and each base by itself."""
    path, other = tmp_path / 'base.yaml', dataclasses.replace(ROBOT, max_speed=0.2)
    assert BaseMemory(path, ROBOT).recall() == (None, '')
    assert BaseMemory(path, ROBOT).keep(KNOWN) == ''
    assert BaseMemory(path, other).recall() == (None, '')
    assert BaseMemory(path, other).keep(BaseKnowledge()) == ''
    assert BaseMemory(path, ROBOT).recall() == (KNOWN, '')
    assert BaseMemory(path, other).recall() == (BaseKnowledge(), '')
    assert list(tmp_path.iterdir()) == [path]


def test_what_has_not_changed_is_not_written_again(tmp_path):
    path = tmp_path / 'base.yaml'
    BaseMemory(path, ROBOT).keep(KNOWN)
    memory = BaseMemory(path, ROBOT)
    memory.recall()
    path.unlink()
    assert memory.keep(KNOWN) == '' and not path.exists()
    assert memory.keep(KNOWN._replace(dead_time=0.1)) == '' and path.exists()


@pytest.mark.parametrize('text, problem', [
    ('robot: {', 'while parsing'), ('- 1', r'got \[1\], expected a mapping of bases'),
    ('KEY: 3', 'got 3, expected a mapping'), ('KEY: {dead_time: -0.1}', 'dead_time: got -0.1'),
    ('KEY: {dead_time: 3.0}', 'dead_time: got 3.0, expected .* up to 1'),
    ('KEY: {pulse: 0}', 'pulse: got 0, expected a number above 0'),
    ('KEY: {max_acceleration: .nan}', 'max_acceleration: got nan'),
    ('KEY: {min_speed: fast}', "min_speed: got 'fast'"),
    ('KEY: {lag: 0.1}', 'lag: got an unknown field'), ('\0', 'unacceptable character')])
def test_a_file_that_cannot_be_read_is_named_and_replaced(tmp_path, text, problem):
    """The base is learned again from nothing."""
    path = tmp_path / 'base.yaml'
    path.write_text(text.replace('KEY', robot_key(ROBOT)))
    memory = BaseMemory(path, ROBOT)
    known, fault = memory.recall()
    assert known is None
    with pytest.raises(AssertionError, match=rf'(?s)base_file: {path}: .*{problem}'):
        raise AssertionError(fault)
    assert memory.keep(KNOWN) == ''
    assert BaseMemory(path, ROBOT).recall() == (KNOWN, '')


def test_of_a_file_of_before_what_is_missing_is_unknown(tmp_path):
    path = tmp_path / 'base.yaml'
    path.write_text(f'{robot_key(ROBOT)}: {{dead_time: 0.2}}')
    assert BaseMemory(path, ROBOT).recall() == (BaseKnowledge(dead_time=0.2), '')


def test_a_file_that_cannot_be_written_is_a_warning(tmp_path):
    """Neither a folder that is missing nor a full disk is more than that."""
    assert BaseMemory(tmp_path / 'no' / 'base.yaml', ROBOT).keep(KNOWN).startswith('base_file: ')
    path = tmp_path / 'base.yaml'
    BaseMemory(path, ROBOT).keep(KNOWN)
    before = path.read_bytes()
    with full_disk(10):
        assert str(path) in BaseMemory(path, ROBOT).keep(BaseKnowledge())
    assert path.read_bytes() == before and list(tmp_path.iterdir()) == [path]


def test_without_a_file_nothing_is_kept():
    memory = BaseMemory(None, ROBOT)
    assert memory.keep(KNOWN) == ''
    assert memory.recall() == (None, '')


@pytest.mark.parametrize('ratio', [0.125, 0.35, 0.5, math.inf])
def test_the_layer_drives_on_with_what_was_kept(ratio):
    """Unless nothing is to be learned; accelerations as one of those that are compared."""
    known = KNOWN._replace(max_acceleration=ratio * ROBOT.max_acceleration)
    layer = SafetyLayer(ROBOT, box())
    layer.start_from(known)
    assert layer.base_knowledge == known
    layer.reset()
    assert layer.base_knowledge == known
    stated = dataclasses.replace(ROBOT, identify_base=False, dead_time=0.1)
    layer = SafetyLayer(stated, box())
    layer.start_from(known)
    assert layer.base_knowledge == BaseKnowledge.stated(stated)
