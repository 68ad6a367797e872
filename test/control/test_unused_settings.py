"""Who sets what has no effect is told so, and nobody else."""

import dataclasses

from helpers.objects import bin_, box
from helpers.push_problems import HOLONOMIC
from push_control.settings import ControlSettings, LAWS
from push_control.supervision_settings import SupervisionSettings
from push_control.unused_settings import DEFAULTS, FEEDBACK, PREDICTION, unused_settings
import pytest

DIFFERENTIAL = dataclasses.replace(HOLONOMIC, drive='differential')
# 12 cm all round: too small for a straight push.
TINY = dataclasses.replace(box(), outline=(
    (0.015, 0.015), (-0.015, 0.015), (-0.015, -0.015), (0.015, -0.015)), inertia=0.0,
    supports=tuple(dataclasses.replace(support, x=0.05 * support.x, y=0.05 * support.y)
                   for support in box().supports))


def names(control, *, obj=None, robot=HOLONOMIC, is_task=False):
    """List the settings that are found without effect."""
    unused = unused_settings(obj or box(), robot, control, SupervisionSettings(), is_task=is_task)
    return [name for item in unused for name in item.names]


@pytest.mark.parametrize('is_task', [True, False])
@pytest.mark.parametrize('robot', [HOLONOMIC, DIFFERENTIAL])
def test_defaults_are_not_complained_of(robot, is_task):
    """Whatever else is chosen: a default is not set by anybody."""
    for law in LAWS:
        found = names(ControlSettings(control_law=law), robot=robot, is_task=is_task)
        assert set(found) <= {'control_law'}


@pytest.mark.parametrize('name', [*FEEDBACK, *PREDICTION])
def test_settings_of_another_law_are_named(name):
    """A horizon without prediction, a gain in open loop; with their law they count."""
    changed = {name: DEFAULTS[name] + 1 if isinstance(DEFAULTS[name], int)
               else 1.01 * DEFAULTS[name]}
    for law in LAWS:
        is_unused = law != 'mpc' if name in PREDICTION else law == 'open_loop'
        found = names(ControlSettings(control_law=law, **changed))
        assert found == ([name] if is_unused else [])


def test_what_goes_by_drive_mode_and_other_settings_is_named():
    assert names(ControlSettings(rolling_gain=5.0)) == []
    assert names(ControlSettings(rolling_gain=5.0), robot=DIFFERENTIAL) == ['rolling_gain']
    assert names(ControlSettings(max_standstill=2.0)) == []
    assert names(ControlSettings(max_standstill=2.0, resume_after_stop='automatic')) == [
        'max_standstill']
    single = ControlSettings(position_tolerance=0.005, max_reapproaches=1)
    assert names(single) == []
    assert names(single, is_task=True) == ['position_tolerance', 'max_reapproaches']


def test_a_law_steers_no_straight_pushes():
    """In a task; an object that is too small for these is steered."""
    control = ControlSettings(control_law='mpc')
    assert names(control) == []
    assert names(control, is_task=True) == ['control_law']
    assert names(control, obj=TINY, is_task=True) == []


@pytest.mark.parametrize('is_free', [True, False])
@pytest.mark.parametrize('is_round', [True, False])
@pytest.mark.parametrize('is_task', [True, False])
def test_a_heading_tolerance_that_a_round_object_does_not_have_is_named(
        is_free: bool, is_round: bool, is_task: bool) -> None:
    """In a task, where its heading is free and the tolerance neither the default nor a circle."""
    obj = bin_() if is_round else box()
    for tolerance in (SupervisionSettings().heading_tolerance, 0.05, 6.28):
        settings = SupervisionSettings(heading_tolerance=tolerance, disc_heading_free=is_free)
        unused = unused_settings(obj, HOLONOMIC, ControlSettings(), settings, is_task=is_task)
        is_named = tolerance == 0.05 and is_free and is_round and is_task
        assert [str(item).split(':')[0] for item in unused] == (
            ['supervision.heading_tolerance'] if is_named else [])


def test_a_setting_is_named_once_with_its_parameter():
    """Where two reasons hold, with the first of them."""
    control = ControlSettings(control_law='open_loop', max_reapproaches=1, rolling_gain=5.0)
    found = unused_settings(box(), DIFFERENTIAL, control, SupervisionSettings(), is_task=True)
    assert [unused.names for unused in found] == [('rolling_gain', 'max_reapproaches'),
                                                  ('control_law',)]
    assert str(found[0]) == ('control.rolling_gain, control.max_reapproaches: set without effect, '
                             'as control.control_law is open_loop')
