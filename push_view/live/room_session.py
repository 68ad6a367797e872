"""Live session of a room: several objects, which its user drags, as their goals."""

from push_model.geometry import Pose, wrap_angle
from push_planner.rearrangement.problem import Move, OrderPlan
from push_scenario.simulation.result import Outcome
from push_scenario.tidying.room import Room
from push_scenario.tidying.tidy import goal_of, RoomRun
from push_sim_node.tape_row import COLUMNS
from push_tidy.tidy_supervisor import TidySupervisor
from push_view.belief import belief_columns
from push_view.live.paced_session import Handlers, PacedSession
from push_view.live.room_move import RoomMove, standing_move
from push_view.messages import (
    bound_values, controls_message, map_message, object_values, order_message, scenario_message)
from push_view.server.commands import (
    CommandRefused, DisplaceObject, require_index, Restart, SetGoal)
from push_view.server.message_log import MessageLog

HELP = ('The robot brings each object to its goal, the dashed outline of its colour. Numbers say '
        'in which order. Drag goals and objects: then the order is planned anew.')
NO_PLAN = OrderPlan((), {}, 0.0, True, 0)


class RoomSession(PacedSession):
    """
    Objects that are brought to their goals, one after the other.

    An edit lets the robot back off from what it pushes; then the order is planned anew.

    :param room: ``Room`` to start from.
    :param log: where the messages go.
    """

    def __init__(self, room: Room, log: MessageLog) -> None:
        super().__init__(log)
        self._room = room
        self._start()

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return self._run.simulation.time

    @property
    def shown_time(self) -> float:
        """Time of the last row, at which the page shows what is changed now [s]."""
        return self._move.shown_time

    @property
    def is_standing(self) -> bool:
        """Tell whether no object is to be moved."""
        return not self._is_moving and not self._needs_plan

    @property
    def poses(self) -> tuple[Pose, ...]:
        """True ``Pose`` of the objects and the robot."""
        return (*self._run.poses.values(), self._run.robot_pose)

    @property
    def goals(self) -> tuple[Pose | None, ...]:
        """Goal ``Pose`` of each object; None where it may stand anywhere."""
        return tuple(None if name in self._room.without_goal else scenario.goal.pose
                     for name, scenario in self._room.scenarios.items())

    @property
    def scenario_text(self) -> str:
        """No file: the room has one."""
        return ''

    @property
    def handlers(self) -> Handlers:
        """What is done at each type of command."""
        return {SetGoal: self._set_goal, DisplaceObject: self._displace, Restart: self._restart}

    def rehearse(self) -> None:
        """Compile what a push needs."""
        self._move.rehearse()

    def advance_once(self) -> None:
        """Let time pass to the next measurement; between two moves plan which comes next."""
        if self._needs_plan:
            self._plan()
        elif not self._is_moving:
            self._move.idle()
        elif (ending := self._move.advance()) is not None:
            self._is_moving, self._needs_plan = False, True
            if not self._is_edited:
                self._supervisor.end_move(
                    self._move.move, None if ending.outcome is Outcome.DONE else ending.reason)

    def show(self) -> None:
        """Send the page what happened."""
        self._move.show()

    def _start(self) -> None:
        room, log = self._room, self.log
        self._run = RoomRun(room)
        self._columns = _columns(room)
        self._names = tuple(room.scenarios)
        self._needs_plan = self._is_edited = False
        log.clear()
        scenario = room.any_scenario
        bodies = tuple(f'body_{index}_{axis}' for index in range(len(self._names))
                       for axis in ('x', 'y', 'theta'))
        log.add({**scenario_message(scenario, scenario.control.control_law,
                                    (*self._columns, *bodies)),
                 'title': room.name.replace('_', ' '), 'description': HELP,
                 'objects': [{'name': name, **object_values(item.object),
                              **bound_values(item.bounds)}
                             for name, item in room.scenarios.items()]})
        log.add(map_message(0.0, room.floor_map.read(room.task.map_reading)))
        self._forget_failures()
        move = self._supervisor.next_move(self._run.scene)
        name = self._names[0]
        self._move = self._made(move or standing_move(name, self._run.poses[name]))
        self._is_moving = move is not None
        if not self._is_moving:
            self._move.cancel()
        self._show_order(self._supervisor.plan)
        log.replace(controls_message(('goal', 'object'), owns_time=True))
        self._note_motion()
        self.show()
        self.show_speed()

    def _made(self, move: Move) -> RoomMove:
        return RoomMove(self._run, move, self._columns, self._body_values, self.log)

    def _forget_failures(self) -> None:
        """Supervise with the present goals, and without what has failed."""
        room = self._room
        self._supervisor = TidySupervisor([goal_of(name, room) for name in self._names],
                                          room.any_scenario.robot, room.task.drive)

    def _replan(self) -> None:
        """Plan the order anew once nothing moves; until then none is shown."""
        self._forget_failures()
        self._needs_plan = not self._is_moving
        self._is_edited = self._is_moving
        if self._is_moving:
            self._move.cancel()
        self._show_order(NO_PLAN)

    def _plan(self) -> None:
        """Plan the order, show it, and begin its first move."""
        self._needs_plan = self._is_edited = False
        move = self._supervisor.next_move(self._run.scene)
        if move is not None:
            self.show()
            self._move = self._made(move)
            self._is_moving = True
        self._show_order(self._supervisor.plan)

    def _show_order(self, plan: OrderPlan) -> None:
        self.log.add(order_message(
            self.shown_time, self._names, self._move.move.name, self.goals, plan,
            self._supervisor.statuses()))

    def _body_values(self) -> tuple[float, ...]:
        return tuple(value for pose in self._run.poses.values() for value in pose)

    def _set_goal(self, command: SetGoal) -> None:
        require_index('goal', command.object_index, len(self._names))
        name = self._names[command.object_index]
        if name in self._room.without_goal:
            raise CommandRefused(f'goal.index: got {command.object_index}, which is {name} and '
                                 'has no goal, expected an object with one')
        heading = self._run.poses[name].theta
        pose = command.pose
        self._room = self._room.with_goal(
            name, pose._replace(theta=heading + wrap_angle(pose.theta - heading)))
        self._replan()

    def _displace(self, command: DisplaceObject) -> None:
        require_index('displace', command.object_index, len(self._names))
        self._run.displace(self._names[command.object_index], command.pose)
        self._replan()
        if self.paused:
            # Where it is now is seen in the next row.
            self.advance_by_a_row()

    def _restart(self, _: Restart) -> None:
        self._start()


def _columns(room: Room) -> tuple[str, ...]:
    """Name the columns that rows have, whichever object is pushed; without energies."""
    most = max((item.object for item in room.scenarios.values()),
               key=lambda obj: len(obj.supports))
    return (*(name for name in COLUMNS if not name.startswith('energy_')), *belief_columns(most))
