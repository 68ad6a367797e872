"""Search for a root between two values."""

import math

from push_model.quasi_static import find_root
import pytest
from scipy.optimize import bisect

FUNCTIONS = {
    'straight': lambda x: 3.0 * x - 1.0,
    'bent': lambda x: math.exp(3.0 * x) - 2.0,
    'flat at the root': lambda x: (x - 0.3) ** 3,
    'a step': lambda x: math.copysign(1.0, x - 0.123),
    'a steep step': lambda x: -(x - 0.7) / math.hypot(x - 0.7, 1e-9) - 0.1 * x}


@pytest.mark.parametrize('name', FUNCTIONS)
@pytest.mark.parametrize('bounds', [(-1.0, 1.0), (-40.0, 3.0)])
def test_the_root_is_found_in_little_more_than_the_steps_of_bisection(name, bounds):
    """Wherever the function is steep or flat; it agrees with another method."""
    function, tolerance, evaluated = FUNCTIONS[name], 1e-12, []

    def counted(x):
        evaluated.append(x)
        return function(x)

    root = find_root(counted, *bounds, tolerance)
    assert root == pytest.approx(bisect(function, *bounds, xtol=1e-14), abs=2.0 * tolerance)
    assert len(evaluated) <= 3 + math.ceil(math.log2((bounds[1] - bounds[0]) / tolerance))


def test_a_smooth_function_takes_far_less_than_bisection():
    """An interpolation is enough where the function is nearly straight."""
    evaluated = []

    def nearly_straight(x):
        evaluated.append(x)
        return math.sin(x) - 0.2

    assert find_root(nearly_straight, -1.0, 1.0, 1e-13) == pytest.approx(math.asin(0.2))
    assert len(evaluated) < 15


def test_a_root_at_a_bound_counts_and_none_is_refused():
    assert find_root(lambda x: x, 0.0, 1.0, 1e-9) == find_root(lambda x: x, -1.0, 0.0, 1e-9) == 0.0
    with pytest.raises(ValueError, match='got 1 at 0 and 2 at 1, expected different signs'):
        find_root(lambda x: 1.0 + x, 0.0, 1.0, 1e-9)
