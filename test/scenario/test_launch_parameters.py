"""Parameters that launch files hand to the nodes: in any namespace, objects and robots by name."""

import math

import numpy as np
from push_control.settings import ControlSettings
from push_model.files.data import config_file
from push_model.files.flat_values import from_parameter_values
from push_model.files.parameter_files import named_file, read_object, read_robot
from push_model.files.strict_yaml import ParameterFileError
from push_model.parameters import PushedObject, RoundRobot
from push_ros.topics import CONTROLLER, PLANNER, SIM
from push_scenario.dds.launch_parameters import (
    launch_parameters, SIM_SECTION, switch, write_parameters,
)
from push_scenario.definition.loader import read_sensors, scenario_from_text
from push_sim_node.plant import Plant
from push_sim_node.sensors import SensorSettings, ViewBias
import pytest
import rclpy
from rclpy.context import Context

DEFAULT = config_file('push.yaml')
OBJECTS = sorted(path.stem for path in config_file('objects/bin.yaml').parent.glob('*.yaml'))
ROBOTS = sorted(path.stem for path in config_file('robots/create3.yaml').parent.glob('*.yaml'))


def received(path, node, namespace):
    """Return the parameters that a node in a namespace receives from a file."""
    context = Context()
    rclpy.init(args=['--ros-args', '-r', f'__ns:={namespace}', '--params-file', str(path)],
               context=context)
    try:
        made = rclpy.create_node(node, context=context,
                                 automatically_declare_parameters_from_overrides=True)
        values = {name: parameter.value
                  for name, parameter in made.get_parameters_by_prefix('').items()}
        made.destroy_node()
        return values
    finally:
        rclpy.shutdown(context=context)


@pytest.mark.dds
@pytest.mark.parametrize('namespace', ['/', '/robot1', '/floor/robot1'])
def test_sections_of_plain_nodes_hold_in_every_namespace(tmp_path, namespace):
    """Where ROS itself would ignore them without a word; later sections take precedence."""
    path = tmp_path / 'my.yaml'
    path.write_text('/**: {ros__parameters: {a: 1, b: {c: 1, d: 1}}}\n'
                    'push_sim: {ros__parameters: {a: 2, b: {c: 2}}}\n')
    values = received(write_parameters(launch_parameters(path), tmp_path), SIM, namespace)
    assert (values['a'], values['b.c'], values['b.d']) == (2, 2, 1)


@pytest.mark.dds
def test_the_default_file_holds_in_every_namespace():
    for node in (PLANNER, CONTROLLER, SIM):
        assert received(DEFAULT, node, '/robot1') == received(DEFAULT, node, '/')


@pytest.mark.parametrize('name', OBJECTS)
def test_an_object_by_name_takes_the_place_of_that_in_the_file(name):
    """Of its friction too, which the simulator's section has; it starts apart from the robot."""
    expected = read_object(named_file('objects', name))
    sections = launch_parameters(DEFAULT, name)
    sim = {**sections['/**'], **sections[SIM_SECTION]}
    for values in (sections['/**'], sim):
        assert from_parameter_values(PushedObject, values, 'object.') == expected
    assert sections[f'/**/{CONTROLLER}']['object_name'] == name
    robot = from_parameter_values(RoundRobot, sim, 'robot.')
    plant = Plant(expected, robot, sim['object_start'], sim['robot_start'], interpret=True)
    assert plant.truth(0.0).gap > 0.2


@pytest.mark.parametrize('name', ROBOTS)
def test_a_robot_by_name_takes_the_place_of_that_in_the_file(name):
    sections = launch_parameters(DEFAULT, robot_name=name)
    expected = read_robot(named_file('robots', name))
    assert from_parameter_values(RoundRobot, sections['/**'], 'robot.') == expected
    assert all(key.startswith(('/**/', '/**')) for key in sections)


def test_sensors_by_name_are_those_of_the_simulator_alone():
    """The default file has those of motion capture."""
    mocap = launch_parameters(DEFAULT, sensors_name='mocap')
    assert mocap[SIM_SECTION] == launch_parameters(DEFAULT)[SIM_SECTION] | {
        name: value for name, value in mocap[SIM_SECTION].items() if name.startswith('sensors.')}
    camera = launch_parameters(DEFAULT, sensors_name='camera')
    settings = from_parameter_values(SensorSettings, camera[SIM_SECTION], 'sensors.')
    assert settings == read_sensors(named_file('sensors', 'camera'))
    assert settings.pose_bias == 0.03 and settings.pose_rate == 10.0
    assert not any(name.startswith('sensors.') for name in camera['/**'])


def test_the_controller_expects_the_poses_of_the_sensors():
    """Its time-out leaves room for three periods, its bias is the root mean square of theirs."""
    mocap, camera = (launch_parameters(DEFAULT, sensors_name=name)[f'/**/{CONTROLLER}']
                     for name in ('mocap', 'camera'))
    default = launch_parameters(DEFAULT)[f'/**/{CONTROLLER}']
    assert {name: mocap[name] for name in default} == default
    assert mocap['control.pose_bias'] == ControlSettings().pose_bias
    assert camera['control.pose_timeout'] == pytest.approx(0.45)
    view = ViewBias(read_sensors(named_file('sensors', 'camera')), np.random.default_rng(1))
    errors = np.array([view.error(bearing) for bearing in np.linspace(0.0, 2.0 * math.pi, 1000)])
    rms = np.sqrt(np.mean(errors ** 2, axis=0))
    assert camera['control.pose_bias'] == pytest.approx(math.hypot(*rms[:2]) / math.sqrt(2.0),
                                                        rel=0.01)
    assert camera['control.heading_bias'] == pytest.approx(rms[2], rel=0.01)
    assert camera['supervision.moved_distance'] == 0.1


def test_a_camera_on_the_robot_sets_view_noise_and_time_out():
    """The view is that of the example in the docs: 0.18 m; motion capture has none."""
    own, near, mocap = (launch_parameters(DEFAULT, robot_name='disc_017', sensors_name=name)[
        f'/**/{CONTROLLER}'] for name in ('own_camera', 'near', 'mocap'))
    assert own['supervision.view_nearest'] == pytest.approx(0.18)
    assert own['supervision.view_angle'] == pytest.approx(math.radians(34.5))
    assert own['control.heading_noise'] == pytest.approx(math.radians(0.5))
    assert own['control.heading_noise_per_distance'] == pytest.approx(math.radians(1.0), rel=1e-3)
    assert own['control.pose_timeout'] == pytest.approx(0.45)
    assert near['supervision.view_nearest'] == pytest.approx(0.15)
    assert near['supervision.view_angle'] == math.pi
    assert not any('view' in name for name in mocap)


def test_a_scenario_may_name_a_file_of_sensors_and_change_parts_of_it():
    text = named_file('scenarios', 'straight_push').read_text()
    scenario = scenario_from_text(text + '\nsensors: {file: camera.yaml, pose_rate: 5.0}', 'seen')
    assert scenario.sensors.pose_rate == 5.0 and scenario.sensors.pose_latency == 0.15


@pytest.mark.parametrize('text, message', [
    ('3', 'got no sections'), ('push_sim: 3', 'push_sim: got no ros__parameters'),
    ('push_sim: {a: 1}', 'push_sim: got no ros__parameters')])
def test_what_is_no_parameter_file_is_refused(tmp_path, text, message):
    path = tmp_path / 'my.yaml'
    path.write_text(text)
    with pytest.raises(ValueError, match=message):
        launch_parameters(path)


def test_unknown_names_are_refused_with_those_that_there_are():
    with pytest.raises(ParameterFileError, match='expected a path or one of bin, box_04'):
        launch_parameters(DEFAULT, 'box')


@pytest.mark.parametrize('argument', ['object', 'robot', 'sensors'])
def test_a_file_that_is_missing_is_refused_with_its_argument(tmp_path, argument):
    missing = str(tmp_path / 'none.yaml')
    names = {'object_name': '', 'robot_name': '', 'sensors_name': '', f'{argument}_name': missing}
    with pytest.raises(ParameterFileError, match=f'^{argument}: {missing}: No such file'):
        launch_parameters(DEFAULT, **names)
    with pytest.raises(ParameterFileError, match=f'^{argument}: got .*{missing}'):
        launch_parameters(missing, argument=argument)


def test_a_switch_is_on_off_or_not_given():
    assert [switch('task', text) for text in ('', 'true', 'False')] == [None, True, False]
    with pytest.raises(ValueError, match="task: got 'yes', expected true or false"):
        switch('task', 'yes')
