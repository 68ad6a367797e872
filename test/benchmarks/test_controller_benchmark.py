"""Benchmark of the controller: confidence interval, groups, published laws, evaluated paths."""

import math
from types import SimpleNamespace

from benchmarks.controller.grid import evaluate_path, PATH_LENGTH, push
from benchmarks.controller.published_laws import dipole_law, force_angle_law
from benchmarks.controller.tables import ALL, groups, wilson
import numpy as np
from push_model.geometry import Pose
import pytest

CASE = {'inertia': 1.0 / 6.0, 'friction': 0.5, 'aside': 0.4, 'yaw': math.radians(22.5),
        'along': -0.4}


@pytest.mark.parametrize(('hits', 'count'), [(0, 10), (5, 10), (997, 1000), (1000, 1000)])
def test_the_interval_is_that_of_scipy(hits, count):
    """Also where all or none succeed."""
    # Imported here: collecting the tests takes a tenth of the time of all of them.
    from scipy.stats import binomtest
    expected = binomtest(hits, count).proportion_ci(method='wilson')
    assert wilson(hits, count) == pytest.approx((expected.low, expected.high), abs=1e-5)


def test_refused_pushes_are_counted_apart():
    """Neither goals without a plan nor refused starts are pushes; failures are."""
    def job(seed):
        return {'kind': 'box, holonomic', 'stress': 'as stated', 'seed': seed}

    def record(outcome, success):
        return {'plan': '', **{f'{law}.{name}': value for law in ('feedback', 'mpc')
                               for name, value in (('outcome', outcome), ('success', success))}}

    records = [{'plan': 'no contact'}, record('refused', False), record('failed', False),
               record('done', True), record('done', False)]
    found = groups([job(seed) for seed in range(5)], records)
    assert {group.kind for group in found} == {ALL, 'box, holonomic'}
    for group in found:
        assert (group.unplanned, group.refused, len(group.pushes), group.successes) == (1, 1, 3, 1)


@pytest.mark.parametrize('force', [(1.0, 0.3), (2.0, -0.5), (0.0, 0.0)])
def test_the_force_angle_law_in_the_mirror(force):
    """Mirrored at the x axis, it pushes in the mirrored direction."""
    truth = SimpleNamespace(normal=0.2, force_n=force[0], force_t=force[1])
    mirrored = SimpleNamespace(normal=-0.2, force_n=force[0], force_t=-force[1])
    assert force_angle_law(mirrored, -0.1, -0.3) == pytest.approx(
        -force_angle_law(truth, 0.1, 0.3), abs=1e-12)


def test_the_dipole_law_turns_with_the_world():
    """And drives straight on behind the object."""
    def law(turn):
        world = Pose(0.3, -0.2, turn)
        truth = SimpleNamespace(object_pose=world @ Pose(1.0, 0.5, 0.0),
                                robot_pose=world @ Pose(0.4, 0.2, 0.0))
        return dipole_law(truth, (world @ Pose(3.0, 1.0, 0.0))[:2])

    assert math.remainder(law(1.1) - law(0.0) - 1.1, 2.0 * math.pi) == pytest.approx(0.0, abs=1e-9)
    behind = SimpleNamespace(object_pose=Pose(1.0, 0.0, 0.0), robot_pose=Pose(0.0, 0.0, 0.0))
    assert math.remainder(dipole_law(behind, (2.0, 0.0)), 2.0 * math.pi) == pytest.approx(
        0.0, abs=1e-9)


@pytest.mark.slow
def test_the_force_angle_law_reaches_the_path_from_both_sides():
    """As its authors report; on the plant, mirrored cases end equally far off."""
    mirrored = {**CASE, **{name: -CASE[name] for name in ('aside', 'yaw', 'along')}}
    found = [push({**case, 'law': 'force angle'}) for case in (CASE, mirrored)]
    assert all(record['converged'] for record in found)
    assert found[0]['off'] == pytest.approx(found[1]['off'], abs=1e-3)


@pytest.mark.parametrize(('position', 'aside', 'converged'), [
    (PATH_LENGTH, lambda x: 0.0 * x, True), (PATH_LENGTH, lambda x: 0.2 + 0.0 * x, False),
    (PATH_LENGTH, lambda x: 0.4 * np.exp(-x), True),
    (0.7 * PATH_LENGTH, lambda x: 0.0 * x, False)])
def test_the_grid_is_judged_at_its_end(position, aside, converged):
    """On the path at last, wherever it began; one that stops short has not converged."""
    x = np.linspace(0.0, position, 500)
    found = evaluate_path('', np.column_stack([x, aside(x)]))
    assert found['converged'] == converged
    assert found['outcome'] == ('' if position == PATH_LENGTH else 'not there')
