"""A run with faults in one process: what is recorded of it, and how it ended."""

from collections.abc import Sequence
import dataclasses
from typing import NamedTuple

from benchmarks.faults.injection import Injection, SentCommand
from benchmarks.faults.row import Ending
from push_control.task.code_text import code_names
from push_control.task.status import StateChange, SupervisorStatus
from push_control.task.supervisor import Supervisor
from push_model.trajectory import PushTrajectory
from push_navigation.occupancy_map import OccupancyMap
from push_scenario.definition.scenario import Scenario
from push_scenario.simulation.loop import simulate
from push_scenario.simulation.result import Outcome
from push_sim_node.simulation import Simulation
from push_sim_node.tape import Tape

# Planning time of tasks [s]; chosen: the usual one with primitives.
PLANNING_TIME = 0.1


class Record(NamedTuple):
    """
    What happened in a run.

    :param scenario: the ``Scenario``.
    :param tape: its ``Tape``.
    :param plans: every ``PushTrajectory``.
    :param sent: each ``SentCommand``.
    :param end_time: when the robot, or the time limit, ended the run [s]; what is recorded after
        that shows whether it stands.
    :param history: ``StateChange`` of each state; empty where it does not matter.
    """

    scenario: Scenario
    tape: Tape
    plans: Sequence[PushTrajectory]
    sent: Sequence[SentCommand]
    end_time: float
    history: Sequence[StateChange] = ()


class Simulated(NamedTuple):
    """
    A run, and how it ended.

    :param record: its ``Record``.
    :param ending: the ``Ending``.
    :param reason: as reported, one sentence.
    :param codes: names of its codes, such as ``SafetyReason.NOT_MOVING``.
    """

    record: Record
    ending: Ending
    reason: str
    codes: tuple[str, ...]


def map_of(scenario: Scenario) -> OccupancyMap | None:
    """
    Return the map of a scenario; None where it has none.

    :param scenario: the ``Scenario``.
    """
    return None if scenario.task is None else scenario.task.occupancy_map


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
    statuses, end = [SupervisorStatus()], max(injection.end for injection in injections)

    def intervene(simulation: Simulation, supervisor: Supervisor) -> None:
        for injection in injections:
            injection(simulation, supervisor)
        statuses[0] = supervisor.status
        if simulation.time > end and supervisor.awaits_resume:
            supervisor.resume()
    result = simulate(dataclasses.replace(scenario, time_limit=time_limit), intervene=intervene,
                      planning_time=PLANNING_TIME)
    if result.tape is None:
        raise ValueError(f'{scenario.name}: {result.reason}')
    plans = [plan.trajectory for plan in result.task_plans]
    # What the robot sends goes through the injection that was put in last, at first.
    record = Record(scenario, result.tape, plans if result.plan is None else [result.plan],
                    injections[-1].sent, result.duration, result.history)
    if result.outcome is Outcome.TIME_LIMIT:
        status = statuses[0]
        return Simulated(record, Ending.WAITS, status.reason, tuple(code_names(status.codes)))
    return Simulated(record, Ending(result.outcome.value), result.reason,
                     tuple(code_names(result.codes)))
