"""Push primitives: how sharply an object and a robot can turn, and how long a push takes."""

from helpers.objects import bin_, box
from helpers.push_problems import DIFFERENTIAL
from helpers.push_sequences import SETTINGS, TASK
import numpy as np
from push_model.plan_request import PlanFailure
from push_planner.collocation.speed_profile import push_time
from push_planner.problem import PlanningFailed
from push_planner.sequence.primitives import primitive_table
from push_planner.settings import PlannerSettings, TaskSettings
import pytest


def test_radii_are_in_proportion_to_the_radius_factor():
    """A differential drive has one primitive to each side of a vertex."""
    tables = [primitive_table(box(), DIFFERENTIAL, SETTINGS, TaskSettings(radius_factor=factor),
                              0.0) for factor in (1.0, 2.0)]
    assert tables[1].radii == pytest.approx(2.0 * tables[0].radii)
    assert len(tables[0].primitives) == 8
    assert sorted(tables[0].sides) == [-1.0] * 4 + [1.0] * 4


def test_an_object_without_feasible_site_has_none():
    with pytest.raises(PlanningFailed, match='no feasible contact site.*not supported') as failure:
        primitive_table(bin_(), DIFFERENTIAL, SETTINGS, TASK, 0.0)
    assert failure.value.code is PlanFailure.NO_FEASIBLE_SITE


@pytest.mark.parametrize('settings', [SETTINGS, PlannerSettings(acceleration=0.2),
                                      PlannerSettings(deceleration=0.0)])
def test_the_time_of_a_push_is_that_of_its_speed(settings):
    """Between that at full speed and at the slowest, and the same for every further metre."""
    times = [push_time(settings, length) for length in (1.0, 2.0, 3.0)]
    assert np.diff(times) == pytest.approx(1.0 / settings.pushing_speed)
    assert 1.0 / settings.pushing_speed <= times[0] < 1.0 / settings.end_speed
    assert (times[0] == pytest.approx(1.0 / 0.15)) == (settings.deceleration == 0.0)
