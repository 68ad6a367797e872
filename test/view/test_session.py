"""A live session, as its user drives it: real simulation, planner and controller."""

import dataclasses
import json
import math

import numpy as np
from push_control.task.status import TaskState
from push_model.files.parameter_files import named_file
from push_scenario.definition.expected_poses import with_sensors
from push_scenario.definition.loader import load_scenario, read_sensors
from push_view.live.session import Session
from push_view.live.setup import Setup
from push_view.live.walls import Drawing, open_floor, with_wall
from push_view.server.commands import CommandRefused, parse_command
from push_view.server.message_log import MessageLog
import pytest


def command(kind, **values):
    """Make a command as the page sends it."""
    return parse_command(json.dumps({'type': kind, **values}))


def messages(session, kind):
    """List the messages of a kind."""
    texts, _ = session.log.since(0)
    return [message for message in map(json.loads, texts) if message['type'] == kind]


def column(session, name):
    """Return a column of all rows."""
    number = messages(session, 'scene')[-1]['columns'].index(name)
    return np.array([row[number] for message in messages(session, 'rows')
                     for row in message['rows']], dtype=float)


@pytest.fixture
def session():
    """Start where the box is a centimetre from its goal."""
    return Session(Setup.of(load_scenario('task_tap')), MessageLog())


def advance_until_standing(session, time_limit=120.0):
    """Let time pass until the robot waits for a goal."""
    end = session.time + time_limit
    session.advance(0.5)
    while not session.is_standing and session.time < end:
        session.advance(0.1)


def test_after_a_rehearsal_the_robot_has_a_plan(session):
    """Nothing is left to be compiled while its user watches."""
    session.rehearse()
    assert messages(session, 'plan') and session.time < 1.0


@pytest.mark.slow
def test_a_task_is_done_and_the_next_goal_too(session):
    """The page is shown all of it: rows without gaps, states, plans, what is believed."""
    advance_until_standing(session)
    session.handle(command('goal', pose=[0.4, 0.1, 0.2]))
    advance_until_standing(session)
    x, y, theta = session.object_pose
    assert math.hypot(x - 0.4, y - 0.1) < 0.01 and abs(theta - 0.2) < math.radians(1.0)
    assert [message['state'] for message in messages(session, 'state')].count('done') == 2
    assert len(messages(session, 'plan')) >= 2
    assert np.diff(column(session, 'time')) == pytest.approx(0.02, abs=1e-4)
    believed = column(session, 'believed_object_x')
    assert np.nanmax(np.abs(believed - column(session, 'object_x'))[50:]) < 0.02
    # Nothing piles up in a session that lasts.
    assert not session._run._simulation.rows


def test_an_object_that_is_moved_is_where_it_was_put(session):
    """Unless the robot stands there: then it is refused, and stays."""
    session.handle(command('displace', pose=[0.3, -0.5, 1.0]))
    assert tuple(session.object_pose) == pytest.approx((0.3, -0.5, 1.0))
    moved, = messages(session, 'displacement')
    assert moved['after'] == pytest.approx([0.3, -0.5, 1.0])
    robot = [column(session, f'robot_{name}')[-1] for name in ('x', 'y')]
    with pytest.raises(CommandRefused, match='the robot is in the way'):
        session.handle(command('displace', pose=[*robot, 0.0]))
    assert tuple(session.object_pose) == pytest.approx((0.3, -0.5, 1.0))


def test_what_is_changed_while_time_stands_is_shown(session):
    """At the last row, or with another one where something has moved."""
    session.advance(0.3)
    session.handle(command('run', paused=True))
    session.handle(command('goal', pose=[0.5, 0.5, 0.0]))
    assert messages(session, 'goal')[-1]['time'] == column(session, 'time')[-1]
    session.handle(command('displace', pose=[0.3, -0.5, 1.0]))
    assert column(session, 'object_y')[-1] == pytest.approx(-0.5)
    assert messages(session, 'displacement')[-1]['time'] < column(session, 'time')[-1]


def test_a_wall_replaces_the_plan(session):
    """It is on the map of the supervisor; one through the robot or the object is refused."""
    session.handle(command('wall', start=[1.0, -1.0], end=[1.0, 1.0]))
    shown = messages(session, 'map')[-1]
    assert any('#' in row for row in shown['rows'])
    for place in ([0.0, 0.0], [column(session, f'robot_{name}')[-1] for name in ('x', 'y')]):
        with pytest.raises(CommandRefused, match='robot or object is in the way'):
            session.handle(command('wall', start=place, end=place))
    assert messages(session, 'map')[-1] == shown
    session.handle(command('clear_walls'))
    assert messages(session, 'map')[-1]['rows'] == []


def test_walls_are_removed_one_by_one_and_changes_taken_back(session):
    """The map and the list that a page removes them from; nothing is left to take back at last."""
    first, second = ([1.0, -1.0], [1.0, 1.0]), ([-1.5, -1.0], [-1.5, 1.0])
    maps = [messages(session, 'map')[-1]['rows']]
    for start, end in (first, second):
        session.handle(command('wall', start=start, end=end))
        maps.append(messages(session, 'map')[-1]['rows'])
    session.handle(command('remove_wall', wall=0))
    assert messages(session, 'walls')[-1]['walls'] == [[*second[0], *second[1]]]
    assert messages(session, 'map')[-1]['rows'] not in maps
    with pytest.raises(CommandRefused, match='remove_wall.wall: got 1, expected one of 1 walls'):
        session.handle(command('remove_wall', wall=1))
    for rows in (maps[2], maps[1], maps[0]):
        session.handle(command('undo'))
        assert messages(session, 'map')[-1]['rows'] == rows
    assert messages(session, 'walls')[-1] == {'type': 'walls', 'walls': [], 'can_undo': False}
    with pytest.raises(CommandRefused, match='undo: got no change'):
        session.handle(command('undo'))


def test_nothing_happens_once_the_robot_waits(session):
    """A second after all stands, until its user does something."""
    assert not session.is_at_rest
    advance_until_standing(session)
    assert not session.is_at_rest
    end = session.time + 30.0
    while not session.is_at_rest and session.time < end:
        session.advance(0.1)
    assert session.is_at_rest
    session.handle(command('displace', pose=[1.0, 1.0, 0.0]))
    assert not session.is_at_rest


def test_presets_are_commands_that_are_understood(session):
    """A kick depends on where things are, and is made a command by the page."""
    for preset in messages(session, 'controls')[-1]['presets']:
        for values in preset['commands']:
            if values['type'] != 'kick':
                session.handle(command(values.pop('type'), **values))
    assert session.setup.choices['base'] == 'late_03'
    assert session.setup.choices['sensors'] == 'own_camera'
    assert max(support.friction_coefficient
               for support in session.setup.scenario.true_object.supports) == 0.9


def test_nothing_gets_through_a_wall(session):
    """The robot stops at one that is not on its map, says why, and takes the next goal."""
    session.handle(command('displace', pose=[0.0, -1.5, 0.0]))
    run = session._run
    x, y, _ = run._simulation.plant.robot_pose
    # A ring of walls that the robot has not been told of.
    ring = open_floor((x, y))
    corners = [(x + u * 0.4, y + v * 0.4) for u, v in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    for start, end in zip(corners, corners[1:] + corners[:1]):
        ring = with_wall(ring, start, end)
    run._set_walls(ring)
    session._drawing = Drawing(ring)
    while not session.is_standing and session.time < 60.0:
        session.advance(0.1)
    session.advance(0.2)
    hit, = messages(session, 'collision')
    assert hit['body'] == 'robot' and ring.clearance([hit['point']])[0] < 0.002
    state = messages(session, 'state')[-1]
    assert (state['state'], state['reason']) == ('idle', 'the robot touches a wall')
    places = np.column_stack([column(session, 'robot_x'), column(session, 'robot_y')])
    assert ring.clearance(places).min() > 0.15
    assert np.hypot(*(places[-1] - places[-5])) == 0.0
    with pytest.raises(CommandRefused, match='a wall is in the way'):
        session.handle(command('displace', pose=[*corners[0], 0.0]))
    # It stands beside the wall, not in it: another one is drawn, and all are removed.
    session.handle(command('wall', start=[x, y + 1.0], end=[x + 0.5, y + 1.0]))
    session.handle(command('clear_walls'))
    session.advance(1.0)
    assert not session.is_standing


def test_true_friction_changes_under_way(session):
    """The plant has it at once, the robot has not been told."""
    session.handle(command('set', name='friction.1', value=0.9))
    session.handle(command('set', name='contact_friction', value=0.1))
    truth = messages(session, 'truth')[-1]
    assert truth['friction'][1] == 0.9 and truth['contact_friction'] == 0.1
    assert messages(session, 'scene')[-1]['object']['friction'][1] != 0.9
    shown = {setting['name']: setting['value']
             for setting in messages(session, 'controls')[-1]['settings']}
    assert shown['friction.1'] == 0.9 and shown['contact_friction'] == 0.1
    session.advance(0.1)


def test_sensors_change_under_way(session):
    """Without noise and latency what is measured is the truth."""
    for name in ('pose_noise', 'pose_heading_noise', 'pose_latency', 'pose_drop_probability'):
        session.handle(command('set', name=name, value=0.0))
    session.advance(0.5)
    measured = session._run._loop.observation.object_pose
    assert tuple(measured.pose) == pytest.approx(tuple(session.object_pose), abs=1e-9)


@pytest.mark.parametrize('kind, values, words', [
    ('set', {'name': 'gravity', 'value': 1}, 'set.name: got .gravity., expected one of friction'),
    ('set', {'name': 'friction.0', 'value': 7}, 'set.value: got 7, expected 0.05 to 1'),
    ('choose', {'object': '../secret'}, 'choose: got .*expected one of objects'),
    ('choose', {'law': 'open_loop'}, 'choose.law: got .open_loop.'),
    ('choose', {'base': 'perfect'}, 'choose: got .perfect., expected one of bases: dead_band_005'),
    ('choose', {'colour': 'red'}, 'choose.colour: got .red.'),
])
def test_what_cannot_be_done_is_refused_and_nothing_changes(session, kind, values, words):
    """With the reason."""
    before = session.log.since(0)
    with pytest.raises(CommandRefused, match=words):
        session.handle(command(kind, **values))
    assert session.log.since(0) == before


def test_another_object_starts_another_run(session):
    """With the walls that were drawn, at time 0; a step is one row."""
    session.advance(0.2)
    session.handle(command('choose', object='bin', robot='holonomic_017'))
    scene, = messages(session, 'scene')
    assert scene['object']['radius'] > 0.0 and scene['robot']['drive'] == 'holonomic'
    assert session.time == 0.0
    session.handle(command('step'))
    assert session.paused and session.time == pytest.approx(0.02)
    assert messages(session, 'run')[-1]['paused']


def base_choice(session):
    """Return the name of the base that is chosen."""
    return next(choice['value'] for choice in messages(session, 'controls')[-1]['choices']
                if choice['name'] == 'base')


def test_another_base_is_not_made_known_to_the_robot(session):
    """Only the true robot and the drive change; another robot keeps the base."""
    before = session._setup.scenario
    assert base_choice(session) == 'good'
    session.handle(command('choose', base='dead_band_008'))
    scenario = session._setup.scenario
    assert scenario == dataclasses.replace(before, true_robot=dataclasses.replace(
        before.robot, min_speed=0.08, min_yaw_rate=0.15))
    scene, = messages(session, 'scene')
    assert (scene['robot']['min_speed'], scene['true_base']['min_speed']) == (0.0, 0.08)
    session.handle(command('choose', base='smoother', robot='holonomic_017'))
    scenario = session._setup.scenario
    assert scenario.true_robot == scenario.robot and scenario.robot.drive == 'holonomic'
    assert scenario.simulation.drive.smoother_acceleration == 0.3
    session.handle(command('choose', robot='create3'))
    assert base_choice(session) == 'smoother'
    assert session._setup.scenario.simulation == scenario.simulation
    session.handle(command('choose', base='good', robot='disc_017'))
    assert session._setup.scenario == before


@pytest.mark.parametrize('name, base', [('task_late_base', 'late_03'), ('task_tap', 'good')])
def test_the_base_of_a_scenario_has_its_name(name, base):
    """Also one that no file describes."""
    scenario = load_scenario(name)
    assert Setup.of(scenario).choices['base'] == base
    other = dataclasses.replace(scenario, true_robot=dataclasses.replace(
        scenario.true_robot, dead_time=0.17))
    setup = Setup.of(other)
    assert setup.choices['base'] == 'as in the scenario'
    assert setup.with_choices({'robot': 'create3'}).choices['base'] == 'good'


@pytest.mark.slow
def test_what_is_learned_of_a_base_is_shown(session):
    """Nothing at first, and something near the truth at the end of a task."""
    session.handle(command('choose', base='late_03'))
    advance_until_standing(session)
    first, *_, last = messages(session, 'base')
    assert (first['time'], first['dead_time'], first['min_speed']) == (0.0, 0.0, 0.0)
    assert last['dead_time'] == pytest.approx(0.3, abs=0.06)
    assert last['pulse'] > 0.0


def sensors_of(name):
    """Read sensors of the package."""
    return read_sensors(named_file('sensors', name))


def test_other_sensors_are_made_known_to_the_controller(session):
    """As ``push replay --sensors`` does, whatever was chosen before; the law stays."""
    before = session._setup.scenario
    session.handle(command('choose', sensors='own_camera'))
    assert session._setup.scenario == with_sensors(before, sensors_of('own_camera'))
    assert session._setup.task == session._setup.scenario.task
    camera = messages(session, 'scene')[-1]['camera']
    assert (camera['place'], camera['nearest']) == ('robot', 0.25)
    assert camera['mount'] == [0.1, 0.0, 0.0]
    assert camera['half_angle'] == pytest.approx(math.radians(34.5))
    session.handle(command('choose', law='mpc', robot='create3'))
    supervision = session._setup.task.supervision
    assert supervision.view_nearest == pytest.approx(
        0.35 - session._setup.scenario.robot.radius, abs=1e-9)
    session.handle(command('choose', law=before.control.control_law, robot='disc_017',
                           sensors='mocap'))
    assert session._setup.scenario == with_sensors(before, sensors_of('mocap'))
    assert messages(session, 'scene')[-1]['camera'] is None
    session.handle(command('choose', sensors='as in the scenario'))
    assert session._setup.scenario == before


@pytest.mark.parametrize('name', ['own_camera', 'mocap'])
def test_sensors_have_the_name_of_their_file(name):
    """Where the controller knows of them; those of a scenario may differ from every file."""
    scenario = load_scenario('task_own_camera')
    assert Setup.of(scenario).choices['sensors'] == 'as in the scenario'
    known = with_sensors(scenario, sensors_of(name))
    assert Setup.of(known).choices['sensors'] == name
    assert Setup.of(dataclasses.replace(known, control=dataclasses.replace(
        known.control, pose_timeout=0.9))).choices['sensors'] == 'as in the scenario'


@pytest.mark.slow
def test_what_the_robot_does_not_see_it_estimates():
    """The page is told what is seen, and where the robot then takes the object to be."""
    session = Session(Setup.of(load_scenario('task_own_camera')), MessageLog())
    advance_until_standing(session)
    seen, deviation = column(session, 'object_seen'), column(
        session, 'believed_object_deviation_major')
    assert set(seen) == {0.0, 1.0} and seen[0] == 0.0
    # Behind the robot at first: nothing is known of the object before it is seen.
    first = int(seen.argmax())
    assert np.isnan(deviation[:first]).all() and np.isfinite(deviation[first + 20:]).all()
    d_x, d_y = (column(session, f'believed_object_{axis}') - column(session, f'object_{axis}')
                for axis in 'xy')
    error = np.hypot(d_x, d_y)[first + 20:]
    seen, deviation = seen[first + 20:], deviation[first + 20:]
    blind = seen == 0.0
    assert blind.any() and deviation[blind].max() > 2.0 * np.median(deviation[~blind])
    assert (error < 3.0 * deviation).mean() > 0.95


def test_a_single_push_is_no_session():
    """It has no supervisor that takes goals."""
    with pytest.raises(ValueError, match='got a single push, expected a task'):
        Setup.of(load_scenario('straight_push'))


def test_a_wall_is_where_it_was_drawn():
    """Its cells are those near the line, on maps at any angle."""
    floor = open_floor((0.5, 0.2))
    assert not floor.occupied.any()
    for occupancy_map in (floor, type(floor)(0.05, (-1.0, -2.0, 0.7), floor.occupied)):
        drawn = with_wall(occupancy_map, (0.3, 0.1), (1.1, 0.9))
        along = np.linspace((0.3, 0.1), (1.1, 0.9), 50)
        assert (drawn.clearance(along) < 0.0).all()
        beside = along + 0.3 * np.array([1.0, -1.0]) / math.sqrt(2.0)
        assert (drawn.clearance(beside) > 0.1).all()


def test_states_of_the_page_are_those_of_the_supervisor():
    """Each has words on the page."""
    from push_view.page_file import page_source
    text = page_source('panel.js')
    assert all(f'{state.value}: ' in text for state in TaskState)
