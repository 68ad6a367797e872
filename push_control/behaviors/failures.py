"""Why a behaviour has failed: codes for the program, sentences for people."""

import enum

from push_model.events import Report


class BehaviorFailure(enum.Enum):
    """
    Why a behaviour has failed.

    The value is the template of its sentence; ``report`` fills in the values.
    """

    # On the way.
    NO_PATH = '{error}'
    STALLED = 'the robot is stalled, {distance:.2f} m from the end of its path'
    PATH_END_MISSED = 'the robot comes beside the end of its path'
    NOT_AT_PRE_PUSH_POSE = 'the robot stands {distance:.0f} mm from its pre-push pose'
    RAN_INTO_OBJECT = 'the robot has run into the object'
    OBJECT_MOVED = 'the object has been moved'

    # At the object: the robot is not where it is estimated to be.
    NO_CONTACT = 'no contact with the object within {length:.2f} m'
    TOUCHED_EARLY = 'the robot touches the object before it should'
    OBJECT_NOT_FOUND = 'the robot does not find the object'
    OBJECT_NOT_MOVED = 'the object does not move'
    LOST_ROBOT_TOUCHES = 'the robot, which was lost, touches the object'
    WHEELS_SPIN = ('the wheels turn, the object hardly moves: it is too heavy for this robot, or '
                   'blocked')

    # During a steered push.
    PUSH_NOT_STARTED = '{reason}'
    PUSH_FAILED = '{reason}'
    OFF_PLANNED_PATH = 'the object deviates by {distance:.2f} m from its planned path'
    OBJECT_NEARS_OBSTACLE = 'the object deviates towards an obstacle of the map'
    ROBOT_NEARS_OBSTACLE = 'the robot deviates towards an obstacle of the map'

    def report(self, **values: float | str) -> 'FailureReport':
        """
        Tell that this has happened.

        :param values: those that the sentence names, in its units.
        """
        return Report(self, values)


FailureReport = Report[BehaviorFailure]
