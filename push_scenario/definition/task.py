"""A task of a scenario: the robot starts anywhere and pushes as often as it takes."""

import dataclasses
import functools

from push_control.task.settings import SupervisionSettings
from push_model.quantity import check, quantity
from push_navigation.settings import DriveSettings
from push_planner.settings import TaskSettings
from push_scenario.definition.floor_map import FloorMap
from push_scenario.definition.placement import Placement


@dataclasses.dataclass(frozen=True)
class LaterGoal:
    """A goal that takes the place of the one before."""

    goal: Placement
    time: float = quantity('when it is given', 's', above=0.0)

    def __post_init__(self):
        """Validate the fields."""
        check(self)


@dataclasses.dataclass(frozen=True)
class Task:
    """What belongs to a task beside what belongs to a push."""

    drive: DriveSettings = DriveSettings()
    supervision: SupervisionSettings = SupervisionSettings()
    planning: TaskSettings = TaskSettings()
    map: FloorMap | None = None
    goals: tuple[LaterGoal, ...] = quantity('goals that are given later', default=())

    def __post_init__(self):
        """Validate the fields."""
        check(self)
        times = [later.time for later in self.goals]
        if times != sorted(set(times)):
            raise ValueError(f'Task.goals: got the times {times}, expected increasing ones [s]')

    @functools.cached_property
    def occupancy_map(self):
        """``OccupancyMap`` of the map, or None."""
        return self.map and self.map.occupancy_map
