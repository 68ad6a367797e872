"""
Rooms: scenario files with several objects.

Such a file is a scenario whose ``objects`` each have a name, ``object``, ``start`` and ``goal`` of
their own, and perhaps ``true_object``; all else holds for each. One without ``goal`` may be moved
aside.
"""

import dataclasses
from pathlib import Path
from typing import Any

import numpy as np
from push_model.files.mapping import expect_mapping, Location
from push_model.files.strict_yaml import load_yaml, parse_yaml
from push_model.geometry import FloatArray, Pose
from push_navigation.settings import MapSettings
from push_scenario.definition.floor_map import FloorMap, FREE
from push_scenario.definition.loader import scenario_from_mapping
from push_scenario.definition.placement import Placement
from push_scenario.definition.scenario import Scenario
from push_scenario.definition.task import Task

OWN_KEYS = ('object', 'true_object', 'start', 'goal')
# Cells of an open floor, and floor beyond all starts and goals [m]; chosen: the robot drives round
# an object anywhere.
RESOLUTION, RIM = 0.05, 2.0


@dataclasses.dataclass(frozen=True)
class Room:
    """
    Several objects on one floor.

    :param name: that of the file.
    :param description: what it shows.
    :param scenarios: by the name of each object the ``Scenario`` that brings it to its goal.
    :param without_goal: names of objects that may stand anywhere.
    """

    name: str
    description: str
    scenarios: dict[str, Scenario]
    without_goal: frozenset[str] = frozenset()

    @property
    def any_scenario(self) -> Scenario:
        """A ``Scenario`` of it, for what all have in common."""
        return next(iter(self.scenarios.values()))

    @property
    def task(self) -> Task:
        """The ``Task`` that all scenarios share."""
        task = self.any_scenario.task
        if task is None:
            raise ValueError('Room.scenarios: got a single push, expected tasks')
        return task

    @property
    def floor_map(self) -> FloorMap:
        """``FloorMap`` without the objects."""
        if self.task.map is None:
            raise ValueError('Room.scenarios: got a task without a map, expected one')
        return self.task.map

    def with_goal(self, name: str, goal: Pose) -> 'Room':
        """Change the goal of an object."""
        scenario = dataclasses.replace(self.scenarios[name], goal=Placement(*goal))
        return dataclasses.replace(self, scenarios={**self.scenarios, name: scenario})


def read_room(path: str | Path) -> Room:
    """
    Read a file with several objects.

    :raises ParameterFileError: naming file and key, what came and what was expected.
    """
    path = Path(path)
    return _room(load_yaml(path), path.stem, Location(path), path.parent)


def room_from_text(text: str, name: str) -> Room:
    """
    Read the same from YAML text.

    :param name: of the room.
    :raises ParameterFileError: naming the key, what came and what was expected.
    """
    return _room(parse_yaml(text, name), name, Location(name), None)


def _room(data: dict[str, Any], name: str, at: Location, directory: Path | None) -> Room:
    if 'objects' not in data:
        raise at.key('objects').error('got none, expected a mapping of names to objects')
    objects = expect_mapping(data['objects'], at.key('objects'))
    common = {key: value for key, value in data.items() if key != 'objects'}
    common.setdefault('task', {})
    for key in OWN_KEYS:
        if key in common and key != 'start':
            raise at.key(key).error('got it for all objects, expected it in each of objects')
    robot = expect_mapping(common.pop('start', {}), at.key('start'))
    scenarios: dict[str, Scenario] = {}
    without_goal: set[str] = set()
    for key, values in objects.items():
        here = at.key('objects').key(key)
        own = expect_mapping(values, here)
        for unknown in set(own) - set(OWN_KEYS):
            raise here.key(unknown).error(f'got an unknown key, expected {", ".join(OWN_KEYS)}')
        start = expect_mapping(own.get('start', {}), here.key('start'))
        if 'goal' not in own:
            without_goal.add(key)
        scenarios[key] = scenario_from_mapping(
            {**common, **own, 'start': {**robot, 'object': start},
             'goal': own.get('goal', start)}, key, here, directory)
    if not scenarios:
        raise at.key('objects').error('got none, expected at least one object')
    room = Room(name, str(data.get('description', '')), scenarios, frozenset(without_goal))
    if room.any_scenario.engine != 'own':
        raise at.key('engine').error(f'got {room.any_scenario.engine!r}, expected own: other '
                                     'engines have no objects that stand')
    return room if room.task.map is not None else _on_open_floor(room)


def _on_open_floor(room: Room) -> Room:
    """Give a room without a map free floor round all starts and goals."""
    poses = [(place.x, place.y) for scenario in room.scenarios.values()
             for place in (scenario.start.object, scenario.goal, scenario.robot_start)]
    low: FloatArray = np.min(poses, axis=0) - RIM
    columns, rows = np.ceil((np.max(poses, axis=0) + RIM - low) / RESOLUTION).astype(int).tolist()
    floor = FloorMap(RESOLUTION, '\n'.join([FREE * columns] * rows),
                     Placement(*low.tolist()))
    task = dataclasses.replace(room.task, map=floor, map_reading=MapSettings())
    return dataclasses.replace(room, scenarios={
        name: dataclasses.replace(scenario, task=task)
        for name, scenario in room.scenarios.items()})
