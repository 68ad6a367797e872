"""The verdict on runs with faults can fail: each thing that is not as it should be, by itself."""

import math

from benchmarks.faults.expectations import (
    expectation_of, EXPECTATIONS, MAX_DEVIATION, MAX_DRIVEN, MAX_STOP_TIME)
from benchmarks.faults.injection import Fault, Input, SentCommand, Word, words_of
from benchmarks.faults.node_rig import end_of_run
from benchmarks.faults.row import Ending
from benchmarks.faults.simulated import Record, Simulated
from benchmarks.faults.verdict import evaluate, Verdict, Violation
import numpy as np
from push_model.geometry import FloatArray
from push_model.signals import STOP, Twist
from push_safety.status import SafetyReason
from push_scenario.definition.loader import load_scenario
from push_sim_node.tape import Tape
import pytest

SCENARIO = load_scenario('task_tap')
FAULT = Fault(Input.ODOMETRY, Word.STUCK, 2.0, math.inf)
REASON = str(SafetyReason.ODOMETRY_FROZEN)
END, SETTLED = 5.0, 6.0
TIMES = np.arange(0.0, SETTLED, 0.02)
DRIVES = Twist(0.1, 0.0, 0.0)
COLUMNS = ('time', 'object_x', 'object_y', 'object_theta', 'robot_x', 'robot_y', 'robot_theta',
           'robot_v_x', 'robot_v_y', 'robot_omega')


def evaluated(*, fault: Fault = FAULT, ending: Ending = Ending.FAILED,
              codes: tuple[str, ...] = (REASON,), stop_time: float = 2.2, speed: float = 0.1,
              final: Twist = STOP, brake: float = 0.0, final_speed: float = 0.0, off: float = 0.0,
              heading_off: float = 0.0, moved: float = 0.0) -> Verdict:
    """
    Evaluate a run that is ok but for what is given.

    :param stop_time: when the robot commands zero for the first time [s].
    :param speed: of the robot until then [m/s].
    :param final: commanded after the end, for ``brake`` at first [s] and zero then, or for good
        where that is 0.
    :param final_speed: of the robot in truth after the end [m/s].
    :param off: of the object from its goal at the end [m], and ``heading_off`` its heading [rad].
    :param moved: distance of the object from its plans while the run lasts [m].
    """
    velocity = np.where(TIMES < stop_time, speed, np.where(TIMES > END, final_speed, 0.0))
    goal, zeros = SCENARIO.final_goal, np.zeros_like(TIMES)
    object_y = np.where((TIMES > 3.0) & (TIMES < 4.0), moved, 0.0) + goal.y
    rows: FloatArray = np.column_stack((
        TIMES, zeros + goal.x + off, object_y, zeros + goal.theta + heading_off,
        0.02 * np.cumsum(velocity) - 1.0, zeros, zeros, velocity, zeros, zeros)).astype(float)
    final_end = END + brake if brake else math.inf
    sent = [SentCommand(time, DRIVES if time < stop_time else final if END < time <= final_end
                        else STOP) for time in TIMES.tolist()]
    record = Record(SCENARIO, Tape(COLUMNS, rows), [], sent, END)
    return evaluate(fault, Simulated(record, ending, 'banana', codes))


@pytest.mark.parametrize('ending', [Ending.FAILED, Ending.WAITS])
def test_a_run_that_stops_for_the_fault_is_ok(ending: Ending) -> None:
    """And so is one that is done in truth; its stop is measured from the fault on."""
    verdict = evaluated(ending=ending)
    assert not verdict.violations
    assert verdict.stop.duration == pytest.approx(0.2, abs=0.021)
    assert verdict.stop.driven == pytest.approx(0.02, abs=0.003)
    assert not evaluated(ending=Ending.DONE, codes=()).violations


@pytest.mark.parametrize('codes', [
    (), ('banana',), ('TaskEvent.ABORTED',), ('TaskEvent.ABORTED', 'SafetyReason.FOLLOWS_LATE'),
    ('PushEvent.OBJECT_POSE_STALE',)])
@pytest.mark.parametrize('ending', [Ending.FAILED, Ending.WAITS])
def test_a_reason_that_names_something_else_is_wrong(codes: tuple[str, ...],
                                                     ending: Ending) -> None:
    """However it is worded; further codes beside the right one do no harm."""
    assert evaluated(codes=codes, ending=ending).violations == (Violation.WRONG_REASON,)
    assert not evaluated(codes=(*codes, REASON), ending=ending).violations


@pytest.mark.parametrize('ending', list(Ending))
def test_a_run_whose_robot_drives_in_the_end_is_not_ok(ending: Ending) -> None:
    """By its commands or in truth; a base that others drive counts by the commands alone."""
    assert evaluated(ending=ending, final=DRIVES).violations == (Violation.STILL_DRIVES,)
    assert evaluated(ending=ending, final_speed=0.3).violations == (Violation.STILL_DRIVES,)
    others = Fault(Input.COMMAND, Word.SHARED, 2.0, math.inf)
    codes = (str(SafetyReason.MOVES_OTHERWISE),)
    assert Violation.STILL_DRIVES not in evaluated(
        fault=others, ending=ending, codes=codes, final_speed=0.3).violations
    assert Violation.STILL_DRIVES in evaluated(
        fault=others, ending=ending, codes=codes, final=DRIVES).violations


def test_a_robot_may_brake_in_the_end_but_not_drive_on() -> None:
    """As a weak base; zero comes at last."""
    for ending in (Ending.DONE, Ending.FAILED):
        assert not evaluated(ending=ending, final=DRIVES, brake=0.5).violations
        fast = Twist(0.38, 0.0, 0.0)
        assert evaluated(ending=ending, final=fast, brake=0.5).violations == (
            Violation.STILL_DRIVES,)
    assert evaluated(ending=Ending.WAITS, final=DRIVES, brake=0.1).violations == (
        Violation.STILL_DRIVES,)


def test_a_robot_that_waits_has_stood_for_a_second() -> None:
    """One that stops just before the end may start again."""
    violations = evaluated(ending=Ending.WAITS, stop_time=END - 0.5).violations
    assert Violation.STILL_DRIVES in violations


@pytest.mark.parametrize('stop_time, violation', [
    (2.0 + MAX_STOP_TIME + 0.03, Violation.STOPS_LATE), (math.inf, Violation.NEVER_STOPS)])
def test_a_robot_that_stops_late_or_never_is_not_ok(stop_time: float,
                                                    violation: Violation) -> None:
    """Be it slow."""
    assert violation in evaluated(stop_time=stop_time, speed=0.0).violations


def test_a_robot_that_drives_far_is_not_ok() -> None:
    """Be it soon."""
    assert evaluated(speed=0.15).violations == ()
    assert evaluated(speed=1.2 * MAX_DRIVEN / 0.2).violations == (Violation.DRIVES_FAR,)


@pytest.mark.parametrize('distance', [1.01 * MAX_DEVIATION, 5.0, 20.0])
def test_an_object_that_is_moved_elsewhere_is_not_ok(distance: float) -> None:
    """Also where it comes back."""
    assert evaluated(moved=distance).violations == (Violation.OBJECT_MOVED,)
    assert not evaluated(moved=0.9 * MAX_DEVIATION).violations


@pytest.mark.parametrize('off, heading_off', [(0.03, 0.0), (5.0, 0.0), (0.0, 0.1), (0.0, -3.0)])
def test_what_is_reported_as_done_is_at_its_goal(off: float, heading_off: float) -> None:
    """Position and heading, in truth."""
    verdict = evaluated(ending=Ending.DONE, codes=(), off=off, heading_off=heading_off)
    assert verdict.violations == (Violation.NOT_AT_GOAL,)


def test_every_fault_has_an_expectation() -> None:
    """With bounds; where they are not the common ones it says why."""
    faults = {(kind, word) for kind in Input for word in words_of(kind)}
    assert faults == EXPECTATIONS.keys()
    for fault, expectation in EXPECTATIONS.items():
        assert expectation.reasons, fault
        assert expectation.deviation <= 1.0, fault
        is_common = (expectation.must_stop and expectation.stop_time == MAX_STOP_TIME
                     and expectation.driven == MAX_DRIVEN
                     and expectation.deviation == MAX_DEVIATION)
        assert is_common is not bool(expectation.note), fault
    assert expectation_of(FAULT) is EXPECTATIONS[FAULT.input, FAULT.word]


def test_a_run_ends_where_its_ending_lasts() -> None:
    """One that begins again, or waits, goes on to its limit."""
    end = 60.0
    for now, has_ended, expected in ((4.0, False, 60.0), (4.8, True, 4.8), (5.0, True, 4.8),
                                     (5.1, False, 60.0), (7.0, True, 7.0), (8.0, True, 7.0)):
        end = end_of_run(end, now, 60.0, has_ended=has_ended)
        assert end == expected
