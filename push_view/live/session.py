"""Live session: the simulation of a task, which its user disturbs and redirects under way."""

from collections.abc import Callable
import dataclasses
import math
from typing import Any

from push_model.geometry import Pose, wrap_angle
from push_planner.straight.map_search.planner import warm_up
from push_view.live.link import link_text, LinkedSetup, read_link
from push_view.live.live_run import LiveRun
from push_view.live.saved_scenario import saved_scenario
from push_view.live.setup import Setup
from push_view.live.walls import Drawing, Wall
from push_view.server.commands import (
    AddWall, Choose, ClearWalls, Command, CommandRefused, DisplaceObject, OpenLink, RemoveWall,
    Restart, Run, SetGoal, SetValue, Step, UndoWall,
)
from push_view.server.message_log import MessageLog

# Time for which nothing must have moved while the robot waits [s]; chosen: long enough to see it.
REST_TIME = 1.0
# Longest simulated time of a rehearsal [s]; chosen: only what is not seen has no plan by then.
REHEARSAL_TIME = 2.0


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
        self._drawing = Drawing(setup.task.occupancy_map)
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
    def setup(self) -> Setup:
        """What is simulated now, with its present goal."""
        return self._setup.with_goal(self._run.goal)

    @property
    def scenario_text(self) -> str:
        """The set-up with its walls as a scenario file, for ``replay``."""
        return saved_scenario(self.setup, self._drawing.occupancy_map)

    @property
    def is_at_rest(self) -> bool:
        """Tell whether nothing will happen until its user does something."""
        return self.is_standing and self.time - self._moved_time > REST_TIME

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
        if self._run.poses != self._poses or not self.is_standing:
            self._moved_time, self._poses = self.time, self._run.poses

    def handle(self, command: Command) -> None:
        """
        Do what the user asks for.

        :raises CommandRefused: where it cannot be done, with the reason; then nothing changes.
        """
        handlers: dict[type[Any], Callable[[Any], None]] = {
            SetGoal: self._set_goal, DisplaceObject: self._displace_object,
            AddWall: self._add_wall, RemoveWall: self._remove_wall, UndoWall: self._undo_wall,
            ClearWalls: self._clear_walls, Choose: self._choose, OpenLink: self._open,
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
        # Something may come of it.
        self._moved_time = self.time

    def setup_after(self, command: Choose | OpenLink) -> Setup:
        """
        Tell what will be simulated after a command that starts over.

        :raises CommandRefused: where there is no such thing, with the reason.
        """
        try:
            return self._linked(command).setup if isinstance(
                command, OpenLink) else self._setup.with_choices(command.choices)
        except ValueError as error:
            raise CommandRefused(str(error)) from error

    def rehearse(self) -> None:
        """Compile what a push needs, and let the first plan be made."""
        self._run.rehearse()
        while not self._run.has_plan and self.time < REHEARSAL_TIME:
            self.advance(0.0)

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
                          'achieved': None if math.isnan(achieved) else round(achieved, 1),
                          'at_rest': self.is_at_rest})

    def _start(self, setup: Setup) -> None:
        """Start over, with the walls that are there."""
        self._run = LiveRun(setup, self._drawing.occupancy_map, self.log)
        self._setup = setup
        self._moved_time, self._poses = 0.0, self._run.poses
        self.show_speed()
        self._show_setup()

    def _show_setup(self) -> None:
        """Show what can be changed, the walls, and the link to all of it."""
        walls = self._drawing.walls
        self.log.replace(self._setup.controls())
        self.log.replace({'type': 'walls', 'walls': [[*wall.start, *wall.end] for wall in walls],
                          'can_undo': self._drawing.previous is not None})
        self.log.replace({'type': 'link', 'link': link_text(self.setup, walls)})

    def _set_goal(self, command: SetGoal) -> None:
        self._run.set_goal(self._near_object(command.pose))
        self._show_setup()

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
        drawing = self._drawing
        if not drawing.walls:
            drawing = dataclasses.replace(drawing, center=self.object_pose[:2])
        self._draw(drawing.add(Wall(*command)))

    def _remove_wall(self, command: RemoveWall) -> None:
        self._draw(self._drawing.remove(command.wall))

    def _undo_wall(self, _: UndoWall) -> None:
        self._draw(self._drawing.undo())

    def _clear_walls(self, _: ClearWalls) -> None:
        self._draw(self._drawing.clear())

    def _draw(self, drawing: Drawing) -> None:
        self._run.set_map(drawing.occupancy_map)
        self._drawing = drawing
        self._show_setup()

    def _choose(self, command: Choose) -> None:
        self._start(self._setup.with_choices(command.choices))

    def _open(self, command: OpenLink) -> None:
        linked, before = self._linked(command), self._drawing
        self._drawing = Drawing(linked.setup.task.occupancy_map,
                                linked.setup.scenario.start.object.pose[:2], linked.walls)
        try:
            self._start(linked.setup)
        except ValueError:
            self._drawing = before
            raise

    def _linked(self, command: OpenLink) -> LinkedSetup:
        return read_link(command.link, Setup.of(self._setup.origin))

    def _set_value(self, command: SetValue) -> None:
        before, self._setup = self._setup, self._setup.with_value(command.name, command.value)
        scenario = self._setup.scenario
        if scenario.true_object != before.scenario.true_object:
            self._run.set_true_object(scenario.true_object)
        if scenario.sensors != before.scenario.sensors:
            self._run.set_sensors(scenario.sensors)
        self._show_setup()

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
