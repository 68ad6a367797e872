"""States and reasons of the safety layer: codes for the program, sentences for people."""

import enum

from push_model.events import Cause, Report


class SafetyState(enum.Enum):
    """State whether commands reach the robot; the values are those of diagnostics and files."""

    CLEAR = 'clear'
    # The robot gets zeros, until it is at rest and nothing is wrong any more.
    STOPPED = 'stopped'


class SafetyReason(Cause):
    """Why the robot is stopped."""

    # The command cannot be sent.
    COMMAND_NOT_FINITE = 'the command is not finite: {command}'

    # What commands rest on does not come.
    CLOCK_FELL_BACK = 'the clock of odometry has fallen back by {shift:.2f} s'

    # The robot does not do what it is commanded to do.
    NOT_MOVING = 'the robot does not move as commanded: {expected} expected, {measured} measured'
    MOVES_OTHERWISE = (
        'the robot moves otherwise than commanded: {expected} expected, {measured} measured')
    COMMANDED_BY_OTHERS = 'somebody else commands the base: cmd_vel is published by {others}, too'
    FOLLOWS_LATE = 'the robot follows its commands {delay:.1f} s late'

    # It waits for a word, be the base as it may.
    BASE_STOOD = (
        'the base did not move for {duration:.1f} s although commanded: an emergency stop, or '
        'something in the way? call controller/resume or send another goal')
    ODOMETRY_WAS_MISSING = (
        'no odometry has come for {duration:.1f} s: an emergency stop? call controller/resume or '
        'send another goal')

    # Odometry contradicts itself.
    ODOMETRY_JUMPED = 'odometry has jumped by {distance:.2f} m and {rotation:.0f} deg'
    ODOMETRY_FROZEN = 'odometry repeats one pose for {duration:.2f} s, and that it moves'
    ODOMETRY_CONTRADICTORY = (
        'odometry contradicts itself: its pose has moved by {moved:.2f} m and {rotated:.0f} deg '
        'in {duration:.1f} s, its twist means {expected:.2f} m and {rotation:.0f} deg')
    ODOMETRY_DIRECTION = (
        'odometry contradicts itself: its pose has moved by {moved:.2f} m at {angle:.0f} deg to '
        'the direction that its heading and its twist mean')
    ODOMETRY_LATERAL = (
        'odometry contradicts itself: it measures {speed:.2f} m/s to the side, where wheels of a '
        'differential drive do not go')
    ODOMETRY_SCALE = (
        'odometry contradicts itself: its pose has moved by {moved:.2f} m, its twist means '
        '{expected:.2f} m')

    @property
    def is_of_odometry(self) -> bool:
        """Tell whether the place of the robot is no longer certain."""
        return self in (SafetyReason.ODOMETRY_JUMPED, SafetyReason.ODOMETRY_FROZEN,
                        SafetyReason.ODOMETRY_CONTRADICTORY, SafetyReason.ODOMETRY_DIRECTION,
                        SafetyReason.ODOMETRY_LATERAL, SafetyReason.ODOMETRY_SCALE)

    @property
    def is_of_motion(self) -> bool:
        """Tell whether the robot moves otherwise than commanded, for no other known reason."""
        return self in (SafetyReason.NOT_MOVING, SafetyReason.MOVES_OTHERWISE)

    @property
    def awaits_resume(self) -> bool:
        """Tell whether the robot stays stopped until somebody lets it go on."""
        return self in (SafetyReason.BASE_STOOD, SafetyReason.ODOMETRY_WAS_MISSING)


SafetyReport = Report[SafetyReason]
