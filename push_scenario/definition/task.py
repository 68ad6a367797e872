"""Tasks of scenarios: the robot may start anywhere, and pushes as often as it takes."""

import dataclasses
import functools

from push_control.supervision_settings import SupervisionSettings
from push_localization.settings import PlaceSettings
from push_model.quantity import check, quantity
from push_navigation.occupancy_map import OccupancyMap
from push_navigation.settings import DriveSettings, MapSettings
from push_scenario.definition.floor_map import FloorMap
from push_scenario.definition.placement import Placement


@dataclasses.dataclass(frozen=True)
class LaterGoal:
    """A goal that replaces the one before during the task."""

    goal: Placement
    time: float = quantity('when it is given', 's', above=0.0)

    def __post_init__(self) -> None:
        """Validate the fields."""
        check(self)


@dataclasses.dataclass(frozen=True)
class Task:
    """Settings of a task in addition to those of a single push."""

    drive: DriveSettings = DriveSettings()
    supervision: SupervisionSettings = SupervisionSettings()
    map: FloorMap | None = None
    map_reading: MapSettings = MapSettings()
    place: PlaceSettings = PlaceSettings()
    goals: tuple[LaterGoal, ...] = quantity('goals that are given later', default=())

    def __post_init__(self) -> None:
        """Validate the fields."""
        check(self)
        times = [later.time for later in self.goals]
        if times != sorted(set(times)):
            raise ValueError(f'Task.goals: got the times {times}, expected increasing ones [s]')

    @functools.cached_property
    def occupancy_map(self) -> OccupancyMap | None:
        """``OccupancyMap`` of the map, or None."""
        return None if self.map is None else self.map.read(self.map_reading)
