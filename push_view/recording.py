"""Recordings: a run that is over, as the messages that the page shows."""

from collections.abc import Iterator
import dataclasses

from push_control.task.status import TaskState
from push_model.geometry import Pose
from push_planner.planned_pushes import planned_pushes
from push_scenario.evaluation.metrics import bounds_missed, verdict
from push_scenario.evaluation.report import report_notes
from push_scenario.simulation.result import RunResult
from push_sim_node.disturbance import change_times, friction_factors
from push_sim_node.tape import Tape
from push_view.belief import BeliefRecorder
from push_view.messages import (
    collision_message, displacement_message, goal_message, map_message, Message, plan_message,
    push_message, refusal_message, rows_message, scenario_message, state_message, truth_message,
)
from push_view.wall_contact import WallContactDetector


def recording(result: RunResult, beliefs: BeliefRecorder | None = None) -> list[Message]:
    """
    Turn a run into messages.

    :param beliefs: what the robot believed in it, where that was recorded.
    :return: messages: the scene first, then the rest, each kind in order of time. One of a goal
        that was refused has no rows.
    """
    scenario, tape = result.scenario, result.tape
    columns = () if tape is None else tape.columns
    if beliefs is not None:
        columns = (*columns, *beliefs.columns)
    messages = [scenario_message(scenario, result.control_law, columns)]
    messages += _truths(result)
    messages.append(goal_message(0.0, scenario.goal.pose))
    if scenario.task is not None:
        messages += [goal_message(later.time, later.goal.pose) for later in scenario.task.goals]
        messages.append(map_message(0.0, scenario.task.occupancy_map))
    messages += _plans(result)
    messages += [state_message(change) for change in result.history]
    if tape is not None:
        messages += _displacements(result, tape)
        messages += _collisions(result, tape)
        messages.append(rows_message(tape.rows if beliefs is None else [
            (*row, *beliefs.row(row_index)) for row_index, row in enumerate(tape.rows.tolist())]))
    messages.append({'type': 'ending', 'time': result.duration, 'outcome': verdict(result),
                     'missed': bounds_missed(result), 'reason': result.reason,
                     'notes': list(report_notes(result))})
    return messages


def _truths(result: RunResult) -> Iterator[Message]:
    """Yield the true friction, at first and after each of its changes."""
    true_object, changes = result.scenario.true_object, result.scenario.simulation.friction_changes
    for time in sorted({0.0, *change_times(changes)}):
        factors = friction_factors(changes, time, len(true_object.supports))
        supports = tuple(
            dataclasses.replace(support, friction_coefficient=(
                factor * support.friction_coefficient))
            for support, factor in zip(true_object.supports, factors))
        yield truth_message(time, dataclasses.replace(true_object, supports=supports))


def _plans(result: RunResult) -> Iterator[Message]:
    """Yield each plan when it was there: then the approach begins; and each refusal."""
    if result.plan is not None:
        yield push_message(0.0, result.plan)
    times = [change.time for change in result.history if change.state is TaskState.APPROACH]
    scenario = result.scenario
    if scenario.task is None:
        return
    for time, plan in zip(times, result.task_plans):
        yield plan_message(time, plan, planned_pushes(
            plan, scenario.object, scenario.robot, scenario.task.drive,
            scenario.task.occupancy_map))
    for time, failure in result.refusals:
        yield refusal_message(time, failure.code, failure.reason, failure.marks)


def _displacements(result: RunResult, tape: Tape) -> Iterator[Message]:
    times, poses = tape['time'], tape.poses('object')
    for displacement in result.scenario.simulation.object_displacements:
        row = int(times.searchsorted(displacement.time))
        if 0 < row < len(times):
            yield displacement_message(displacement.time, Pose(*poses[row - 1]),
                                       Pose(*poses[row]))


def _collisions(result: RunResult, tape: Tape) -> Iterator[Message]:
    """Yield what touched a wall: in a run that is over, nothing has stopped it there."""
    scenario = result.scenario
    if scenario.task is None or scenario.task.occupancy_map is None:
        return
    detector = WallContactDetector(scenario.true_object, scenario.true_robot)
    for time, contact in detector.contacts_of(tape, scenario.task.occupancy_map):
        yield collision_message(time, contact)
