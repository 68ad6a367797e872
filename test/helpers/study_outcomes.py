"""Computes studies in memory, with the values of config/studies.yaml or others."""

from typing import Any

from push_study.framework.parameters import read_chosen_values, Values
from push_study.framework.runner import run_in_memory
from push_study.framework.study import Outcome, Study


def values_of(study: Study, **overrides: Any) -> Values:
    """Return the values of a study, some of them overridden."""
    return study.values(read_chosen_values(), overrides)


# Those with the values of config/studies.yaml, by figure: the gallery shows what tests check.
_OUTCOMES: dict[str, Outcome] = {}


def outcome_of(study: Study, **overrides: Any) -> Outcome:
    """Compute a study, once without overrides; its caption must be complete."""
    if not overrides and study.figure in _OUTCOMES:
        return _OUTCOMES[study.figure]
    outcome = study.compute(values_of(study, **overrides), run_in_memory)
    assert study.caption(outcome.findings)
    if not overrides:
        _OUTCOMES[study.figure] = outcome
    return outcome


def numbers(outcome: Outcome) -> dict[str, float]:
    """Return the findings of an outcome as plain numbers."""
    return {name: finding.value for name, finding in outcome.findings.items()}


def by_figure(*modules: Any) -> dict[str, Study]:
    """Return the studies of modules by the number of their figure."""
    return {study.figure: study for module in modules for study in module.STUDIES}
