"""The grid of walls lists all that are near, and results are those of looking at all walls."""

import math

from helpers.objects import bin_, box
import numpy as np
from push_dynamics.encoding import (
    body_values, drive_values, initial_state, NO_OUTLINE, support_rows,
)
from push_dynamics.layout import TOUCH_SIZE, WALL_SLACK, World
from push_dynamics.step import advance
from push_dynamics.touches import MAX_TOUCHES
from push_dynamics.wall_grid import touch_reach, wall_grid, walls_near
from push_dynamics.walls import Wall, wall_rows
from push_model.geometry import FloatArray, Pose
from push_model.parameters import PushedObject, RoundRobot
import pytest

pytestmark = pytest.mark.physics
ROBOT = RoundRobot(0.17, 'holonomic')
# More than the diagonal of the room [m].
EVERYWHERE = 6.0


def ragged_room(rng: np.random.Generator) -> list[Wall]:
    """List walls of one cell each, as of a scanned room, and some slanted ones."""
    corners = np.round(rng.uniform(-2.0, 2.0, (150, 2)), 2)
    corners = corners[np.hypot(*corners.T) > 0.75]
    along = rng.integers(2, size=len(corners))
    walls = [Wall(x, y, x + 0.05 * (1 - a), y + 0.05 * a)
             for (x, y), a in zip(corners.tolist(), along.tolist())]
    return walls + [Wall(-2.0, 0.9, 2.0, 0.75), Wall(0.5, -1.0, 0.6, 1.0)]


def distance(row: FloatArray, point: FloatArray) -> float:
    """Distance of a point from a wall."""
    along = np.clip((point - row[:2]) @ row[2:4], 0.0, row[4])
    return math.hypot(*(point - row[:2] - along * row[2:4]))


def test_all_walls_within_reach_are_listed_in_order() -> None:
    rng, reach = np.random.default_rng(0), 0.4
    grid = wall_grid(wall_rows(ragged_room(rng)), reach)
    counts = []
    for point in rng.uniform(-3.0, 3.0, (150, 2)):
        first, last = walls_near(grid, *point.tolist())
        listed = grid.near[first:last].tolist()
        within = {i for i, row in enumerate(grid.rows) if distance(row, point) <= reach}
        assert within <= set(listed)
        assert listed == sorted(set(listed))
        counts.append(len(listed))
    assert 0 < np.mean(counts) < 0.2 * len(grid.rows)


@pytest.mark.parametrize('obj', [box(), bin_()], ids=['box', 'bin'])
def test_results_are_those_of_looking_at_all_walls(obj: PushedObject) -> None:
    """To the last digit, but for the distance that is left before walls are looked at again."""
    rng = np.random.default_rng(1)
    rows, command = wall_rows(ragged_room(rng)), np.zeros(3)
    start = initial_state(obj, Pose(0.0, 0.0, 0.0), Pose(-0.4, 0.02, 0.0))
    worlds = [World(
        np.array(start), np.array(body_values(obj, ROBOT, 1e-5)),
        np.array(support_rows(obj, obj.capacities, [1.0] * len(obj.supports))),
        np.array(obj.outline or NO_OUTLINE), np.zeros((0, 8)),
        np.zeros(2 * len(obj.supports)), np.array(drive_values(ROBOT)), command,
        wall_grid(rows, reach), np.zeros((MAX_TOUCHES, TOUCH_SIZE)))
        for reach in (touch_reach(obj, ROBOT.radius), EVERYWHERE)]
    forces = 0
    for _ in range(40):
        command[:] = rng.normal((0.3, 0.05, 0.2), (0.1, 0.1, 0.3))
        for world in worlds:
            advance(world, 0.1, 4e-3)
        one, other = (np.delete(world.state, WALL_SLACK) for world in worlds)
        assert one.tolist() == other.tolist()
        forces += bool(worlds[0].touches[0].any())
    assert forces > 5
