"""What can happen during a push: codes for the program, sentences for people."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
import dataclasses
import enum
from typing import Any, Generic, TypeVar

SomeCause = TypeVar('SomeCause', bound='Cause')
ReportedCause = TypeVar('ReportedCause', bound='Cause', covariant=True)


class Cause(enum.Enum):
    """
    Something that can happen; a base without members.

    The value of a member is the template of the sentence that tells it; ``report`` fills in the
    values. Messages and files carry the name, as ``SafetyReason.NOT_MOVING``.
    """

    def report(self: SomeCause, **values: Any) -> Report[SomeCause]:
        """
        Tell that this has happened.

        :param values: what the sentence names, in its units; the ``Report`` of something else
            that it quotes, or the code of it.
        """
        return Report(self, values)


# Codes of what has happened, from the event itself to what is behind it.
Codes = tuple[enum.Enum, ...]


class PushEvent(Cause):
    """Something out of the ordinary during a push."""

    # The robot waits: the measurements cannot be used.
    MEASUREMENT_REFUSED = 'a message was refused: {error}'
    ODOMETRY_NOT_FINITE = 'odometry is not finite'
    NO_OBJECT_POSE = 'no object pose yet'
    OBJECT_POSE_NOT_FINITE = 'object pose is not finite'
    OBJECT_POSE_STALE = 'object pose is stale: {age:.2f} s old, at most {limit:g} s'
    PLACE_LOST = (
        'what the robot measures does not fit the map: it is elsewhere, or the map is of another '
        'place')
    # The same again and again, by a little.
    OBJECT_POSES_LATE = (
        'object poses come late: up to {age:.2f} s old, control.pose_timeout is {limit:g} s: '
        'raise it, or make the tracker quicker')
    OBJECT_POSE_JUMPS = (
        'object pose jumps by {distance:.2f} m and {rotation:.0f} deg, not believed until some '
        'agree')
    OBJECT_POSE_FROZEN = (
        'object pose repeats itself more than {count} times: the tracker is frozen')
    OBJECT_ELSEWHERE = (
        'object poses do not fit the push: they are {distance:.0f} mm and {rotation:.0f} deg from '
        'where it has brought the object')
    OBJECT_POSES_SCATTER = (
        'object poses differ from one to the next by {distance:.0f} mm and {rotation:.0f} deg, '
        'which is more than their noise')
    OBJECT_STAYS_BEHIND = (
        'object poses do not fit odometry: in the last {path:g} m the object was found displaced '
        'by {distance:.0f} mm in all; wheels slip, or odometry or the poses are wrong')
    # Stamps alone do not tell which of the two is off.
    ODOMETRY_STALE = (
        'odometry is stale: {age:.2f} s old, at most {limit:g} s; or object poses are stamped '
        'ahead of it')

    # The push has failed: it has waited long enough.
    GAVE_UP_WAITING = 'gave up after {limit:g} s: {reason}'

    # The safety layer has stopped the robot: it waits, or the push has failed.
    SAFETY_STOP = '{reason}'
    STOPPED_TOO_OFTEN = 'stopped {count} times: {reason}'

    # The push cannot start.
    TARGET_REFUSED = '{error}'
    OBJECT_NOT_AT_START = (
        'the object is not where the plan starts, but {distance:.3f} m away and turned by '
        '{rotation:.1f} deg: request another plan')
    ROBOT_NOT_AT_START = (
        'the robot is not where the plan starts, but {distance:.3f} m away and turned by '
        '{rotation:.1f} deg: it must stand at {x:.3f} m, {y:.3f} m, {heading:.3f} rad')

    # The push goes on.
    CONTACT_SLIDES = 'the contact is sliding'
    CLOSING_GAP = 'contact is lost: approaching the object'

    # The push has failed.
    GAP_TOO_WIDE = 'contact is lost: the object is at least {gap:.0f} mm away'
    OBJECT_DOES_NOT_FOLLOW = 'contact is lost: the object does not follow the robot'
    ONE_SIDED_STEERING = (
        'the centre of friction is too far to the side of this contact: friction cannot hold a '
        'straight push there')
    TURNED_OFF_VERTEX = 'jackknifed: the robot has rotated around the vertex onto a face'
    PUSH_OUT_OF_CONTACT = 'jackknifed: the required push points out of the contact'

    # The push has failed: it has taken what the plan for its goal stands for.
    PATH_TOO_LONG = (
        'aborted after {travelled:.1f} m, planned: {planned:.1f} m; the goal is {distance:.0f} mm '
        'and {heading:.1f} deg away')
    LEFT_FLOOR = (
        'has left the floor of its plan: the object is {deviation:.2f} m from the planned path, '
        'at most {limit:.2f} m; the goal is {distance:.0f} mm and {heading:.1f} deg away')

    # The push has failed: no plan moves an object by the little that is in doubt.
    ARRIVAL_UNCERTAIN = (
        'the object may be at its goal, but after {time:g} s at rest its poses do not show it: '
        '{distance:.1f} mm and {heading:.2f} deg beside the goal with standard deviations of '
        '{position_std:.1f} mm and {heading_std:.2f} deg, at most {position_tolerance:g} mm and '
        '{heading_tolerance:g} deg')

    # The push has failed, but another plan may bring the object to its goal.
    NO_PROGRESS = (
        'comes no nearer to its goal, for {length:.1f} m and {time:.0f} s: that is '
        '{distance:.0f} mm and {heading:.1f} deg away')
    GOAL_MISSED = 'ended {distance:.0f} mm and {heading:.1f} deg beside the goal'

    # The push has failed, and the plan that was to bring the object to its goal is not followed.
    PLAN_EXCEEDS_FLOOR = (
        '{failure}; another plan would need more floor or length than the first one')


class ObjectFailure(Cause):
    """Reason why an object does not get to its goal."""

    START_NOT_FREE = 'it stands where the map has an obstacle or ends'
    GOAL_NOT_FREE = 'its goal is where the map has an obstacle or ends'
    GOALS_OVERLAP = 'its goal overlaps that of {other}'
    TOO_NARROW = 'the floor is too narrow for it, even without the other objects'
    BLOCKED = '{others} stand in its way, and cannot be moved out of it first'
    NO_TEMPORARY_PLACE = '{others} stand in its way, and there is no free place for them'
    NO_ROOM_FOR_ROBOT = 'the robot has no room to push it from where it stands to its goal'
    SEARCH_LIMIT = 'no order was found before the search had to end'
    PUSHES_FAILED = 'its pushes failed: {reason}'
    NOT_ALL = 'nothing more is moved: all were asked for, and {others} cannot get to a goal'
    NOT_MOVED = 'it was not moved: {reason}'
    NOT_MEASURED = '{missing} did not come for {time:g} s'


@dataclasses.dataclass(frozen=True)
class Report(Generic[ReportedCause]):
    """
    Event with the values that belong to it; ``str`` gives the sentence.

    :param code: what has happened, a member of a ``Cause``.
    :param values: what its sentence names.
    """

    code: ReportedCause
    values: Mapping[str, Any] = dataclasses.field(default_factory=dict[str, Any])

    def __str__(self) -> str:
        """Return the sentence."""
        return self.code.value.format(**self.values)

    @property
    def codes(self) -> Codes:
        """Its code, and those of what its sentence quotes."""
        return self.code, *self._quoted_codes()

    def _quoted_codes(self) -> Iterator[enum.Enum]:
        for value in self.values.values():
            if isinstance(value, Report):
                yield from value.codes
            elif isinstance(value, enum.Enum):
                yield value


AnyReport = Report[Cause]
EventReport = Report[PushEvent]
# The object does not seem to be where it was pushed to.
UNBELIEVED_POSES = (
    PushEvent.OBJECT_ELSEWHERE, PushEvent.OBJECT_POSES_SCATTER, PushEvent.OBJECT_STAYS_BEHIND)


def sentence(report: AnyReport | None) -> str:
    """
    Put an event into words.

    :param report: ``Report``, or None.
    :return: one sentence; empty where nothing has happened.
    """
    return '' if report is None else str(report)


def codes(report: AnyReport | None) -> Codes:
    """
    List the codes of an event.

    :param report: ``Report``, or None.
    :return: none where nothing has happened.
    """
    return () if report is None else report.codes
