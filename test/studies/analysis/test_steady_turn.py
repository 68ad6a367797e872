"""Steady turns by the laws that they keep: limits, scaling, symmetry and power."""

import dataclasses
import math

from helpers.objects import bin_, box
import numpy as np
from push_model.dynamics import State
from push_model.parameters import GRAVITY
from push_model.quasi_static import quasi_static_yaw_rate
import pytest
from studies.analysis.steady_turn import FIXED, steady_force, steady_yaw_rate
from studies.analysis.time_integration import body_fixed_push, integrate

pytestmark = pytest.mark.physics
MID_FACE = (-0.2, 0.0)
ANGLE = -math.radians(20)  # rotates the object to the left
SKEW = {'friction': (0.2, 0.4, 0.3, 0.25), 'center_of_mass': (0.02, -0.03),
        'contact_friction_coefficient': 3.0}


def scaled(obj, factor):
    """Return the object with all lengths multiplied and the same mass."""
    supports = tuple(dataclasses.replace(s, x=factor * s.x, y=factor * s.y) for s in obj.supports)
    return dataclasses.replace(
        obj, supports=supports, outline=tuple((factor * x, factor * y) for x, y in obj.outline),
        center_of_mass=tuple(factor * part for part in obj.center_of_mass),
        inertia=factor ** 2 * obj.inertia)


@pytest.mark.parametrize('speed, ratio', [(0.05, 0.998), (0.25, 0.957), (0.5, 0.848),
                                          (1.0, 0.575), (2.0, 0.247)])
def test_steady_over_quasi_static_yaw_rate(speed, ratio):
    slow = quasi_static_yaw_rate(box(), MID_FACE, speed * math.cos(ANGLE), speed * math.sin(ANGLE))
    steady = steady_yaw_rate(box(), MID_FACE, ANGLE, speed)
    assert steady / slow == pytest.approx(ratio, abs=6e-4)


@pytest.mark.parametrize('speed', [0.2, 1.0])
@pytest.mark.parametrize('obj, point, direction', [
    (box(), MID_FACE, ANGLE), (box(**SKEW), (-0.2, 0.05), -0.1), (bin_(), (-0.2, 0.0), -0.3)])
def test_steady_turn_is_what_the_motion_tends_to(obj, point, direction, speed):
    begin = State(0.0, 0.0, 0.0, 0.0, 0.0, *point)
    _, states = integrate(obj, FIXED, body_fixed_push(direction, speed), begin,
                          [0.0, 8.0 / speed, 9.0 / speed])
    steady = steady_yaw_rate(obj, point, direction, speed)
    assert abs(steady) > 0.01
    assert states[1:, 3] == pytest.approx([steady] * 2, rel=1e-5)


def test_steady_turn_knows_neither_mass_nor_inertia():
    known = steady_yaw_rate(box(), MID_FACE, ANGLE, 1.0)
    for changes in ({'mass': 0.5}, {'mass': 30.0}, {'inertia': 0.01}, {'inertia': 3.0}):
        assert steady_yaw_rate(box(**changes), MID_FACE, ANGLE, 1.0) == pytest.approx(
            known, rel=1e-9)
    assert steady_yaw_rate(box(friction=(0.6,) * 4), MID_FACE, ANGLE, 1.0) > 1.2 * known


@pytest.mark.parametrize('length, friction', [(2.0, 1.0), (1.0, 2.0), (0.5, 0.3)])
def test_steady_turn_depends_on_speed_squared_over_friction_and_length(length, friction):
    """At equal v^2 / (mu g L) the rotation per distance, in lengths of the object, is the same."""
    plain, other = box(), scaled(box(friction=(0.3 * friction,) * 4), length)
    faster = 0.8 * math.sqrt(length * friction)
    per_distance = steady_yaw_rate(plain, MID_FACE, ANGLE, 0.8) / 0.8
    point = tuple(length * part for part in MID_FACE)
    assert length * steady_yaw_rate(other, point, ANGLE, faster) / faster == pytest.approx(
        per_distance, rel=1e-6)
    assert length * steady_yaw_rate(other, point, ANGLE, 1.5 * faster) / (1.5 * faster) < \
        0.95 * per_distance


def test_slow_steady_turn_is_the_quasi_static_one():
    """The difference falls with the square of the speed; inertia only damps the turn."""
    deficits = []
    for speed in (0.2, 0.1, 0.05):
        slow = quasi_static_yaw_rate(box(), MID_FACE, speed * math.cos(ANGLE),
                                     speed * math.sin(ANGLE))
        deficits.append(1.0 - steady_yaw_rate(box(), MID_FACE, ANGLE, speed) / slow)
    assert 0.0 < deficits[2] < 3e-3
    assert np.divide(deficits[:2], deficits[1:]) == pytest.approx([4.0, 4.0], rel=0.05)


def test_steady_turn_is_mirrored_with_the_push():
    left, right = (steady_yaw_rate(box(), MID_FACE, side * ANGLE, 0.7) for side in (1, -1))
    assert left > 0.0 and right == pytest.approx(-left)
    assert steady_yaw_rate(box(), MID_FACE, 0.0, 0.7) == pytest.approx(0.0, abs=1e-9)


def test_steady_force_is_friction_and_the_pull_to_the_middle_of_the_turn():
    """Power of the push is what friction takes; without a turn the force is mu m g."""
    obj, speed, omega = box(), 1.0, steady_yaw_rate(box(), MID_FACE, ANGLE, 1.0)
    f_n, f_t = steady_force(obj, MID_FACE, ANGLE, speed, 0.0)
    v_x, v_y = speed * math.cos(ANGLE), speed * math.sin(ANGLE)
    loss = sum(q * math.hypot(v_x - omega * (s.y - MID_FACE[1]), v_y + omega * (s.x - MID_FACE[0]))
               for s, q in zip(obj.supports, obj.capacities))
    assert f_n * v_x + f_t * v_y == pytest.approx(loss, rel=1e-6)
    assert steady_force(obj, MID_FACE, 0.0, speed, 0.0) == pytest.approx(
        (0.3 * obj.mass * GRAVITY, 0.0), abs=1e-6)


@pytest.mark.parametrize('direction', [1.6, math.pi, -2.0])
def test_a_push_away_from_the_mass_centre_is_refused(direction):
    with pytest.raises(ValueError, match='direction: got .*away from the mass centre'):
        steady_yaw_rate(box(), MID_FACE, direction, 0.5)
