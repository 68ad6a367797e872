"""Live session: the simulation of a task, which its user disturbs and redirects under way."""

import dataclasses

from push_model.geometry import Pose, wrap_angle
from push_planner.straight.map_search.planner import warm_up
from push_view.live.link import link_text, LinkedSetup, read_link
from push_view.live.live_run import LiveRun
from push_view.live.paced_session import Handlers, PacedSession
from push_view.live.saved_scenario import saved_scenario
from push_view.live.setup import Setup
from push_view.live.walls import Drawing, Wall
from push_view.server.commands import (
    AddWall, Choose, ClearWalls, CommandRefused, DisplaceObject, OpenLink, RemoveWall,
    require_index, Restart, SetGoal, SetValue, UndoWall,
)
from push_view.server.message_log import MessageLog

# Longest simulated time of a rehearsal [s]; chosen: only what is not seen has no plan by then.
REHEARSAL_TIME = 2.0


class Session(PacedSession):
    """
    A run under way, what it was made of, and the commands that change both.

    :param setup: ``Setup`` to start from.
    :param log: where the messages go.
    """

    def __init__(self, setup: Setup, log: MessageLog) -> None:
        super().__init__(log)
        self._drawing = Drawing(setup.task.occupancy_map)
        self._start(setup)

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return self._run.time

    @property
    def shown_time(self) -> float:
        """Time of the last row, at which the page shows what is changed now [s]."""
        return self._run.shown_time

    @property
    def poses(self) -> tuple[Pose, ...]:
        """True ``Pose`` of object and robot."""
        return self._run.poses

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
    def object_pose(self) -> Pose:
        """True ``Pose`` of the object."""
        return self._run.object_pose

    @property
    def handlers(self) -> Handlers:
        """What is done at each type of command."""
        return {
            SetGoal: self._set_goal, DisplaceObject: self._displace_object,
            AddWall: self._add_wall, RemoveWall: self._remove_wall, UndoWall: self._undo_wall,
            ClearWalls: self._clear_walls, Choose: self._choose, OpenLink: self._open,
            SetValue: self._set_value, Restart: self._restart}

    def advance_once(self) -> None:
        """Let time pass to the next measurement."""
        self._run.advance()

    def show(self) -> None:
        """Send the page what happened."""
        self._run.show()

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

    def _start(self, setup: Setup) -> None:
        """Start over, with the walls that are there."""
        self._run = LiveRun(setup, self._drawing.occupancy_map, self.log)
        self._setup = setup
        self._note_motion()
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
        require_index('goal', command.object_index, 1)
        self._run.set_goal(self._near_object(command.pose))
        self._show_setup()

    def _displace_object(self, command: DisplaceObject) -> None:
        require_index('displace', command.object_index, 1)
        self._run.displace_object(self._near_object(command.pose))
        if self.paused:
            # Where it is now is seen in the next row.
            self.advance_by_a_row()

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

    def _restart(self, _: Restart) -> None:
        self._start(self._setup.with_goal(self._run.goal))
