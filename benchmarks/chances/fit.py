"""Fit of the outlook of plans: quantile regression, and shares of runs."""

from typing import Any, Sequence

from benchmarks.chances.samples import Ends, Sample
import numpy as np
from push_model.geometry import FloatArray
from push_model.outlook import LEVELS
from push_planner.outlook import STEERED_PUSH
from scipy import sparse
from scipy.optimize import linprog


def fit_model(samples: Sequence[Sample]) -> dict[str, Any]:
    """
    Fit one model of ``push_planner.outlook``.

    :param samples: of this model.
    :return: plain values, as ``OutlookModel.from_mapping`` takes them.
    """
    done = [sample for sample in samples if sample.is_done]
    weights = np.array([sample.weight for sample in done])
    chance = _chance([sample for sample in samples if not sample.is_retry], 0.5)
    model: dict[str, Any] = {'chance': _rounded(chance), 'retry_chance': _rounded(_chance(
        [sample for sample in samples if sample.is_retry], chance))}
    for name in Ends._fields:
        known, actual = (np.array([getattr(getattr(sample, part), name) for sample in done])
                         for part in ('known', 'actual'))
        lines = [quantile_line(known, actual, weights, level) for level in LEVELS]
        model[name] = {'offsets': [_rounded(offset) for offset, _ in lines],
                       'slopes': [_rounded(slope) for _, slope in lines]}
    return model


def quantile_line(known: FloatArray, actual: FloatArray, weights: FloatArray,
                  level: float) -> tuple[float, float]:
    """
    Fit a line below which a share of the samples lies.

    It minimizes ``sum of w (level r+ + (1 - level) r-)`` over the residuals ``r+ - r- = y - a - b
    x`` (Koenker and Bassett 1978), as a linear program. The slope is not negative: whoever expects
    more gets no less. Where x is always the same, the line passes through the origin.

    :param known: x, shape (n,).
    :param actual: y, shape (n,).
    :param weights: w, shape (n,).
    :param level: the share, in (0, 1).
    :return: offset a and slope b.
    """
    scale_x, scale_y = known.max() or 1.0, actual.max() or 1.0
    count = len(known)
    costs = np.concatenate([(0.0, 0.0), level * weights, (1.0 - level) * weights])
    eye = sparse.eye(count)
    equations = sparse.hstack([np.column_stack([np.ones(count), known / scale_x]), eye, -eye])
    is_constant = bool(np.ptp(known) <= 1e-9 * scale_x)
    offset_bounds = (0.0, 0.0) if is_constant else (None, None)
    bounds = [offset_bounds, (0.0, None)] + [(0.0, None)] * (2 * count)
    solution = linprog(costs, A_eq=equations, b_eq=actual / scale_y, bounds=bounds)
    offset, slope = solution.x[:2]
    return float(offset * scale_y), float(slope * scale_y / scale_x)


def _chance(samples: Sequence[Sample], expected: float) -> float:
    """
    Estimate a chance by Laplace's rule of succession: what is expected counts as two runs.

    A steered push counts where it is done, whatever its tolerances.
    """
    hits = sum(sample.weight * (sample.is_done if sample.model == STEERED_PUSH
                                else sample.is_within) for sample in samples)
    return (hits + 2.0 * expected) / (sum(sample.weight for sample in samples) + 2.0)


def _rounded(value: float) -> float:
    """Round to what can be told apart."""
    return float(f'{value:.4g}')
