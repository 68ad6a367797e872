"""Computes studies in memory, with the values of config/studies.yaml or others."""

from typing import Any, Callable, Sequence

from push_study.framework.parameters import read_chosen_values, Values
from push_study.framework.study import Outcome, Record, SHORT_JOB, Study


def run_in_memory(function: Callable[[Any], Record], jobs: Sequence[Any], /, *,
                  job_time: float = SHORT_JOB) -> Sequence[Record]:
    """Run jobs one after the other, in memory; for ``compute`` without a runner."""
    return [function(job) for job in jobs]


def values_of(study: Study, **overrides: Any) -> Values:
    """Return the values of a study, some of them overridden."""
    return study.values(read_chosen_values(), overrides)


# By figure and overrides: the gallery shows what tests check.
_OUTCOMES: dict[tuple[str, str], Outcome] = {}
# Studies that repeat pushes take a minute; tests repeat them twice.
REPEATED = ('4.7', '4.10', '4.14', 'disturbed-objects')


def outcome_of(study: Study, **overrides: Any) -> Outcome:
    """Compute a study, once for the same values; its caption must be complete."""
    key = (study.figure, repr(sorted(overrides.items())))
    if key not in _OUTCOMES:
        _OUTCOMES[key] = study.compute(values_of(study, **overrides), run_in_memory)
        assert study.caption(_OUTCOMES[key].findings)
    return _OUTCOMES[key]


def quick_outcome_of(study: Study) -> Outcome:
    """Compute a study, with few repetitions where it has many."""
    return outcome_of(study, **({'seeds': 2} if study.figure in REPEATED else {}))


def numbers(outcome: Outcome) -> dict[str, float]:
    """Return the findings of an outcome as plain numbers."""
    return {name: finding.value for name, finding in outcome.findings.items()}


def by_figure(*modules: Any) -> dict[str, Study]:
    """Return the studies of modules by the number of their figure."""
    return {study.figure: study for module in modules for study in module.STUDIES}
