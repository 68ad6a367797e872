"""Sections of parameter files that a renamed node does not get."""

from push_model.files.data import config_file
from push_ros.parameter_files import missed_section, parameter_files
from push_ros.topics import CONTROLLER, PLANNER
import pytest

DEFAULT = config_file('push.yaml')


def test_every_file_of_a_command_line_is_found():
    arguments = ['controller', '--ros-args', '--params-file', 'a.yaml', '-p', 'task:=true',
                 '--params-file', 'b.yaml']
    assert [str(path) for path in parameter_files(arguments)] == ['a.yaml', 'b.yaml']
    assert parameter_files(['controller', '--params-file']) == []


@pytest.mark.parametrize('usual, name, section', [
    (CONTROLLER, CONTROLLER, ''), (CONTROLLER, 'second', f'/**/{CONTROLLER}'),
    # It gets the section of the other node.
    (CONTROLLER, PLANNER, ''), ('push_other', 'second', '')])
def test_a_renamed_node_misses_the_section_of_its_usual_name(usual, name, section):
    assert missed_section(DEFAULT, usual, name) == section


@pytest.mark.parametrize('text', ['', '3', '- a', '{', 'push_controller:\n\t- a'])
def test_what_is_no_parameter_file_is_left_to_the_middleware(tmp_path, text):
    path = tmp_path / 'odd.yaml'
    assert missed_section(path, CONTROLLER, 'second') == ''
    path.write_text(text)
    assert missed_section(path, CONTROLLER, 'second') == ''
