"""Statements of plans, each beside what then happened."""

import json
import math
from typing import Any, Iterator, NamedTuple, Sequence

from benchmarks.controller.run import HEADING_TOLERANCE, POSITION_TOLERANCE
from benchmarks.controller.tables import Job, Pair, Record
from push_model.outlook import Outlook
from push_model.plan_request import GoalTolerances
from push_planner.outlook import (
    MAP, narrowness, OPEN_FLOOR, OutlookModel, STEERED_PUSH, usable_tolerances,
)

DONE = 'done'
# Steered pushes are judged as in the benchmark of the controller.
PUSH_TOLERANCES = GoalTolerances(POSITION_TOLERANCE, HEADING_TOLERANCE)


class Ends(NamedTuple):
    """
    Times and errors, one of each quantity of an ``Outlook``.

    :param time: [s].
    :param position_error: [m].
    :param heading_error: [rad].
    """

    time: float
    position_error: float
    heading_error: float


class Sample(NamedTuple):
    """
    A plan, what it knew, and how the run ended.

    :param model: name of its model in ``push_planner.outlook``.
    :param group: what the report names it by.
    :param seed: of the case.
    :param expected_time: by the plan [s].
    :param aims: ``GoalTolerances`` that the pushes of a task aim at; None of a steered push.
    :param actual: time from the plan to the end, and true errors there.
    :param tolerances: ``GoalTolerances`` that the true errors are judged by.
    :param is_done: whether the run was reported as done.
    :param is_first: whether it is the first plan of its run.
    :param is_retry: whether attempts before have brought the object no nearer to its goal.
    :param weight: share of the plan in its run, by which all runs count alike for chances.
    """

    model: str
    group: str
    seed: int
    expected_time: float
    aims: GoalTolerances | None
    actual: Ends
    tolerances: GoalTolerances
    is_done: bool
    is_first: bool = True
    is_retry: bool = False
    weight: float = 1.0

    @property
    def is_within(self) -> bool:
        """Whether the run was done, within the tolerances."""
        return (self.is_done and self.actual.position_error <= self.tolerances.position
                and self.actual.heading_error <= self.tolerances.heading)

    @property
    def narrowness(self) -> float:
        """Narrowness of the tolerances, by which times grow; 0 of a steered push."""
        return 0.0 if self.aims is None else narrowness(self.aims)

    @property
    def relative_errors(self) -> tuple[float, float]:
        """Errors of position and heading over what is usable; as they are of a steered push."""
        errors = self.actual.position_error, self.actual.heading_error
        if self.aims is None:
            return errors
        usable = usable_tolerances(self.aims)
        return errors[0] / usable.position, errors[1] / usable.heading

    def with_tolerances(self, scale: float) -> 'Sample':
        """
        Judge it by other tolerances.

        :param scale: of those that it has.
        """
        return self._replace(tolerances=GoalTolerances(
            *(scale * value for value in self.tolerances)))

    def outlook(self, model: OutlookModel) -> Outlook:
        """
        State what the package would.

        :param model: ``OutlookModel`` of this sort of plans.
        """
        if self.aims is None:
            return model.of_push(self.expected_time, self.tolerances)
        return model.of_task(self.expected_time, self.aims, is_retry=self.is_retry)


def task_samples(group: str, pairs: Sequence[Pair]) -> list[Sample]:
    """
    List the plans of tasks.

    :param pairs: (job, record) of ``run_task``.
    """
    return [sample for job, record in pairs for sample in _plans(group, job, record)]


def _plans(group: str, job: Job, record: Record) -> Iterator[Sample]:
    plans: list[dict[str, Any]] = json.loads(record['plans'])
    for index, plan in enumerate(plans):
        yield Sample(
            MAP if plan['is_in_map'] else OPEN_FLOOR, group, job['seed'],
            plan['expected_time'],
            GoalTolerances(plan['position_tolerance'], plan['heading_tolerance']),
            Ends(record['duration'] - plan['time'], record['position_error'],
                 record['heading_error']),
            GoalTolerances(record['position_tolerance'], record['heading_tolerance']),
            record['outcome'] == DONE, index == 0, plan['cone_fraction'] < 1.0,
            1.0 / len(plans))


def push_samples(group: str, pairs: Sequence[Pair]) -> list[Sample]:
    """
    List the plans of steered pushes; cases without a plan, or refused at the start, have none.

    :param pairs: (job, record) of ``run_push``.
    """
    return [Sample(
        STEERED_PUSH, group, job['seed'],
        record['planned_time'], None,
        Ends(record['duration'], record['position_error'], record['heading_error']),
        PUSH_TOLERANCES, record['outcome'] == DONE)
        for job, record in pairs if math.isfinite(record.get('duration', math.nan))]
