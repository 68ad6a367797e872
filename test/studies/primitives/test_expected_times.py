"""Expected times to goals, and which push is best for which."""

import math

from helpers.study_outcomes import by_figure, numbers, outcome_of
import numpy as np
from push_model.geometry import Pose
import pytest
from studies.primitives import expected_time, selected_push, steered_push
from studies.primitives.selected_push import Kind
from studies.primitives.setup import named_object, named_primitives, named_robot
from studies.primitives.steered_push import path_length, steered_vertices, SteeredVertex

STUDIES = by_figure(expected_time, selected_push, steered_push)
SPEED = 0.17


def test_a_holonomic_drive_is_never_later():
    outcome = outcome_of(STUDIES['P.6'], headings=[0.0])
    differential, holonomic = (outcome.tables[drive] for drive in ('differential', 'holonomic'))
    assert (holonomic['time_s'] <= differential['time_s'] + 1e-3).all()
    at_goal = np.hypot(differential['x_m'], differential['y_m']) < 1e-9
    assert at_goal.any() and not differential['time_s'][at_goal].any()
    found = numbers(outcome)
    assert found['differential_ahead'] < found['differential_turned'] \
        < found['differential_reversed']
    assert 5.0 < found['saved'] < 30.0


def test_time_jumps_at_the_tolerances_and_rises_with_the_distance():
    outcome = outcome_of(STUDIES['P.7'], objects=['box_04'])
    curves = outcome.tables['box_04']
    settings = named_primitives('box_04', 'disc_017').settings
    times = np.array(curves['miss_time_s'])
    inside = curves['miss_m'] < settings.position_limit
    assert not times[inside].any()
    # Nothing outside can take less than a look, a contact and a push.
    outside = curves['miss_m'] > 1.2 * settings.position_limit
    assert (times[outside] > settings.contact_time + settings.push_time).all()
    assert (np.diff(curves['distance_time_s']) >= 0.0).all()
    found = numbers(outcome)
    # A metre cannot take less than it takes to drive it.
    assert found['slope'] > 1.0 / settings.pushing_speed
    assert found['miss_heading_least'] > found['both_least'] > found['miss_least']


def test_near_goals_begin_with_taps_and_those_ahead_with_a_push_in_the_middle():
    outcome = outcome_of(STUDIES['P.8'], distances=[0.03, 0.64], bearings=4, headings=[0.0])
    table = outcome.tables['selected']
    kinds = np.array(table['kind'])
    near = table['distance_m'] < 0.1
    assert (kinds[near] == Kind.TAP.value).all()
    assert (kinds[~near] == Kind.MIDDLE.value).all()
    found = numbers(outcome)
    assert sum(found[kind.name.lower()] for kind in Kind) == pytest.approx(100.0)
    assert found['tap'] == pytest.approx(50.0) and found['near_tap'] == pytest.approx(100.0)
    # Nobody is there before the push is driven.
    assert (table['expected_time_s'] > table['length_m'] / SPEED).all()


def test_steered_vertices_of_the_box_are_alike_and_tighter_for_a_holonomic_drive():
    box, robot = named_object('box_04'), named_robot('disc_017')
    differential = steered_vertices(box, robot, SPEED)
    holonomic = steered_vertices(box, named_robot('holonomic_017'), SPEED)
    assert len(differential) == len(holonomic) == 4
    for vertices in (differential, holonomic):
        radii = [radius for vertex in vertices for radius in vertex[1:]]
        assert radii == pytest.approx([radii[0]] * 8, rel=1e-6)
    assert holonomic[0].radius_left < differential[0].radius_left


def test_a_steered_path_is_straight_to_where_the_vertex_points():
    vertex = SteeredVertex(Pose(0.1, 0.1, 0.25 * math.pi), 0.7, 0.7)
    ahead = Pose(math.cos(vertex.start.theta), math.sin(vertex.start.theta), 0.0)
    assert path_length(vertex, ahead) == pytest.approx(1.0)
    assert path_length(vertex, Pose(0.0, 0.0, 0.0)) == pytest.approx(0.0, abs=1e-9)
    # It cannot turn in place: the flat output point follows arcs of that radius at best.
    turned = path_length(vertex, Pose(0.0, 0.0, 1.0))
    assert turned > 0.7


def test_steered_pushes_win_far_away_and_straight_ones_near():
    outcome = outcome_of(STUDIES['P.9'], headings=[0.0])
    found = numbers(outcome)
    assert found['differential_near'] > found['holonomic_near']
    assert found['differential_distance'] > found['holonomic_distance']
    table = outcome.tables['differential']
    saved = table['straight_s'] - table['steered_s']
    distance = np.hypot(table['x_m'], table['y_m'])
    assert (saved[distance > 2.5] > 0.0).all()
    # Straight ahead of a face lies where no vertex points: it would have to go round in a circle.
    before = (np.abs(table['y_m']) < 0.01) & (np.abs(np.abs(table['x_m']) - 0.45) < 0.01)
    assert before.any() and (saved[before] < 0.0).all()
