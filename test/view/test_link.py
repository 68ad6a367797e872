"""Set-ups that leave a session: as a link, and as a scenario file."""

import json
import math

from push_model.geometry import Pose
from push_scenario.definition.loader import load_scenario, scenario_from_text
from push_view.live.link import link_text, read_link
from push_view.live.session import Session
from push_view.live.setup import Setup
from push_view.live.walls import Wall
from push_view.server.commands import CommandRefused, parse_command
from push_view.server.message_log import MessageLog
import pytest

WALLS = (Wall((0.5, 0.0), (0.5, -0.6)), Wall((-1.0, 1.2), (1.0, 1.2)))


@pytest.fixture
def setup():
    """Take the demonstration as it begins."""
    return Setup.of(load_scenario('task_demo'))


def test_a_link_carries_what_differs_from_its_scenario(setup):
    """Whatever the page that opens it was started with; alone it is the name of the scenario."""
    assert link_text(setup, ()) == 'scenario=task_demo'
    changed = setup.with_choices({'object': 'bin', 'base': 'late_02', 'sensors': 'own_camera'})
    changed = changed.with_value('friction.0', 0.125).with_value('pose_latency', 0.2)
    changed = changed.with_goal(Pose(1.1, -0.6, math.radians(90.0)))
    text = link_text(changed, WALLS)
    assert '&goal=1.1,-0.6,90&friction.0=0.125&pose_latency=0.2&wall=0.5,0,0.5,-0.6&' in text
    for opened_in in (setup, Setup.of(load_scenario('task_tap'))):
        linked = read_link(text, opened_in)
        assert linked.walls == WALLS
        assert linked.setup.choices == changed.choices
        assert linked.setup.scenario == changed.scenario


@pytest.mark.parametrize('text, words', [
    ('bin', 'link: got .bin., expected name=value'),
    ('&'.join(['wall=0,0,1,1'] * 200), 'link: got .*at most 100'),
    ('scenario=../secret', 'link.scenario: got .../secret., expected the name of a scenario'),
    ('scenario=straight_push', 'link.scenario: straight_push: got a single push'),
    ('object=car', 'got .car., expected one of objects'),
    ('goal=1,2', 'link.goal: got .1,2., expected 3 numbers'),
    ('goal=1,2,east', 'link.goal: got .east., expected a number from -720 to 720'),
    ('wall=0,0,nan,1', 'link.wall: got .nan., expected a number from -50 to 50'),
    ('friction.0=7', 'set.value: got 7, expected 0.05 to 1'),
    ('gravity=1', 'set.name: got .gravity.'),
])
def test_what_is_wrong_in_a_link_is_named(setup, text, words):
    """With what was expected."""
    with pytest.raises(CommandRefused, match=words):
        read_link(text, setup)


def test_a_session_opens_a_link_and_saves_it_as_a_scenario(setup):
    """The file holds goal, walls, friction and base; what is refused changes nothing."""
    session = Session(setup, MessageLog())
    text = link_text(setup.with_choices({'base': 'late_02'}).with_value('friction.1', 0.9), WALLS)
    session.handle(parse_command(json.dumps({'type': 'open', 'link': text})))
    assert link_text(session.setup, WALLS) == text
    with pytest.raises(CommandRefused, match='link.goal'):
        session.handle(parse_command('{"type": "open", "link": "goal=1"}'))
    session.handle(parse_command('{"type": "goal", "pose": [1.0, 0.5, 0.25]}'))
    saved = scenario_from_text(session.scenario_text, 'task_demo')
    scenario = session.setup.scenario
    assert tuple(saved.goal.pose) == pytest.approx((1.0, 0.5, 0.25))
    assert saved.true_robot.dead_time == 0.2 and saved.true_object == scenario.true_object
    occupancy_map = saved.task.occupancy_map
    assert occupancy_map.clearance([(0.5, -0.3), (0.0, 1.2)]).max() < 0.0
    assert occupancy_map.clearance([(-0.5, -1.5)])[0] > 0.5
