"""Parameter dataclasses as ROS parameters: the same values, described and guarded."""

import contextlib
import dataclasses
import math
from typing import get_type_hints

from push_control import controller_node
from push_control.ros.parameters import ControllerParameters
from push_control.settings import ControlSettings
from push_model.files.data import config_file
from push_model.files.flat_values import (
    from_parameter_values, parameter_specs, to_parameter_values,
)
from push_model.files.parameter_files import read_object, read_robot
from push_model.parameters import PushedObject, RoundRobot, Support
from push_model.quantity import quantity
from push_planner import planner_node
from push_planner.problem import PlannerSettings
from push_ros.node_settings import ControllerOptions, Frames, SimOptions
from push_ros.parameters import dynamic_parameters, ParameterSet
from push_ros.topics import CONTROLLER, PLANNER, SIM
from push_scenario.dds.parameter_files import write_parameter_files
from push_scenario.definition.catalogue import scenario_names
from push_scenario.definition.loader import load_scenario
from push_scenario.simulation.start import place_robot
from push_sim_node import sim_node
from push_sim_node.disturbance import FrictionChange
from push_sim_node.sensors import SensorSettings
from push_sim_node.simulation import SimulationSettings
import pytest
import rclpy
from rclpy.parameter import Parameter
import yaml

BOX = PushedObject(
    mass=3.0, inertia=0.08, center_of_mass=(0.01, 0.02), contact_friction_coefficient=0.4,
    outline=((-0.2, -0.2), (0.2, -0.2), (0.2, 0.2), (-0.2, 0.2)),
    supports=(Support(-0.1, 0.0, 0.3, 0.45), Support(0.1, 0.1, 0.2, 0.375),
              Support(0.1, -0.1, 0.4, 0.175)))
DISC = PushedObject(mass=1.0, inertia=0.01, radius=0.2, supports=(Support(0.0, 0.0, 0.5),))
SECTIONS = {PLANNER: planner_node.SECTIONS, CONTROLLER: controller_node.SECTIONS,
            SIM: sim_node.SECTIONS}
INSTANCES = [
    BOX, DISC, RoundRobot(0.17, 'holonomic'), ControlSettings(control_law='open_loop'),
    PlannerSettings(segments=30), Frames(world_frame='map'), ControllerOptions(task=True),
    SensorSettings(pose_dropouts=((1.0, 2.0), (3.0, 4.5))),
    SimulationSettings(seed=7, friction_changes=(FrictionChange(1.0, 2.0, 0.5),
                                                 FrictionChange(3.0, 4.0, 2.0, 1))),
    SimOptions(lockstep=True, object_start=(1.0, 2.0, 3.0), tape_path='tape.csv')]


def parameters(name):
    """List the parameters of a node."""
    return [spec for prefix, cls in SECTIONS[name] for spec in parameter_specs(cls, prefix)]


@contextlib.contextmanager
def node_with(overrides):
    """Make a node that was given parameters, as ``--params-file`` does, in a quiet context."""
    context = rclpy.Context()
    rclpy.init(args=[], context=context, domain_id=0)
    node = rclpy.create_node(
        'probe', context=context, automatically_declare_parameters_from_overrides=True,
        parameter_overrides=[Parameter(name, value=value) for name, value in overrides.items()])
    try:
        yield node
    finally:
        node.destroy_node()
        rclpy.shutdown(context=context)


@pytest.mark.parametrize('instance', INSTANCES, ids=lambda item: type(item).__name__)
def test_values_come_back_as_they_went(instance):
    """Flat values make the same dataclass again, and all have their place in the layout."""
    values = to_parameter_values(instance, 'some.')
    assert from_parameter_values(type(instance), values, 'some.') == instance
    assert set(values) <= {spec.name for spec in parameter_specs(type(instance), 'some.')}
    assert all(type(value) in (bool, int, float, str, list) for value in values.values())


@pytest.mark.parametrize('instance', INSTANCES, ids=lambda item: type(item).__name__)
def test_a_node_reads_the_same_dataclass(instance):
    """Also through rclpy, and through a YAML file's types."""
    values = yaml.safe_load(yaml.safe_dump(to_parameter_values(instance, 'some.')))
    with node_with(values) as node:
        assert ParameterSet(node, [('some.', type(instance))]).settings == [instance]
        for name, value in values.items():
            got = node.get_parameter(name).value
            assert (list(got) if isinstance(value, list) else got) == value


@pytest.mark.parametrize('name', scenario_names())
def test_the_nodes_of_a_replay_get_its_scenario(tmp_path, name):
    """Planner and controller what is believed, the simulator what is true."""
    case = place_robot(load_scenario(name))
    files = write_parameter_files(tmp_path, case, case.control, tmp_path / 'tape.csv',
                                  real_time=False, stamped=True)
    expected = {SIM: [case.true_object, case.true_robot, case.sensors, case.plant_settings],
                PLANNER: [case.object, case.robot],
                CONTROLLER: [case.object, case.robot, case.control]}
    if case.task is None:
        expected[PLANNER] += [case.planner]
    else:
        expected[PLANNER] += [case.task.drive]
        expected[CONTROLLER] += [case.task.drive, case.task.supervision]
    for node, instances in expected.items():
        values = yaml.safe_load(files[node].read_text())[node]['ros__parameters']
        prefixes = {cls: prefix for prefix, cls in SECTIONS[node]}
        for instance in instances:
            cls = type(instance)
            assert from_parameter_values(cls, values, prefixes[cls]) == instance


@pytest.mark.parametrize('name', [PLANNER, CONTROLLER, SIM])
def test_defaults_are_those_of_the_dataclasses(name):
    """Nothing is given but what must be; all the rest is declared with its default."""
    required = {**to_parameter_values(BOX, 'object.'), 'robot.radius': 0.17}
    with node_with(required) as node:
        instances = ParameterSet(node, SECTIONS[name]).settings
        for (prefix, cls), instance in zip(SECTIONS[name], instances):
            if cls not in (PushedObject, RoundRobot):
                assert instance == cls()
        for spec in parameters(name):
            value = node.get_parameter(spec.name).value
            if spec.name not in required and spec.default is not None:
                assert (tuple(value) if isinstance(spec.default, tuple) else value) == spec.default


@pytest.mark.parametrize('name', [PLANNER, CONTROLLER, SIM])
def test_every_parameter_is_described_and_read_only(name):
    """Tools see description, unit and range; nobody changes physics under way."""
    with node_with({**to_parameter_values(BOX, 'object.'), 'robot.radius': 0.17}) as node:
        ParameterSet(node, SECTIONS[name])
        for spec in parameters(name):
            described = node.describe_parameter(spec.name)
            assert len(described.description) > 3 and described.read_only
            assert spec.metadata['unit'] in described.description
            limits = described.floating_point_range or described.integer_range
            bounded = math.isfinite(spec.metadata['low']) or spec.metadata['above'] is not None
            if spec.kind in (int, float) and bounded:
                assert len(limits) == 1
            assert not node.set_parameters([Parameter(spec.name, value=1.5)])[0].successful


@pytest.mark.parametrize('change, text', [
    ({'object.mass': -1.0}, 'object.mass: got -1.0, expected a finite number from 0.005 to 1000'),
    ({'object.mass': 'heavy'}, "object.mass: got 'heavy', expected a finite number"),
    ({'object.mass': math.nan}, 'object.mass: got nan'),
    ({'object.masss': 1.0}, 'object.masss: got a parameter that probe does not have'),
    ({'object.supports.x': [0.1, 0.2]}, 'lists of one length'),
    ({'object.supports.friction_coefficient': [0.1, 0.2, -0.3]},
     'object.supports.friction_coefficient: got -0.3, expected a finite number from 0 to 10'),
    ({'object.outline': [0.0, 0.1, 0.2]}, 'object.outline: got 3 numbers, expected pairs'),
    ({'robot.drive': 'legs'}, "robot.drive: got 'legs', expected one of differential, holonomic"),
    ({'world_frame': ''}, 'world_frame: got an empty text')])
def test_a_bad_parameter_is_refused_by_its_name(change, text):
    """With what came and what was expected."""
    values = {**to_parameter_values(BOX, 'object.'), 'robot.radius': 0.17, **change}
    sections = (('object.', PushedObject), ('robot.', RoundRobot), ('', Frames))
    with node_with(values) as node, pytest.raises(ValueError, match=text):
        ParameterSet(node, sections)


def test_a_missing_parameter_is_named():
    """There is no default for what must be measured."""
    with node_with({'object.inertia': 1.0}) as node, \
            pytest.raises(ValueError, match='object.mass: got nothing, expected'):
        ParameterSet(node, [('object.', PushedObject)])


def test_whole_numbers_do_for_real_ones():
    """People write ``mass: 3`` in YAML."""
    with node_with({**to_parameter_values(BOX, 'object.'), 'object.mass': 3}) as node:
        assert ParameterSet(node, [('object.', PushedObject)]).settings == [BOX]
        assert isinstance(node.get_parameter('object.mass').value, float)


def test_each_section_of_the_controller_has_its_field():
    """As ``ControllerParameters`` is made of the sections, in their order."""
    fields = get_type_hints(ControllerParameters).values()
    assert [cls for _, cls in controller_node.SECTIONS] == list(fields)


def test_what_takes_no_effect_while_the_node_runs_cannot_be_set():
    """Its field says so, and nothing else has to be told."""
    @dataclasses.dataclass(frozen=True)
    class Settings:
        gain: float = quantity('gain', default=1.0)
        noise: float = quantity('noise', is_dynamic=False, default=1.0)
    sections = [('some.', Settings), ('other.', Settings)]
    assert dynamic_parameters(sections, 'some.') == ['some.gain']
    built = {spec.name for prefix, cls in controller_node.SECTIONS
             for spec in parameter_specs(cls, prefix) if not spec.metadata['is_dynamic']}
    assert built and not built.intersection(controller_node.SETTABLE)


@pytest.mark.parametrize('name', [PLANNER, CONTROLLER, SIM])
def test_the_default_file_has_only_parameters_that_its_nodes_have(name):
    """Each key of push.yaml, in ``/**`` and in the node's own section; values pass the checks."""
    sections = yaml.safe_load(config_file('push.yaml').read_text())
    values = {}
    for part in ('/**', f'/**/{name}'):
        values.update(_flat(sections[part]['ros__parameters']))
    assert set(sections) == {'/**', *(f'/**/{node}' for node in (PLANNER, CONTROLLER, SIM))}
    assert set(values) <= {spec.name for spec in parameters(name)}
    for prefix, cls in SECTIONS[name]:
        from_parameter_values(cls, values, prefix)


def test_the_default_file_has_the_box_and_the_disc_of_the_scenarios():
    """What `push.yaml` repeats of their files cannot differ from them."""
    values = _flat(yaml.safe_load(config_file('push.yaml').read_text())['/**']['ros__parameters'])
    assert from_parameter_values(PushedObject, values, 'object.') == read_object(
        config_file('objects/box_04.yaml'))
    assert from_parameter_values(RoundRobot, values, 'robot.') == read_robot(
        config_file('robots/disc_017.yaml'))


@pytest.mark.parametrize('name', [PLANNER, CONTROLLER])
def test_the_default_file_has_every_basic_parameter_before_the_others_of_its_group(name):
    """Those with a default at that, but for the box and the disc."""
    sections = yaml.safe_load(config_file('push.yaml').read_text())
    values = {}
    for part in ('/**', f'/**/{name}'):
        values.update(_flat(sections[part]['ros__parameters']))
    specs = {spec.name: spec for spec in parameters(name)}
    basic = {key for key, spec in specs.items() if spec.metadata['is_basic']}
    # The box has an outline in its place.
    assert basic - set(values) == {'object.radius'}
    for group in {key.split('.')[0] for key in values}:
        flags = [key in basic for key in values if key.split('.')[0] == group]
        assert flags == sorted(flags, reverse=True), group
    for key in basic.intersection(values):
        if not key.startswith(('object.', 'robot.')):
            assert values[key] == specs[key].default


def _flat(tree, prefix=''):
    flat = {}
    for key, value in tree.items():
        flat.update(_flat(value, f'{prefix}{key}.') if isinstance(value, dict)
                    else {prefix + key: value})
    return flat
