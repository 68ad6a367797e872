"""Force and energy of a first touch, against an integration of two masses and a spring."""

import math

from benchmarks.touch.first_touch import FirstTouch, reduced_mass
import pytest

STEP = 1e-6


@pytest.mark.parametrize('robot, obj', [(3.0, 3.0), (20.0, 3.0), (5.0, 40.0)])
def test_force_is_that_of_two_masses_with_a_spring_between(robot: float, obj: float) -> None:
    """And the energy that of the spring when it is shortest."""
    stiffness, speed = 5e3, 0.2
    v_robot, v_object, compression = speed, 0.0, 0.0
    while v_robot > v_object:
        force = stiffness * compression
        v_robot -= STEP * force / robot
        v_object += STEP * force / obj
        compression += STEP * (v_robot - v_object)
    touch = FirstTouch(reduced_mass(robot, obj), stiffness)
    assert touch.force(speed) == pytest.approx(stiffness * compression, rel=1e-3)
    assert touch.energy(speed) == pytest.approx(0.5 * stiffness * compression ** 2, rel=2e-3)
    assert reduced_mass(math.inf, obj) == pytest.approx(reduced_mass(1e9, obj))


def test_the_speed_limit_keeps_one_limit_and_reaches_the_other() -> None:
    """Whichever is the lower."""
    touch = FirstTouch(3.0, 5e3)
    for force, energy in ((10.0, 1.0), (1000.0, 0.01)):
        speed = touch.speed_limit(force, energy)
        ratios = touch.force(speed) / force, touch.energy(speed) / energy
        assert max(ratios) == pytest.approx(1.0) and min(ratios) < 1.0
