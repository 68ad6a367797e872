"""Constants that a benchmark changes: all that use them see it, and only then."""

from benchmarks.tasks.constants import Constant, CONSTANTS, replaced, value_of
from push_scenario.dds import result
from push_scenario.simulation import loop
import pytest


@pytest.mark.parametrize('constant', CONSTANTS, ids=lambda constant: constant.name)
def test_a_constant_is_replaced_and_put_back(constant: Constant) -> None:
    """Each that is listed exists, and is a positive number."""
    original = value_of(constant)
    assert original > 0.0
    with replaced(constant, 2.0 * original):
        assert value_of(constant) == 2.0 * original
    assert value_of(constant) is original


def test_a_module_that_imports_a_constant_sees_the_other_value() -> None:
    """Also where an error ends the run."""
    constant = Constant('push_scenario.simulation.loop', 'REST_SPEED', 'm/s', '')
    original = loop.REST_SPEED
    assert result.REST_SPEED is original
    with pytest.raises(ZeroDivisionError), replaced(constant, 1.0):
        assert result.REST_SPEED == 1.0
        raise ZeroDivisionError
    assert result.REST_SPEED is loop.REST_SPEED is original
