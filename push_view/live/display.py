"""What the page has been shown of a run, and what of it is new."""

from push_model.base_knowledge import BaseKnowledge
from push_safety.layer import SafetyLayer
from push_scenario.simulation.robot_control import TaskControl
from push_sim_node.simulation import Simulation
from push_view.belief import BeliefSampler
from push_view.messages import (
    base_message, plan_message, refusal_message, rows_message, state_message)
from push_view.server.message_log import MessageLog


class RunDisplay:
    """
    Sends the page what is new of a run.

    That is rows of the tape, changes of state, plans and refusals of plans, and what is learned of
    the base.

    ``time``: of the last row [s], at which the page shows what is changed now.

    :param log: where the messages go.
    :param simulation: the ``Simulation``.
    :param robot: the ``TaskControl``.
    :param safety: the ``SafetyLayer``, which learns what the base is like.
    :param support_count: number of supports of the object.
    """

    def __init__(self, log: MessageLog, simulation: Simulation, robot: TaskControl,
                 safety: SafetyLayer, support_count: int) -> None:
        self.time = 0.0
        self._log = log
        self._simulation = simulation
        self._robot = robot
        self._safety = safety
        self._base: BaseKnowledge | None = None
        self._belief = BeliefSampler(support_count)
        self._rows: list[tuple[float, ...]] = []
        self._row_count = 0
        self._shown = (0, 0, 0)

    def take_rows(self) -> None:
        """Move new rows of the tape, with what is believed at them, and show events."""
        for row in self._simulation.rows:
            self._rows.append((*row, *self._belief.sample(
                self._row_count, self._simulation, self._robot.supervisor)))
            self._row_count += 1
            self.time = row[0]
        # A session may last for hours.
        self._simulation.rows.clear()
        states, plans, refusals = self._shown
        history, known_plans = self._robot.history, self._robot.plans
        for change in history[states:]:
            self._log.add(state_message(change))
        for plan in known_plans[plans:]:
            self._log.add(plan_message(self._simulation.time, plan, self._robot.pushes_of(plan)))
        known_refusals = self._robot.refusals
        for time, failure in known_refusals[refusals:]:
            self._log.add(refusal_message(time, failure.code, failure.reason, failure.marks))
        self._shown = len(history), len(known_plans), len(known_refusals)
        if self._safety.base_knowledge != self._base:
            self._base = self._safety.base_knowledge
            self._log.add(base_message(self._simulation.time, self._base))

    def send_rows(self) -> None:
        """Show the rows that were taken."""
        if self._rows:
            self._log.add(rows_message(self._rows))
            self._rows = []
