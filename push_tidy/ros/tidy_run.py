"""
Pursuit of one goal of ``push_objects``: measure, ask the supervisor, move, and so on.

    MEASURING  poses of all objects come, until there are enough of each
    MOVING     the controller pursues the goal of one object
    ENDED      all is done that can be done
"""

from collections.abc import Callable
import enum
import math
from typing import Any, NamedTuple

from push_model.events import ObjectFailure
from push_model.geometry import distance, Pose, wrap_angle
from push_planner.rearrangement.problem import Move
from push_ros.conversions.primitives import from_pose_message
from push_ros.node import PushNode
from push_ros.node_settings import TidyOptions
from push_ros.push_interfaces import ACTION
from push_tidy.obstacles import MARGIN_SIGMAS, StandingObject
from push_tidy.rest_poses import RestPose, RestPoses
from push_tidy.ros.room_map import RoomMap
from push_tidy.ros.single_moves import MoveEnd, MoveGoal, SingleMoves
from push_tidy.tidy_supervisor import MeasuredScene, ObjectGoal, TidySupervisor


class RunState(enum.Enum):
    """State of the pursuit of a goal."""

    MEASURING = 'measures all objects'
    MOVING = 'moves an object'
    ENDED = 'has ended'


class RoomInputs:
    """
    What a run needs to know of the room, as it was last received.

    ``room_map``: the ``RoomMap``, or None before it has come.
    """

    def __init__(self) -> None:
        self.room_map: RoomMap | None = None
        self._odometry: Pose | None = None
        # From where odometry has the robot to where the controller has it.
        self._correction = Pose(0.0, 0.0, 0.0)

    @property
    def robot_pose(self) -> Pose | None:
        """``Pose`` of the robot, by odometry since the controller has estimated it; or None."""
        return None if self._odometry is None else self._correction @ self._odometry

    def on_odometry(self, pose: Pose) -> None:
        """Take odometry in, which drifts."""
        self._odometry = pose

    def on_estimate(self, pose: Pose) -> None:
        """Take in where the controller estimates the robot to be now."""
        if self._odometry is not None:
            self._correction = pose @ self._odometry.inverse()

    @property
    def missing(self) -> list[str]:
        """Topics on which nothing has come yet."""
        return [topic for topic, value in (('room_map', self.room_map),
                                           ('odom', self.robot_pose)) if value is None]


class RunPorts(NamedTuple):
    """
    Where a run sends what it decides.

    :param node: the ``PushNode``, for its clock.
    :param frame: id of the world frame.
    :param moves: the ``SingleMoves``.
    :param publish_map: publishes the map with the objects that stand.
    :param on_change: called after each change, for feedback, and at the end.
    """

    node: PushNode
    frame: str
    moves: SingleMoves
    publish_map: Callable[[Any], None]
    on_change: Callable[[], None]


class TidyRun:
    """
    Pursuit of one goal.

    ``state``: the ``RunState``. ``feedback``: the last feedback of the present move, or None.
    ``supervisor``: the ``TidySupervisor``. ``is_cancelled``: whether the client has cancelled it.

    :param goals: ``ObjectGoal`` of each object that is there, by name.
    :param supervisor: of the same.
    :param inputs: ``RoomInputs``.
    :param ports: ``RunPorts``.
    :param options: ``TidyOptions``.
    :param start: time at which it starts [s].
    """

    def __init__(self, goals: dict[str, ObjectGoal], supervisor: TidySupervisor,
                 inputs: RoomInputs, ports: RunPorts, *, options: TidyOptions,
                 start: float) -> None:
        self._goals = goals
        self.supervisor = supervisor
        self._inputs = inputs
        self._ports = ports
        self._start = start
        self._now = start
        self._rest = RestPoses(list(goals), options.pose_count)
        self._timeout = options.measuring_timeout
        # Steady time at which this state was first looked at [s]; None before.
        self._measuring_since: float | None = None
        self.state = RunState.MEASURING
        self.feedback: Any = None
        self.is_cancelled = False
        self._measured: dict[str, RestPose] = {}

    @property
    def elapsed(self) -> float:
        """Time since the start [s]."""
        return max(0.0, self._now - self._start)

    @property
    def text(self) -> str:
        """What comes next and why, for people."""
        if self.state is RunState.MEASURING and self._missing:
            return f'waits for {", ".join(self._missing)}'
        moves = self.supervisor.plan.moves
        if self.state is not RunState.MOVING or not moves:
            return self.state.value
        first = moves[0]
        if not first.is_temporary:
            return f'{first.name} to its goal'
        after = next((move.name for move in moves if move.name != first.name), '')
        return f'{first.name} out of the way' + (f', as {after} is next' if after else '')

    @property
    def _missing(self) -> list[str]:
        """What has to come before it is known where everything is."""
        return [*self._inputs.missing, *(f'poses of {name}' for name in self._rest.missing)]

    def errors(self, name: str) -> tuple[float, float]:
        """Return distance [m] and rotation [rad] of an object from its goal; nan if unknown."""
        goal, measured = self._goals[name].pose, self._measured.get(name)
        if goal is None or measured is None:
            return math.nan, math.nan
        return (distance(measured.pose, goal), wrap_angle(measured.pose.theta - goal.theta))

    def on_pose(self, name: str, pose: Pose, time: float) -> None:
        """
        Take a measured pose in, and decide once there are enough.

        :param name: of the object.
        :param time: of the measurement [s].
        """
        self._now = max(self._now, time)
        if self.state is not RunState.MEASURING:
            return
        self._rest.add(name, pose)
        if not self._missing:
            self._decide()

    def cancel(self, reason: str) -> None:
        """
        End as soon as the robot stands off its object.

        :param reason: one clause.
        """
        self.supervisor.cancel(reason)
        if self.state is RunState.MOVING:
            self._ports.moves.cancel()
        elif self.state is RunState.MEASURING:
            self._end()

    def check(self, time: float) -> None:
        """
        End where the controller is gone, or measurements stay away.

        :param time: of a clock that never stands [s].
        """
        if self.state is RunState.MOVING and not self._ports.moves.is_ready:
            self._ports.moves.drop()
            self.supervisor.cancel(f'nobody serves {ACTION}')
            self._end()
        elif self.state is RunState.MEASURING:
            self._check_measuring(time)

    def _check_measuring(self, time: float) -> None:
        if self._measuring_since is None:
            self._measuring_since = time
        elif time - self._measuring_since > self._timeout:
            self.supervisor.cancel(ObjectFailure.NOT_MEASURED.report(
                missing=' and '.join(self._missing), time=self._timeout))
            self._end()

    def _decide(self) -> None:
        """Start the next move from where all objects are, or end."""
        room_map, robot_pose = self._inputs.room_map, self._inputs.robot_pose
        if room_map is None or robot_pose is None:
            return
        self._measured = self._rest.means()
        move = self.supervisor.next_move(
            MeasuredScene({name: item.pose for name, item in self._measured.items()}, robot_pose,
                          room_map.occupancy_map), self.elapsed)
        if move is None:
            self._end()
        else:
            self._move(move, room_map)

    def _move(self, move: Move, room_map: RoomMap) -> None:
        self.state, self.feedback = RunState.MOVING, None
        standing = dict(self._measured)
        pushed = standing.pop(move.name)
        stamp = self._ports.node.now()
        self._ports.publish_map(room_map.with_objects(
            [StandingObject(self._goals[name].obj, item.pose) for name, item in standing.items()],
            MARGIN_SIGMAS * max((item.deviation for item in standing.values()), default=0.0),
            StandingObject(self._goals[move.name].obj, pushed.pose), stamp))
        self._ports.moves.start(
            MoveGoal(move.name, move.end, self._goals[move.name].tolerances, stamp,
                     self._ports.frame),
            self._on_feedback, lambda end: self._on_end(move, end))
        self._ports.on_change()

    def _on_feedback(self, feedback: Any) -> None:
        self.feedback = feedback
        pose = feedback.status.robot_pose
        if not math.isnan(pose.position.x):
            self._inputs.on_estimate(from_pose_message(pose, ACTION))
        self._ports.on_change()

    def _on_end(self, move: Move, end: MoveEnd) -> None:
        self.supervisor.end_move(move, end.failure or None)
        if end.ends_all:
            self.supervisor.cancel(end.failure)
        self._rest.restart()
        self.state, self._measuring_since = RunState.MEASURING, None
        self._ports.on_change()

    def _end(self) -> None:
        self.state = RunState.ENDED
        self._ports.on_change()
