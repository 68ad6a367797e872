"""The programme's algebra against differences, and its integration against its own limit."""

import math

import numpy as np
from push_model.geometry import Pose
from push_planner.rollout import graded, Rollout, settling_way
from push_planner.stage import Constants, NODE, POINTS, radau
from push_planner.stage_functions import EQUALITIES, StageFunctions
from push_planner.warm_start import guess, routes
from push_problems import DIFFERENTIAL, HOLONOMIC, vertex_problem
import pytest

PROBLEM = vertex_problem(Pose(1.5, 0.5, 0.0), normal=0.05, heading=-0.03)
BOUNDS = [0.25, 2.0, 10.0, 0.1, 1.4]


def sample_inputs(seed):
    generator = np.random.default_rng(seed)
    node = [*generator.normal(size=3), generator.normal(scale=0.5), generator.normal(scale=0.3)]
    return np.array([*node, *generator.normal(scale=0.2, size=2), generator.uniform(0.05, 0.3),
                     *generator.normal(scale=0.5, size=POINTS)])


def central_differences(function, point, step=1e-6):
    columns = []
    for i in range(len(point)):
        shift = np.zeros(len(point))
        shift[i] = step
        columns.append((function(point + shift) - function(point - shift)) / (2.0 * step))
    return np.column_stack(columns)


@pytest.mark.parametrize('drive', ['differential', 'holonomic'])
@pytest.mark.parametrize('moving', [0.0, 1.0])
def test_derivatives_of_a_stage_agree_with_differences(drive, moving):
    """First and second, at random points."""
    stage = StageFunctions(drive, len(PROBLEM.obj.supports))
    physics = np.concatenate([Constants.of(PROBLEM).column(), BOUNDS])
    weights = np.random.default_rng(7).normal(size=stage.rows)
    for seed in range(3):
        inputs = sample_inputs(seed)

        def value(x):
            return np.array(stage.value(x, moving, physics)).ravel()

        def weighted_slope(x):
            return np.array(stage.slope(x, moving, physics)[1]).T @ weights

        slope = np.array(stage.slope(inputs, moving, physics)[1])
        bend = np.array(stage.bend(inputs, moving, physics, weights))
        scale = 1.0 + np.abs(slope).max()
        np.testing.assert_allclose(slope, central_differences(value, inputs), atol=1e-6 * scale)
        scale = 1.0 + np.abs(bend).max()
        np.testing.assert_allclose(bend, central_differences(weighted_slope, inputs),
                                   atol=1e-6 * scale)
        np.testing.assert_allclose(bend, bend.T, atol=1e-9 * scale)


@pytest.mark.parametrize('degree', range(POINTS))
def test_radau_integrates_polynomials_exactly(degree):
    """To the points for degree POINTS - 1, to the end for 2 POINTS - 2."""
    points, matrix, inverse = radau()
    np.testing.assert_allclose(matrix @ points ** degree, points ** (degree + 1) / (degree + 1),
                               atol=1e-14)
    high = degree + POINTS - 1
    assert matrix[-1] @ points ** high == pytest.approx(1.0 / (high + 1))
    np.testing.assert_allclose(matrix @ inverse, np.eye(POINTS), atol=1e-13)


@pytest.mark.parametrize('robot', [DIFFERENTIAL, HOLONOMIC], ids=lambda r: r.drive)
def test_fine_integration_converges_fast(robot):
    """At least with the fourth power of the step, through the settling after a switch."""
    problem = vertex_problem(Pose(1.5, 0.5, 0.0), robot, pushing_speed=0.4)
    begin = np.array([0.0, 0.0, -math.pi / 4, 0.0, 0.0])

    def end(spacing):
        rollout = Rollout(problem, spacing, 1e-3, first=spacing)
        return rollout.segment(begin, None, 0.12, 0.48).nodes[-1]

    exact = end(0.0025)
    errors = [np.abs(end(spacing) - exact).max() for spacing in (0.04, 0.02)]
    assert errors[0] < 1e-4
    assert errors[1] < errors[0] / 16.0


def test_settling_way_is_that_of_the_rollout():
    """After the first touch w nears its steady value by a factor e per settling way."""
    problem = vertex_problem(Pose(1.5, 0.5, 0.0), HOLONOMIC, pushing_speed=0.05)
    rollout = Rollout(problem, 2e-5, 1e-4)
    segment = rollout.segment(np.array([0.0, 0.0, -math.pi / 4, 0.0, 0.0]), None, 1e-3, 0.01)
    w = segment.nodes[:, NODE.index('w')]
    # Beyond the settling w grows slowly: the push is unstable.
    steady = w[-1]
    jump = segment.begin[NODE.index('w')] - steady
    index = np.searchsorted(segment.ways, settling_way(problem))
    assert (w[index] - steady) / jump == pytest.approx(math.exp(-1.0), abs=0.05)


@pytest.mark.parametrize('length, first, longest', [(0.3, 0.001, 0.015), (0.01, 0.02, 0.015),
                                                    (0.0004, 0.001, 0.015), (1.0, 0.1, 0.1)])
def test_graded_steps_fill_the_way(length, first, longest):
    """They sum to it, grow, and none is longer than allowed."""
    steps = graded(length, first, longest)
    assert steps.sum() == pytest.approx(length)
    assert (steps > 0.0).all() and steps.max() <= longest * (1.0 + 1e-12)
    assert steps[0] <= first * (1.0 + 1e-12)


@pytest.mark.parametrize('robot', [DIFFERENTIAL, HOLONOMIC], ids=lambda r: r.drive)
def test_the_guess_nearly_keeps_the_equations(robot):
    """Its nodes follow each other as the rolling kinematics ask for, to a few centimetres."""
    problem = vertex_problem(Pose(1.5, 0.5, 0.0), robot, pushing_speed=0.02)
    iterate = guess(problem, routes(problem)[0], 48)
    stage = StageFunctions(robot.drive, 4)
    physics = np.concatenate([Constants.of(problem).column(), BOUNDS])
    moment = []
    for k in range(1, 48):
        inputs = [*iterate.nodes[k - 1], iterate.angles[k - 1], iterate.angles[k],
                  iterate.way / 48, *iterate.rates[k]]
        rows = np.array(stage.value(inputs, 1.0, physics)).ravel()
        assert np.abs(iterate.nodes[k] + rows[:len(NODE)])[:3].max() < 0.03
        moment.append(np.abs(rows[len(NODE):EQUALITIES]).max())
    # Relative to the supports' friction times a metre; large only where the curvature jumps.
    assert np.median(moment) < 0.01
