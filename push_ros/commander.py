"""
A commander for programs: push an object somewhere, watch, cancel, and learn how it ended.

    rclpy.init()
    with PushCommander() as commander:
        commander.wait_until_ready()
        commander.push_to(Pose(1.0, 0.5, 0.0))
        while not commander.is_done():
            print(commander.feedback())
        print(commander.result())

Nothing here needs threads: ``is_done`` handles what has come. All states and error codes are those
of the action ``push_object`` of ``push_control_msgs``.
"""

import math
from typing import Any, NamedTuple

from builtin_interfaces.msg import Duration
from geometry_msgs.msg import PoseStamped
from push_model.geometry import Pose
from push_ros.action_commander import ActionCommander, PushOutcome
from push_ros.conversions.primitives import seconds, to_stamp
from push_ros.push_interfaces import ACTION, PushInterfaces

__all__ = ['PushCommander', 'PushFeedback', 'PushOutcome', 'PushResult']


class PushFeedback(NamedTuple):
    """
    Progress of the pursuit of a goal.

    :param state: one of the constants of ``PushStatus``.
    :param text: state and reason, for people.
    :param push_number: of the present or last push, from 1 on; 0 before the first.
    :param pushes_done: number of pushes that have ended.
    :param position_error: distance of the object from its goal [m].
    :param heading_error: object heading minus that of the goal [rad].
    :param position_deviation: standard deviation of the position in the frame of the goal [m],
        where that drifts with odometry; nan where it does not.
    :param heading_deviation: of the heading [rad], likewise.
    :param codes: cause codes of the reason, such as ``TaskEvent.AVERAGING``.
    :param elapsed_time: since the goal was taken [s].
    :param estimated_time_remaining: median that the last plan states [s]; 0 while nothing is
        known.
    :param expected_time_p95: time within which 95 % of such tasks end, from now on [s]; nan while
        nothing is known, as is the chance.
    :param chance: to be done, with the object within its tolerances.
    """

    state: int
    text: str
    push_number: int
    pushes_done: int
    position_error: float
    heading_error: float
    position_deviation: float
    heading_deviation: float
    codes: tuple[str, ...]
    elapsed_time: float
    estimated_time_remaining: float
    expected_time_p95: float
    chance: float


class PushResult(NamedTuple):
    """
    Result of the pursuit of a goal.

    :param outcome: ``PushOutcome``.
    :param error_code: one of the constants of ``PushObject.Result``; 0 where all went well.
    :param error_msg: one sentence on that, or empty.
    :param position_error: last known distance of the object from its goal [m]; nan if unknown.
    :param heading_error: last known object heading minus that of the goal [rad]; nan if unknown.
    :param position_deviation: standard deviation of the position in the frame of the goal [m],
        where that drifts with odometry; nan where it does not.
    :param heading_deviation: of the heading [rad], likewise.
    :param pushes: number of pushes begun.
    :param duration: [s].
    :param codes: cause codes, such as ``TaskEvent.NO_PLAN``; of a goal that was reached
        ``TaskEvent.DONE_BY_ODOMETRY`` where the deviations say how well that is known.
    """

    outcome: PushOutcome
    error_code: int = 0
    error_msg: str = ''
    position_error: float = math.nan
    heading_error: float = math.nan
    position_deviation: float = math.nan
    heading_deviation: float = math.nan
    pushes: int = 0
    duration: float = 0.0
    codes: tuple[str, ...] = ()


class PushCommander(ActionCommander[PushFeedback, PushResult]):
    """Sends goals to the controller, one at a time."""

    server_name = 'controller'
    rejection = 'the controller is inactive'

    def push_to(self, pose: Pose | PoseStamped, *, object_name: str = '',
                position_tolerance: float = 0.0, heading_tolerance: float = 0.0,
                time_limit: float = 0.0) -> bool:
        """
        Send a goal, in place of the present one, and wait until it is accepted.

        :param pose: goal pose of the object.
        :param object_name: name of the object; empty for the present one.
        :param position_tolerance: [m]; 0 for that of the parameters.
        :param heading_tolerance: [rad]; 0 for that of the parameters.
        :param time_limit: [s]; 0 for none.
        :return: whether it is accepted; a goal that cannot be used is accepted and aborted.
        """
        return self._send(self._interfaces.action.Goal(
            goal_pose=self._stamped(pose), object_name=object_name,
            position_tolerance=position_tolerance, heading_tolerance=heading_tolerance,
            time_limit=to_stamp(time_limit, Duration)))

    def _action_of(self, interfaces: PushInterfaces) -> tuple[Any, str]:
        return interfaces.action, ACTION

    def _read_feedback(self, message: Any) -> PushFeedback:
        status = message.status
        return PushFeedback(
            status.state, status.text, status.push_number, status.pushes_done,
            status.position_error, status.heading_error, status.position_deviation,
            status.heading_deviation, tuple(status.codes), seconds(message.elapsed_time),
            seconds(message.estimated_time_remaining), status.expected_time_p95, status.chance)

    def _read_result(self, outcome: PushOutcome, message: Any) -> PushResult:
        return PushResult(
            outcome, message.error_code, message.error_msg, message.position_error,
            message.heading_error, message.position_deviation, message.heading_deviation,
            message.pushes, seconds(message.duration), tuple(message.codes))

    def _missing_result(self, outcome: PushOutcome, reason: str) -> PushResult:
        return PushResult(outcome, error_msg=reason)
