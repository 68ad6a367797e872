"""
Cost-to-go: expected time until the object is at its goal, on a grid.

The goal in the frame of the object, at distance r, bearing beta and heading theta, and the face f
at which the robot stands make a state. ``value_iteration`` computes the values, which are
interpolated here.
"""

import dataclasses
import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from push_dynamics.compiled import compiled, wrap_angles
from push_model.geometry import FloatArray, Pose

# Rise of V beyond the grid [s/m]: about that of its last two metres.
OUTER_SLOPE = 9.0


class CostGrid(NamedTuple):
    """Cost-to-go as compiled code reads it; fields as of ``CostToGo``."""

    values: NDArray[np.float32]
    distances: FloatArray
    headings: FloatArray


@dataclasses.dataclass(frozen=True, eq=False)
class CostToGo:
    """
    Expected time until the object is at its goal [s]; arrays are read-only.

    :param values: by face where the robot stands, distance, bearing (equally spaced, from 0,
        counter-clockwise) and heading of the goal in the object frame, shape (F, R, B, T) [s].
    :param distances: of the goal, increasing from 0, shape (R,) [m].
    :param headings: of the goal, increasing from -pi to pi, shape (T,) [rad].
    """

    values: NDArray[np.float32]
    distances: FloatArray
    headings: FloatArray

    def __post_init__(self) -> None:
        """Freeze the arrays."""
        for array in (self.values, self.distances, self.headings):
            array.setflags(write=False)

    @property
    def grid(self) -> CostGrid:
        """The same for compiled code."""
        return CostGrid(self.values, self.distances, self.headings)

    def at(self, goal: Pose, face: int) -> float:
        """
        Interpolate.

        :param goal: ``Pose`` of the goal in the object frame.
        :param face: where the robot stands.
        :return: expected time [s].
        """
        return float(interpolate_cost(self.grid, goal, face))


class GridPosition(NamedTuple):
    """
    Position between two points of a grid.

    :param cell: index of the lower point.
    :param fraction: of the distance to the next one, 0 to 1.
    """

    cell: int
    fraction: float


@compiled
def locate(grid: Any, value: float) -> GridPosition:
    """
    Find a value in an increasing grid; beyond the ends the end counts.

    :param grid: shape (n,).
    :param value: of the same unit.
    """
    low, high = 0, grid.shape[0] - 1
    if value <= grid[0]:
        return GridPosition(0, 0.0)
    if value >= grid[high]:
        return GridPosition(high - 1, 1.0)
    while high - low > 1:
        middle = (low + high) // 2
        if grid[middle] <= value:
            low = middle
        else:
            high = middle
    return GridPosition(low, (value - grid[low]) / (grid[low + 1] - grid[low]))


@compiled
def interpolate_cost(grid: CostGrid, goal: Pose, face: int) -> float:
    """
    Interpolate the cost-to-go, linearly in distance, bearing and heading.

    :param goal: in the object frame, its angle not wrapped.
    :param face: where the robot stands.
    :return: expected time [s].
    """
    distance = math.sqrt(goal.x * goal.x + goal.y * goal.y)
    beyond = max(0.0, distance - grid.distances[grid.distances.shape[0] - 1])
    return (interpolate_cell(grid.values, locate(grid.distances, distance),
                             math.atan2(goal.y, goal.x),
                             locate(grid.headings, wrap_angles(goal.theta)), face)
            + OUTER_SLOPE * beyond)


@compiled
def interpolate_cell(values: Any, distance: GridPosition, bearing: float, heading: GridPosition,
                     face: int) -> float:
    """
    Interpolate values between grid points.

    :param values: shape (F, R, B, T), see ``CostToGo``.
    :param distance: ``GridPosition`` among the distances.
    :param bearing: any angle [rad].
    :param heading: ``GridPosition`` among the headings.
    :param face: where the robot stands.
    """
    i, u = distance
    k, w = heading
    count = values.shape[2]
    position = bearing * (count / (2.0 * math.pi))
    j = int(math.floor(position))
    v = position - j
    j = j % count
    after = j + 1 if j + 1 < count else 0
    near = ((values[face, i, j, k] * (1.0 - v) + values[face, i, after, k] * v) * (1.0 - w)
            + (values[face, i, j, k + 1] * (1.0 - v) + values[face, i, after, k + 1] * v) * w)
    i += 1
    far = ((values[face, i, j, k] * (1.0 - v) + values[face, i, after, k] * v) * (1.0 - w)
           + (values[face, i, j, k + 1] * (1.0 - v) + values[face, i, after, k + 1] * v) * w)
    return near * (1.0 - u) + far * u


@compiled
def cost_after(grid: CostGrid, goal: Pose, displacement: Any, face: int) -> float:
    """
    Interpolate the cost-to-go after a displacement of the object.

    Arguments are as in ``interpolate_cost``; ``displacement`` is the new (x, y, theta) of the
    object in its old frame.
    """
    d_x, d_y = goal.x - displacement[0], goal.y - displacement[1]
    c, s = math.cos(displacement[2]), math.sin(displacement[2])
    return interpolate_cost(grid, Pose(c * d_x + s * d_y, c * d_y - s * d_x,
                                       goal.theta - displacement[2]), face)
