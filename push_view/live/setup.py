"""What a session simulates, and what its user has chosen of it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
import dataclasses
from typing import Any

from push_control.settings import LAWS
from push_model.files.data import share_directory
from push_model.files.parameter_files import (
    files_by_name, named_file, read_object, read_robot,
)
from push_model.geometry import Pose
from push_scenario.definition.bases import base_names, FOLDER, with_base
from push_scenario.definition.expected_poses import with_sensors
from push_scenario.definition.loader import read_sensors
from push_scenario.definition.placement import Placement
from push_scenario.definition.scenario import Scenario
from push_scenario.definition.task import Task
from push_sim_node.drive_imperfections import DriveImperfections
from push_sim_node.sensors import SensorSettings
from push_view.live.presets import preset_messages
from push_view.live.settings import (
    CONTACT_FRICTION, find_setting, FRICTION, setting_messages, setting_values, with_friction,
)
from push_view.messages import controls_message, Message
from push_view.server.commands import CommandRefused

# A task has no open loop.
TASK_LAWS = tuple(law for law in LAWS if law != 'open_loop')
# Names of a base that does what its robot states, and of things that no file describes.
GOOD_BASE = 'good'
OF_SCENARIO = 'as in the scenario'


@dataclasses.dataclass(frozen=True)
class Setup:
    """
    A scenario with a task, and the names of what is in it.

    :param scenario: the ``Scenario``.
    :param task: its ``Task``.
    :param choices: names of ``object``, ``robot``, ``base``, ``sensors`` and ``law``.
    :param origin: the ``Scenario`` that it started from.
    """

    scenario: Scenario
    task: Task
    choices: Mapping[str, str]
    origin: Scenario

    @classmethod
    def of(cls, scenario: Scenario) -> Setup:
        """
        Start from a scenario.

        :raises ValueError: where it has no task.
        """
        if scenario.task is None:
            raise ValueError(f'{scenario.name}: got a single push, expected a task')
        return cls(scenario, scenario.task, {
            'object': _name_of(scenario.object, 'objects', read_object),
            'robot': _name_of(scenario.robot, 'robots', read_robot),
            'base': _base_name(scenario),
            'sensors': _sensors_name(scenario),
            'law': scenario.control.control_law}, scenario)

    def with_choices(self, choices: Mapping[str, str]) -> Setup:
        """
        Put something else in it; its true parameters are the nominal ones at first.

        Another robot has the base and the sensors that were chosen before. The controller is
        informed of sensors, but of no base.

        :param choices: names to names, some of those of ``choices``.
        :raises CommandRefused: where there is no such thing.
        """
        setup, chosen = self, {**self.choices, **choices}
        if 'robot' in choices and chosen['base'] == OF_SCENARIO:
            chosen['base'] = GOOD_BASE
        for name, value in choices.items():
            setup = setup._with_choice(name, value)
        if 'robot' in choices or 'base' in choices:
            setup = setup._with_base(chosen['base'])
        if 'robot' in choices or 'sensors' in choices:
            setup = setup._informed_of(chosen['sensors'])
        return dataclasses.replace(setup, choices=chosen)

    def with_value(self, name: str, value: float) -> Setup:
        """
        Change the true friction, or what the robot measures with: the robot is not told.

        :param name: of a setting.
        :param value: SI units.
        :raises CommandRefused: where there is none, or the value is out of its range.
        """
        scenario = self.scenario
        find_setting(scenario.true_object, name, value)
        if name == CONTACT_FRICTION or name.startswith(FRICTION):
            return self._with_scenario(
                true_object=with_friction(scenario.true_object, name, value))
        return self._with_scenario(
            sensors=dataclasses.replace(scenario.sensors, **{name: value}))

    def with_goal(self, goal: Pose) -> Setup:
        """Change the first goal."""
        return self._with_scenario(goal=Placement(*goal))

    @property
    def object_names(self) -> list[str]:
        """Names of the objects of the package."""
        return _names('objects')

    @property
    def values(self) -> dict[str, float]:
        """Values of all settings by name, SI units."""
        return setting_values(self.scenario.true_object, self.scenario.sensors)

    def controls(self) -> Message:
        """Describe what can be chosen and changed, with its present values."""
        options = {'object': _names('objects'), 'robot': _names('robots'),
                   'base': (GOOD_BASE, *base_names()), 'sensors': _names('sensors'),
                   'law': TASK_LAWS}
        choices = [{'name': name, 'value': value,
                    'options': list(dict.fromkeys((value, *options[name])))}
                   for name, value in self.choices.items()]
        settings = setting_messages(self.scenario.true_object, self.scenario.sensors)
        return controls_message(('goal', 'object', 'wall'), choices=choices, settings=settings,
                                presets=preset_messages(self.scenario.true_object),
                                owns_time=True)

    def _with_scenario(self, **fields: Any) -> Setup:
        return dataclasses.replace(self, scenario=dataclasses.replace(self.scenario, **fields))

    def _with_choice(self, name: str, value: str) -> Setup:
        if name == 'object':
            obj = read_object(_known('objects', value))
            return self._with_scenario(object=obj, true_object=obj)
        if name == 'robot':
            robot = read_robot(_known('robots', value))
            return self._with_scenario(robot=robot)
        if name == 'base':
            return self
        if name == 'sensors':
            return self._with_scenario(sensors=self._sensors(value))
        if name == 'law' and value in TASK_LAWS:
            return self._with_scenario(control=dataclasses.replace(
                self.scenario.control, control_law=value))
        raise CommandRefused(
            f'choose.{name[:60]}: got {value[:60]!r}, expected an object, a robot, a '
            f'base, sensors or a law ({", ".join(TASK_LAWS)})')

    def _sensors(self, name: str) -> SensorSettings:
        """Read sensors; those of the scenario have no file."""
        if name == OF_SCENARIO:
            return self.origin.sensors
        return read_sensors(_known('sensors', name))

    def _informed_of(self, sensors: str) -> Setup:
        """Let the controller know which poses sensors give, and nothing of those before."""
        origin, law = self.origin, self.scenario.control.control_law
        if sensors != OF_SCENARIO:
            origin = with_sensors(dataclasses.replace(origin, robot=self.scenario.robot),
                                  self._sensors(sensors))
        control = dataclasses.replace(origin.control, control_law=law)
        return dataclasses.replace(self._with_scenario(control=control, task=origin.task),
                                   task=origin.task or self.task)

    def _with_base(self, name: str) -> Setup:
        """Put another base below the robot; robot and sensors are not informed."""
        if name != GOOD_BASE:
            return dataclasses.replace(self, scenario=with_base(
                self.scenario, _known(FOLDER, name)))
        ideal = dataclasses.replace(self.scenario.simulation, drive=DriveImperfections())
        return self._with_scenario(true_robot=self.scenario.robot, simulation=ideal)


def _base_name(scenario: Scenario) -> str:
    """Find out which base of the package a scenario has."""
    if (scenario.true_robot, scenario.simulation.drive) == (scenario.robot, DriveImperfections()):
        return GOOD_BASE
    return next((name for name in base_names()
                 if with_base(scenario, named_file(FOLDER, name)) == scenario), OF_SCENARIO)


def _sensors_name(scenario: Scenario) -> str:
    """Find out which sensors of the package a scenario has, of which its controller knows."""
    return next((name for name in _names('sensors') if with_sensors(
        scenario, read_sensors(named_file('sensors', name))) == scenario), OF_SCENARIO)


def _known(folder: str, value: str) -> Any:
    if value not in _names(folder):
        raise CommandRefused(f'choose: got {value[:60]!r}, expected one of {folder}: '
                             + ', '.join(_names(folder)))
    return named_file(folder, value)


def _names(folder: str) -> list[str]:
    """List the files of objects, robots or sensors of the package."""
    return sorted(files_by_name(share_directory() / 'config' / folder))


def _name_of(value: Any, folder: str, read: Callable[[Any], Any]) -> str:
    """Find out which file of the package describes an object or a robot."""
    return next((name for name in _names(folder) if read(named_file(folder, name)) == value),
                OF_SCENARIO)
