"""The prototype of a box on casters: without them it is the model, and wheels follow the push."""

import math

from benchmarks.plant.casters import (
    Cart, CASTERS, CONTACT, feedback_error, FRICTION, hold, INERTIA, MASS, OMEGA, SPEED,
    start_state, SUPPORTS, SWIVELS, TRAIL,
)
import numpy as np
from push_model.parameters import PushedObject, Support
from push_model.quasi_static import quasi_static_yaw_rate
import pytest

SQUARE = ((-0.2, -0.2), (0.2, -0.2), (0.2, 0.2), (-0.2, 0.2))


def test_without_casters_the_box_turns_as_the_model_says():
    """The inertia of a push at 0.15 m/s takes less than 3 of 100 from the quasi-static rate."""
    obj = PushedObject(MASS, INERTIA, outline=SQUARE, supports=tuple(
        Support(x, y, FRICTION) for x, y in SUPPORTS.tolist()))
    rho = 0.2
    end = Cart(()).push(1.0, hold, start_state(rho))[:, -1]
    expected = quasi_static_yaw_rate(obj, (float(CONTACT[0]), float(CONTACT[1])),
                                     SPEED * math.cos(rho), SPEED * math.sin(rho))
    assert 0.97 < end[OMEGA] / expected < 1.0


def test_a_wheel_swings_behind_its_swivel_within_a_few_trails():
    """On a straight push psi' = -v sin(psi) / t: tan(psi / 2) falls by e for each trail."""
    swivels = np.array([0.0, 1.0, 0.0, 0.0])
    distance = 3.0 * TRAIL
    end = Cart((1, 2)).push(distance, hold, start_state(swivels=swivels))[:, -1]
    ideal = 2.0 * math.atan(math.tan(0.5) * math.exp(-3.0))
    assert end[SWIVELS][1] == pytest.approx(ideal, abs=0.05)


def test_feedback_bears_casters_that_stand_ahead():
    for name in CASTERS:
        aside, heading = feedback_error(name, 2.0, None)
        assert aside < 5.0 and heading < 0.5, name
