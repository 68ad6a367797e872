"""Objects that stand while another is pushed, as cells of a map that are not free."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from push_model.geometry import BoolArray, FloatArray, Pose
from push_model.parameters import PushedObject
from push_planner.rearrangement.footprints import distances_to_object

# Standard deviations of a measured pose by which its obstacle is wider; chosen.
MARGIN_SIGMAS = 2.0


class StandingObject(NamedTuple):
    """
    An object that stands.

    :param obj: the ``PushedObject``.
    :param pose: ``Pose`` in the world.
    """

    obj: PushedObject
    pose: Pose


class MapGrid(NamedTuple):
    """
    Cells of a map.

    :param resolution: side of a cell [m].
    :param origin: ``Pose`` in the world of the corner from which rows and columns count.
    :param rows: number of rows, along y.
    :param columns: number of columns, along x.
    """

    resolution: float
    origin: Pose
    rows: int
    columns: int


def covered_cells(grid: MapGrid, standing: Sequence[StandingObject], margin: float,
                  pushed: StandingObject) -> BoolArray:
    """
    Tell which cells objects may reach into, but for those in which the pushed one stands.

    Objects that touch share cells: the pushed one could not be planned away from the other.

    :param grid: the ``MapGrid``.
    :param standing: where they are measured.
    :param margin: uncertainty of their outlines [m].
    :param pushed: where the pushed one is measured.
    :return: shape (rows, columns).
    """
    rows, columns = np.indices((grid.rows, grid.columns)).reshape(2, -1)
    centers: FloatArray = np.asarray(
        grid.resolution * np.stack((columns + 0.5, rows + 0.5), axis=1), dtype=np.float64)
    to_map = grid.origin.inverse()

    def is_within(item: StandingObject, gap: float) -> BoolArray:
        distances = distances_to_object(centers, item.obj, to_map @ item.pose)
        return np.asarray(distances < gap + 0.5 * grid.resolution, dtype=np.bool_)

    covered = np.zeros(len(centers), dtype=np.bool_)
    for item in standing:
        covered |= is_within(item, margin)
    return (covered & ~is_within(pushed, 0.0)).reshape(grid.rows, grid.columns)
