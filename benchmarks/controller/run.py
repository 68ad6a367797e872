"""Simulation of one random push under every law; its figures as a flat record."""

import math
import time
from typing import Any

from benchmarks.controller.cases import scenario
from push_planner.problem import PlanningFailed
from push_scenario.definition.scenario import Scenario
from push_scenario.evaluation.metrics import measure
from push_scenario.simulation.loop import simulate
from push_scenario.simulation.result import Outcome

LAWS = ('feedback', 'mpc')
# Errors at rest that count as success [m], [rad]; chosen.
POSITION_TOLERANCE = 0.02
HEADING_TOLERANCE = math.radians(3.0)


def push(job: dict[str, Any]) -> dict[str, Any]:
    """
    Push one case.

    :param job: dict of ``kind``, ``seed``, ``stress`` and ``laws``.
    :return: flat dict: of the plan, and for each law (``feedback.outcome`` ...) outcome and
        reason, errors at rest, time over that of the plan, slip at the contact.
    """
    try:
        case, plan = scenario(job['kind'], job['seed'], job['stress'])
    except PlanningFailed as failure:
        return {'plan': failure.reason}
    record: dict[str, Any] = {
        'plan': '', 'contact': plan.problem.contact.kind, 'planned': plan.trajectory.duration,
        'detour': plan.report['path_length'] / math.hypot(case.goal.x, case.goal.y)}
    for law in job['laws']:
        record.update({f'{law}.{name}': value
                       for name, value in _run(case, law, record['planned']).items()})
    return record


def _run(case: Scenario, law: str, planned: float) -> dict[str, Any]:
    began = time.process_time()
    result = simulate(case, law)
    measures = measure(result)
    record: dict[str, Any] = {'outcome': result.outcome.value, 'reason': result.reason,
                              'cpu': time.process_time() - began, 'success': False}
    if measures is not None:
        record.update(position_error=measures.position_error,
                      heading_error=abs(measures.heading_error),
                      time_ratio=measures.time / planned, slip=measures.slip,
                      success=bool(result.outcome is Outcome.DONE
                                   and measures.position_error <= POSITION_TOLERANCE
                                   and abs(measures.heading_error) <= HEADING_TOLERANCE))
    return record
