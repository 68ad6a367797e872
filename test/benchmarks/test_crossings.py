"""Whoever walks at a robot meets it, and does not walk through it."""

import math

from benchmarks.crossings.crossings import walk
import numpy as np
import pytest

LEAST = 0.36
ROBOT = np.zeros(2)


@pytest.mark.parametrize('seed', range(20))
def test_nobody_walks_through_a_robot(seed: int) -> None:
    """Neither who walks at it, nor who is overtaken by it."""
    rng = np.random.default_rng(seed)
    direction = rng.uniform(-math.pi, math.pi)
    step = rng.uniform(0.001, 0.2) * np.array([math.cos(direction), math.sin(direction)])
    lateral = rng.uniform(-0.6, 0.6)
    person = -10.0 * step + lateral * np.array([-math.sin(direction), math.cos(direction)])
    robot, motion = ROBOT, rng.uniform(-0.01, 0.01, 2)
    for _ in range(40):
        person = walk(person, step, robot, LEAST)
        assert np.hypot(*(person - robot)) >= LEAST - 1e-12
        robot = robot + motion


@pytest.mark.parametrize('lateral', [0.0, 0.3, -0.35, 0.37, 1.0])
def test_a_robot_that_stands_is_touched_or_passed(lateral: float) -> None:
    """Who walks past it goes as straight and as far as without it; who meets it stops there."""
    person, step = np.array([-1.0, lateral]), np.array([0.1, 0.0])
    for _ in range(20):
        person = walk(person, step, ROBOT, LEAST)
    meets = abs(lateral) < LEAST
    assert person[1] == lateral
    assert np.hypot(*person) == pytest.approx(LEAST) if meets else person[0] == pytest.approx(1.0)
