"""Rooms with several objects: files, obstacles and walls of those that stand, a whole run."""

import json
import math
from pathlib import Path

from helpers.blocked_door import small_rooms
from helpers.objects import bin_, box
import numpy as np
from push_model.events import ObjectFailure
from push_model.files.strict_yaml import ParameterFileError
from push_model.geometry import Pose
from push_navigation.settings import MapSettings
from push_planner.straight.map_search.planner import MAX_OVERLAP
from push_scenario.definition.floor_map import FloorMap
from push_scenario.tidying import cli
from push_scenario.tidying.room import Room, room_from_text
from push_scenario.tidying.standing_objects import least_gap, with_obstacles
from push_scenario.tidying.tidy import tidy
from push_sim_node.tape import Tape
from push_tidy.obstacles import StandingObject
import pytest

ROOM = """
description: a box to its goal, a bin in its place, another box that stays
robot: {file: holonomic_017.yaml}
start: {robot: {x: -1.2, y: -0.6}}
objects:
  box: {object: {file: box_04.yaml}, start: {x: -0.5, y: 0.0}, goal: {x: 0.3, y: 0.0}}
  bin: {object: {file: bin.yaml}, start: {x: 0.35, y: 0.1}}
  crate:
    object: {file: box_04.yaml}
    start: {x: 0.2, y: -1.4}
    goal: {x: 0.2, y: -1.4}
time_limit: 200
"""
BODIES = [StandingObject(box(), Pose(0.7, 0.9, 0.4)), StandingObject(bin_(), Pose(1.7, 1.4, 0.0))]


def small_room() -> Room:
    """Return the room of the text."""
    return room_from_text(ROOM, 'small')


def test_each_object_has_a_scenario_of_its_own() -> None:
    """What is stated once holds for all; an open floor gets a map."""
    room = small_room()
    assert list(room.scenarios) == ['box', 'bin', 'crate'] and room.without_goal == {'bin'}
    assert room.scenarios['bin'].object.radius == pytest.approx(0.2)
    assert {scenario.robot_start for scenario in room.scenarios.values()} == {
        Pose(-1.2, -0.6, 0.0)}
    assert not room.floor_map.occupied.any()


@pytest.mark.parametrize('old, new, key', [
    ('objects:', 'things:', 'objects'), ('goal: {x: 0.3, y: 0.0}', 'gaol: {x: 0.3}', 'gaol'),
    ('time_limit', 'goal: {x: 1.0}\ntime_limit', 'goal'), ('bin.yaml', 'bun.yaml', 'file'),
    ('time_limit', 'engine: mujoco\ntime_limit', 'engine')])
def test_a_mistake_in_a_file_is_named(old: str, new: str, key: str) -> None:
    """Errors name the key."""
    with pytest.raises(ParameterFileError, match=key):
        room_from_text(ROOM.replace(old, new), 'small')


def test_standing_objects_are_obstacles_but_no_walls_of_the_map() -> None:
    """All of their outlines is in cells that are not free, and little else."""
    floor = FloorMap(0.05, '\n'.join(['.' * 50] * 40))
    pushed = StandingObject(bin_(), Pose(2.2, 0.3, 0.0))
    drawn = with_obstacles(floor, MapSettings(allow_unknown=True), BODIES, 0.0, pushed)
    assert not drawn.walls
    occupied = drawn.occupancy_map
    for obj, pose in BODIES:
        assert occupied.object_clearance(obj, [pose]) < -0.1
    area = 0.05 ** 2 * occupied.occupied.sum()
    assert 0.16 + math.pi * 0.04 < area < 0.25 + math.pi * 0.225 ** 2 + 0.05


@pytest.mark.parametrize('angle', [0.0, 0.4, 1.1])
def test_an_object_that_touches_another_stands_on_free_floor(angle: float) -> None:
    """It can be planned away from it, wherever both are; behind the other nothing is free."""
    floor = FloorMap(0.05, '\n'.join(['.' * 50] * 40))
    pushed = StandingObject(box(), Pose(1.2, 1.0, angle))
    standing = StandingObject(box(), pushed.pose @ Pose(0.4, 0.0, 0.0))
    drawn = with_obstacles(floor, MapSettings(), [standing], 0.005, pushed).occupancy_map
    assert drawn.object_clearance(box(), [pushed.pose]) > -MAX_OVERLAP
    assert drawn.object_clearance(box(), [standing.pose]) < -0.1


def tape_of(robot: Pose, moving: Pose) -> Tape:
    """Return a tape of one row."""
    columns = [f'{body}_{name}' for body in ('object', 'robot') for name in ('x', 'y', 'theta')]
    return Tape(('time', *columns), np.array([[0.0, *moving, *robot]]))


def test_gaps_are_those_of_the_nearest_bodies() -> None:
    """Of a corner at a face and a face at a corner, and of the robot."""
    far, standing = Pose(9.0, 0.0, 0.0), StandingObject(box(), Pose(0.0, 0.0, 0.0))
    corner = Pose(0.3 + 0.2 * math.sqrt(2.0), 0.0, math.pi / 4)
    assert least_gap(tape_of(far, corner), box(), 0.17, standing) == pytest.approx(0.1)
    turned = standing._replace(pose=Pose(0.0, 0.0, math.pi / 4))
    beside = Pose(0.3 + 0.2 * math.sqrt(2.0), 0.0, 0.0)
    assert least_gap(tape_of(far, beside), box(), 0.17, turned) == pytest.approx(0.1)
    assert least_gap(tape_of(Pose(0.4, 0.0, 0.0), far), box(), 0.17,
                     standing) == pytest.approx(0.03)


@pytest.mark.slow
def test_a_door_is_freed_and_nothing_is_touched() -> None:
    """The bin leaves the door, the box comes through, the crate stays at its goal."""
    room = small_rooms()
    counts: list[tuple[int, int]] = []
    result = tidy(room, progress=lambda progress: counts.append(
        (progress.placed, progress.goals)))
    assert [item.move.name for item in result.moves] == ['bin', 'box']
    assert all(map(result.is_placed, result.poses)) and not result.failures
    assert result.poses['crate'] == room.scenarios['crate'].start.object.pose
    assert result.touches == 0 and counts == [(1, 2), (1, 2), (2, 2)]


def test_the_command_reports_each_object(tmp_path: Path,
                                         capsys: pytest.CaptureFixture[str]) -> None:
    """A goal in a goal has a code and does not stop the others; nothing needs to move here."""
    path = tmp_path / 'shelf.yaml'
    path.write_text(ROOM.replace('goal: {x: 0.3, y: 0.0}', 'goal: {x: 0.2, y: -1.3}')
                    .replace('crate', 'a_crate'))
    assert cli.main([str(path), '--json', '--out', str(tmp_path)]) == cli.NOT_DONE
    objects = json.loads(capsys.readouterr().out)['objects']
    assert objects['a_crate']['is_placed'] and objects['bin']['is_placed']
    assert ObjectFailure.GOALS_OVERLAP.name in objects['box']['codes']
    assert (tmp_path / 'shelf.png').stat().st_size > 5000


def test_a_file_that_is_not_there_is_misuse(tmp_path: Path,
                                            capsys: pytest.CaptureFixture[str]) -> None:
    """The error names it."""
    assert cli.main([str(tmp_path / 'none.yaml')]) == cli.MISUSE
    assert 'none.yaml' in capsys.readouterr().err
