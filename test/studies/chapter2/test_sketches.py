"""Sketches are drawn from the model's geometry, and their labels can be read."""

import math

from helpers.sketch_checks import collisions, drawn, texts
from helpers.study_outcomes import by_figure, numbers, outcome_of, values_of
import numpy as np
from push_model.contact import find_contact
import pytest
from studies.chapter2.sketches import (
    case_studies, curved_pusher, load_balance, rest_positions, rolling_faces, sliding_object,
    steady_state, wheel_analogy,
)

LABELS = {'2.1': '$f_4$ $F_C$ $G$ $F$ $C$ $P$ $n$ $t$ $R_p$',
          '2.2': '$C$ $F$ $v$ $n$ $\\rho$ $\\alpha$', '2.3': '$C$ $F$ $v$',
          '2.4': '$F_C$ $F$ $C$ $n$ $v$ $G$ $\\alpha$', '2.5': '$F$ $C$ $v$',
          '2.10': '$R_p$ $P$ $n_f$ $t_f$ $n$ $t$ $C$ $F$',
          '2.18': '$C$ $z$ $L$ $v_C$ $\\alpha$', '2.27': '$C$ $F$ $P$ $h$ $n$ $v$ $\\rho$',
          'C.1': '$P$ $O$ $C$ $F$ $v_C$ $n$ $t$', '2.30': '$G$ $F$',
          '2.31': '$C$ $P$ $R_p$ 50 100 150 200'}
STUDIES = by_figure(sliding_object, rest_positions, steady_state, wheel_analogy, curved_pusher,
                    case_studies, load_balance, rolling_faces)


@pytest.mark.parametrize('figure', LABELS)
def test_labels_are_drawn_and_legible(figure):
    """Each label is on the sketch and on no line or other label."""
    sketch = drawn(STUDIES[figure])
    assert set(LABELS[figure].split()) <= texts(sketch)
    assert collisions(sketch) == []


def test_drawn_forces_balance_about_the_mass_centre():
    """Moments of the drawn forces about G make up I omega'."""
    now = sliding_object.sketched_instant(values_of(STUDIES['2.1']))
    table = outcome_of(STUDIES['2.1']).tables['forces']
    arms = np.column_stack([table['x_m'], table['y_m']]) - now.mass_center
    moment = arms[:, 0] @ table['force_y_N'] - arms[:, 1] @ table['force_x_N']
    assert moment == pytest.approx(now.obj.inertia * now.forces.yaw_acceleration, rel=1e-9)


def test_disturbed_state_returns_on_a_large_robot_only():
    """The yaw acceleration opposes the disturbance, either way; on a small robot it does not."""
    for side, radius in ((0.3, 0.4), (-0.1, 0.4)):
        found = numbers(outcome_of(STUDIES['2.4'], disturbance=side, robot_radius=radius))
        assert found['yaw_acceleration'] * side < 0.0
    found = numbers(outcome_of(STUDIES['2.4'], disturbance=0.1, robot_radius=0.1))
    assert found['yaw_acceleration'] > 0.0


def test_object_settles_where_its_center_of_friction_is_lowest():
    """As a wheel under its weight; the hill's top is the edge of the basin."""
    outcome = outcome_of(STUDIES['2.5'])
    found, table = numbers(outcome), outcome.tables['height']
    assert found['final'] == pytest.approx(found['lowest'], abs=0.01)
    top = table['theta_rad'][np.argmax(table['height_m'])]
    assert abs(top) == pytest.approx(found['edge'], abs=0.02)


def test_rolled_box_touches_the_robot():
    """The drawn contact is the one that the geometry finds."""
    values = values_of(STUDIES['2.10'])
    now = curved_pusher.rolled_instant(values, values.rotation)
    contact, gamma, gap = find_contact(now.obj, now.pose, now.robot, now.robot_radius)
    assert gap == pytest.approx(0.0, abs=1e-12)
    assert contact.offset == pytest.approx(values.robot_radius * values.rotation)
    assert math.remainder(gamma - now.state.gamma, 2.0 * math.pi) == pytest.approx(0.0, abs=1e-9)


def test_balanced_load_brings_the_friction_center_to_the_middle():
    """Loads carry the weight and balance about G; the roughness decides which way G moves."""
    for rough, side in ((0.45, 1.0), (0.2, -1.0)):
        outcome = outcome_of(STUDIES['2.30'], friction_right=rough)
        table, found = outcome.tables['supports'], numbers(outcome)
        loads = np.array(table['load_N'])
        assert loads.sum() == pytest.approx(values_of(STUDIES['2.30']).mass * 9.81, rel=1e-12)
        assert loads @ table['y_m'] / loads.sum() == pytest.approx(found['shift'], abs=1e-12)
        assert found['residual'] < 1e-9 and side * found['shift'] > 0.01


def test_wider_robot_holds_more_positions_of_the_load():
    stable = [numbers(outcome_of(STUDIES['2.31'], robot_radius=radius))['stable']
              for radius in (0.04, 0.12, 0.17, 0.3)]
    assert stable == [0, 2, 3, 4]


def test_push_on_a_side_goes_through_the_friction_center():
    """The drawn angle leads from C to F; a narrow robot loses the margin."""
    outcome = outcome_of(STUDIES['2.27'])
    found = numbers(outcome)
    x, y = (np.array(outcome.tables['points'][name]) for name in ('x_m', 'y_m'))
    rho = math.degrees(math.atan2(y[2] - y[0], x[2] - x[0]))
    assert found['rho'] == pytest.approx(rho, abs=1e-9)
    assert found['margin'] > 0.0
    assert numbers(outcome_of(STUDIES['2.27'], robot_radius=0.2))['margin'] < 0.0
