"""Scenario files: what is read is what was written, and errors say what is wrong."""

import dataclasses
import math
import re

from push_model.contact import find_contact
from push_model.files.parameter_files import read_object
from push_model.files.strict_yaml import ParameterFileError
from push_model.friction import friction_center
from push_model.geometry import Pose
from push_scenario.definition.catalogue import (
    find_scenario, scenario_description, scenario_directory, scenario_names,
)
from push_scenario.definition.loader import read_scenario, scenario_from_text, scenario_text
import pytest

MINIMAL = """
description: a push
object:
  mass: 2
  inertia: 0.05
  outline: [[-0.2, -0.2], [0.2, -0.2], [0.2, 0.2], [-0.2, 0.2]]
  supports:
    - {x: 0.1, y: 0.1, friction_coefficient: 0.3}
    - {x: -0.1, y: -0.1, friction_coefficient: 0.3}
robot: {radius: 0.17}
start:
  contact: {kind: face, index: 3}
goal: {x: 1}
"""


def write(tmp_path, text):
    """Write a scenario file and return its path."""
    path = tmp_path / 'case.yaml'
    path.write_text(text)
    return path


@pytest.mark.parametrize('name', scenario_names())
def test_every_scenario_survives_being_written_and_read(name):
    scenario = read_scenario(find_scenario(name))
    assert scenario.name == name
    assert scenario_description(name) == scenario.description
    again = scenario_from_text(scenario_text(scenario), name)
    assert again == scenario
    assert dataclasses.asdict(again) == dataclasses.asdict(scenario)


@pytest.mark.parametrize('name', scenario_names())
def test_every_push_starts_with_the_robot_at_the_object_and_every_task_away(name):
    scenario = read_scenario(find_scenario(name))
    _, _, gap = find_contact(scenario.true_object, scenario.start.object.pose,
                             scenario.robot_start, scenario.robot.radius)
    assert name.startswith('task_') == (scenario.task is not None)
    if scenario.task is None:
        assert 0.0 - 1e-9 <= gap <= scenario.planner.contact_tolerance
    else:
        assert gap > scenario.task.drive.clearance


def test_the_named_scenarios_are_there():
    assert {'straight_push', 'curved_push', 'corner_push_mismatch', 'holonomic_face',
            'sensor_dropout', 'unreachable_goal'} <= set(scenario_names())


def test_the_true_object_differs_only_in_what_it_names(tmp_path):
    text = MINIMAL + """
true_object:
  supports: [{friction_coefficient: 0.6}, {}]
true_robot: {time_constant: 0.3}
"""
    scenario = read_scenario(write(tmp_path, text))
    nominal, true = scenario.object, scenario.true_object
    assert [s.friction_coefficient for s in nominal.supports] == [0.3, 0.3]
    assert [s.friction_coefficient for s in true.supports] == [0.6, 0.3]
    assert dataclasses.replace(true, supports=nominal.supports) == nominal
    assert friction_center(true)[0] > friction_center(nominal)[0] + 0.01
    assert scenario.true_robot == dataclasses.replace(scenario.robot, time_constant=0.3)


def test_without_true_parameters_the_nominal_ones_are_true(tmp_path):
    scenario = read_scenario(write(tmp_path, MINIMAL))
    assert scenario.true_object == scenario.object
    assert scenario.true_robot == scenario.robot


def test_object_file_is_read_and_changed(tmp_path):
    (tmp_path / 'my_box.yaml').write_text(
        (scenario_directory().parent / 'objects' / 'box_04.yaml').read_text())
    before, after = MINIMAL.split('object:')[0], MINIMAL.split('robot:')[1]
    text = f'{before}object: {{file: my_box.yaml, mass: 7}}\nrobot:{after}'
    scenario = read_scenario(write(tmp_path, text))
    assert scenario.object == dataclasses.replace(read_object(tmp_path / 'my_box.yaml'), mass=7.0)


def test_radians_may_be_written_in_degrees(tmp_path):
    degrees = read_scenario(write(tmp_path, MINIMAL.replace('x: 1}', 'theta_deg: 30}')))
    assert degrees.goal.theta == pytest.approx(math.pi / 6)


def test_exponents_without_a_point_are_numbers(tmp_path):
    text = MINIMAL + 'simulation: {step: 1e-3}\n'
    assert read_scenario(write(tmp_path, text)).simulation.step == 0.001


@pytest.mark.parametrize('contact, normal', [('kind: face, index: 3', 0.0),
                                             ('kind: vertex, index: 0', 0.4),
                                             ('kind: vertex, index: 2', -0.7)])
@pytest.mark.parametrize('gap', [0.0, 0.02])
def test_the_robot_is_placed_at_the_contact(tmp_path, contact, normal, gap):
    text = MINIMAL.replace('contact: {kind: face, index: 3}',
                           f'contact: {{{contact}}}\n  gap: {gap}\n  normal: {normal}\n'
                           '  heading: 0.2\n  object: {x: 3, y: -1, theta: 2}')
    scenario = read_scenario(write(tmp_path, text))
    pose = scenario.robot_start
    found, gamma, distance = find_contact(scenario.object, Pose(3, -1, 2), pose, 0.17)
    contact = scenario.start.contact
    assert (found.kind, found.index) == (contact.kind, contact.index)
    assert distance == pytest.approx(gap, abs=1e-12)
    assert math.remainder(pose.theta - gamma - 0.2, 2 * math.pi) == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize('change, words', [
    (('goal:', 'gaol:'), ("gaol: got an unknown key, expected 'goal'",)),
    (('goal: {x: 1}', ''), ('goal: got nothing, expected a mapping',)),
    (('goal: {x: 1}', 'goal: 1'), ('goal: got 1, expected a mapping',)),
    (('x: 1}', 'z: 1}'), ('goal.z: got an unknown key, expected one of x, y, theta',)),
    (('x: 1}', 'x: far}'), ("goal.x: got 'far', expected a finite number [m]",)),
    (('x: 1}', 'x: .nan}'), ('goal.x: got nan, expected a finite number [m]',)),
    (('x: 1}', 'x: 1, x: 2}'), (":13: got the key 'x' twice, expected it once",)),
    (('x: 1}', 'theta: 1, theta_deg: 2}'), ("goal.theta_deg: got 'theta' too",)),
    (('x: 1}', 'theta_deg: wide}'), ("goal.theta_deg: got 'wide', expected a number [deg]",)),
    (('mass: 2', 'mass: -2'),
     ('object.mass: got -2, expected a finite number from 0.005 to 1000 [kg]',)),
    (('mass: 2', ''),
     ('object.mass: got nothing, expected a finite number from 0.005 to 1000 [kg]',)),
    (('radius: 0.17', 'radius: true'),
     ('robot.radius: got True, expected a number of at least 0',)),
    (('radius: 0.17', 'file: none.yaml'),
     ("robot.file: got 'none.yaml', expected a file in", 'create3.yaml, disc_017.yaml')),
    (('radius: 0.17', 'radius: 0.17, drive: legs'), ("robot.drive: got 'legs', expected one of "
                                                     'differential, holonomic',)),
    (('{x: -0.1, y: -0.1, friction_coefficient: 0.3}', '{x: -0.1, y: -0.1}'),
     ('object.supports[1].friction_coefficient: got nothing', 'Coulomb friction')),
    (('index: 3', 'index: 4'), ('start: Contact.index: got 4',)),
    (('index: 3}', 'index: 3}\n  robot: {x: 5}'), ('start.robot: got robot',)),
    (('goal:', 'planner: {cone_margin: 1.5}\ngoal:'), ('planner.cone_margin: got 1.5, expected',)),
    (('goal:', 'planner: {cone_magrin: 0.5}\ngoal:'),
     ("planner.cone_magrin: got an unknown key, expected 'cone_margin'",)),
    (('goal:', 'control: {control_law: hope}\ngoal:'),
     ("control.control_law: got 'hope', expected one of feedback, mpc, open_loop",)),
    (('goal:', 'true_object: {supports: [{}]}\ngoal:'),
     ('true_object.supports: got 1 items, expected 2',)),
    (('goal:', 'true_object: {colour: red}\ngoal:'), ('true_object.colour: got an unknown key',)),
    (('goal:', 'expected: fun\ngoal:'),
     ("got 'fun', expected one of reached, refused, too_heavy",)),
    (('goal:', 'name: me\ngoal:'), ("name: got 'me', expected no such key",)),
    (('goal:', ': : goal'), (':13: ',)),
])
def test_errors_name_file_key_and_expectation(tmp_path, change, words):
    assert change[0] in MINIMAL
    path = write(tmp_path, MINIMAL.replace(*change))
    with pytest.raises(ParameterFileError) as error:
        read_scenario(path)
    assert str(error.value).startswith(f'{path}:')
    for word in words:
        assert word in str(error.value)


def test_overlap_at_the_start_is_refused(tmp_path):
    text = MINIMAL.replace('contact: {kind: face, index: 3}', 'robot: {x: -0.3}')
    with pytest.raises(ParameterFileError,
                       match=r'start: got a robot that overlaps .* by 0\.07 m'):
        read_scenario(write(tmp_path, text))


def test_missing_files_and_unknown_names_are_errors(tmp_path):
    with pytest.raises(ParameterFileError, match=re.escape(f'{tmp_path}/no.yaml: ')):
        read_scenario(find_scenario(tmp_path / 'no.yaml'))
    with pytest.raises(ParameterFileError, match='nowhere: got no such scenario.*straight_push'):
        find_scenario('nowhere')
    with pytest.raises(ParameterFileError, match=r"case.yaml: got \['time_limit'\].*description"):
        scenario_description(write(tmp_path, 'time_limit: 3'))
    with pytest.raises(ParameterFileError, match='case.yaml:1: '):
        scenario_description(write(tmp_path, '[}'))
