"""What a push may take of floor, length and time, as its plan needed it."""

import math

from helpers.contact_sites import arc_trajectory, FACE
from helpers.objects import box
import numpy as np
from push_control.settings import ControlSettings
from push_control.steered.plan_bounds import (
    DEVIATION_RATIO, LENGTH_MARGIN_RATIO, PlanBounds, planned_length, STALL_TIME)
from push_model.events import PushEvent
import pytest

OBJECT = box(foot=0.18)
TARGET = arc_trajectory(OBJECT, FACE, 0.3, 2.0)
PERIOD = 0.02


def make_bounds(**settings):
    """Take the bounds of a push along an arc."""
    return PlanBounds(TARGET, OBJECT.size, ControlSettings(**settings))


def beside(distance, sample=20):
    """Place the object to the left of its planned path."""
    x, y, _ = TARGET.object_poses[sample]
    along = np.diff(TARGET.object_poses[sample - 1:sample + 2:2, :2], axis=0)[0]
    normal = np.array((-along[1], along[0])) / math.hypot(*along)
    return (x, y) + distance * normal


@pytest.mark.parametrize('setting, limit', [(0.4, 0.4), (0.0, DEVIATION_RATIO * OBJECT.size)])
@pytest.mark.parametrize('side', [-1.0, 1.0])
def test_the_floor_is_what_the_plan_needs_and_a_margin(setting, limit, side):
    """The margin is that of the settings, or some sizes of the object; to either side alike."""
    bounds = make_bounds(max_path_deviation=setting)
    inside, outside = beside(side * 0.98 * limit), beside(side * 1.02 * limit)
    assert bounds.check(inside, 0.0, 2.0, PERIOD) is None
    event = bounds.check(outside, 0.0, 2.0, PERIOD)
    assert event is not None and event.code is PushEvent.LEFT_FLOOR
    assert event.values['limit'] == limit < event.values['deviation']
    assert bounds.is_on_floor(np.array([beside(0.0), inside]))
    assert not bounds.is_on_floor(np.array([beside(0.0), inside, outside]))


@pytest.mark.parametrize('ratio', [1.0, 3.0])
def test_the_length_is_a_multiple_of_the_planned_one_and_a_margin(ratio):
    """Whatever remains of the present path."""
    bounds = make_bounds(max_length_ratio=ratio)
    limit = ratio * planned_length(TARGET) + LENGTH_MARGIN_RATIO * OBJECT.size
    assert bounds.max_length == pytest.approx(limit)
    assert bounds.check(beside(0.0), limit - 0.01, 0.5, PERIOD) is None
    event = bounds.check(beside(0.0), limit + 0.01, 0.4, PERIOD)
    assert event is not None and event.code is PushEvent.PATH_TOO_LONG


def test_a_push_that_comes_nearer_goes_on_however_slowly():
    """A micrometre at a time."""
    bounds = make_bounds()
    for k in range(5000):
        assert bounds.check(beside(0.0), 1e-6 * k, 2.0 - 1e-6 * k, PERIOD) is None


@pytest.mark.parametrize('speed', [0.0, 0.15])
def test_a_push_that_comes_no_nearer_ends_after_some_way_or_time(speed):
    """As where it goes round in circles, or stands."""
    bounds, event, count = make_bounds(), None, 0
    while event is None:
        event = bounds.check(beside(0.0), speed * PERIOD * count, 1.0, PERIOD)
        count += 1
        assert count < 2000
    assert event.code is PushEvent.NO_PROGRESS
    assert (count * PERIOD > STALL_TIME) is (speed == 0.0)
    bounds.restart()
    assert bounds.check(beside(0.0), speed * PERIOD * count, 1.5, PERIOD) is None
