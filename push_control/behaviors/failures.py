"""Why a behaviour has failed: codes for the program, sentences for people."""

from push_model.events import Cause, PushEvent, Report
from push_navigation.path import NoPathFound


class BehaviorFailure(Cause):
    """Why a behaviour has failed."""

    # On the way.
    NO_PATH = '{reason}'
    STALLED = 'the robot is stalled, {distance:.2f} m from the end of its path'
    PATH_END_MISSED = 'the robot comes beside the end of its path'
    NOT_AT_PRE_PUSH_POSE = 'the robot stands {distance:.0f} mm from its pre-push pose'
    RAN_INTO_OBJECT = 'the robot has run into the object'
    BUMPED = 'the bumper was touched where the way should be clear'
    OBJECT_MOVED = 'the object has been moved'

    # At the object: the robot is not where it is estimated to be.
    NO_CONTACT = 'no contact with the object within {length:.2f} m'
    TOUCHED_EARLY = 'the robot touches the object before it should'
    OBJECT_NOT_FOUND = 'the robot does not find the object'
    OBJECT_NOT_MOVED = 'the object does not move'
    LOST_ROBOT_TOUCHES = 'the robot, which was lost, touches the object'
    WHEELS_SPIN = ('the wheels turn, the object hardly moves: it is too heavy for this robot, or '
                   'blocked')
    OBJECT_UNYIELDING = ('the wheels turn, the object does not move at all: it is too heavy for '
                         'this robot or blocked, or it is not where it seems to be')
    BASE_STALLS = 'the base stalls at the object: it is too heavy for this robot, or blocked'
    HELD_UP = 'the object is held up by {obstacle}'

    # During a steered push.
    OFF_PLANNED_PATH = 'the object deviates by {distance:.2f} m from its planned path'
    OBJECT_NEARS_OBSTACLE = 'the object deviates towards an obstacle of the map'
    ROBOT_NEARS_OBSTACLE = 'the robot deviates towards an obstacle of the map'


def held_up(*, is_in_map: bool) -> Report[BehaviorFailure]:
    """
    Report that something holds the object up.

    :param is_in_map: whether the map shows what.
    """
    return BehaviorFailure.HELD_UP.report(
        obstacle='an obstacle of the map' if is_in_map else 'a wall or another thing in its way')


def no_path(error: ValueError) -> Report[BehaviorFailure]:
    """
    Report that there is no path to drive.

    :param error: with the reason, a ``NoPathFound`` or of what cannot be planned at all.
    """
    reason = error.report if isinstance(error, NoPathFound) else error
    return BehaviorFailure.NO_PATH.report(reason=reason)


# A steered push fails for an event that its controller reports.
FailureReport = Report[BehaviorFailure] | Report[PushEvent]
