"""Live session: the simulation of a task, which its user disturbs and redirects under way."""

from collections.abc import Callable
import dataclasses
import math
from typing import Any

from push_model.geometry import Pose, wrap_angle
from push_navigation.occupancy_map import OccupancyMap
from push_planner.straight.map_search.planner import warm_up
from push_view.live.live_run import LiveRun
from push_view.live.settings import CONTACT_FRICTION, find_setting, FRICTION, with_friction
from push_view.live.setup import Setup
from push_view.live.walls import open_floor, with_wall
from push_view.server.commands import (
    AddWall, Choose, ClearWalls, Command, CommandRefused, DisplaceObject, Restart, Run, SetGoal,
    SetValue, Step,
)
from push_view.server.message_log import MessageLog


class Session:
    """
    A run under way, what it was made of, and the commands that change both.

    Time passes only in ``advance``.

    :param setup: ``Setup`` to start from.
    :param log: where the messages go.
    """

    def __init__(self, setup: Setup, log: MessageLog) -> None:
        self.log = log
        self.paused = False
        self.speed = 1.0
        self._map: OccupancyMap | None = setup.task.occupancy_map
        self.show_speed()
        self._start(setup)

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return self._run.time

    @property
    def is_standing(self) -> bool:
        """Tell whether the robot waits for a goal."""
        return self._run.is_standing

    @property
    def object_pose(self) -> Pose:
        """True ``Pose`` of the object."""
        return self._run.object_pose

    def advance(self, duration: float, is_late: Callable[[], bool] = lambda: False) -> None:
        """
        Let simulated time pass.

        :param duration: how much [s]; to the next measurement at least.
        :param is_late: asked after every measurement whether to stop before.
        """
        end = self.time + duration
        self._run.advance()
        while self.time < end and not is_late():
            self._run.advance()
        self._run.show()

    def handle(self, command: Command) -> None:
        """
        Do what the user asks for.

        :raises CommandRefused: where it cannot be done, with the reason; then nothing changes.
        """
        handlers: dict[type[Any], Callable[[Any], None]] = {
            SetGoal: self._set_goal, DisplaceObject: self._displace_object,
            AddWall: self._add_wall, ClearWalls: self._clear_walls, Choose: self._choose,
            SetValue: self._set_value, Run: self._set_speed, Step: self._step,
            Restart: self._restart}
        if type(command) not in handlers:
            raise CommandRefused('call: got one to a simulation, expected one to a robot')
        try:
            handlers[type(command)](command)
        except CommandRefused:
            raise
        except ValueError as error:
            raise CommandRefused(str(error)) from error

    def prepare_for_walls(self) -> None:
        """Plan once in a map, which takes a minute where that has not been compiled yet."""
        scenario = self._setup.scenario
        warm_up(scenario.object, scenario.robot, self._setup.task.drive)

    def show_speed(self, achieved: float = math.nan) -> None:
        """
        Show whether time runs, and how fast.

        :param achieved: simulated over real time, as measured; nan where it is not known.
        """
        self.log.replace({'type': 'run', 'paused': self.paused, 'speed': self.speed,
                          'achieved': None if math.isnan(achieved) else round(achieved, 1)})

    def _start(self, setup: Setup) -> None:
        """Start over, with the walls that are there."""
        self._run = LiveRun(setup, self._map, self.log)
        self._setup = setup
        self._show_controls()

    def _show_controls(self) -> None:
        self.log.replace(self._setup.controls())

    def _set_goal(self, command: SetGoal) -> None:
        self._run.set_goal(self._near_object(command.pose))

    def _displace_object(self, command: DisplaceObject) -> None:
        self._run.displace_object(self._near_object(command.pose))
        if self.paused:
            # Where it is now is seen in the next row.
            self._advance_by_a_row()

    def _near_object(self, pose: Pose) -> Pose:
        """Count the heading by the short side round from that of the object."""
        heading = self.object_pose.theta
        return pose._replace(theta=heading + wrap_angle(pose.theta - heading))

    def _add_wall(self, command: AddWall) -> None:
        floor = open_floor(self.object_pose) if self._map is None else self._map
        self._set_map(with_wall(floor, command.start, command.end))

    def _clear_walls(self, _: ClearWalls) -> None:
        self._set_map(self._setup.task.occupancy_map)

    def _set_map(self, occupancy_map: OccupancyMap | None) -> None:
        self._run.set_map(occupancy_map)
        self._map = occupancy_map

    def _choose(self, command: Choose) -> None:
        self._start(self._setup.with_choices(command.choices))

    def _set_value(self, command: SetValue) -> None:
        scenario = self._setup.scenario
        find_setting(scenario.true_object, command.name, command.value)
        if command.name == CONTACT_FRICTION or command.name.startswith(FRICTION):
            changed = with_friction(scenario.true_object, command.name, command.value)
            self._run.set_true_object(changed)
            self._setup = self._setup.with_true_object(changed)
        else:
            sensors = dataclasses.replace(scenario.sensors, **{command.name: command.value})
            self._run.set_sensors(sensors)
            self._setup = self._setup.with_sensors(sensors)
        self._show_controls()

    def _set_speed(self, command: Run) -> None:
        self.paused = self.paused if command.paused is None else command.paused
        self.speed = command.speed or self.speed
        self.show_speed()

    def _step(self, _: Step) -> None:
        self.paused = True
        self.show_speed()
        self._advance_by_a_row()

    def _advance_by_a_row(self) -> None:
        shown = self._run.shown_time
        while self._run.shown_time == shown:
            self.advance(0.0)

    def _restart(self, _: Restart) -> None:
        self._start(self._setup.with_goal(self._run.goal))
