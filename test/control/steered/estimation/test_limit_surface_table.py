"""The table of the supports against the supports themselves."""

import math

from helpers.objects import bin_, box
from push_control.steered.estimation.limit_surface_table import LimitSurfaceTable
from push_model.quasi_static import quasi_static_yaw_rate, vehicle
import pytest

CORNER = (-0.2, -0.2)
FACE = (-0.2, 0.0)


@pytest.mark.parametrize('obj, point', [(box(foot=0.18), CORNER), (box(foot=0.18), FACE),
                                        (bin_(), (-0.2, 0.0))])
@pytest.mark.parametrize('alpha', [-0.73, -0.2, 0.04, 0.55])
def test_the_table_turns_as_the_supports_do(obj, point, alpha):
    """Interpolated c^2 gives the turning rate of the supports to a percent."""
    flat, table = vehicle(obj, point), LimitSurfaceTable(obj, point)
    push = math.cos(flat.angle + alpha), math.sin(flat.angle + alpha)
    omega = quasi_static_yaw_rate(obj, point, *push)
    turned = -flat.arm * math.sin(alpha) / (table.c_squared(alpha) + flat.arm ** 2)
    assert turned == pytest.approx(omega, rel=0.01)
    curvature = omega / math.cos(alpha)
    assert table.push_angle(flat, curvature) == pytest.approx(alpha, abs=0.01)
