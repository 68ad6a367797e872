"""The table that a replay prints."""

import dataclasses
import math
import re

from helpers.tapes import make_result, make_tape, straight_plan, TIMES
from push_scenario.definition.loader import load_scenario
from push_scenario.evaluation.headline import headline
from push_scenario.evaluation.report import format_report, GREEN, PLAIN, RED
from push_scenario.simulation.result import Outcome, RunResult
import pytest


def runs():
    """Two runs: one that misses by 30 mm, one that arrives."""
    near = make_tape(object_x=0.2 * TIMES, robot_x=0.2 * TIMES, mode=1)
    far = make_tape(object_x=0.203 * TIMES, robot_x=0.2 * TIMES, object_theta=0.1, mode=1)
    for law, tape in (('open_loop', far), ('feedback', near)):
        result = make_result(tape, straight_plan(), (2.0, 0.0, 0.0))
        yield dataclasses.replace(result, control_law=law)


def cells(text, title):
    """Cells behind a row's title."""
    line = next(line for line in text.splitlines() if line.startswith(title))
    return re.split(r' {2,}', line.strip())[1:]


def test_rows_show_both_runs_and_the_bound():
    text = format_report(list(runs()))
    assert cells(text, 'final position error') == ['[mm]', '30.0', '0.0', '10.0']
    assert cells(text, 'final heading error') == ['[deg]', '+5.73', '+0.00', '1.50']
    assert cells(text, 'path length against the plan') == ['[%]', '100.0', '100.0']
    assert cells(text, 'time in contact') == ['[s]', '10.00', '10.00']
    assert cells(text, 'within bounds') == ['no', 'yes']


def test_columns_are_aligned():
    lines = format_report(list(runs())).split('\n\n')[1].splitlines()
    header = lines[0]
    ends = [header.index('open loop') + len('open loop'),
            header.index('feedback') + len('feedback')]
    rows = [line for line in lines[2:] if not line.startswith('open loop:')]
    assert rows[-1].startswith('outcome')
    for line in rows:
        for end in ends:
            assert line[end - 1] != ' ' and line[end:end + 1] in ('', ' ')


def test_a_run_that_is_done_elsewhere_has_missed():
    """By how much, and what the bound is; one that arrives is done."""
    text = format_report(list(runs()))
    assert cells(text, 'outcome') == ['missed', 'done']
    assert text.splitlines()[-2:] == [
        'open loop: missed, position error 30.0 mm, bound 10.0 mm',
        'open loop: missed, heading error +5.73 deg, bound 1.50 deg']


def test_a_refusal_is_reported_with_its_reason():
    scenario = load_scenario('unreachable_goal')
    text = format_report([RunResult(scenario, 'feedback', Outcome.REFUSED, 'it is too far')])
    assert text.splitlines()[0] == 'REFUSED, as expected: it is too far'
    assert text.endswith('feedback: it is too far')


def test_a_row_without_a_value_is_left_out():
    """Nothing moved after a refusal; a plan that was replaced compares with no path."""
    scenario = load_scenario('unreachable_goal')
    refused = format_report([RunResult(scenario, 'feedback', Outcome.REFUSED, 'it is too far')])
    assert 'final position error' not in refused and 'outcome' in refused
    arrived = list(runs())[1]
    without_contact = dataclasses.replace(arrived, duration=math.inf)
    assert '\ntime  ' in format_report([arrived])
    assert '\ntime  ' not in format_report([without_contact])


def test_the_report_begins_with_how_each_run_ended():
    """In at most 80 columns, with what the scenario allows."""
    late, arrived = runs()
    first = format_report([late, arrived]).split('\n\n')[0]
    assert ' '.join(first.split()) == (
        'open loop: MISSED in 9.0 s: 30.0 mm and 5.73 degrees from the goal, allowed 10 mm and '
        '1.5 degrees feedback: DONE in 9.0 s: 0.0 mm and 0.00 degrees from the goal, allowed 10 '
        'mm and 1.5 degrees')
    assert max(map(len, first.splitlines())) <= 80
    assert headline(arrived) in ' '.join(format_report([arrived]).split())


def test_a_degree_is_one():
    scenario = load_scenario('task_demo')
    result = dataclasses.replace(list(runs())[1], scenario=scenario)
    assert headline(result).endswith('allowed 10 mm and 1 degree')


def test_what_ended_as_expected_is_green_and_the_rest_is_red():
    late, arrived = runs()
    text = format_report([late, arrived], is_colored=True)
    assert text.startswith(RED + 'open loop: ') and GREEN + 'feedback: ' in text
    assert PLAIN not in format_report([late, arrived])


def test_a_result_without_its_parts_is_refused():
    scenario = load_scenario('unreachable_goal')
    with pytest.raises(ValueError, match='RunResult.tape: got None'):
        RunResult(scenario, 'feedback', Outcome.DONE)
