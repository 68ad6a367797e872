"""Computes studies in memory, with the values of studies/values.yaml or others."""

import functools
from typing import Any, Callable, Sequence

from studies.framework.parameters import ChosenValues, read_chosen_values, Values
from studies.framework.study import Outcome, Record, SHORT_JOB, Study


def run_in_memory(function: Callable[[Any], Record], jobs: Sequence[Any], /, *,
                  job_time: float = SHORT_JOB) -> Sequence[Record]:
    """Run jobs one after the other, in memory; for ``compute`` without a runner."""
    return [function(job) for job in jobs]


@functools.lru_cache(maxsize=None)
def chosen_values() -> ChosenValues:
    """Read studies/values.yaml, once."""
    return read_chosen_values()


def values_of(study: Study, **overrides: Any) -> Values:
    """Return the values of a study, some of them overridden."""
    return study.values(chosen_values(), overrides)


# By figure and overrides: the gallery shows what tests check.
_OUTCOMES: dict[tuple[str, str], Outcome] = {}
# Studies that take long, and what tests compute of them: fewer pushes, or those of another study.
DRAWN = {'seeds': 1, 'factors': [2.0, 2.0], 'start_times': [4.0, 4.0], 'intervals': [2.0, 2.0]}
QUICK: dict[str, dict[str, Any]] = {
    '4.1': {'goal': [2.0, -0.5, 0.3]}, '4.3': {'goal': [2.0, -0.5, 0.3]},
    '4.7': {'seeds': 1}, '4.10': DRAWN, '4.14': DRAWN,
    'four-goals': {'goals': [[2.0, -0.5, 0.3]]},
    'disturbed-objects': {'seeds': 1}, 'side-push-experiment': {'seeds': 1}}


def outcome_of(study: Study, **overrides: Any) -> Outcome:
    """Compute a study, once for the same values; its caption must be complete."""
    key = (study.figure, repr(sorted(overrides.items())))
    if key not in _OUTCOMES:
        _OUTCOMES[key] = study.compute(values_of(study, **overrides), run_in_memory)
        assert study.caption(_OUTCOMES[key].findings)
    return _OUTCOMES[key]


def quick_outcome_of(study: Study) -> Outcome:
    """Compute a study, with fewer pushes where it has many."""
    return outcome_of(study, **QUICK.get(study.figure, {}))


def numbers(outcome: Outcome) -> dict[str, float]:
    """Return the findings of an outcome as plain numbers."""
    return {name: finding.value for name, finding in outcome.findings.items()}


def by_figure(*modules: Any) -> dict[str, Study]:
    """Return the studies of modules by the number of their figure."""
    return {study.figure: study for module in modules for study in module.STUDIES}
