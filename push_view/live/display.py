"""What the page has been shown of a run, and what of it is new."""

from collections.abc import Callable, Sequence
import math

from push_model.base_knowledge import BaseKnowledge
from push_model.parameters import PushedObject
from push_safety.layer import SafetyLayer
from push_scenario.simulation.robot_control import TaskControl
from push_sim_node.simulation import Simulation
from push_view.belief import belief_columns, BeliefSampler
from push_view.messages import (
    base_message, plan_message, refusal_message, rows_message, state_message)
from push_view.server.message_log import MessageLog


class RunDisplay:
    """
    Sends the page what is new of a run.

    That is rows of the tape, changes of state, plans and refusals of plans, and what is learned of
    the base.

    ``time``: of the last row [s], at which the page shows what is changed now. ``columns``: names
    of all columns that there are.

    :param log: where the messages go.
    :param simulation: the ``Simulation``.
    :param robot: the ``TaskControl``.
    :param safety: the ``SafetyLayer``, which learns what the base is like.
    :param obj: the nominal ``PushedObject``.
    :param columns: names of the columns that the page is sent; None for all that there are.
    :param more: values of columns behind these; None for none.
    """

    def __init__(self, log: MessageLog, simulation: Simulation, robot: TaskControl,
                 safety: SafetyLayer, obj: PushedObject, *,
                 columns: Sequence[str] | None = None,
                 more: Callable[[], Sequence[float]] | None = None) -> None:
        self.time = 0.0
        self._log = log
        self._start = simulation.time
        self._simulation = simulation
        self._robot = robot
        self._safety = safety
        self._base: BaseKnowledge | None = None
        self._belief = BeliefSampler(len(obj.supports))
        self.columns = (*simulation.columns, *belief_columns(obj))
        # Where the values of the columns are; -1 for that behind them.
        self._places = None if columns is None else [
            self.columns.index(name) if name in self.columns else -1 for name in columns]
        self._more = more
        self._rows: list[tuple[float, ...]] = []
        self._row_count = 0
        self._shown = (0, 0, 0)

    def take_rows(self) -> None:
        """Move new rows of the tape, with what is believed at them, and show events."""
        for row in self._simulation.rows:
            self._rows.append(self._sent((*row, *self._belief.sample(
                self._row_count, self._simulation, self._robot.supervisor))))
            self._row_count += 1
            self.time = row[0]
        # A session may last for hours.
        self._simulation.rows.clear()
        states, plans, refusals = self._shown
        history, known_plans = self._robot.history, self._robot.plans
        for change in history[states:]:
            # A supervisor knows no time before its first measurements.
            self._log.add(state_message(change._replace(time=max(change.time, self._start))))
        for plan in known_plans[plans:]:
            self._log.add(plan_message(self._simulation.time, plan, self._robot.pushes_of(plan)))
        known_refusals = self._robot.refusals
        for time, failure in known_refusals[refusals:]:
            self._log.add(refusal_message(time, failure.code, failure.reason, failure.marks))
        self._shown = len(history), len(known_plans), len(known_refusals)
        if self._safety.base_knowledge != self._base:
            self._base = self._safety.base_knowledge
            self._log.add(base_message(self._simulation.time, self._base))

    def _sent(self, values: tuple[float, ...]) -> tuple[float, ...]:
        """Pick the values of the columns that are sent."""
        if self._places is not None:
            known = (*values, math.nan)
            values = tuple(known[place] for place in self._places)
        return values if self._more is None else (*values, *self._more())

    def send_rows(self) -> None:
        """Show the rows that were taken."""
        if self._rows:
            self._log.add(rows_message(self._rows))
            self._rows = []
