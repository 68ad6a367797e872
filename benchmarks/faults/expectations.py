"""
Expectations: for each fault which reasons name it, and how soon and how near the robot stops.

Most faults have the common bounds. Where others hold, a note says why: it stands in the report.
"""

from collections.abc import Iterable
import enum
from typing import NamedTuple

from benchmarks.faults.injection import Fault, Input, Word
from push_control.behaviors.failures import BehaviorFailure
from push_control.events import PerceptionEvent, TaskEvent
from push_model.events import PushEvent
from push_model.plan_request import PlanFailure
from push_safety.status import SafetyReason

# Common bounds: time from the beginning of a fault until zero is commanded [s], what the robot
# drives until then [m], and how far the object gets from everything that was planned for it [m];
# chosen, the last one as what pushes with wrong friction deviate by without any fault.
MAX_STOP_TIME = 0.3
MAX_DRIVEN = 0.05
MAX_DEVIATION = 0.2
# Why no bound holds for faults of goals, maps and plans.
HARMLESS_NOTE = 'what the robot does rests on the last goal, map or plan that could be used'


class Notice(enum.Enum):
    """What the controller's node reports beside the state of the task, by its first words."""

    NO_GOAL = 'waits for a goal'
    NO_ODOMETRY = 'no odometry for'
    ODOMETRY_REFUSED = 'odom: got'
    POSE_REFUSED = 'object_pose: got'
    GOAL_REFUSED = 'goal_pose: got'
    MAP_REFUSED = 'map: got'
    PLAN_REFUSED = 'push_plan: got'
    TIME_WENT_BACK = 'stopped: time went back'


class Expectation(NamedTuple):
    """
    What is expected of a run with a fault.

    :param reasons: names of codes of which one has to be told, unless the task is done.
    :param must_stop: whether the robot has to stop for the fault at all.
    :param stop_time: until it commands zero, at most [s].
    :param driven: by the robot until then, at most [m].
    :param deviation: of the object from all that was planned for it, at most [m].
    :param note: why the bounds are not the common ones; empty where they are.
    """

    reasons: frozenset[str]
    must_stop: bool = True
    stop_time: float = MAX_STOP_TIME
    driven: float = MAX_DRIVEN
    deviation: float = MAX_DEVIATION
    note: str = ''


def _named(*groups: enum.Enum | Iterable[enum.Enum]) -> frozenset[str]:
    """Name codes, and those of groups of them."""
    names: set[str] = set()
    for group in groups:
        members = (group,) if isinstance(group, enum.Enum) else group
        names.update(map(str, members))
    return frozenset(names)


def _harmless(reasons: frozenset[str]) -> Expectation:
    """Expect the reasons of a fault for which the robot need not stop."""
    return Expectation(reasons, must_stop=False, note=HARMLESS_NOTE)


STALE_ODOMETRY = PushEvent.ODOMETRY_STALE, SafetyReason.ODOMETRY_WAS_MISSING
WRONG_ODOMETRY = (
    SafetyReason.ODOMETRY_JUMPED, SafetyReason.ODOMETRY_FROZEN,
    SafetyReason.ODOMETRY_CONTRADICTORY, SafetyReason.ODOMETRY_DIRECTION,
    SafetyReason.ODOMETRY_LATERAL, SafetyReason.ODOMETRY_SCALE)
SLIP = (PerceptionEvent.ODOMETRY_TOO_LARGE, PerceptionEvent.ODOMETRY_TOO_SMALL,
        PushEvent.OBJECT_STAYS_BEHIND)
NOT_FOLLOWING = SafetyReason.NOT_MOVING, SafetyReason.MOVES_OTHERWISE
LATE_POSES = PushEvent.OBJECT_POSE_STALE, PushEvent.OBJECT_POSES_LATE
ELSEWHERE = (
    PerceptionEvent.POSES_ELSEWHERE, PerceptionEvent.POSES_JUMPED_ELSEWHERE,
    PerceptionEvent.POSES_JUMPED,
    PushEvent.OBJECT_ELSEWHERE, PushEvent.OBJECT_STAYS_BEHIND, PushEvent.OBJECT_POSE_JUMPS)
SCATTER = (
    PushEvent.OBJECT_POSES_SCATTER, PushEvent.OBJECT_POSE_JUMPS,
    PerceptionEvent.OBJECT_POSES_DIFFER, PerceptionEvent.OBJECT_POSES_NOISIER_THAN_STATED)
NO_PLAN = TaskEvent.NOBODY_PLANS, TaskEvent.PLANNER_SILENT, TaskEvent.PLANNERS_SILENT

ODOMETRY = {
    Word.OFF: Expectation(
        _named(STALE_ODOMETRY), driven=0.07,
        note='at 0.3 m/s it slows down while the next message may still come'),
    Word.STUCK: Expectation(_named(WRONG_ODOMETRY, NOT_FOLLOWING, SafetyReason.BASE_STOOD)),
    Word.GARBAGE: Expectation(_named(WRONG_ODOMETRY)),
    Word.WRONG: Expectation(_named(WRONG_ODOMETRY, ELSEWHERE)),
    Word.SLOW: Expectation(
        _named(STALE_ODOMETRY, WRONG_ODOMETRY), must_stop=False,
        note='five messages a second are enough; the robot is slower between them'),
    Word.DELAYED: Expectation(
        _named(STALE_ODOMETRY, SafetyReason.FOLLOWS_LATE), stop_time=0.35, driven=0.07,
        note='as off, until the first late message'),
    Word.INTERMITTENT: Expectation(
        _named(STALE_ODOMETRY), stop_time=0.4, driven=0.07,
        note='after a shorter gap it slows down later: messages have been as late before'),
    Word.SLIPPING: Expectation(
        _named(SLIP, ELSEWHERE, WRONG_ODOMETRY), must_stop=False,
        note='wheels that slip show in the next contact alone'),
    Word.LIFTED: Expectation(
        _named(ELSEWHERE, PushEvent.OBJECT_DOES_NOT_FOLLOW, NOT_FOLLOWING,
               BehaviorFailure.LOST_ROBOT_TOUCHES), must_stop=False,
        deviation=0.25,
        note='wheels count nothing of it: contacts show it, with the object or with walls; where '
        'a lidar shows it, in `task_lidar`, pushes deviate by 0.23 m without a fault'),
    Word.RESTARTED: Expectation(
        _named(WRONG_ODOMETRY, TaskEvent.STARTED_OVER, ELSEWHERE), deviation=0.3,
        note='a robot that stood starts over from where odometry has it'),
    Word.IN_WORLD_AXES: Expectation(
        _named(WRONG_ODOMETRY), must_stop=False,
        note='it shows where the robot drives at an angle to the axes of the world'),
}
POSE = {
    Word.OFF: Expectation(
        _named(LATE_POSES, PerceptionEvent.NO_POSES_COME), driven=0.09,
        note='0.3 s of the way to the object at 0.3 m/s'),
    Word.STUCK: Expectation(_named(PushEvent.OBJECT_POSE_FROZEN, LATE_POSES)),
    Word.GARBAGE: Expectation(
        _named(SCATTER, LATE_POSES, PerceptionEvent.OBJECT_MOVES), driven=0.09, note='as off'),
    Word.WRONG: Expectation(
        _named(ELSEWHERE, SCATTER), must_stop=False, deviation=0.5,
        note='what is planned lies 0.3 m beside the object'),
    Word.SLOW: Expectation(_named(LATE_POSES), driven=0.09, note='as off'),
    Word.DELAYED: Expectation(
        _named(LATE_POSES), stop_time=0.35, driven=0.09, note='as off, until the first late pose'),
    Word.INTERMITTENT: Expectation(_named(LATE_POSES), driven=0.09, note='as off'),
    Word.OUTLIERS: Expectation(
        _named(SCATTER, LATE_POSES), must_stop=False,
        note='nine of ten poses are right; the others do not count'),
    Word.NEAR_TIMEOUT: Expectation(_named(LATE_POSES), must_stop=False,
                                   note='a pose of 0.24 s counts'),
    Word.OF_ANOTHER_OBJECT: Expectation(
        _named(ELSEWHERE), must_stop=False, deviation=1.0,
        note='somebody may have put the object there; the one that is in the way to it is pushed '
        'until contacts do not fit'),
    Word.MIRRORED: Expectation(
        _named(ELSEWHERE), must_stop=False, deviation=0.5,
        note='an object on the x axis looks the same; contacts show it'),
    Word.OF_THE_ROBOT: Expectation(
        _named(ELSEWHERE, PerceptionEvent.OBJECT_MOVES), must_stop=False,
        note='contacts show that it is another object'),
    Word.NOISY: Expectation(
        _named(SCATTER, LATE_POSES), must_stop=False, note='ten times the noise is averaged'),
}
COMMAND = {
    Word.OFF: Expectation(_named(NOT_FOLLOWING, SafetyReason.BASE_STOOD)),
    Word.STUCK: Expectation(
        _named(NOT_FOLLOWING, SafetyReason.FOLLOWS_LATE, SafetyReason.BASE_STOOD), deviation=0.4,
        note='zeros do not stop it either: it pushes the object on at up to 0.3 m/s'),
    Word.GARBAGE: Expectation(_named(NOT_FOLLOWING, SafetyReason.FOLLOWS_LATE)),
    Word.WRONG: Expectation(_named(NOT_FOLLOWING, SafetyReason.FOLLOWS_LATE)),
    Word.SLOW: Expectation(
        _named(NOT_FOLLOWING), must_stop=False,
        note='half of the speed is within what loaded bases do; it is learned and made up for'),
    Word.DELAYED: Expectation(
        _named(NOT_FOLLOWING, SafetyReason.FOLLOWS_LATE), stop_time=1.0, driven=0.3,
        note='a base at a constant speed shows its delay where its command changes; until then '
        'it drives at up to 0.3 m/s'),
    Word.INTERMITTENT: Expectation(_named(NOT_FOLLOWING, SafetyReason.FOLLOWS_LATE,
                                          SafetyReason.BASE_STOOD)),
    Word.IN_WORLD_AXES: Expectation(
        _named(NOT_FOLLOWING, SafetyReason.FOLLOWS_LATE, SafetyReason.BASE_STOOD),
        must_stop=False,
        note='a robot that drives nearly along the axes follows nearly; one at a right angle to '
        'them stands'),
    Word.SHARED: Expectation(
        _named(NOT_FOLLOWING, SafetyReason.COMMANDED_BY_OTHERS, SafetyReason.FOLLOWS_LATE),
        stop_time=2.0, driven=0.35,
        note='the mean of both commands is near one while both drive ahead; over ROS, the other '
        'publisher is seen within 0.25 s'),
}
GOAL = {
    word: _harmless(reasons) for word, reasons in {
        Word.OFF: _named(Notice.NO_GOAL),
        Word.STUCK: _named(TaskEvent.NEW_GOAL),
        Word.GARBAGE: _named(Notice.GOAL_REFUSED, TaskEvent.GOAL_REFUSED),
        Word.WRONG: _named(TaskEvent.GOAL_TOO_FAR),
        Word.SLOW: _named(TaskEvent.NEW_GOAL),
        Word.DELAYED: _named(TaskEvent.NEW_GOAL),
        Word.INTERMITTENT: _named(TaskEvent.NEW_GOAL)}.items()}
MAP = {
    word: _harmless(reasons) for word, reasons in {
        Word.OFF: _named(TaskEvent.NO_USABLE_MAP),
        Word.STUCK: _named(TaskEvent.NO_USABLE_MAP),
        Word.GARBAGE: _named(Notice.MAP_REFUSED, TaskEvent.NO_USABLE_MAP),
        # The planner that plays here has no map: its plans are refused.
        Word.WRONG: _named(TaskEvent.MAP_BLOCKS_PATH, PlanFailure.NOT_FREE, PlanFailure.BLOCKED,
                           PlanFailure.INVALID_PLAN, BehaviorFailure.NO_PATH),
        Word.SLOW: _named(TaskEvent.NO_USABLE_MAP),
        Word.DELAYED: _named(TaskEvent.NO_USABLE_MAP),
        Word.INTERMITTENT: _named(TaskEvent.NO_USABLE_MAP)}.items()}
PLAN = {
    word: _harmless(reasons) for word, reasons in {
        Word.OFF: _named(NO_PLAN),
        Word.STUCK: _named(TaskEvent.PLAN_STARTS_ELSEWHERE, PlanFailure.INVALID_PLAN),
        Word.GARBAGE: _named(Notice.PLAN_REFUSED, PlanFailure.INVALID_PLAN),
        Word.WRONG: _named(TaskEvent.PLAN_STARTS_ELSEWHERE),
        Word.SLOW: _named(NO_PLAN),
        Word.DELAYED: _named(NO_PLAN),
        Word.INTERMITTENT: _named(NO_PLAN)}.items()}
STAMPS = (Notice.ODOMETRY_REFUSED, Notice.POSE_REFUSED, Notice.TIME_WENT_BACK,
          TaskEvent.TIME_WENT_BACK, Notice.NO_ODOMETRY, *STALE_ODOMETRY, *LATE_POSES)
CLOCK = {
    Word.OFF: Expectation(_named(STAMPS)),
    Word.STUCK: Expectation(_named(STAMPS)),
    Word.GARBAGE: Expectation(_named(STAMPS)),
    Word.WRONG: Expectation(_named(STAMPS)),
    Word.SLOW: Expectation(
        _named(STAMPS, WRONG_ODOMETRY, NOT_FOLLOWING), stop_time=3.0, driven=0.2,
        note='the robot is slower with its clock, until its motion contradicts that'),
    Word.DELAYED: Expectation(_named(STAMPS, SafetyReason.CLOCK_FELL_BACK), must_stop=False,
                              note='half a second is within what clocks differ by'),
    Word.INTERMITTENT: Expectation(
        _named(STAMPS, WRONG_ODOMETRY, NOT_FOLLOWING, SafetyReason.BASE_STOOD), driven=0.07,
        note='as odometry that is off'),
}
UNFIT = (*NOT_FOLLOWING, SafetyReason.FOLLOWS_LATE, SafetyReason.BASE_STOOD)
BASE = {
    Word.DEAD_BAND: Expectation(
        _named(UNFIT, BehaviorFailure.STALLED), must_stop=False,
        note='it is learned, and the base is driven in pulses'),
    Word.ONE_WHEEL: Expectation(
        _named(UNFIT), must_stop=False, deviation=0.1,
        note='the speed of the wheel is learned and made up for; the object shows what is not'),
    Word.SLUGGISH: Expectation(
        _named(UNFIT), must_stop=False,
        note='it is learned, and the base is driven no harder than it follows'),
    Word.LATE: Expectation(
        _named(UNFIT), must_stop=False,
        note='within what bases are late by; it is learned, and driven ahead of'),
}
TABLES = {Input.ODOMETRY: ODOMETRY, Input.POSE: POSE, Input.COMMAND: COMMAND, Input.GOAL: GOAL,
          Input.MAP: MAP, Input.PLAN: PLAN, Input.CLOCK: CLOCK, Input.BASE: BASE}
EXPECTATIONS = {(kind, word): expectation for kind, table in TABLES.items()
                for word, expectation in table.items()}


def expectation_of(fault: Fault) -> Expectation:
    """
    Look up what is expected.

    :param fault: the ``Fault``.
    """
    return EXPECTATIONS[fault.input, fault.word]


def notices(text: str) -> tuple[str, ...]:
    """
    Name the ``Notice`` that a sentence of the node is.

    :param text: the sentence.
    :return: its name; none where it is none of them.
    """
    return tuple(str(notice) for notice in Notice if text.startswith(notice.value))
