"""A steering law of one's own: named, imported, refused with a reason, and obeyed."""

import dataclasses

from helpers.own_laws import Lost, Same
from push_control.law_names import (
    ENTRY_POINT_GROUP, law_file_name, law_name, law_title, LAWS,
)
from push_control.settings import ControlSettings
from push_control.steered.laws.own_law import import_law
from push_scenario import load_scenario, simulate
import pytest

SAME = 'helpers.own_laws:Same'
# The first seconds, in which the law steers already.
STRAIGHT_PUSH = dataclasses.replace(load_scenario('straight_push'), time_limit=4.0)


def test_a_law_that_computes_the_same_moves_everything_the_same():
    own, builtin = simulate(STRAIGHT_PUSH, Same), simulate(STRAIGHT_PUSH, 'feedback')
    assert own.tape.to_bytes() == builtin.tape.to_bytes()
    assert own.control_law == own.scenario.control.control_law == SAME


def test_a_law_that_answers_no_number_is_named():
    with pytest.raises(ValueError, match='helpers.own_laws:Lost.curvature: got nan, expected'):
        simulate(STRAIGHT_PUSH, Lost)


def test_names_lead_back_to_their_law():
    assert law_name(Same) == SAME and import_law(SAME) is Same
    assert ControlSettings(control_law=SAME).control_law == SAME


def test_an_installed_package_offers_a_law(tmp_path, monkeypatch):
    folder = tmp_path / 'other-1.0.dist-info'
    folder.mkdir()
    (folder / 'METADATA').write_text('Name: other\nVersion: 1.0\n')
    (folder / 'entry_points.txt').write_text(f'[{ENTRY_POINT_GROUP}]\nother_law = {SAME}\n')
    with pytest.raises(ValueError, match="got 'other_law', expected one of feedback, mpc"):
        ControlSettings(control_law='other_law')
    monkeypatch.syspath_prepend(str(tmp_path))
    assert import_law(ControlSettings(control_law='other_law').control_law) is Same


@pytest.mark.parametrize('name, expected', [
    ('helpers.nothing:Same', "No module named 'helpers.nothing'"),
    ('helpers.own_laws:Other', "has no attribute 'Other'"),
    ('helpers.own_laws:NO_LAW', 'which is 3.0, expected a subclass of push_control.SteeringLaw'),
    ('helpers.own_laws:math.inf', 'expected a subclass'),
    ('helpers.own_laws:Incomplete', 'without curvature, expected'),
    ('helpers.own_laws:WithoutRobot', r'made from \(robot, settings\)'),
])
def test_what_is_no_law_is_refused_before_anything_moves(name, expected):
    with pytest.raises(ValueError, match=expected):
        simulate(load_scenario('task_approach'), name)


@pytest.mark.parametrize('name', ['', 'feedbak', 'helpers', ':Same', 'helpers:', 'a b:c', 'a:b:c'])
def test_what_can_be_no_name_is_refused_by_the_settings(name):
    with pytest.raises(ValueError, match='expected one of feedback, mpc, open_loop, module:Class'):
        ControlSettings(control_law=name)


def test_classes_without_a_name_of_their_own_are_refused():
    class Local(Same):
        """Is known inside of a function only."""

    with pytest.raises(ValueError, match='expected one at the top level of a module'):
        STRAIGHT_PUSH.with_law(Local)
    with pytest.raises(ValueError, match='expected the name of a law, or a subclass'):
        STRAIGHT_PUSH.with_law(Same(None, ControlSettings()))


def test_tables_and_files_tell_laws_apart():
    names = (*LAWS, SAME, 'helpers.own_laws:Lost')
    assert [law_title(name) for name in names] == ['feedback', 'mpc', 'open loop', 'Same', 'Lost']
    assert len({law_file_name(name) for name in names}) == len(names)
    assert not any(mark in law_file_name(name) for name in names for mark in ':/ ')
