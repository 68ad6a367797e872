"""Quasi-static yaw rates and the object as a vehicle, on supports and by the ellipsoid."""

import math

from helpers.objects import box
import numpy as np
from push_model.friction import c_squared, friction_center
from push_model.quasi_static import (
    compare_yaw_rates, ellipsoid_yaw_rate, quasi_static_yaw_rate, vehicle,
)
import pytest

pytestmark = pytest.mark.physics


def test_square_pushed_at_mid_face_has_a_wheelbase_of_its_side():
    assert vehicle(box(), (-0.2, 0.0)).wheelbase == pytest.approx(0.4)


def test_ellipsoid_rotates_a_square_by_a_third_less_than_its_supports_do():
    """Wheelbase l on the supports, 1.5 l by the ellipsoid: rotation goes as 1 / wheelbase."""
    near, far = compare_yaw_rates(box(), (-0.2, 0.0), (1e-4, 1.5))
    for found, wheelbase in zip(near[1:], (0.4, 0.4, 0.6)):
        assert -1e-4 / found == pytest.approx(wheelbase, rel=1e-3)
    assert 0.85 < far.ellipsoid / far.supports < 0.95
    assert far.near_straight / far.supports > 1.3


@pytest.mark.parametrize('seed', range(4))
def test_ellipsoid_with_c_squared_meets_the_supports_near_straight(seed):
    rng = np.random.default_rng(seed)
    obj = box(friction=rng.uniform(0.1, 0.5, 4))
    point = (-0.2, -0.2)
    view = vehicle(obj, point)
    for small in (1e-3, 2e-3):
        v_x, v_y = math.cos(view.angle + small), math.sin(view.angle + small)
        f_x, f_y = friction_center(obj)
        omega = ellipsoid_yaw_rate(c_squared(obj, view.angle), point[0] - f_x,
                                   point[1] - f_y, v_x, v_y)
        true = quasi_static_yaw_rate(obj, point, v_x, v_y)
        assert omega == pytest.approx(true, rel=20 * small)
        z_x, z_y = view.flat_output[0] - point[0], view.flat_output[1] - point[1]
        sideways = (-(v_x - true * z_y) * math.sin(view.angle)
                    + (v_y + true * z_x) * math.cos(view.angle))
        assert abs(sideways) < 0.02 * small


def test_yaw_rate_is_isotropic_in_speed_and_zero_at_rest():
    slow, fast = (quasi_static_yaw_rate(box(), (-0.2, 0.0), v, 0.3 * v) for v in (0.01, 1.0))
    assert fast == pytest.approx(100 * slow, rel=1e-6)
    assert quasi_static_yaw_rate(box(), (-0.2, 0.0), 0.0, 0.0) == 0.0
    with pytest.raises(ValueError, match='the centre of friction'):
        vehicle(box(), (0.0, 0.0))
