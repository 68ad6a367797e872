"""Statements of plans, each beside what then happened."""

import json
import math
from typing import Any, Iterator, NamedTuple, Sequence

from benchmarks.controller.run import HEADING_TOLERANCE, POSITION_TOLERANCE
from benchmarks.controller.tables import Job, Pair, Record
from push_model.outlook import Outlook
from push_model.plan_request import GoalTolerances
from push_planner.outlook import MAP, OPEN_FLOOR, OutlookModel, STEERED_PUSH

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
    :param known: of each quantity the number of which its quantiles are lines.
    :param actual: time from the plan to the end, and true errors there.
    :param tolerances: ``GoalTolerances`` that the true errors are judged by.
    :param is_done: whether the run was reported as done.
    :param is_first: whether it is the first plan of its run.
    :param is_retry: whether attempts before have brought the object no nearer to its goal.
    :param weight: share of the plan in its run.
    """

    model: str
    group: str
    seed: int
    known: Ends
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
        if self.model == STEERED_PUSH:
            return model.of_push(self.known.time, self.known.position_error, self.tolerances)
        aims = GoalTolerances(self.known.position_error, self.known.heading_error)
        return model.of_task(self.known.time, aims, is_retry=self.is_retry)


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
            Ends(plan['expected_time'], plan['position_tolerance'], plan['heading_tolerance']),
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
        Ends(record['planned_time'], record['path_length'], record['path_length']),
        Ends(record['duration'], record['position_error'], record['heading_error']),
        PUSH_TOLERANCES, record['outcome'] == DONE)
        for job, record in pairs if math.isfinite(record.get('duration', math.nan))]
