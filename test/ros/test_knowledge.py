"""What was learned of objects is kept in a file, and between tasks without one."""

import os

from helpers.disk import full_disk
from helpers.objects import bin_, box
from push_control.perception.object_knowledge import object_key, ObjectKnowledge
from push_control.ros.objects.knowledge import KnowledgeFile, KnowledgeMemory
from push_control.supervision_settings import SupervisionSettings
from push_control.task.status import TaskState
from push_model.files.whole_file import write_whole
import pytest

KNOWN = ObjectKnowledge((0.01, -0.02), 0.003, 0.35, 0.04)
OTHER = ObjectKnowledge((0.0, 0.03), 0.001, 0.2, 0.02)
SETTINGS = SupervisionSettings()
KEY = 'object_0123'


class Time:
    """A clock that the test sets."""

    def __init__(self):
        self.now = 1.7e9

    def __call__(self):
        return self.now


def push(memory, knowledge):
    """Let a push end, after which so much is known."""
    states = TaskState.PUSH, TaskState.RETREAT, TaskState.PLAN
    assert [memory.is_due(state) for state in states] == [False, False, True]
    assert memory.keep(knowledge) == ''


def test_a_file_holds_several_objects(tmp_path):
    """Each is read as it was written, to the last bit, and replaced alone."""
    file = KnowledgeFile(tmp_path / 'known.yaml')
    assert file.read(KEY) is None
    file.write(KEY, 1.7e9 + 0.1, KNOWN)
    file.write('object_4567', 5.0, OTHER)
    assert KnowledgeFile(tmp_path / 'known.yaml').read(KEY) == (1.7e9 + 0.1, KNOWN)
    file.write(KEY, 1.8e9, OTHER)
    assert file.read(KEY) == (1.8e9, OTHER)
    assert file.read('object_4567') == (5.0, OTHER)
    assert [path.name for path in tmp_path.iterdir()] == ['known.yaml']


@pytest.mark.parametrize('text, problem', [
    (f'{KEY}: {{time: 1.0', 'expected a YAML file'),
    ('- 1', r'got \[1\], expected a mapping of objects'),
    (f'{KEY}: 3', f'{KEY}: got 3, expected a mapping'),
    (f'{KEY}: {{friction_center: [0, 0]}}', f'{KEY}.time: got None'),
    (f'{KEY}: {{time: 1.0, friction_center: [0, 0]}}', f'{KEY}.center_deviation: got nothing'),
    (f'{KEY}: {{time: 1.0, center_deviation: x}}', f'{KEY}.friction_center: got nothing')])
def test_a_file_that_cannot_be_read_is_refused_by_name(tmp_path, text, problem):
    """The error names file, object and field; the file stays as it is."""
    path = tmp_path / 'known.yaml'
    path.write_text(text)
    with pytest.raises(ValueError, match=rf'(?s)^{path}: .*{problem}'):
        KnowledgeFile(path).read(KEY)
    assert path.read_text() == text


def test_a_file_that_cannot_be_read_is_not_replaced(tmp_path):
    path = tmp_path / 'known.yaml'
    path.write_text('- 1')
    with pytest.raises(ValueError, match='expected a mapping of objects'):
        KnowledgeFile(path).write(KEY, 1.0, KNOWN)
    assert path.read_text() == '- 1'


def test_a_missing_folder_is_refused_at_once(tmp_path):
    with pytest.raises(ValueError, match='knowledge_file: got .*, expected a file in a folder'):
        KnowledgeFile(tmp_path / 'nowhere' / 'known.yaml')


@pytest.mark.parametrize('is_kept_in_file', [True, False])
def test_what_is_remembered_grows_old(tmp_path, is_kept_in_file):
    """Also where the process has ended between, if there is a file."""
    file = KnowledgeFile(tmp_path / 'known.yaml') if is_kept_in_file else None
    clock = Time()
    memory = KnowledgeMemory(box(), SETTINGS, file, clock)
    assert memory.recall() is None
    push(memory, KNOWN)
    assert memory.recall() == KNOWN
    clock.now += 3600.0
    aged = KNOWN.aged(3600.0, SETTINGS.center_walk, SETTINGS.contact_friction_walk)
    assert memory.recall() == aged
    assert KNOWN.center_deviation < aged.center_deviation < 2.0 * KNOWN.center_deviation
    later = KnowledgeMemory(box(), SETTINGS, file, clock).recall()
    assert later == (aged if is_kept_in_file else None)
    clock.now -= 7200.0
    assert memory.recall() == KNOWN


def test_what_was_learned_of_one_object_is_not_of_another(tmp_path):
    file, clock = KnowledgeFile(tmp_path / 'known.yaml'), Time()
    memory = KnowledgeMemory(box(), SETTINGS, file, clock)
    push(memory, KNOWN)
    memory.select(bin_())
    assert memory.recall() is None
    push(memory, OTHER)
    memory.select(box())
    assert memory.recall() == KNOWN
    assert KnowledgeMemory(box(), SETTINGS, file, clock).recall() == KNOWN
    assert KnowledgeMemory(box(mass=9.0), SETTINGS, file, clock).recall() is None
    assert file.read(object_key(bin_())) == (clock.now, OTHER)


def test_only_pushes_are_kept_once_they_have_ended():
    """Late poses still tell of a push while the robot retreats."""
    memory = KnowledgeMemory(box(), SETTINGS, None, Time())
    states = (TaskState.IDLE, TaskState.PLAN, TaskState.APPROACH, TaskState.PUSH,
              TaskState.RETREAT)
    assert not any(memory.is_due(state) for state in states)
    assert memory.is_due(TaskState.FAILED)
    memory.keep(KNOWN)
    assert not memory.is_due(TaskState.PLAN)


def test_a_file_that_cannot_be_written_is_a_warning(tmp_path):
    """What was learned is known as long as the process lasts."""
    path = tmp_path / 'known.yaml'
    memory = KnowledgeMemory(box(), SETTINGS, KnowledgeFile(path), Time())
    path.write_text('- 1')
    text = memory.keep(KNOWN)
    assert text.startswith(f'knowledge_file: {path}: got [1]') and text.endswith('in memory only')
    assert memory.recall() == KNOWN and path.read_text() == '- 1'


def test_a_full_disk_leaves_the_file_as_it_was(tmp_path):
    """And nothing beside it."""
    path = tmp_path / 'known.yaml'
    memory = KnowledgeMemory(box(), SETTINGS, KnowledgeFile(path), Time())
    assert memory.keep(KNOWN) == ''
    before = path.read_bytes()
    with full_disk(10):
        text = memory.keep(KNOWN)
    assert text.startswith('knowledge_file: ') and str(path) in text
    assert path.read_bytes() == before and list(tmp_path.iterdir()) == [path]


def test_what_is_no_file_is_written_to_and_not_replaced(tmp_path):
    """As ``/dev/null`` is, by which somebody throws a file away."""
    path = tmp_path / 'pipe'
    os.mkfifo(path)
    reader = os.open(path, os.O_RDONLY | os.O_NONBLOCK)
    write_whole(path, b'text')
    assert os.read(reader, 10) == b'text' and path.is_fifo()
    os.close(reader)
