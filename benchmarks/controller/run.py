"""One random push under every law, as a record."""

import math
import time

from benchmarks.controller.cases import scenario
from push_planner.problem import PlanningFailed
from push_scenario.evaluation.metrics import measure
from push_scenario.simulation.loop import simulate
from push_scenario.simulation.result import Outcome

LAWS = ('feedback', 'mpc')
TOLERANCES = 0.02, math.radians(3.0)


def push(job):
    """
    Push one case.

    :param job: dict of ``kind``, ``seed``, ``stress`` and ``laws``.
    :return: flat dict: of the plan, and for each law (``feedback.outcome`` ...) outcome and
        reason, errors at rest, time over that of the plan, way slid at the contact.
    """
    try:
        case, answer = scenario(job['kind'], job['seed'], job['stress'])
    except PlanningFailed as failure:
        return {'plan': failure.reason}
    record = {'plan': '', 'contact': answer.problem.contact.kind,
              'planned': answer.trajectory.duration,
              'detour': answer.report['path_length'] / math.hypot(case.goal.x, case.goal.y)}
    for law in job['laws']:
        record.update({f'{law}.{name}': value
                       for name, value in _run(case, law, record['planned']).items()})
    return record


def _run(case, law, planned):
    began = time.process_time()
    result = simulate(case, law)
    found = measure(result)
    record = {'outcome': result.outcome.value, 'reason': result.reason,
              'cpu': time.process_time() - began, 'success': False}
    if found is not None:
        record.update(position_error=found.position_error,
                      heading_error=abs(found.heading_error),
                      time_ratio=found.time / planned, slip=found.slip,
                      success=bool(result.outcome is Outcome.DONE
                                   and found.position_error <= TOLERANCES[0]
                                   and abs(found.heading_error) <= TOLERANCES[1]))
    return record
