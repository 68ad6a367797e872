"""A session's set-up as a scenario file."""

import dataclasses

from push_navigation.occupancy_map import OccupancyMap
from push_scenario.definition.floor_map import FloorMap, FREE, OCCUPIED
from push_scenario.definition.loader import scenario_text
from push_scenario.definition.placement import Placement
from push_view.live.setup import Setup

DESCRIPTION = 'Saved from the page; it began as {name}.'


def saved_scenario(setup: Setup, occupancy_map: OccupancyMap | None) -> str:
    """
    Write a set-up as YAML, which ``push replay`` reads.

    :param occupancy_map: map with the walls that were drawn; None for open floor.
    """
    floor_map = None if occupancy_map is None else _floor_map(occupancy_map)
    scenario = dataclasses.replace(
        setup.scenario, description=DESCRIPTION.format(name=setup.origin.name),
        task=dataclasses.replace(setup.task, map=floor_map))
    return scenario_text(scenario)


def _floor_map(occupancy_map: OccupancyMap) -> FloorMap:
    rows = [''.join(OCCUPIED if cell else FREE for cell in row)
            for row in occupancy_map.occupied.tolist()]
    return FloorMap(occupancy_map.resolution, '\n'.join(reversed(rows)),
                    Placement(*occupancy_map.origin))
