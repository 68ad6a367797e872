"""One random push under one law, as a record."""

import math
import time

from controller_cases import scenario
from push_planner.problem import PlanningFailed
from push_scenario.closed_loop import run
from push_scenario.metrics import measure

TOLERANCES = 0.02, math.radians(3.0)


def push(job):
    """
    Push one case.

    :param job: dict of ``kind``, ``seed``, ``stress`` and ``law``.
    :return: flat dict: outcome and reason, errors at rest, times and ways.
    """
    try:
        case, answer = scenario(job['kind'], job['seed'], job['stress'])
    except PlanningFailed as failure:
        return {'outcome': 'no plan', 'reason': failure.reason}
    began = time.process_time()
    result = run(case, job['law'])
    record = {'outcome': result.outcome, 'reason': result.reason,
              'cpu': time.process_time() - began, 'planned': answer.trajectory.duration,
              'detour': answer.report['path_length'] / math.hypot(case.goal.x, case.goal.y)}
    found = measure(result)
    if found is not None:
        record.update(position_error=found.position_error,
                      heading_error=abs(found.heading_error), time=found.time, slip=found.slip)
    return record


def succeeded(record):
    """Tell whether the object rests where it should, and the controller says so."""
    return (record['outcome'] == 'done' and record['position_error'] <= TOLERANCES[0]
            and record['heading_error'] <= TOLERANCES[1])
