"""
Verdict on a run with faults: what of it is not as it should be.

A run is ok where nothing is: done in truth, or stopped for a reason that names the fault, soon
enough and with the object where it was, and nothing drives in the end. What the robot says counts
by its codes, never by its sentence.
"""

from collections.abc import Collection
import enum
import math
from typing import NamedTuple

from benchmarks.faults.effect import effect_time
from benchmarks.faults.expectations import Expectation, expectation_of
from benchmarks.faults.injection import Fault, Input, OFFSET, OTHER_OBJECT, SIMULATED, Word
from benchmarks.faults.row import Ending
from benchmarks.faults.simulated import Record, Simulated
import numpy as np
from push_control.task.status import TaskState
from push_model.geometry import distance, FloatArray, Pose, wrap_angle
from push_model.signals import STOP, Twist
from push_sim_node.tape import Tape

# What counts as where the controller says that the object is, over its tolerances; chosen: a
# measured pose errs, too.
TRUE_RATIO = 1.5
# Commands before the end of a run that waits which must be zero [s]; chosen.
FINAL_TIME = 1.0
# Velocity at which a robot stands [m/s], [rad/s]; chosen: what is left after a second of zeros.
STANDING_SPEED, STANDING_YAW_RATE = 0.01, 0.05
# Time after a fault of commands, or the stop for it, in which the object counts as displaced by it
# [s]; chosen: longer than a base takes to come to rest.
DISPLACING_TIME = 1.0
# Greatest speed at the end of a run, from which a weak base brakes in a time [m/s], [s]: at
# 0.15 m/s^2. Lever of rotations [m].
BRAKING_SPEED, BRAKING_TIME = 0.4, 2.5
LEVER = 0.2
# Error of a difference of times [s].
ROUNDING = 1e-6


class Violation(enum.Enum):
    """What is not as it should be."""

    NOT_AT_GOAL = 'reported as done, but the object is not at its goal'
    WRONG_REASON = 'the reason does not name the fault'
    STILL_DRIVES = 'drives in the end'
    NEVER_STOPS = 'does not stop'
    STOPS_LATE = 'stops too late'
    DRIVES_FAR = 'drives too far until it stops'
    OBJECT_MOVED = 'the object is moved too far from what was planned for it'


class Stop(NamedTuple):
    """
    How the robot stops for a fault.

    :param duration: from the beginning of the fault, of commands of its effect, until the robot
        first commands zero [s]; nan: never during the fault, or it needs no stop.
    :param driven: by the robot until then [m]; nan likewise.
    """

    duration: float
    driven: float


class Verdict(NamedTuple):
    """
    Verdict on a run.

    :param violations: each ``Violation``; empty where all is as it should be.
    :param stop: the ``Stop``.
    :param deviation: greatest distance of the object, after the beginning of the fault, from all
        that was planned for it [m].
    """

    violations: tuple[Violation, ...]
    stop: Stop
    deviation: float


def evaluate(fault: Fault, simulated: Simulated) -> Verdict:
    """
    Evaluate a run.

    :param fault: the ``Fault``.
    :param simulated: ``Simulated``: what was done to it.
    """
    record, expectation = simulated.record, expectation_of(fault)
    start = effective_start(fault, record)
    stop = find_stop(fault, record, start)
    moved = deviation(record, fault, start + stop.duration)
    violations = [
        *ending_violations(simulated, expectation.reasons, fault),
        *stop_violations(stop, expectation, fault, start),
        *([Violation.OBJECT_MOVED] if moved > expectation.deviation else [])]
    return Verdict(tuple(violations), stop, moved)


def effective_start(fault: Fault, record: Record) -> float:
    """
    Find when a fault first has an effect on what the robot needs, or on what its base does.

    :param fault: the ``Fault``.
    :param record: ``Record`` of the run.
    :return: time [s]; nan for never.
    """
    if fault.input in (Input.COMMAND, Input.BASE):
        return effect_time(record.scenario.true_robot, fault, record.tape, record.sent)
    start = fault.start
    if fault.input in (*SIMULATED, Input.CLOCK) and fault.word is Word.INTERMITTENT:
        start = fault.first_gap
    return _end_of_retreat(record, start) if fault.input is Input.POSE else start


def _end_of_retreat(record: Record, time: float) -> float:
    """Return a time, or the end of the retreat that it is in, which needs no object poses [s]."""
    state = TaskState.IDLE
    for change in record.history:
        if change.time > time:
            return change.time if state is TaskState.RETREAT else time
        state = change.state
    return time


def find_stop(fault: Fault, record: Record, start: float) -> Stop:
    """
    Find when the robot first commands zero for a fault, and what it drives until then.

    :param fault: the ``Fault``.
    :param record: ``Record`` of the run.
    :param start: when the fault begins to have an effect [s].
    """
    stop_time = next((sent.time for sent in record.sent
                      if start <= sent.time < fault.end and sent.twist == STOP), math.nan)
    return Stop(stop_time - start, _driven(record.tape, start, stop_time))


def ending_violations(simulated: Simulated, reasons: Collection[str],
                      fault: Fault | None) -> list[Violation]:
    """
    Check how a run has ended.

    :param simulated: ``Simulated``.
    :param reasons: names of the codes that name what was done to it.
    :param fault: the ``Fault`` as of ``is_truly_done``; None where several come and go.
    """
    record, ending = simulated.record, simulated.ending
    violations: list[Violation] = []
    if _has_changing_goal(fault) and ending is Ending.WAITS:
        # The robot drives to the newest goal: that is no fault.
        return []
    if ending is Ending.DONE:
        if not is_truly_done(record, fault):
            violations.append(Violation.NOT_AT_GOAL)
    elif not set(reasons).intersection(simulated.codes):
        violations.append(Violation.WRONG_REASON)
    is_base_driven = fault is not None and fault.input is Input.COMMAND
    if not stands(simulated, is_base_driven):
        violations.append(Violation.STILL_DRIVES)
    return violations


def _has_changing_goal(fault: Fault | None) -> bool:
    """Tell whether somebody alternates between two goals to the end."""
    return fault is not None and not fault.is_temporary and (
        fault.input is Input.GOAL and fault.word is Word.SLOW)


def stop_violations(stop: Stop, expectation: Expectation, fault: Fault,
                    start: float) -> list[Violation]:
    """
    Compare a stop with its bounds.

    :param stop: the ``Stop``.
    :param expectation: the ``Expectation``.
    :param fault: the ``Fault``.
    :param start: when it begins to have an effect [s]; nan for never.
    """
    if not expectation.must_stop or math.isnan(start):
        return []
    if math.isnan(stop.duration):
        lasts = fault.end - start > expectation.stop_time
        return [Violation.NEVER_STOPS] if lasts else []
    return [violation for violation, is_so in (
        (Violation.STOPS_LATE, stop.duration > expectation.stop_time + ROUNDING),
        (Violation.DRIVES_FAR, stop.driven > expectation.driven)) if is_so]


def stands(simulated: Simulated, is_base_driven: bool) -> bool:
    """
    Tell whether nothing drives in the end.

    :param simulated: ``Simulated``: a robot that waits has to have commanded zero for a second,
        another one may brake as slowly as a weak base does.
    :param is_base_driven: whether somebody else may drive the base; only commands count then.
    """
    record, tape = simulated.record, simulated.record.tape
    waits = simulated.ending is Ending.WAITS
    since = record.end_time - FINAL_TIME if waits else record.end_time
    last = [sent for sent in record.sent if sent.time > since]
    if any(sent.twist != STOP for sent in (last if waits else last[-1:])):
        return False
    if not all(_size(sent.twist) <= _braking_limit(sent.time - since) for sent in last):
        return False
    return is_base_driven or (
        math.hypot(tape['robot_v_x'][-1], tape['robot_v_y'][-1]) <= STANDING_SPEED
        and abs(float(tape['robot_omega'][-1])) <= STANDING_YAW_RATE)


def _size(twist: Twist) -> float:
    """Return the speed of a command, rotations by a lever [m/s]."""
    return math.hypot(twist.v_x, twist.v_y, LEVER * twist.omega)


def _braking_limit(elapsed: float) -> float:
    """Limit the speed of a command some time [s] after the end of a run [m/s]."""
    return max(0.0, BRAKING_SPEED * (1.0 - elapsed / BRAKING_TIME))


def is_truly_done(record: Record, fault: Fault | None = None) -> bool:
    """
    Tell whether the object is at its goal in truth.

    :param record: the ``Record``.
    :param fault: the ``Fault``, where it may last; what a tracker shows that is off for good is
        all that can be known.
    """
    scenario = record.scenario
    settings = (scenario.control if scenario.task is None
                else scenario.task.supervision.for_object(scenario.object))
    object_pose, goal = Pose(*record.tape.poses('object')[-1]), scenario.final_goal
    if fault is not None and not fault.is_temporary and (
            fault.input is Input.POSE and fault.word is Word.WRONG):
        object_pose = Pose(object_pose.x + OFFSET.x, object_pose.y, object_pose.theta
                           + OFFSET.theta)
    return bool(
        distance(object_pose, goal) <= TRUE_RATIO * settings.position_tolerance
        and abs(wrap_angle(object_pose[2] - goal.theta)) <= (
            TRUE_RATIO * settings.heading_tolerance))


def deviation(record: Record, fault: Fault, stop_time: float) -> float:
    """
    Find how far the object is from all that was planned for it, after a fault begins [m].

    :param record: the ``Record``.
    :param fault: the ``Fault``.
    :param stop_time: when the robot first commands zero during the fault; nan: never [s].
    """
    poses = np.array(record.tape.poses('object'))[:, :2]
    planned = np.concatenate([poses[:1], *(plan.object_poses[:, :2] for plan in record.plans)])
    end = math.inf
    if fault.input in (Input.COMMAND, Input.BASE):
        # What it has done to the object is corrected on other paths, and a base that goes on to
        # push the object although zero is commanded does so for nobody here.
        end = (fault.end if math.isnan(stop_time) else stop_time) + DISPLACING_TIME
    times = record.tape['time']
    after = poses[(times >= fault.start) & (times <= end)]
    gaps = [np.hypot(*(planned - position).T).min() for position in after[::5]]
    return float(max(gaps, default=0.0))


def offset_of(fault: Fault) -> float:
    """
    Return by how much the object seems to be displaced [m]; infinite: anywhere.

    :param fault: the ``Fault``.
    """
    if fault.input is not Input.POSE:
        return 0.0
    if fault.word in (Word.MIRRORED, Word.OF_THE_ROBOT):
        return math.inf
    offset = {Word.WRONG: OFFSET, Word.OF_ANOTHER_OBJECT: OTHER_OBJECT}.get(fault.word)
    return 0.0 if offset is None else math.hypot(offset.x, offset.y)


def _driven(tape: Tape, start: float, end: float) -> float:
    """Sum up what the robot drives between two times; nan where one is [m]."""
    times, poses = tape['time'], np.array(tape.poses('robot'))
    within = poses[(times >= start) & (times <= end)]
    return math.nan if math.isnan(end) else _length(within)


def _length(poses: FloatArray) -> float:
    return float(np.hypot(*np.diff(poses[:, :2], axis=0).T).sum())
