"""Verdict on a run with faults: whether it ended done in truth, or standing with a reason."""

from collections.abc import Sequence
import dataclasses
import math
from typing import NamedTuple

from benchmarks.faults.injection import (
    Fault, Injection, Input, OFFSET, OTHER_OBJECT, SentCommand, Word,
)
from benchmarks.faults.row import Ending
import numpy as np
from push_control.task.supervisor import Supervisor
from push_model.geometry import distance, Pose, wrap_angle
from push_model.signals import STOP
from push_model.trajectory import PushTrajectory
from push_scenario.definition.scenario import Scenario
from push_scenario.simulation.loop import simulate
from push_scenario.simulation.result import Outcome
from push_sim_node.simulation import Simulation
from push_sim_node.tape import Tape

# Planning time of tasks [s]; chosen: the usual one with primitives.
PLANNING_TIME = 0.1
# What counts as where the controller says that the object is, over its tolerances; chosen: a
# measured pose errs, too.
TRUE_RATIO = 1.5
# Commands at the end of a run that must be zero [s]; chosen.
FINAL_TIME = 1.0
# Time after a fault of commands, or the stop for it, in which the object counts as displaced by it
# [s]; chosen: longer than a base takes to come to rest.
DISPLACING_TIME = 1.0
# Distance of the object from everything that was planned for it up to which a fault has not
# displaced it [m]; chosen: twice what single pushes deviate by without a fault.
MAX_DEVIATION = 0.2


class Record(NamedTuple):
    """
    What happened in a run.

    :param scenario: the ``Scenario``.
    :param tape: its ``Tape``.
    :param plans: every ``PushTrajectory``.
    :param sent: each ``SentCommand``.
    """

    scenario: Scenario
    tape: Tape
    plans: Sequence[PushTrajectory]
    sent: Sequence[SentCommand]


class Simulated(NamedTuple):
    """
    A run, and how it ended.

    :param record: its ``Record``.
    :param ending: the ``Ending``.
    :param reason: as reported, one sentence.
    """

    record: Record
    ending: Ending
    reason: str


def simulated_record(scenario: Scenario, injections: Sequence[Injection],
                     time_limit: float) -> Simulated:
    """
    Simulate a scenario with faults, in one process.

    A robot that waits for somebody, as its base was stopped, is let go on after all faults.

    :param scenario: the ``Scenario``.
    :param injections: an ``Injection`` for each fault, at least one.
    :param time_limit: simulated time in which the run has to end [s].
    :return: ``Simulated``.
    :raises ValueError: where the scenario has no plan to begin with.
    """
    reasons, end = [''], max(injection.end for injection in injections)

    def intervene(simulation: Simulation, supervisor: Supervisor) -> None:
        for injection in injections:
            injection(simulation, supervisor)
        reasons[0] = supervisor.status.reason
        if simulation.time > end and supervisor.awaits_resume:
            supervisor.resume()
    result = simulate(dataclasses.replace(scenario, time_limit=time_limit), intervene=intervene,
                      planning_time=PLANNING_TIME)
    if result.tape is None:
        raise ValueError(f'{scenario.name}: {result.reason}')
    has_ended = result.outcome is not Outcome.TIME_LIMIT
    plans = [plan.trajectory for plan in result.task_plans]
    # What the robot sends goes through the injection that was put in last, at first.
    record = Record(scenario, result.tape, plans if result.plan is None else [result.plan],
                    injections[-1].sent)
    return Simulated(record, Ending(result.outcome.value) if has_ended else Ending.WAITS,
                     result.reason if has_ended else reasons[0])


def stands(commands: Sequence[SentCommand]) -> bool:
    """
    Tell whether the robot has commanded zero for a second at the end.

    :param commands: each ``SentCommand``.
    """
    return all(sent.twist == STOP for sent in commands
               if sent.time > commands[-1].time - FINAL_TIME)


def is_truly_done(record: Record, fault: Fault | None = None) -> bool:
    """
    Tell whether the object is at its goal in truth.

    :param record: the ``Record``.
    :param fault: the ``Fault``, where it may last; what a tracker shows that is off for good is
        all that can be known.
    """
    scenario = record.scenario
    settings = scenario.control if scenario.task is None else scenario.task.supervision
    object_pose, goal = Pose(*record.tape.poses('object')[-1]), scenario.final_goal
    if fault is not None and not fault.is_temporary and (
            fault.input is Input.POSE and fault.word is Word.WRONG):
        object_pose = Pose(object_pose.x + OFFSET.x, object_pose.y, object_pose.theta
                           + OFFSET.theta)
    return bool(
        distance(object_pose, goal) <= TRUE_RATIO * settings.position_tolerance
        and abs(wrap_angle(object_pose[2] - goal.theta)) <= (
            TRUE_RATIO * settings.heading_tolerance))


def deviation(record: Record, fault: Fault, stop_time: float) -> float:
    """
    Find how far the object is from all that was planned for it, after a fault begins [m].

    :param record: the ``Record``.
    :param fault: the ``Fault``.
    :param stop_time: when the robot first commands zero during the fault; nan: never [s].
    """
    poses = np.array(record.tape.poses('object'))[:, :2]
    planned = np.concatenate([poses[:1], *(plan.object_poses[:, :2] for plan in record.plans)])
    end = math.inf
    if fault.input is Input.COMMAND:
        # What it has done to the object is corrected on other paths, and a base that goes on to
        # push the object although zero is commanded does so for nobody here.
        end = (fault.end if math.isnan(stop_time) else stop_time) + DISPLACING_TIME
    times = record.tape['time']
    after = poses[(times >= fault.start) & (times <= end)]
    gaps = [np.hypot(*(planned - position).T).min() for position in after[::5]]
    return float(max(gaps, default=0.0))


def deviation_limit(fault: Fault) -> float:
    """
    Limit the deviation [m]: a tracker that is off has what is planned beside the object.

    :param fault: the ``Fault``.
    """
    return MAX_DEVIATION + offset_of(fault)


def offset_of(fault: Fault) -> float:
    """
    Return by how much the object seems to be displaced [m]; infinite: anywhere.

    :param fault: the ``Fault``.
    """
    if fault.input is not Input.POSE:
        return 0.0
    if fault.word in (Word.MIRRORED, Word.OF_THE_ROBOT):
        return math.inf
    offset = {Word.WRONG: OFFSET, Word.OF_ANOTHER_OBJECT: OTHER_OBJECT}.get(fault.word)
    return 0.0 if offset is None else math.hypot(offset.x, offset.y)
