"""Sketches are drawn from the model's geometry, and their labels can be read."""

import math

from helpers.sketch_checks import collisions, computed, drawn, texts
import numpy as np
from push_model.contact import find_contact
from push_study.chapter2.sketches import (
    box as sketches_box, curved_fence as sketches_fence, loads as sketches_loads,
    model as sketches_model, rest_positions as sketches_rest, steady_state as sketches_state,
    wheel as sketches_wheel,
)
import pytest

LABELS = {'2.1': '$f_4$ $F_C$ $G$ $F$ $C$ $P$ $n$ $t$ $R_p$', '2.2': '$C$ $F$ $v$',
          '2.3': '$F_C$ $F$ $n$ $G$', '2.4': '$F$ $C$ $n$ $v$', '2.5': '$F$ $C$ $v$',
          '2.10': '$R_p$ $P$ $n_f$ $t_f$ $n$ $t$ $C$ $F$',
          '2.18': '$C$ $z$ $L$ $v_C$ $\\alpha$', '2.27': '$C$ $F$ $P$ $h$ $n$ $v$ $\\rho$',
          '2.30': '$G$ $F$', '2.31': '$C$ $P$ $R_p$ 50 100 150 200'}
STUDIES = {study.figure: study for module in (sketches_model, sketches_rest, sketches_state,
                                              sketches_wheel, sketches_fence, sketches_box,
                                              sketches_loads)
           for study in module.STUDIES}


@pytest.mark.parametrize('figure', LABELS)
def test_labels_are_there_and_free(figure):
    """Each label stands on the sketch and on no line or other label."""
    picture = drawn(STUDIES[figure])
    assert set(LABELS[figure].split()) <= texts(picture)
    assert collisions(picture) == []


def test_drawn_forces_balance_about_the_mass_centre():
    """Moments of the drawn forces about G make up I omega'."""
    values, outcome = computed(STUDIES['2.1'])
    now, table = sketches_model.instant(values), outcome.tables['forces']
    arms = np.column_stack([table['x_m'], table['y_m']]) - now.mass_centre
    moment = arms[:, 0] @ table['force_y_N'] - arms[:, 1] @ table['force_x_N']
    assert moment == pytest.approx(now.obj.inertia * now.forces.yaw_acceleration, rel=1e-9)


def test_disturbed_state_turns_back_on_a_round_robot_only():
    """The yaw acceleration opposes the disturbance, either way; on a small robot it grows."""
    for side, radius in ((0.3, 0.4), (-0.1, 0.4)):
        found = computed(STUDIES['2.4'], disturbance=side, robot_radius=radius)[1].findings
        assert found['yaw_acceleration'].value * side < 0.0
    found = computed(STUDIES['2.4'], disturbance=0.1, robot_radius=0.1)[1].findings
    assert found['yaw_acceleration'].value > 0.0


def test_object_settles_where_friction_is_lowest():
    """As a wheel under its weight; the hill's top is the edge of the basin."""
    _, outcome = computed(STUDIES['2.5'])
    found, table = outcome.findings, outcome.tables['height']
    assert found['settled'].value == pytest.approx(found['lowest'].value, abs=0.01)
    top = table['theta_rad'][np.argmax(table['height_m'])]
    assert abs(top) == pytest.approx(found['edge'].value, abs=0.02)


def test_rolled_box_touches_the_robot():
    """The drawn contact is the one that the geometry finds."""
    values, _ = computed(STUDIES['2.10'])
    now = sketches_fence.rolled(values, values.turn)
    contact, gamma, gap = find_contact(now.obj, now.pose, now.robot, now.robot_radius)
    assert gap == pytest.approx(0.0, abs=1e-12)
    assert contact.offset == pytest.approx(values.robot_radius * values.turn)
    assert math.remainder(gamma - now.state.gamma, 2.0 * math.pi) == pytest.approx(0.0, abs=1e-9)


def test_balanced_load_brings_the_friction_centre_to_the_middle():
    """Loads carry the weight and balance about G; the roughness decides which way G moves."""
    for rough, side in ((0.45, 1.0), (0.2, -1.0)):
        values, outcome = computed(STUDIES['2.30'], friction_right=rough)
        table, found = outcome.tables['supports'], outcome.findings
        loads = np.array(table['load_N'])
        assert loads.sum() == pytest.approx(values.mass * 9.81, rel=1e-12)
        assert loads @ table['y_m'] / loads.sum() == pytest.approx(found['shift'].value, abs=1e-12)
        assert found['off'].value < 1e-9 and side * found['shift'].value > 0.01


def test_wider_robot_holds_more_places_of_the_load():
    stable = [computed(STUDIES['2.31'], robot_radius=radius)[1].findings['stable'].value
              for radius in (0.04, 0.12, 0.17, 0.3)]
    assert stable == [0, 2, 3, 4]


def test_push_on_a_side_goes_through_the_friction_centre():
    """The drawn angle leads from C to F; a narrow robot loses the margin."""
    values, outcome = computed(STUDIES['2.27'])
    x, y = (np.array(outcome.tables['places'][name]) for name in ('x_m', 'y_m'))
    rho = math.degrees(math.atan2(y[2] - y[0], x[2] - x[0]))
    assert outcome.findings['rho'].value == pytest.approx(rho, abs=1e-9)
    assert outcome.findings['margin'].value > 0.0
    assert computed(STUDIES['2.27'], robot_radius=0.2)[1].findings['margin'].value < 0.0
