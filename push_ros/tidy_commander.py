"""
A commander of several objects for programs: it sends goals of ``push_objects``.

    with TidyCommander() as commander:
        commander.wait_until_ready()
        commander.tidy({'crate': Pose(1.0, 0.5, 0.0), 'barrel': Pose(0.0, 1.0, 0.0)})
        while not commander.is_done():
            print(commander.feedback())
        print(commander.result())
"""

from collections.abc import Mapping
from typing import Any, NamedTuple

from builtin_interfaces.msg import Duration
from geometry_msgs.msg import PoseStamped
from push_model.geometry import Pose
from push_ros.action_commander import ActionCommander, PushOutcome
from push_ros.conversions.primitives import seconds, to_stamp
from push_ros.push_interfaces import PushInterfaces, TIDY_ACTION


class ObjectReport(NamedTuple):
    """
    One of several objects.

    :param state: one of the constants of ``ObjectStatus``.
    :param position_error: distance from its goal as last measured at rest [m]; nan if unknown.
    :param heading_error: its heading minus that of its goal [rad]; nan if unknown.
    :param codes: cause codes of why it is given up, such as ``ObjectFailure.BLOCKED``.
    :param text: state or reason, for people.
    """

    state: int
    position_error: float
    heading_error: float
    codes: tuple[str, ...]
    text: str


class TidyFeedback(NamedTuple):
    """
    Progress of a room.

    :param objects: ``ObjectReport`` of each object, by name.
    :param placed: number of objects at their goals.
    :param goals: number of objects that have one.
    :param text: what comes next and why, or what is waited for.
    :param object_name: of the object that is moved; empty before the first push of a move.
    :param elapsed_time: since the goal was taken [s].
    :param estimated_time_remaining: of all moves when the present one began [s]; 0 if unknown.
    """

    objects: dict[str, ObjectReport]
    placed: int
    goals: int
    text: str
    object_name: str
    elapsed_time: float
    estimated_time_remaining: float


class TidyResult(NamedTuple):
    """
    End of a room.

    :param outcome: ``PushOutcome``.
    :param error_code: one of the constants of ``PushObjects.Result``; 0 where all went well.
    :param error_msg: one sentence on that, or empty.
    :param objects: ``ObjectReport`` of each object, by name.
    :param moves: number of moves made.
    :param duration: [s].
    """

    outcome: PushOutcome
    error_code: int = 0
    error_msg: str = ''
    objects: Mapping[str, ObjectReport] = {}
    moves: int = 0
    duration: float = 0.0


class TidyCommander(ActionCommander[TidyFeedback, TidyResult]):
    """Sends goals to the node ``tidy``, one at a time."""

    server_name = 'node tidy'
    rejection = 'the node tidy has another goal'

    def tidy(self, goals: Mapping[str, Pose | PoseStamped], *, position_tolerance: float = 0.0,
             heading_tolerance: float = 0.0, time_limit: float = 0.0,
             all_or_none: bool = False) -> bool:
        """
        Send goals of several objects, and wait until they are accepted.

        :param goals: goal pose of each object, by name; others may be moved out of the way.
        :param position_tolerance: [m]; 0 for that of the parameters.
        :param heading_tolerance: [rad]; 0 for that of the parameters.
        :param time_limit: time after which no move begins [s]; 0 for none.
        :param all_or_none: whether nothing is moved any more where one cannot get to its goal.
        :return: whether they are accepted.
        """
        return self._send(self._interfaces.tidy_action.Goal(
            object_names=list(goals), goal_poses=[self._stamped(pose) for pose in goals.values()],
            position_tolerance=position_tolerance, heading_tolerance=heading_tolerance,
            time_limit=to_stamp(time_limit, Duration), all_or_none=all_or_none))

    def _action_of(self, interfaces: PushInterfaces) -> tuple[Any, str]:
        return interfaces.tidy_action, TIDY_ACTION

    def _read_feedback(self, message: Any) -> TidyFeedback:
        return TidyFeedback(
            _reports(message.objects), message.placed, message.goals, message.text,
            message.status.object_name, seconds(message.elapsed_time),
            seconds(message.estimated_time_remaining))

    def _read_result(self, outcome: PushOutcome, message: Any) -> TidyResult:
        return TidyResult(outcome, message.error_code, message.error_msg,
                          _reports(message.objects), message.moves, seconds(message.duration))

    def _missing_result(self, outcome: PushOutcome, reason: str) -> TidyResult:
        return TidyResult(outcome, error_msg=reason)


def _reports(messages: Any) -> dict[str, ObjectReport]:
    """Read messages ``ObjectStatus``, by the name of the object."""
    return {message.object_name: ObjectReport(
        message.state, message.position_error, message.heading_error, tuple(message.codes),
        message.text) for message in messages}
