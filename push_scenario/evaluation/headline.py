"""How a run ended, in a sentence: the first line of a report."""

import math

from push_scenario.evaluation.metrics import is_as_expected, verdict
from push_scenario.simulation.result import Outcome, RunResult


def headline(result: RunResult) -> str:
    """
    Say how a run ended, how near the object came to its goal, and what the scenario allows.

    :return: such as ``DONE in 23.6 s, 3 pushes: 7.5 mm and 0.25 degrees from the goal, allowed
        10 mm and 1 degree``, or the reason of a run that did not get so far.
    """
    word = verdict(result).replace('_', ' ').upper()
    if result.scenario.expected != 'reached' and is_as_expected(result):
        word += ', as expected'
    if result.outcome in (Outcome.REFUSED, Outcome.FAILED):
        pushes = f' after {_counted(result.pushes, "push", "pushes")}' if result.pushes else ''
        return f'{word}{pushes}: {result.reason}'
    pushes = '' if result.scenario.task is None else (
        ', ' + _counted(result.pushes, 'push', 'pushes'))
    bounds = result.scenario.final_bounds
    error = f'{1e3 * result.position_error:.1f} mm and {_degrees(result.heading_error, ".2f")}'
    allowed = f'{1e3 * bounds.position_error:g} mm and {_degrees(bounds.heading_error, "g")}'
    return (f'{word} in {result.duration:.1f} s{pushes}: {error} from the goal, '
            f'allowed {allowed}')


def _counted(count: int, singular: str, plural: str) -> str:
    return f'{count} {singular if count == 1 else plural}'


def _degrees(angle: float, style: str) -> str:
    """Write the size of an angle [rad] in degrees."""
    size = f'{abs(math.degrees(angle)):{style}}'
    return f'{size} {"degree" if size == "1" else "degrees"}'
