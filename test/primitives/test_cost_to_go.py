"""Laws of the cost-to-go: tolerances, symmetry and Bellman's equation."""

import dataclasses
import math

from helpers.objects import bin_, box
import numpy as np
from push_model.geometry import Pose
from push_model.parameters import RoundRobot
from push_primitives import value_iteration
from push_primitives.cost_settings import CostSettings
from push_primitives.cost_to_go import CostToGo
from push_primitives.placement_errors import PlacementDeviations
from push_primitives.store import load_primitives
from push_primitives.table import build_table, FrictionSamples, sample_friction
from push_primitives.value_iteration import (
    distance_grid, face_change_times, heading_grid, select_actions, solve_cost_to_go,
)
import pytest

RADIUS = 0.17
BIN = bin_(feet=4)
ROBOT = RoundRobot(radius=RADIUS, max_speed=0.3)
EXACT = PlacementDeviations(0.0, 0.0, 0.0)


@pytest.fixture(scope='module')
def primitives():
    """Return the primitives of a bin."""
    return load_primitives(BIN, ROBOT)


@pytest.fixture(scope='module')
def table():
    """Return the table of a bin for nominal friction only."""
    nominal = FrictionSamples(*(array[:1] for array in sample_friction(BIN)))
    return build_table(BIN, RADIUS, friction_samples=nominal)


@pytest.fixture
def few_bearings(monkeypatch):
    """Make grids with few bearings, which are solved sooner."""
    monkeypatch.setattr(value_iteration, 'BEARINGS', 8)
    return 8


@pytest.mark.slow
def test_there_is_nothing_to_do_inside_the_tolerances_alone(primitives):
    """V is 0 there, and at least the time of a contact outside."""
    cost_to_go, settings = primitives.cost_to_go, primitives.settings
    distances, headings = np.meshgrid(cost_to_go.distances, cost_to_go.headings, indexing='ij')
    arrived = ((distances <= settings.position_limit + 1e-9)
               & (np.abs(headings) <= settings.heading_limit + 1e-9))
    for face in range(4):
        values = cost_to_go.values[face].transpose(0, 2, 1)
        assert not values[arrived].any()
        assert (values[~arrived] > settings.contact_time + settings.push_time).all()
    assert np.isfinite(cost_to_go.values).all()


@pytest.mark.slow
def test_bellman_equation_holds(primitives):
    """The best of all actions, evaluated one by one, is as good as V states."""
    table, settings = primitives.table, primitives.settings
    cost_to_go = primitives.cost_to_go
    actions = select_actions(table, settings)
    times = face_change_times(table, settings)
    rng = np.random.default_rng(3)
    ratios = []
    for _ in range(12):
        i = int(rng.integers(3, len(cost_to_go.distances)))
        j, k = int(rng.integers(32)), int(rng.integers(len(cost_to_go.headings)))
        bearing = 2.0 * math.pi * j / 32
        goal = Pose(cost_to_go.distances[i] * math.cos(bearing),
                    cost_to_go.distances[i] * math.sin(bearing), cost_to_go.headings[k])
        after = [np.mean([cost_to_go.at(Pose(*displacement).inverse() @ goal, int(face))
                          for displacement in displacements])
                 for displacements, face in zip(actions.displacements, actions.faces)]
        best = np.min(times[0, actions.faces] + actions.times + after)
        ratios.append(cost_to_go.values[0, i, j, k] / best)
    assert np.min(ratios) > 0.97
    assert np.max(ratios) < 1.1
    assert np.mean(np.abs(np.log(ratios))) < 0.01


@pytest.mark.slow
def test_the_mirrored_goal_is_as_far(few_bearings):
    """The box is symmetric about its x axis, which swaps its first and third face."""
    obj = box(foot=0.17)
    nominal = FrictionSamples(*(array[:1] for array in sample_friction(obj)))
    table = build_table(obj, RADIUS, friction_samples=nominal)
    parts: list[float] = []
    values = solve_cost_to_go(table, deviations=EXACT, progress=parts.append).values
    # Progress is stated from the first sweep to the whole.
    assert parts == sorted(parts) and 0.0 < parts[0] < 0.02 and parts[-1] == pytest.approx(1.0)
    mirrored = values[[2, 1, 0, 3]][:, :, (-np.arange(few_bearings)) % few_bearings, ::-1]
    outside = values > 0.0
    np.testing.assert_array_equal(outside, mirrored > 0.0)
    errors = np.abs(values - mirrored)[outside] / values[outside]
    # A push at the middle rolls to a side that rounding decides.
    assert errors.mean() < 0.01
    unmirrored = np.abs(values - values[:, :, :, ::-1])[outside] / values[outside]
    assert unmirrored.mean() > 5.0 * errors.mean()


@pytest.mark.slow
def test_tighter_tolerances_and_slower_robots_take_longer(table, few_bearings):
    """Everywhere outside the tolerances, up to what interpolation makes of other grids."""
    assert few_bearings < 32
    usual = solve_cost_to_go(table, deviations=EXACT)
    tight = solve_cost_to_go(table, CostSettings(position_tolerance=0.003), deviations=EXACT)
    slow = solve_cost_to_go(table, CostSettings(robot_speed=0.15), deviations=EXACT)
    assert (slow.values >= usual.values - 1e-3).all()
    rng = np.random.default_rng(0)
    goals = [Pose(*rng.normal(0.0, 0.1, 3)) for _ in range(200)]
    extra = [tight.at(goal, 0) - usual.at(goal, 0) for goal in goals]
    assert np.mean(extra) > 0.0


def test_the_grids_have_the_edges_of_the_tolerances():
    """They increase strictly from 0, or are symmetric about it."""
    for limit in (0.0085, 0.0035, 0.0015, 0.05):
        grid = distance_grid(limit)
        assert (np.diff(grid) > 0.0).all() and grid[0] == 0.0 and limit in grid
        assert grid[-1] >= 3.3
    for limit in (math.radians(0.8), math.radians(0.1), 0.2):
        grid = heading_grid(limit)
        assert (np.diff(grid) > 0.0).all() and limit in grid
        np.testing.assert_array_equal(grid, -grid[::-1])
        assert grid[-1] == math.pi


def test_values_are_interpolated_between_the_grid_points():
    """At grid points V is the value; headings and bearings wrap."""
    rng = np.random.default_rng(5)
    distances, headings = distance_grid(0.0085), heading_grid(0.014)
    values = rng.uniform(1.0, 2.0, (2, len(distances), 32, len(headings))).astype(np.float32)
    values[..., 0] = values[..., -1]
    cost_to_go = CostToGo(values, distances, headings)
    for i, j, k in ((3, 0, 4), (5, 31, 0), (7, 16, len(headings) - 1), (2, 9, 12)):
        bearing = 2.0 * math.pi * j / 32 + 1e-12
        for turn in (-2.0 * math.pi, 0.0, 2.0 * math.pi):
            goal = Pose(distances[i] * math.cos(bearing), distances[i] * math.sin(bearing),
                        headings[k] + turn)
            assert cost_to_go.at(goal, 1) == pytest.approx(values[1, i, j, k], abs=1e-6)
    between = Pose(0.5 * (distances[4] + distances[5]), 0.0, headings[9])
    assert cost_to_go.at(between, 0) == pytest.approx(values[0, 4:6, 0, 9].mean(), abs=1e-6)


def test_settings_are_validated():
    """Nothing but a position within the tolerance is left where a look is very unsure."""
    with pytest.raises(ValueError, match=r'CostSettings\.position_tolerance'):
        CostSettings(position_tolerance=0.0)
    unsure = dataclasses.replace(CostSettings(), position_deviation=0.1)
    assert unsure.position_limit == pytest.approx(0.003)
