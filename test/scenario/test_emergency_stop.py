"""An emergency stop at any moment of tasks and pushes: the robot waits for somebody after it."""

import dataclasses
from typing import Any, Callable

from benchmarks.faults.injection import Fault, Injection, Input, Word
from push_control.steered.status import Phase
from push_control.task.status import TaskState
from push_control.task.supervisor import Supervisor
from push_model.signals import STOP
from push_safety.status import SafetyReason
from push_scenario.definition.loader import load_scenario
from push_scenario.definition.scenario import Scenario
from push_scenario.simulation.loop import simulate
from push_scenario.simulation.result import Outcome, RunResult
from push_sim_node.simulation import Simulation
import pytest

pytestmark = pytest.mark.slow

TASK, PUSH = load_scenario('task_tap'), load_scenario('curved_push')
LENGTH, WAITING_TIME = 5.0, 8.0
# Stops after which the robot waits for a word.
AWAITED = {SafetyReason.BASE_STOOD, SafetyReason.ODOMETRY_WAS_MISSING}


class EmergencyStop:
    """
    Stops the base for a while, and says a word some time later.

    ``moves``: times of commands after the stop, and before the word, that are not zero [s].
    ``waits``: whether the robot waits for the word when it comes.
    """

    def __init__(self, start: float, length: float, word: Callable[[Supervisor], None],
                 kind: Input = Input.COMMAND) -> None:
        self._injection = Injection(Fault(kind, Word.OFF, start, start + length))
        self._word_at = start + length + WAITING_TIME
        self._word = word
        self._is_said = False
        self.waits = False

    def __call__(self, simulation: Simulation, robot: Supervisor) -> None:
        """Do both."""
        self._injection(simulation, robot)
        if simulation.time >= self._word_at and not self._is_said:
            self._is_said = True
            self.waits = robot.awaits_resume and bool(AWAITED.intersection(robot.status.codes))
            self._word(robot)

    @property
    def moves(self) -> list[float]:
        return [time for time, twist in self._injection.sent
                if self._injection.end <= time < self._word_at and twist != STOP]


def resume(robot: Supervisor) -> None:
    """Let the robot go on."""
    robot.resume()


def set_goal(robot: Supervisor) -> None:
    """Set a goal anew."""
    robot.set_goal(TASK.goal.pose)


def run(scenario: Scenario, stop: EmergencyStop, **settings: Any) -> RunResult:
    """Simulate a scenario with other settings of the controller."""
    control = dataclasses.replace(scenario.control, **settings)
    return simulate(dataclasses.replace(scenario, control=control, time_limit=100.0),
                    intervene=stop, planning_time=0.1)


# In plan, in approach (turning, and on its way), in push, and in the retreat from the first one.
@pytest.mark.parametrize('scenario, start, state', [
    (TASK, 0.4, TaskState.PLAN), (TASK, 0.8, TaskState.APPROACH), (TASK, 1.5, TaskState.APPROACH),
    (TASK, 1.9, TaskState.APPROACH), (TASK, 2.8, TaskState.PUSH),
    (load_scenario('task_demo'), 12.2, TaskState.RETREAT)])
def test_a_task_waits_after_an_emergency_stop(scenario: Scenario, start: float,
                                              state: TaskState) -> None:
    """Without a single command; it is done after the word."""
    stop = EmergencyStop(start, LENGTH, resume)
    result = run(scenario, stop)
    assert [change.state for change in result.history if change.time <= start][-1] is state
    assert stop.waits and not stop.moves
    assert result.outcome is Outcome.DONE


def test_another_goal_is_a_word_as_well() -> None:
    """The task begins anew with it."""
    stop = EmergencyStop(1.5, LENGTH, set_goal)
    assert run(TASK, stop).outcome is Outcome.DONE
    assert stop.waits and not stop.moves


@pytest.mark.parametrize('start', [1.5, 2.8])
@pytest.mark.parametrize('length, settings', [
    (0.5, {}), (2.0, {}), (LENGTH, {'resume_after_stop': 'automatic'})])
def test_a_task_goes_on_by_itself(start: float, length: float, settings: dict[str, Any]) -> None:
    """After a moment, and after any time where that is what somebody wants."""
    stop = EmergencyStop(start, length, resume)
    assert run(TASK, stop, **settings).outcome is Outcome.DONE
    assert stop.moves and not stop.waits


@pytest.mark.parametrize('kind', [Input.COMMAND, Input.ODOMETRY])
def test_a_push_waits_and_goes_on_when_it_is_told(kind: Input) -> None:
    """Of a base that was stopped, and of one that was off; it reaches its goal."""
    stop = EmergencyStop(6.0, LENGTH, resume, kind)
    assert run(PUSH, stop).outcome is Outcome.DONE
    assert stop.waits and not stop.moves


def test_a_push_waits_for_as_long_as_it_takes() -> None:
    """It does not give up as for measurements that do not come."""
    stop = EmergencyStop(6.0, 30.0, resume)
    phases: list[Phase] = []

    def intervene(simulation: Simulation, robot: Supervisor) -> None:
        stop(simulation, robot)
        if simulation.time < 43.0:
            phases.append(robot.status.push.phase)
    result = simulate(dataclasses.replace(PUSH, time_limit=100.0), intervene=intervene)
    assert phases[-1] is Phase.WAITING and result.outcome is Outcome.DONE


def test_a_task_waits_after_odometry_was_missing() -> None:
    """As where the base was off."""
    stop = EmergencyStop(1.5, LENGTH, resume, Input.ODOMETRY)
    assert run(TASK, stop).outcome is Outcome.DONE
    assert stop.waits and not stop.moves
