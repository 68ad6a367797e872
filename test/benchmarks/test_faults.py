"""A part of the campaign of faults: every run ends as it should."""

import math

from benchmarks.faults.campaign import Case, draw, LIDAR_SCENARIO, run, SCENARIOS
from benchmarks.faults.commands import Finished, MAX_LENGTH
from benchmarks.faults.injection import (
    Fault, IN_PROCESS, Injection, Input, Word, words_of,
)
from benchmarks.faults.process_rig import (
    append_process_row, MOVING, process_faults, ProcessRow, read_process_rows, TaskMonitor,
)
from benchmarks.faults.random_faults import (
    append_random_row, CATALOGUE, draw_case, GIVEN_UP, LONGEST, RandomRow, read_random_rows,
    run_many, share_reason, SHORTEST, SORTS,
)
from benchmarks.faults.report import Findings, table, write_report
from benchmarks.faults.row import append_line, Ending, Row
from benchmarks.faults.simulated import simulated_record
from benchmarks.faults.soak import append_task, read_tasks, Sample, SoakTask
from benchmarks.faults.surroundings import read_surroundings, SurroundingsRow
from benchmarks.faults.verdict import deviation
from nav_msgs.msg import Odometry
from push_control.task.status import TaskState
from push_scenario.definition.loader import load_scenario
import pytest
from rclpy.serialization import serialize_message

pytestmark = pytest.mark.slow
PUSH, TASK = 'curved_push', 'task_tap'
# Greatest distance driven after the beginning of a fault that shows at once [m]: 0.3 s of a push.
STOPPING_DISTANCE = 0.05


@pytest.mark.parametrize('kind, word, text', [
    (Input.COMMAND, Word.OFF, 'the base did not move for'),
    (Input.COMMAND, Word.WRONG, 'commanded'),
    (Input.ODOMETRY, Word.WRONG, 'its heading and its twist mean'),
    (Input.ODOMETRY, Word.STUCK, 'odometry repeats one pose'),
    (Input.ODOMETRY, Word.OFF, 'odometry is stale'),
    (Input.POSE, Word.STUCK, 'the tracker is frozen'),
    (Input.POSE, Word.GARBAGE, 'object pose jumps by'),
    (Input.POSE, Word.SLOW, 'object poses come late'),
    (Input.POSE, Word.NEAR_TIMEOUT, 'object poses come late'),
    (Input.POSE, Word.OFF, 'object pose is stale')])
def test_a_push_ends_stopped_and_named(kind, word, text):
    """With a fault that lasts."""
    row = run(Case(PUSH, Fault(kind, word, 4.0, math.inf)), time_after=22.0)
    assert row.is_ok and row.ending is not Ending.DONE
    assert text in row.reason
    # As far as a pose may be old that is still used, besides.
    assert row.driven < STOPPING_DISTANCE + (0.04 if kind is Input.POSE else 0.0)


def test_a_base_that_keeps_a_command_is_stopped_once_it_should_do_something_else():
    """What it gets anyway is no fault, and no time counts until then."""
    fault = Fault(Input.COMMAND, Word.STUCK, 5.22, math.inf)
    row = run(Case(PUSH, fault), time_after=10.0)
    assert row.ending is Ending.WAITS and row.stop_time < 2.0 and row.driven < 0.25


@pytest.mark.parametrize('word', [Word.WRONG, Word.MIRRORED, Word.NOISY])
def test_a_push_whose_object_seems_elsewhere_waits_for_it(word: Word) -> None:
    """It goes on where that is over within two seconds, and names it where it is not."""
    row = run(Case(PUSH, Fault(Input.POSE, word, 5.0, 7.0)))
    assert row.ending is Ending.DONE and row.is_ok and row.driven < STOPPING_DISTANCE
    row = run(Case(PUSH, Fault(Input.POSE, word, 5.0, math.inf)), time_after=40.0)
    assert row.ending is Ending.FAILED and row.is_ok and row.driven < STOPPING_DISTANCE
    assert 'object poses d' in row.reason


def test_what_a_base_does_to_the_object_after_the_stop_does_not_count() -> None:
    """As long as somebody else commands it; until then, and in a run without a stop, it does."""
    fault = Fault(Input.COMMAND, Word.SHARED, 1.06, math.inf)
    record = simulated_record(load_scenario(TASK), [Injection(fault)], 12.0).record
    row = run(Case(TASK, fault), time_after=10.94)
    assert 0.0 < row.stop_time < 1.5 and row.deviation < 0.1
    assert deviation(record, fault, math.nan) > 0.4


@pytest.mark.parametrize('start, first', [(0.0, 0.0), (0.2, 1.0), (3.39, 4.0), (3.9, 4.0)])
def test_an_intermittent_input_is_faulty_from_its_first_gap(start: float, first: float) -> None:
    """One that has begun before is shorter."""
    fault = Fault(Input.ODOMETRY, Word.INTERMITTENT, start, start + 2.0)
    assert fault.first_gap == pytest.approx(first)


@pytest.mark.parametrize('kind, word', [
    (Input.ODOMETRY, Word.STUCK), (Input.ODOMETRY, Word.IN_WORLD_AXES),
    (Input.COMMAND, Word.OFF), (Input.POSE, Word.GARBAGE), (Input.POSE, Word.OF_ANOTHER_OBJECT)])
def test_a_task_goes_on_after_a_fault(kind, word):
    """Until it is done."""
    row = run(Case(TASK, Fault(kind, word, 1.0, 2.0)))
    assert row.ending is Ending.DONE and row.is_ok


def test_a_task_gives_up_where_a_fault_stays():
    """And names it."""
    row = run(Case(TASK, Fault(Input.POSE, Word.INTERMITTENT, 1.2, math.inf)))
    assert row.ending is Ending.FAILED and row.is_ok
    assert 'object poses come late' in row.reason


def test_a_task_whose_base_stays_away_waits_for_somebody():
    """And says what for."""
    row = run(Case(TASK, Fault(Input.COMMAND, Word.OFF, 1.2, math.inf)), time_after=15.0)
    assert row.ending is Ending.WAITS and row.is_ok
    assert 'call controller/resume' in row.reason


@pytest.mark.parametrize('word', [Word.OF_ANOTHER_OBJECT, Word.MIRRORED, Word.OF_THE_ROBOT])
def test_a_task_whose_tracker_shows_something_else_is_given_up_and_named(word: Word) -> None:
    """After some contacts that do not fit: the robot does not try for minutes."""
    fault = Fault(Input.POSE, word, 0.0, math.inf)
    found = simulated_record(load_scenario(TASK), [Injection(fault)], 100.0)
    assert found.ending is Ending.FAILED and found.record.tape['time'][-1] < 60.0
    assert ': they are of another object or of the robot, mirrored' in found.reason


@pytest.mark.slow
def test_an_object_that_is_touched_elsewhere_is_not_first_of_all_too_heavy() -> None:
    """Poses that are mirrored during the first push: wheels that spin come second."""
    fault = Fault(Input.POSE, Word.MIRRORED, 8.0, math.inf)
    mirrored = simulated_record(load_scenario('task_demo'), [Injection(fault)], 100.0)
    assert mirrored.ending is Ending.FAILED
    assert mirrored.codes.index('PerceptionEvent.POSES_ELSEWHERE') < (
        mirrored.codes.index('BehaviorFailure.WHEELS_SPIN'))


@pytest.mark.parametrize('word, start', [(Word.LIFTED, 2.5), (Word.RESTARTED, 0.5)])
def test_an_object_for_a_robot_that_is_elsewhere_is_not_only_too_heavy(
        word: Word, start: float) -> None:
    """Nobody can tell: both are named."""
    row = run(Case(TASK, Fault(Input.ODOMETRY, word, start, math.inf)), time_after=40.0)
    assert row.ending is Ending.FAILED and row.is_ok


@pytest.mark.parametrize('scenario', [PUSH, TASK])
def test_outliers_cost_nothing(scenario):
    """However long there are some."""
    row = run(Case(scenario, Fault(Input.POSE, Word.OUTLIERS, 0.5, math.inf)), time_after=40.0)
    assert row.ending is Ending.DONE and row.is_ok


def test_every_word_is_drawn_for_every_input():
    """And has a line in the table, unless each run was done."""
    drawn = draw([PUSH, TASK], seed=1, count=2)
    # For both scenarios, moments and durations; a robot is lifted for good.
    words = {kind: len(words_of(kind)) for kind in Input}
    assert len(drawn) == (
        4 * (sum(words.values()) + sum(words[kind] for kind in IN_PROCESS)) - 4)
    assert draw([PUSH, TASK], seed=1, count=2) == drawn
    row = run(Case(PUSH, Fault(Input.POSE, Word.SLOW, 1.0, 1.5)), time_after=1.0)
    lines = table([row._replace(fault=case.fault) for case in drawn]).splitlines()
    assert len(lines) == 2 + 2 * sum(words.values()) - 1
    done = row._replace(ending=Ending.DONE, violations=())
    assert len(table([done]).splitlines()) == 2
    assert len(table([done, done._replace(violations=('NOT_AT_GOAL',))]).splitlines()) == 3


def test_only_the_scenarios_that_are_asked_for_are_drawn() -> None:
    """All that happens to a robot with a lidar is that it is lifted."""
    for scenarios in ([PUSH], [TASK, LIDAR_SCENARIO], SCENARIOS):
        assert {case.scenario for case in draw(scenarios, 1, 1)} == set(scenarios)
    assert [case.fault.word for case in draw([LIDAR_SCENARIO], 1, 2)] == [Word.LIFTED] * 2


def _odometry(speed: float) -> bytes:
    message = Odometry()
    message.twist.twist.linear.x = speed
    return serialize_message(message)


@pytest.mark.parametrize('state', MOVING)
def test_a_state_in_which_the_robot_moves_is_reached_once_it_drives(state: TaskState) -> None:
    """Where it plans, there is nothing to wait for."""
    monitor = TaskMonitor()
    monitor.state = state
    assert not monitor.has_reached(state)
    monitor.on_message('odom', _odometry(0.1))
    monitor.watch()
    assert monitor.has_reached(state) and math.isnan(monitor.stood_at)
    assert not monitor.has_reached(TaskState.PLAN)
    monitor.on_message('odom', _odometry(0.0))
    assert not monitor.has_reached(state) and monitor.stood_at >= monitor.changed_at
    monitor.state = TaskState.PLAN
    assert monitor.has_reached(TaskState.PLAN)


def test_commands_that_no_longer_come_are_a_gap_too() -> None:
    """It grows, and is kept until somebody watches anew."""
    monitor = TaskMonitor()
    monitor.state = TaskState.PUSH
    assert monitor.command_gap == 0.0
    monitor.on_message('cmd_vel', b'')
    first, gap = monitor.command_gap, max(monitor.command_gap for _ in range(1000))
    assert gap > first
    monitor.on_message('cmd_vel', b'')
    assert monitor.command_gap >= gap > 0.0
    monitor.state = TaskState.DONE
    assert monitor.command_gap >= gap
    monitor.watch()
    assert monitor.command_gap == 0.0


def test_two_runs_that_are_given_up_share_no_reason_by_that_alone() -> None:
    """What they are given up for counts."""
    given_up = ('TaskEvent.ABORTED_AFTER', 'TaskEvent.ABORTED', 'TaskEvent.ABORTED_INCONSISTENT')
    assert GIVEN_UP == set(given_up)
    assert not share_reason(given_up, given_up) and not share_reason((), ())
    assert not share_reason((*given_up, 'SafetyReason.NOT_MOVING'),
                            (*given_up, 'BehaviorFailure.STALLED'))
    assert share_reason((*given_up, 'SafetyReason.NOT_MOVING'), ('SafetyReason.NOT_MOVING',))


def test_what_is_told_of_a_line_ends_with_a_word() -> None:
    """And says that there is more."""
    lines = [' '.join(['word'] * count) for count in (1, MAX_LENGTH)]
    short, long = (Finished(0, line, 0).observation(0).seen for line in lines)
    assert short == 'word'
    assert len(long) <= MAX_LENGTH and set(long.split()) == {'word', '...'}


def test_the_report_has_everything(tmp_path):
    """Runs, stops, processes and the soak; numbers that were not measured leave no hole."""
    fault = Fault(Input.POSE, Word.OFF, 1.0, math.inf)
    row = Row(PUSH, fault, Ending.FAILED, 'object pose is stale', (), (), 0.2, 0.03, 0.0)
    process = ProcessRow(process_faults()[0], Ending.WAITS, 'waits for a goal', (),
                         ('STILL_DRIVES',), math.nan)
    node = Sample(100.0, 18, 15, 0.5)
    task = SoakTask(True, '', 5.0, 2.0, {'push_sim': node}, 0.1)
    path = tmp_path / 'faults.md'
    case = SurroundingsRow('a folder as a file', 'says so', ('leaves 2 processes',), 3.0)
    append_line(tmp_path / 'surroundings.jsonl', case._asdict())
    assert read_surroundings(tmp_path / 'surroundings.jsonl') == [case]
    everything = Findings([row], [process], [case], [task] * 20)
    for findings in (everything, Findings([row], [], [], [])):
        write_report(path, findings, '--count 1')
        text = path.read_text(encoding='utf-8')
        assert '@' not in text and '--count 1' in text
        assert '| odometry or poses off, stuck or garbage | 1 | 0.20 |' in text
    write_report(path, everything, '')
    text = path.read_text(encoding='utf-8')
    assert '| a folder as a file | says so VIOLATES: leaves 2 processes | 3 |' in text
    assert '2 violate what is expected' in text and 'waits VIOLATES: STILL_DRIVES' in text
    assert '20 tasks in a row, 100 s simulated: 20 done.' in text
    assert '| `push_sim`: memory [MB] | 100.0 | 100.0 | 1.000 |' in text


def test_what_was_found_is_read_back(tmp_path):
    """As it was written."""
    rows = [ProcessRow(fault, Ending.DONE, '', (), (), 0.5) for fault in process_faults()]
    assert len(set(process_faults())) == len(rows)
    for row in rows:
        append_process_row(tmp_path / 'processes.jsonl', row)
    assert read_process_rows(tmp_path / 'processes.jsonl') == rows
    tasks = [SoakTask(False, 'reason', 5.0, 2.0, {'push_sim': Sample(1.0, 2, 3, 4.0)}, 0.1)]
    tasks.append(tasks[0]._replace(is_done=True, first=1))
    for task in tasks:
        append_task(tmp_path / 'soak.jsonl', task)
    assert read_tasks(tmp_path / 'soak.jsonl') == tasks
    assert read_tasks(tmp_path / 'none') == [] == read_process_rows(tmp_path / 'none')


def test_random_faults_are_drawn_from_seed_and_number():
    """Each run by itself; all inputs, numbers of faults and sorts of scenarios come."""
    cases = [draw_case(7, number) for number in range(200)]
    assert cases[150] == draw_case(7, 150) != draw_case(8, 150)
    faults = [fault for case in cases for fault in case.faults]
    assert {fault.input for fault in faults} == set(IN_PROCESS)
    assert {len(case.faults) for case in cases} == {1, 2, 3}
    assert all(SHORTEST - 0.01 < fault.end - fault.start < LONGEST + 0.01 for fault in faults)
    drawn = {case.task.partition(':')[0] for case in cases if ':' in case.task}
    assert drawn == set(SORTS) - {CATALOGUE}
    assert any(':' not in case.task for case in cases)
    assert '--seed 7 --run 150' in cases[150].command


def test_random_runs_that_are_done_are_not_done_again(tmp_path):
    """They are read from the file, and counted; those of other seeds are not."""
    path = tmp_path / 'random.jsonl'
    rows = [RandomRow(draw_case(seed, number), Ending.DONE, '', (), 0.1)
            for seed in (1, 2) for number in range(3)]
    for row in rows:
        append_random_row(path, row)
    assert read_random_rows(path) == rows
    assert run_many(2, 3, path, jobs=1) == rows[3:]


@pytest.mark.parametrize('word', [Word.DEAD_BAND, Word.ONE_WHEEL, Word.SLUGGISH, Word.LATE])
def test_a_base_that_is_imperfect_for_a_while_costs_no_goal(word: Word) -> None:
    """And nothing that is not expected of it."""
    row = run(Case(TASK, Fault(Input.BASE, word, 1.0, 3.0)))
    assert row.ending is Ending.DONE and row.is_ok
