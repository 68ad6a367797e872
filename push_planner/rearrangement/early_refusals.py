"""What cannot be done whatever the order: goals in walls, goals that overlap."""

from collections.abc import Sequence

from push_model.events import ObjectFailure, Report
from push_navigation.occupancy_map import OccupancyMap
from push_planner.rearrangement.footprints import object_gap
from push_planner.rearrangement.moves import MIN_GAP
from push_planner.rearrangement.problem import NamedObject
from push_planner.straight.map_search.planner import MAX_OVERLAP


def early_refusals(objects: Sequence[NamedObject],
                   occupancy_map: OccupancyMap) -> dict[str, Report[ObjectFailure]]:
    """
    Find the objects that get to their goals in no order.

    Of objects whose goals overlap the first by name keeps its goal.

    :param objects: in the order of their names.
    :param occupancy_map: the ``OccupancyMap`` without the objects.
    :return: why, by name.
    """
    refusals: dict[str, Report[ObjectFailure]] = {}
    accepted: list[NamedObject] = []
    for item in objects:
        report = _refusal(item, accepted, occupancy_map)
        if report is None:
            accepted.append(item)
        else:
            refusals[item.name] = report
    return refusals


def _refusal(item: NamedObject, accepted: Sequence[NamedObject],
             occupancy_map: OccupancyMap) -> Report[ObjectFailure] | None:
    """Say why an object cannot get to its goal; None where nothing speaks against it."""
    if item.goal is None:
        return None
    overlap = MAX_OVERLAP + 0.5 * occupancy_map.resolution
    if occupancy_map.object_clearance(item.obj, [item.pose]) < -overlap:
        return ObjectFailure.START_NOT_FREE.report()
    if (occupancy_map.object_clearance(item.obj, [item.goal])
            < -min(MAX_OVERLAP, item.tolerances.position)):
        return ObjectFailure.GOAL_NOT_FREE.report()
    for other in accepted:
        if other.goal is not None and object_gap(
                item.obj, item.goal, other.obj, other.goal) < MIN_GAP:
            return ObjectFailure.GOALS_OVERLAP.report(other=other.name)
    return None
