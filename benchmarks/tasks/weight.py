"""Whether an object is too heavy for a robot, and whether the robot says so."""

from benchmarks.controller.tables import Record
import numpy as np
from push_base.push_force import needed_force
from push_control.goal import TaskFailure
from push_scenario.simulation.result import RunResult
from push_sim_node.tape import Tape

# Gap up to which robot and object touch [m]; chosen: soft contacts have depth, and no approach
# comes so near.
TOUCH_GAP = 1e-3


def weight_record(result: RunResult) -> Record:
    """
    Gather what was said of the weight of the object, and what is true.

    :param result: of a task.
    :return: ``is_too_heavy``, whether the true object needs more force than the true robot has;
        ``called_too_heavy``, whether the task ended so; then ``called_after``, the time from the
        first touch until then [s].
    """
    scenario, status = result.scenario, result.status
    is_called = status is not None and status.failure is TaskFailure.TOO_HEAVY
    record: Record = {
        'is_too_heavy': needed_force(scenario.true_object) > scenario.true_robot.max_push_force,
        'called_too_heavy': is_called}
    touch = first_touch(result.tape) if is_called and result.tape is not None else None
    if touch is not None:
        record['called_after'] = result.duration - touch
    return record


def first_touch(tape: Tape) -> float | None:
    """
    Return when the robot first touched the object [s]; None where it never did.

    :param tape: of the run.
    """
    gap, time = tape.columns.index('gap'), tape.columns.index('time')
    rows = np.flatnonzero(tape.rows[:, gap] <= TOUCH_GAP)
    return float(tape.rows[rows[0], time]) if rows.size else None
