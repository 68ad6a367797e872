"""Parameters for launch files: files that hold in every namespace, objects and robots by name."""

import math
from pathlib import Path
import tempfile
from typing import Any, Callable, TypeVar

from push_localization.settings import PlaceSettings
from push_model.files.flat_values import from_parameter_values, to_parameter_values
from push_model.files.parameter_files import (
    named_file, ParameterFileError, read_object, read_robot,
)
from push_model.parameters import PushedObject, RoundRobot
from push_ros.topics import CONTROLLER, SIM
from push_scenario.definition.expected_poses import expected_place, expected_poses
from push_scenario.definition.loader import read_sensors
from push_sim_node.sensors import SensorSettings
import yaml

ANY_NODE = '/**'
SIM_SECTION = f'{ANY_NODE}/{SIM}'
CONTROLLER_SECTION = f'{ANY_NODE}/{CONTROLLER}'
# Clearance between robot and object at the start of a simulation [m], chosen: room to turn.
START_CLEARANCE = 0.3
# What a file describes.
Values = TypeVar('Values')


def launch_parameters(path: str | Path, object_name: str = '', robot_name: str = '',
                      sensors_name: str = '', *, argument: str = 'params_file'
                      ) -> dict[str, dict[str, Any]]:
    """
    Read a parameter file so that its sections hold in whatever namespace the nodes are.

    A section ``push_sim`` means the node in the root namespace alone; it becomes
    ``/**/push_sim``. Sections with a leading slash stay as they are.

    :param path: ROS parameter file.
    :param object_name: object that takes the place of the one in the file, see ``named_file``; a
        simulation then starts with the robot behind it.
    :param robot_name: the same for the robot.
    :param sensors_name: the same for the sensors of the simulator; the controller then expects
        such poses, see ``pose_settings``.
    :param argument: what errors call the argument that names the file.
    :return: parameters by section, with dotted names.
    :raises ValueError: naming the argument, what came and what was expected.
    """
    try:
        data = yaml.safe_load(Path(path).read_text(encoding='utf-8'))
    except OSError as error:
        raise ParameterFileError(f'{argument}: got {str(path)!r}, expected a ROS parameter '
                                 f'file: {error.strerror}') from error
    if not isinstance(data, dict):
        raise ValueError(f'{argument}: {path}: got no sections, expected a ROS parameter file')
    sections: dict[str, dict[str, Any]] = {ANY_NODE: {}}
    for name, section in data.items():
        if not isinstance(section, dict) or not isinstance(section.get('ros__parameters'), dict):
            raise ValueError(f'{argument}: {path}: {name}: got no ros__parameters, expected '
                             'parameters below that key')
        key = name if str(name).startswith('/') else f'{ANY_NODE}/{name}'
        sections.setdefault(key, {}).update(_with_dots(section['ros__parameters']))
    if object_name:
        file = named_file('objects', object_name)
        _replace(sections, 'object.', _read('object', file, read_object))
        sections.setdefault(CONTROLLER_SECTION, {})['object_name'] = file.stem
    if robot_name:
        robot = _read('robot', named_file('robots', robot_name), read_robot)
        _replace(sections, 'robot.', robot)
    sim = sections.setdefault(SIM_SECTION, {})
    if object_name or robot_name:
        sim.update(_start_apart({**sections[ANY_NODE], **sim}))
    if sensors_name:
        sensors = _read('sensors', named_file('sensors', sensors_name), read_sensors)
        _replace(sections, 'sensors.', sensors, SIM_SECTION)
        robot = from_parameter_values(RoundRobot, {**sections[ANY_NODE], **sim}, 'robot.')
        sections.setdefault(CONTROLLER_SECTION, {}).update(pose_settings(sensors, robot.radius))
    return sections


def _read(argument: str, path: Path, read: Callable[[Path], Values]) -> Values:
    """Read a file, and name the argument where it cannot be read."""
    try:
        return read(path)
    except ParameterFileError as error:
        raise ParameterFileError(f'{argument}: {error}') from error


def pose_settings(sensors: SensorSettings, robot_radius: float) -> dict[str, Any]:
    """
    Compute what the controller has to know of poses and of a lidar, as ``expected_poses`` does.

    :param robot_radius: [m].
    :return: parameters of the controller, with dotted names.
    """
    expected = expected_poses(sensors, robot_radius)
    place = {}
    if sensors.lidar.rate > 0.0:
        place = to_parameter_values(expected_place(PlaceSettings(), sensors.lidar), 'place.')
    return {**{f'control.{name}': value for name, value in expected.control.items()},
            **{f'supervision.{name}': value for name, value in expected.supervision.items()},
            **place}


def write_parameters(sections: dict[str, dict[str, Any]], folder: str | Path) -> str:
    """
    Write a ROS parameter file that outlives this process, as the nodes read it later.

    :param sections: parameters by section.
    :param folder: where, as that of the log, which then tells what the nodes were given.
    :return: its path.
    """
    with tempfile.NamedTemporaryFile('w', prefix='push_control_', suffix='.yaml', delete=False,
                                     encoding='utf-8', dir=folder) as file:
        yaml.safe_dump({name: {'ros__parameters': values} for name, values in sections.items()
                        if values}, file, sort_keys=False)
    return file.name


def switch(name: str, text: str) -> bool | None:
    """
    Read an argument that is on, off, or not given.

    :param name: of the argument.
    :param text: ``true``, ``false`` or nothing.
    :return: None where nothing was given.
    :raises ValueError: naming the argument, where it is anything else.
    """
    values = {'': None, 'true': True, 'false': False}
    if text.lower() not in values:
        raise ValueError(f'{name}: got {text!r}, expected true or false')
    return values[text.lower()]


def _start_apart(values: dict[str, Any]) -> dict[str, list[float]]:
    """Place the robot behind the object so that they do not touch."""
    obj: PushedObject = from_parameter_values(PushedObject, values, 'object.')
    robot: RoundRobot = from_parameter_values(RoundRobot, values, 'robot.')
    extent = max(obj.radius, *(math.hypot(x, y) for x, y in obj.outline or ((0.0, 0.0),)))
    return {'object_start': [0.0, 0.0, 0.0],
            'robot_start': [-(extent + robot.radius + START_CLEARANCE), 0.0, 0.0]}


def _replace(sections: dict[str, dict[str, Any]], prefix: str, instance: Any,
             section: str = ANY_NODE) -> None:
    """Put an instance, in one section, in place of the parameters with a prefix in all."""
    for values in sections.values():
        for name in [name for name in values if name.startswith(prefix)]:
            del values[name]
    sections[section].update(to_parameter_values(instance, prefix))


def _with_dots(values: dict[str, Any], prefix: str = '') -> dict[str, Any]:
    """Flatten nested parameters to dotted names."""
    flat: dict[str, Any] = {}
    for name, value in values.items():
        if isinstance(value, dict):
            flat.update(_with_dots(value, f'{prefix}{name}.'))
        else:
            flat[f'{prefix}{name}'] = value
    return flat
