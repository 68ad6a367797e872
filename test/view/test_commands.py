"""Commands of the page: what is understood, and what is refused with which words."""

import json

from push_model.geometry import Pose
from push_view.server.commands import (
    AddWall, Choose, ClearWalls, CommandRefused, DisplaceObject, OpenLink, parse_command,
    RemoveWall, Restart, Run, SetGoal, SetValue, Step, UndoWall,
)
import pytest


@pytest.mark.parametrize('text, command', [
    ('{"type": "goal", "pose": [1, -2.5, 0.1]}', SetGoal(Pose(1.0, -2.5, 0.1))),
    ('{"type": "displace", "pose": [0, 0, 3]}', DisplaceObject(Pose(0.0, 0.0, 3.0))),
    ('{"type": "wall", "start": [0, 1], "end": [2, 1]}', AddWall((0.0, 1.0), (2.0, 1.0))),
    ('{"type": "clear_walls"}', ClearWalls()),
    ('{"type": "choose", "object": "bin"}', Choose({'object': 'bin'})),
    ('{"type": "set", "name": "friction.0", "value": 0.2}', SetValue('friction.0', 0.2)),
    ('{"type": "run", "paused": true}', Run(paused=True)),
    ('{"type": "run", "speed": 5}', Run(speed=5.0)),
    ('{"type": "remove_wall", "wall": 2}', RemoveWall(2)),
    ('{"type": "undo"}', UndoWall()),
    ('{"type": "open", "link": "object=bin"}', OpenLink('object=bin')),
    ('{"type": "step"}', Step()),
    ('{"type": "restart"}', Restart()),
])
def test_a_command_is_understood(text, command):
    """As the page writes it."""
    parsed = parse_command(text)
    assert parsed == command and type(parsed) is type(command)


@pytest.mark.parametrize('text, words', [
    ('', 'message: got .*expected JSON'),
    ('[' * 100_000, 'message: got .*expected JSON'),
    ('[1]', 'message: got .*expected an object'),
    ('{}', 'type: got None, expected one of goal'),
    ('{"type": ["goal"]}', 'type: got .*expected one of'),
    ('{"type": "goal"}', 'goal.pose: got None, expected 3 numbers'),
    ('{"type": "set", "name": "friction.0", "value": 1' + 400 * '0' + '}', 'expected a number'),
    ('{"type": "set", "name": "friction.0", "value": Infinity}', 'expected a number'),
    ('{"type": "set", "name": "friction.0", "value": 1' + 5000 * '0' + '}', 'expected JSON'),
    ('{"type": "goal", "pose": [1, 2]}', 'goal.pose: got .*expected 3 numbers'),
    ('{"type": "goal", "pose": [1, 2, NaN]}', 'goal.pose: got nan, expected a number from'),
    ('{"type": "goal", "pose": [1, 2, Infinity]}', 'goal.pose: got inf'),
    ('{"type": "goal", "pose": [1, true, 0]}', 'goal.pose: got True'),
    ('{"type": "goal", "pose": [1e9, 0, 0]}', 'goal.pose: got 1000000000.0'),
    ('{"type": "goal", "pose": [0, 0, 0], "speed": 1}', 'goal.speed: got an unknown field'),
    ('{"type": "remove_wall", "wall": true}', 'remove_wall.wall: got True'),
    ('{"type": "open", "link": 7}', 'open.link: got 7, expected the text of a link'),
    ('{"type": "run", "speed": 100}', 'run.speed: got 100, expected a number from 0.1 to 10'),
    ('{"type": "run", "paused": 1}', 'run.paused: got 1, expected true or false'),
    ('{"type": "choose", "object": 3}', 'choose.object: got 3, expected a name'),
    ('{"type": "set", "name": 1, "value": 0}', 'set.name: got 1'),
    ('{"type": "set", "name": "x", "value": null}', 'set.value: got None'),
])
def test_what_is_wrong_is_named(text, words):
    """Field, what came and what was expected, never more than a line of it."""
    with pytest.raises(CommandRefused, match=words) as refusal:
        parse_command(text)
    assert len(str(refusal.value)) < 200


def test_a_long_value_is_not_repeated():
    """Only its beginning."""
    with pytest.raises(CommandRefused) as refusal:
        parse_command(json.dumps({'type': 'x' * 10_000}))
    assert len(str(refusal.value)) < 200
