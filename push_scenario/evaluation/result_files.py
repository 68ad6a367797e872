"""Results of replays for other programs: as JSON, and as the JUnit XML that CI servers show."""

from collections.abc import Sequence
import json
import math
from typing import Any, NamedTuple
from xml.etree import ElementTree

from push_scenario.evaluation.headline import headline
from push_scenario.evaluation.result_row import result_row
from push_scenario.simulation.result import RunResult


class Replay(NamedTuple):
    """
    A scenario that was replayed.

    :param name: of the scenario.
    :param results: of its laws, those that were run.
    :param is_as_expected: whether all laws that are judged ended as the scenario expects.
    :param error: why it could not be run, or not to its end; empty where it was.
    """

    name: str
    results: Sequence[RunResult]
    is_as_expected: bool
    error: str = ''


def to_json(replays: Sequence[Replay]) -> str:
    """
    Write replays as JSON.

    :return: an array with an object for each run: ``law``, ``headline``, and what ``result_row``
        has; values that are not finite are null. One for each error has ``scenario`` and
        ``error``.
    """
    rows: list[dict[str, Any]] = []
    for replay in replays:
        for result in replay.results:
            row = {'law': result.control_law, 'headline': headline(result), **result_row(result)}
            rows.append({key: _finite(value) for key, value in row.items()})
        if replay.error:
            rows.append({'scenario': replay.name, 'error': replay.error})
    return json.dumps(rows, indent=2) + '\n'


def to_junit(replays: Sequence[Replay]) -> str:
    """
    Write replays as JUnit XML.

    :return: a test suite; each scenario is a test case, whose time is simulated [s].
    """
    suite = ElementTree.Element('testsuite', {
        'name': 'push replay', 'tests': str(len(replays)),
        'failures': str(sum(not replay.is_as_expected and not replay.error
                            for replay in replays)),
        'errors': str(sum(bool(replay.error) for replay in replays))})
    for replay in replays:
        seconds = sum(result.duration for result in replay.results)
        case = ElementTree.SubElement(suite, 'testcase', {
            'classname': 'scenarios', 'name': replay.name, 'time': f'{seconds:.3f}'})
        text = '\n'.join(f'{result.control_law}: {headline(result)}' for result in replay.results)
        if replay.error:
            ElementTree.SubElement(case, 'error', {'message': replay.error})
        elif not replay.is_as_expected:
            ElementTree.SubElement(case, 'failure', {'message': text})
        ElementTree.SubElement(case, 'system-out').text = text
    ElementTree.indent(suite)
    return ElementTree.tostring(suite, encoding='unicode', xml_declaration=True) + '\n'


def _finite(value: Any) -> Any:
    return None if isinstance(value, float) and not math.isfinite(value) else value
