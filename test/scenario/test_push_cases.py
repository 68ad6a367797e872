"""Cases of a push as arrays: each ends as its plant would, to the bit, and is refused as it is."""

import dataclasses
import math

from helpers.objects import bin_, box
from helpers.push_draws import draw, PUSH
import numpy as np
from push_dynamics.cases import CaseEnd
from push_dynamics.floor import FloorPatch
from push_model.parameters import RoundRobot, Support
from push_scenario.batch.push_cases import (
    case_values, POSE_COLUMNS, refusal, simulate_cases,
)
from push_scenario.batch.varied_push import VariedPush
from push_sim_node.truth import ContactMode, Energy
import pytest

# Feet that statics leave open, and no symmetry anywhere.
BOX = dataclasses.replace(
    box(), outline=((-0.2, -0.2), (0.25, -0.15), (0.2, 0.2), (-0.15, 0.25)),
    supports=tuple(Support(x, y, mu) for x, y, mu in (
        (-0.15, -0.1, 0.2), (0.2, -0.1, 0.4), (0.15, 0.15, 0.3), (-0.1, 0.2, 0.25),
        (0.02, 0.03, 0.3))))
PATCH = FloorPatch(0.1, 0.0, 0.3, 5.0, 1.5, 0.3, 0.02)
HOLONOMIC, DIFFERENTIAL = (RoundRobot(0.17, drive) for drive in ('holonomic', 'differential'))
FLAT = RoundRobot(math.inf, 'holonomic')
AHEAD = ((0.15, 0.2, 0.0, 0.1), (0.1, 0.1, 0.0, -0.4))
PUSHES = {
    'polygon': VariedPush(BOX, HOLONOMIC, (0.0, 0.0, 0.0), (-0.35, 0.0, 0.0), AHEAD, 5e-3),
    'heights': VariedPush(dataclasses.replace(BOX, contact_height=0.2, center_of_mass_height=0.1),
                          DIFFERENTIAL, (0.0, 0.0, 0.0), (-0.35, 0.0, 0.0), AHEAD, 5e-3),
    'disc': VariedPush(bin_(), HOLONOMIC, (0.0, 0.0, 0.0), (-0.37, 0.0, 0.0), AHEAD, 5e-3,
                       floor=(PATCH,)),
    'flat pusher': VariedPush(BOX, FLAT, (0.0, 0.0, 0.0), (-0.2, 0.0, 0.0), AHEAD, 5e-3)}


def columns(rng, push, count):
    """Draw all columns that there are; many starts overlap by some millimetres, or too much."""
    supports = len(push.object.supports)
    sideways = 0.1 * (push.robot.drive == 'holonomic')
    patches = np.tile(np.array(dataclasses.astuple(PATCH)), (count, 2, 1))
    patches[:, :, 4] = rng.uniform(0.5, 2.0, (count, 2))
    patches[:, 1, 5] = rng.uniform(-3.0, 3.0, count)
    segments = rng.normal(0.0, 1.0, (count, 3, 4 + supports))
    segments[:, :, 0] = rng.choice((0.0, 0.031, 0.1), (count, 3))
    # Many commands are beyond the limits of the drive.
    segments[:, :, 1:3] = np.abs(segments[:, :, 1:3]) * (0.5, sideways)
    segments[:, :, 4:] = rng.choice((1.3, math.nan), (count, 3, 1))
    return {
        'object.mass': rng.uniform(0.5, 5.0, count), 'object.inertia': rng.choice((0, 0.1), count),
        'object.contact_friction_coefficient': rng.uniform(0.0, 0.8, count),
        'object.contact_height': rng.uniform(0.0, 0.4, count) * (push.object.contact_height > 0),
        'object.center_of_mass': rng.uniform(-0.06, 0.06, (count, 2)),
        'robot.max_speed': rng.uniform(0.1, 0.5, count),
        'robot.max_acceleration': rng.uniform(0.5, 2.0, count),
        'robot.time_constant': rng.choice((0.0, 0.1), count),
        'object_pose': rng.normal(0.0, (0.003, 0.003, 0.2), (count, 3)),
        'robot_pose': push.robot_pose + rng.normal(0.0, (0.003, 0.02, 0.1), (count, 3)),
        'friction_factors': rng.uniform(0.0, 1.5, (count, supports)),
        'segments': segments, 'floor': patches}


def outcome(push, values):
    """Run one case on its plant; return its row of results, or the text of the error."""
    try:
        plant = push.run(values)
    except ValueError as error:
        return str(error)
    return (*plant.object_pose, *plant.object_twist, *plant.robot_pose, *plant.robot_twist,
            *plant.energy, plant.mode.code, plant.steps, plant.unsolved_steps)


def result(push, row):
    """Return the same of a row."""
    if row['end'] == CaseEnd.REFUSED:
        return refusal(push, row)
    return tuple(row[name].item() for name in (*POSE_COLUMNS, *Energy._fields, 'mode', 'steps',
                                               'unsolved_steps'))


@pytest.mark.parametrize('name', PUSHES)
def test_every_case_ends_as_its_plant_to_the_bit_or_is_refused_as_it(name):
    push, rng = PUSHES[name], np.random.default_rng(1)
    values = columns(rng, push, 40)
    rows = simulate_cases(push, values)
    expected = [outcome(push, {key: column[i] for key, column in values.items()})
                for i in range(len(rows))]
    assert [result(push, row) for row in rows] == expected
    kinds = [type(one) for one in expected]
    assert kinds.count(tuple) >= 8 and kinds.count(str) >= 1
    assert sum(row['object_v_x'] != 0.0 for row in rows if row['end'] == CaseEnd.COMPLETED) >= 5
    assert all(case_values(row).keys() == values.keys() for row in rows)


@pytest.mark.parametrize('name, value', [
    ('object.mass', 0.0), ('object.mass', 1e4), ('object.inertia', -1.0),
    ('object.mass', math.nan), ('object.contact_friction_coefficient', 11.0),
    ('object.center_of_mass', (0.3, 0.0)), ('object.contact_height', 3.0),
    ('robot.radius', -0.1), ('robot.max_speed', 0.0), ('robot.time_constant', math.inf),
    ('object_pose', (math.nan, 0.0, 0.0)), ('robot_pose', (0.0, math.inf, 0.0)),
    ('robot_pose', (0.0, 0.0, 0.0)), ('friction_factors', (1.0, 1.0, 1.0, -1.0)),
    ('friction_factors', (1.0, 1.0, math.inf, 1.0)), ('segments', ((-0.1, 0.1, 0.0, 0.0),)),
    ('segments', ((0.1, math.nan, 0.0, 0.0),)), ('segments', ((math.inf, 0.1, 0.0, 0.0),)),
    ('segments', ((0.1, 0.1, 0.0, 0.0, 1.0, math.nan, 1.0, 1.0),)),
    ('floor', ((0.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0),))])
def test_what_a_plant_refuses_is_refused_with_its_reason_and_the_rest_is_run(name, value):
    bad = np.array(value)
    fine = {'segments': np.array([[0.1, 0.1, 0.0, 0.0] + [1.0] * (bad.size - 4)]),
            'floor': np.array([[0.0, 0.0, 1.0, 1.0, 1.0, 0.0, 0.0]]),
            'object_pose': np.zeros(3), 'robot_pose': np.array([-0.4, 0.0, 0.0]),
            'friction_factors': np.ones(4), 'object.center_of_mass': np.zeros(2)}.get(
                name, np.array(0.17))
    rows = simulate_cases(PUSH, {name: np.stack([fine, bad, fine])})
    with pytest.raises(ValueError) as error:
        PUSH.run({name: value})
    assert refusal(PUSH, rows[1]) == str(error.value) != ''
    assert math.isnan(rows[1]['object_x']) and rows[1]['steps'] == 0
    assert list(rows['end']) == [CaseEnd.COMPLETED, CaseEnd.REFUSED, CaseEnd.COMPLETED]
    assert rows[0]['robot_x'] == rows[2]['robot_x'] and refusal(PUSH, rows[0]) == ''


@pytest.mark.parametrize('values, words', [
    ({'objekt.mass': [1.0]}, 'objekt.mass'), ({}, 'columns: got'),
    ({'object.mass': ['heavy']}, "object.mass: got .'heavy'., expected numbers"),
    ({'object.mass': 1.0}, r'object.mass: got shape \(\)'),
    ({'object.mass': [1.0, 2.0], 'object.inertia': [1.0]}, r'got shape \(1,\), expected \(2,\)'),
    ({'friction_factors': [[1.0]]}, r'expected \(1, 4\)'),
    ({'segments': [[[0.1, 0.1, 0.0]]]}, r'expected \(1, any, 4\) or \(1, any, 8\)')])
def test_columns_that_do_not_fit_are_named(values, words):
    with pytest.raises(ValueError, match=words):
        simulate_cases(PUSH, values)


def test_a_lost_object_ends_its_case_when_it_rests_and_the_robot_is_away():
    commands = ((0.4, 0.3, 0.0, 0.0), (1.0, -0.3, 0.0, 0.0))
    push = dataclasses.replace(PUSH, segments=commands, lost_gap=0.02)
    rows = simulate_cases(push, {**draw(np.random.default_rng(3), 6),
                                 'object_pose': np.outer([0, 0, 0, 0, 0, 9], [1.0, 0.0, 0.0])})
    assert list(rows['end']) == [CaseEnd.LOST] * 5 + [CaseEnd.COMPLETED]
    for row in rows[:5]:
        plant = push.plant(case_values(row))
        gaps = []
        for segment in push.driven_segments(case_values(row)):
            for _ in range(round(segment.duration / push.step)):
                if plant.steps < row['steps']:
                    plant.advance(push.step, segment.command)
                    gaps.append(plant.truth(0.0).gap)
        assert row['time'] == pytest.approx(row['steps'] * push.step) and row['time'] < 1.2
        assert tuple(row[list(POSE_COLUMNS[:3])]) == tuple(plant.object_pose)
        assert gaps[-2] <= 0.02 < gaps[-1] and plant.mode is ContactMode.SEPARATE
    # What comes after would have moved the object no more.
    later = simulate_cases(dataclasses.replace(push, lost_gap=math.inf),
                           {name: rows[name] for name in case_values(rows[0])})
    assert later['object_x'] == pytest.approx(rows['object_x'], abs=1e-6)
    assert np.all(later['steps'] == 280)


def test_a_case_that_names_nothing_new_is_the_push_itself():
    named = {'object_pose': (0.0, 0.0, 0.0), 'robot_pose': [-0.37, 0.0, 0.0],
             'friction_factors': [1.0] * 4, 'segments': PUSH.segments, 'object.mass': 2.0}
    assert outcome(PUSH, {}) == outcome(PUSH, named)
    turned = {'object_pose': [[0.0, 0.0, math.pi / 2]], 'robot_pose': [[0.0, -0.37, math.pi / 2]]}
    aside = simulate_cases(PUSH, turned)[0]
    assert aside['object_y'] == pytest.approx(PUSH.run({}).object_pose.x, abs=1e-9)


def test_friction_changes_between_segments_and_with_the_floor():
    before, after = [0.3, 0.2, 0.0, 0.0], [0.3, 0.2, 0.0, 0.0]
    plain, grippy, always = (
        simulate_cases(PUSH, {'segments': [[before + [first] * 4, after + [then] * 4]]})[0]
        for first, then in ((1.0, math.nan), (1.0, 2.0), (2.0, math.nan)))
    assert always['support_loss'] == pytest.approx(2.0 * plain['support_loss'], rel=1e-3)
    assert plain['support_loss'] < 0.9 * grippy['support_loss'] < 0.9 * always['support_loss']
    patch = FloorPatch(0.0, 0.0, 9.0, 9.0, 2.0)
    doubled = simulate_cases(PUSH, {'floor': [[dataclasses.astuple(patch)]]})[0]
    assert result(PUSH, doubled) == outcome(PUSH, {'friction_factors': [2.0] * 4})
    assert result(PUSH, doubled) == outcome(dataclasses.replace(PUSH, floor=(patch,)), {})
