"""A live session of several objects: real simulation, order, planner and controller."""

import json

from push_scenario.tidying.room import Room, room_from_text
from push_scenario.tidying.tidy import tidy
from push_view.live.room_session import RoomSession
from push_view.messages import Message
from push_view.server.commands import CommandRefused, parse_command
from push_view.server.message_log import MessageLog
import pytest

ROOM = """
description: a bin and a box to places near by, beside a crate
robot: {file: holonomic_017.yaml}
start: {robot: {x: -0.6, y: 0.0}}
objects:
  bin: {object: {file: bin.yaml}, start: {x: 0.0, y: 0.0}, goal: {x: 0.1, y: 0.0}}
  box: {object: {file: box_04.yaml}, start: {x: 0.0, y: -1.0}, goal: {x: 0.15, y: -1.0}}
  crate: {object: {file: box_04.yaml}, start: {x: 1.5, y: -1.0}}
task: {}
time_limit: 60
"""


@pytest.fixture
def room() -> Room:
    """Take a bin and a box that are pushed, and a crate that may stand anywhere."""
    return room_from_text(ROOM, 'room')


@pytest.fixture
def session(room: Room) -> RoomSession:
    """Start it."""
    return RoomSession(room, MessageLog())


def send(session: RoomSession, kind: str, **values: object) -> None:
    """Do what the page asks for."""
    session.handle(parse_command(json.dumps({'type': kind, **values})))


def messages(session: RoomSession, kind: str) -> list[Message]:
    """List the messages of a kind."""
    texts, _ = session.log.since(0)
    return [message for message in map(json.loads, texts) if message['type'] == kind]


def advance_to_the_end(session: RoomSession) -> None:
    """Let time pass until nothing more is moved."""
    while not session.is_standing and session.time < 300.0:
        session.advance(0.5)


@pytest.mark.slow
def test_a_session_ends_where_push_tidy_ends(session: RoomSession, room: Room) -> None:
    """To the bit; each move is shown, in order of time, with what comes after it."""
    advance_to_the_end(session)
    assert session.poses[:-1] == tuple(tidy(room).poses.values())
    *orders, last = messages(session, 'order')
    assert [len(order['moves']) for order in orders] == [2, 1]
    assert sorted(order['pushed'] for order in orders) == [0, 1]
    assert [order['placed'] for order in (*orders, last)] == [0, 1, 2] and not last['moves']
    for kind in ('order', 'state', 'goal', 'truth'):
        times = [message['time'] for message in messages(session, kind)]
        assert times == sorted(times)
    columns = messages(session, 'scene')[-1]['columns']
    assert all(len(row) == len(columns) for rows in messages(session, 'rows')
               for row in rows['rows'])


@pytest.mark.slow
def test_an_object_gets_to_the_goal_that_was_dragged_under_way(session: RoomSession) -> None:
    """The robot backs off from what it pushes, and the order is planned anew."""
    while not messages(session, 'state') or messages(session, 'state')[-1]['state'] != 'push':
        session.advance(0.1)
    send(session, 'goal', pose=[0.2, 0.1, 0.0], index=0)
    advance_to_the_end(session)
    assert messages(session, 'order')[-1]['placed'] == 2
    assert session.poses[0][:2] == pytest.approx((0.2, 0.1), abs=0.02)


def test_a_drag_moves_one_goal_or_one_object(session: RoomSession) -> None:
    """Time stands: the page is shown it, and nothing else is elsewhere."""
    send(session, 'run', paused=True)
    goals, poses = session.goals, session.poses
    send(session, 'goal', pose=[0.3, -1.2, 0.1], index=1)
    assert session.goals == (goals[0], pytest.approx((0.3, -1.2, 0.1)), None)
    assert messages(session, 'order')[-1]['goals'][1] == [0.3, -1.2, 0.1]
    assert session.poses == poses
    goals = session.goals
    send(session, 'displace', pose=[1.5, -0.5, 0.3], index=2)
    assert session.goals == goals and session.poses[:2] == poses[:2]
    assert session.poses[2] == pytest.approx((1.5, -0.5, 0.3))
    scene, shown = messages(session, 'scene')[-1], messages(session, 'rows')[-1]['rows'][-1]
    assert shown[scene['columns'].index('body_2_y')] == -0.5


@pytest.mark.parametrize('kind, values, words', [
    ('goal', {'index': 3}, 'goal.index: got 3, expected 0 to 2, one of 3 objects'),
    ('displace', {'index': -1}, 'displace.index: got -1, expected 0 to 2'),
    ('goal', {'index': 2}, 'goal.index: got 2, which is crate and has no goal'),
    ('displace', {'index': 1}, 'box cannot be there: bin is in the way'),
    ('goal', {'index': 0.5}, 'goal.index: got 0.5, expected a whole number'),
])
def test_what_cannot_be_dragged_is_refused(session: RoomSession, kind: str,
                                           values: dict[str, object], words: str) -> None:
    """With the reason; nothing changes."""
    before, goals, poses = session.log.since(0), session.goals, session.poses
    with pytest.raises(CommandRefused, match=words):
        send(session, kind, pose=[0.1, 0.1, 0.0], **values)
    assert (session.log.since(0), session.goals, session.poses) == (before, goals, poses)
    assert not session.is_standing


def test_starting_over_keeps_the_goals(session: RoomSession) -> None:
    """All stand where the room has them; time is 0."""
    poses = session.poses
    send(session, 'displace', pose=[1.5, -0.5, 0.3], index=2)
    send(session, 'goal', pose=[0.3, -1.2, 0.1], index=1)
    session.advance(1.0)
    goals = session.goals
    send(session, 'restart')
    assert (session.goals, session.poses) == (goals, poses) and session.time < 0.1
