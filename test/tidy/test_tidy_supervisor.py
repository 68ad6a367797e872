"""Supervisor of a room: moves that succeed, that fail, that are refused, and what is reported."""

from collections.abc import Callable
import math

from helpers.maps import walled_floor
from helpers.objects import bin_, box
from push_model.events import ObjectFailure
from push_model.geometry import Pose
from push_model.parameters import RoundRobot
from push_model.plan_request import GoalTolerances
from push_planner.rearrangement.problem import Move
from push_tidy.tidy_supervisor import (
    MAX_FAILURES, MAX_MOVES_PER_OBJECT, MeasuredScene, ObjectGoal, ObjectState, TidySupervisor)
import pytest

ROBOT = RoundRobot(0.17)
FLOOR = walled_floor(4.0, 3.0)
LEFT, RIGHT, MIDDLE = Pose(-1.0, 0.2, 0.2), Pose(1.0, 0.3, 0.7), Pose(0.0, -0.7, 0.0)
IN_A_WALL = Pose(2.0, 0.0, 0.0)
SWAP = [ObjectGoal('a', box(), RIGHT), ObjectGoal('b', box(), LEFT)]
STARTS = {'a': LEFT, 'b': RIGHT, 'bin': MIDDLE}


class Room:
    """Objects that are where the last successful move has brought them."""

    def __init__(self, goals: list[ObjectGoal]) -> None:
        self.poses = {goal.name: STARTS[goal.name] for goal in goals}
        self.robot_pose = Pose(0.0, 1.0, 0.0)

    @property
    def scene(self) -> MeasuredScene:
        """Where everything is."""
        return MeasuredScene(self.poses, self.robot_pose, FLOOR)

    def run(self, supervisor: TidySupervisor,
            fails: Callable[[Move], bool] = lambda move: False) -> list[Move]:
        """Make all moves; some of them fail, and leave everything where it is."""
        moves: list[Move] = []
        while (move := supervisor.next_move(self.scene, time=float(len(moves)))) is not None:
            moves.append(move)
            is_failed = fails(move)
            if not is_failed:
                self.poses[move.name] = move.end
            supervisor.end_move(move, 'no progress' if is_failed else None)
        return moves


def codes(supervisor: TidySupervisor) -> dict[str, object]:
    """Return the codes of what does not get to its goal."""
    return {name: report.code for name, report in supervisor.failures().items()}


def test_all_get_to_their_goals_where_every_move_does() -> None:
    """Two change places by three moves; the bin, which has no goal, stays."""
    goals = [*SWAP, ObjectGoal('bin', bin_())]
    room, supervisor = Room(goals), TidySupervisor(goals, ROBOT)
    moves = room.run(supervisor)
    assert [move.is_temporary for move in moves] == [True, False, False]
    assert room.poses == {'a': RIGHT, 'b': LEFT, 'bin': MIDDLE}
    assert {name: status.state for name, status in supervisor.statuses().items()} == {
        'a': ObjectState.AT_GOAL, 'b': ObjectState.AT_GOAL, 'bin': ObjectState.WITHOUT_GOAL}
    assert supervisor.placed_count == supervisor.goal_count == 2 and not supervisor.failures()


def test_an_object_that_is_moved_aside_says_so() -> None:
    """The other one waits."""
    supervisor = TidySupervisor(SWAP, ROBOT)
    move = supervisor.next_move(Room(SWAP).scene)
    assert move is not None and move.is_temporary
    other, = {'a', 'b'} - {move.name}
    assert supervisor.statuses()[move.name].state is ObjectState.MOVING_ASIDE
    assert supervisor.statuses()[other].state is ObjectState.WAITING


def test_an_object_whose_moves_fail_is_given_up_and_the_other_gets_to_its_goal() -> None:
    """After as many failures as are allowed; what is free is moved in between."""
    goals = [ObjectGoal('a', box(), LEFT @ Pose(0.0, 0.6, 0.0)),
             ObjectGoal('b', box(), RIGHT @ Pose(0.0, 0.6, 0.0))]
    room, supervisor = Room(goals), TidySupervisor(goals, ROBOT)
    moves = room.run(supervisor, fails=lambda move: move.name == 'a')
    assert [move.name for move in moves].count('a') == MAX_FAILURES
    assert [move.name for move in moves].count('b') == 1
    assert codes(supervisor) == {'a': ObjectFailure.PUSHES_FAILED}
    assert supervisor.placed_count == 1


def test_an_object_that_is_given_up_keeps_its_reason_where_a_move_aside_fails() -> None:
    goals = [ObjectGoal('a', box(), RIGHT)]
    supervisor = TidySupervisor(goals, ROBOT)
    move = supervisor.next_move(Room(goals).scene)
    assert move is not None and not move.is_temporary
    for _ in range(MAX_FAILURES):
        supervisor.end_move(move, 'no progress')
    supervisor.end_move(move._replace(is_temporary=True), 'no room')
    assert 'no progress' in str(supervisor.failures()['a'])


def test_what_cannot_be_moved_aside_is_not_tried_for_ever() -> None:
    """A bin at the goal of a box does not move: the box is blocked, by its code."""
    goals = [ObjectGoal('a', box(), MIDDLE), ObjectGoal('bin', bin_())]
    room, supervisor = Room(goals), TidySupervisor(goals, ROBOT)
    moves = room.run(supervisor, fails=lambda move: move.name == 'bin')
    assert [move.name for move in moves] == ['bin'] * MAX_FAILURES
    assert codes(supervisor) == {'a': ObjectFailure.BLOCKED}


def test_a_move_that_failed_once_is_repeated_where_nothing_else_can_be_moved() -> None:
    """The only object gets a second chance."""
    goals = [ObjectGoal('a', box(), RIGHT)]
    room, supervisor = Room(goals), TidySupervisor(goals, ROBOT)
    failures = iter([True, False])
    assert len(room.run(supervisor, fails=lambda move: next(failures))) == 2
    assert not supervisor.failures() and supervisor.placed_count == 1


@pytest.mark.parametrize('needs_all, moved', [(False, ['a']), (True, [])])
def test_what_cannot_be_done_stops_the_others_only_on_request(needs_all: bool,
                                                              moved: list[str]) -> None:
    """A goal in a wall is refused before anything moves."""
    goals = [ObjectGoal('a', box(), MIDDLE), ObjectGoal('b', box(), IN_A_WALL)]
    room, supervisor = Room(goals), TidySupervisor(goals, ROBOT, needs_all=needs_all)
    assert [move.name for move in room.run(supervisor)] == moved
    assert codes(supervisor) == {
        'b': ObjectFailure.GOAL_NOT_FREE, **({'a': ObjectFailure.NOT_ALL} if needs_all else {})}


def test_no_move_starts_after_the_time_limit() -> None:
    """Each takes a second here: one of two objects stays where it is."""
    goals = [ObjectGoal('a', box(), LEFT @ Pose(0.0, 0.6, 0.0)),
             ObjectGoal('b', box(), RIGHT @ Pose(0.0, 0.6, 0.0))]
    room, supervisor = Room(goals), TidySupervisor(goals, ROBOT, time_limit=0.5)
    assert len(room.run(supervisor)) == 1
    assert list(codes(supervisor).values()) == [ObjectFailure.NOT_MOVED]


def test_a_cancelled_room_stays_as_it_is() -> None:
    """Every object that is not at its goal says why."""
    supervisor = TidySupervisor(SWAP, ROBOT)
    supervisor.cancel('cancelled')
    assert supervisor.next_move(Room(SWAP).scene) is None
    assert codes(supervisor) == dict.fromkeys('ab', ObjectFailure.NOT_MOVED)


def test_moves_come_to_an_end_where_objects_slip_back() -> None:
    """Every move succeeds, and every object is back at its start after it."""
    goals = [ObjectGoal('a', box(), RIGHT)]
    room, supervisor = Room(goals), TidySupervisor(goals, ROBOT)
    moves = 0
    while (move := supervisor.next_move(room.scene)) is not None:
        moves += 1
        supervisor.end_move(move, None)
    assert moves == MAX_MOVES_PER_OBJECT
    assert codes(supervisor) == {'a': ObjectFailure.NOT_MOVED}


def test_names_differ() -> None:
    """Else nobody knows which one is meant."""
    with pytest.raises(ValueError, match='different'):
        TidySupervisor([SWAP[0], SWAP[0]], ROBOT)


def test_the_heading_of_a_disc_does_not_count() -> None:
    """With a tolerance of pi a bin that was rotated is at its goal."""
    goals = [ObjectGoal('bin', bin_(), MIDDLE @ Pose(0.0, 0.0, 2.0),
                        GoalTolerances(0.01, math.pi))]
    supervisor = TidySupervisor(goals, ROBOT)
    assert supervisor.next_move(Room(goals).scene) is None and not supervisor.failures()
