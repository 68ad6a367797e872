"""
The one entry of goals: from ``goal_pose``, or a program, to their pursuit.

One goal is pursued at a time; another one replaces it. A goal is taken when it comes, and the
stamp of its message is no appointment: the clock of an operator's computer may be wrong. Only in
lockstep, where there is but one clock, a goal holds from the time of its stamp on.
"""

import dataclasses
import math
from typing import Any, Callable, NamedTuple, TYPE_CHECKING

from push_control.events import TaskEvent
from push_control.goal import GoalOutcome, GoalProgress, PushGoal
from push_control.ros.start_state import StartState
from push_model.events import AnyReport
from push_model.geometry import Pose, wrap_angle
from push_model.signals import ObjectPose
from push_ros.conversions.measurements import from_object_pose_message
from push_ros.conversions.primitives import MessageRefused, seconds
from push_ros.diagnostics import OK
from push_ros.node import PushNode

if TYPE_CHECKING:  # It is imported once the node has reported.
    from push_control.ros.pursuit import GoalPursuit

# Difference between a goal's stamp and the clock of the node that is worth a line in the log [s];
# chosen: longer than a message takes, shorter than what confuses an operator.
NOTED_CLOCK_DIFFERENCE = 1.0
# Difference of a repeated goal from the one that is pursued [m], [rad]; chosen: rounding, as both
# follow the drift of their frame.
REPETITION_TOLERANCE = 1e-6
# Why a goal ends that is replaced.
REPLACED = TaskEvent.GOAL_REPLACED.report()
# Why the robot has not backed off from its object at the end of a goal.
ODOMETRY_LOST = TaskEvent.ODOMETRY_LOST.report()
# Why a goal is abandoned, by the outcome that it then has.
ABANDONED = {GoalOutcome.CANCELLED: TaskEvent.GOAL_CANCELLED.report(),
             GoalOutcome.REPLACED: REPLACED,
             GoalOutcome.TIMED_OUT: TaskEvent.GOAL_TIMED_OUT.report()}


class GoalFeedback(NamedTuple):
    """
    Feedback on a goal.

    :param elapsed_time: since the goal was taken [s].
    :param remaining_time: until its time limit [s], infinite without one.
    """

    progress: GoalProgress
    elapsed_time: float
    remaining_time: float


class GoalHandle:
    """
    A goal that was taken.

    ``goal``: the ``PushGoal``. ``outcome``: its ``GoalOutcome``, None while it is pursued.
    ``cause``: ``Report`` of why, or None. ``last_feedback``: ``GoalFeedback`` of the last
    measurement. ``elapsed_time``: since it was taken [s].
    """

    def __init__(self, goal: PushGoal, on_end: Callable[['GoalHandle'], None] | None) -> None:
        """
        Start the pursuit.

        :param on_end: called with this handle once the outcome is known.
        """
        self.goal = goal
        self.outcome: GoalOutcome | None = None
        self.cause: AnyReport | None = None
        self.last_feedback = GoalFeedback(GoalProgress(), 0.0, goal.time_limit)
        # How it ends as soon as the robot stands.
        self.pending_outcome: GoalOutcome | None = None
        # As of ``PushNode.running_time`` [s].
        self.taken_at = 0.0
        # Time of the first measurement after it was taken [s].
        self.start_time: float | None = None
        self.elapsed_time = 0.0
        self._on_end = on_end

    def end(self, outcome: GoalOutcome, cause: AnyReport | None) -> None:
        """
        Note how the pursuit ended.

        :param cause: ``Report`` of why, or None.
        """
        self.outcome = outcome
        self.cause = cause
        if self._on_end is not None:
            self._on_end(self)


class _NextGoal(NamedTuple):
    """A goal that waits until the robot stands, and what is to be done before it begins."""

    handle: GoalHandle
    prepare: Callable[[], None]


class _LaterGoal(NamedTuple):
    """A goal that holds from the time of its pose on, and what is called once it is taken."""

    pose: ObjectPose
    follow: Callable[[], None]


class GoalEntry:
    """Takes goals, one at a time, and notes how each of them ends."""

    def __init__(self, node: PushNode, pursuit: 'GoalPursuit', frame: str, *,
                 is_lockstep: bool) -> None:
        """
        Wait for a goal.

        :param frame: id of the world frame.
        :param is_lockstep: whether goals hold from the time of their stamps on.
        """
        self._node = node
        self._pursuit = pursuit
        self._frame = frame
        self._is_lockstep = is_lockstep
        self._time = 0.0
        self._current: GoalHandle | None = None
        self._next: _NextGoal | None = None
        # Goals that hold from a later time on, in lockstep.
        self._later: list[_LaterGoal] = []

    @property
    def frame(self) -> str:
        """Id of the world frame."""
        return self._frame

    @property
    def current(self) -> GoalHandle | None:
        """The ``GoalHandle`` of the goal that is pursued, or None."""
        return self._current

    @property
    def is_idle(self) -> bool:
        """Tell whether there is no goal, and the robot stands."""
        return self._current is None and self._next is None and not self._pursuit.is_commanding

    @property
    def refusal(self) -> str:
        """Why no goal is taken at present, one sentence; empty where goals are taken."""
        is_stopped = self._pursuit.start_state is StartState.STOPPED
        return f'no goal is taken: {TaskEvent.STOPPED_BY_USER.report()}' if is_stopped else ''

    def on_message(self, message: Any, follow: Callable[[], None]) -> None:
        """
        Take a goal from a topic.

        :param follow: called with nothing once it is taken: from then on ``move`` is for it.
        :raises MessageRefused: where it cannot be used; the previous goal stays.
        """
        if self.refusal:
            raise MessageRefused(f'goal_pose: {self.refusal}')
        goal = from_object_pose_message(message, self._frame, 'goal_pose')
        if self._is_lockstep and goal.time > self._time:
            self._later = sorted([*self._later, _LaterGoal(goal, follow)],
                                 key=lambda later: later.pose)
            return
        self._note_clock_difference(message)
        if self._is_pursued(goal.pose):
            self._node.get_logger().debug('goal_pose: the goal that is pursued came again')
        else:
            self.start(PushGoal(goal.pose))
        follow()

    def _is_pursued(self, pose: Pose) -> bool:
        """Tell whether a goal is the present one, which some source repeats."""
        current = self._current
        if (current is None or current.pending_outcome is not None or self._next is not None
                or not self._pursuit.is_commanding):
            return False
        difference = current.goal.pose.inverse() @ pose
        return (current.goal == PushGoal(current.goal.pose)
                and max(abs(difference.x), abs(difference.y), abs(wrap_angle(difference.theta)))
                < REPETITION_TOLERANCE)

    def move(self, correction: Pose) -> None:
        """
        Move the present goal with the frame that it is in, or the one that a start goes on to.

        :param correction: ``Pose`` that takes the previous goal to the new one,
            ``correction @ goal``.
        """
        if self._next is not None:
            goal = self._next.handle.goal
            self._next.handle.goal = dataclasses.replace(goal, pose=correction @ goal.pose)
            return
        if self._current is not None:
            goal = self._current.goal
            self._current.goal = dataclasses.replace(goal, pose=correction @ goal.pose)
        self._pursuit.move_goal(correction)

    def start(self, goal: PushGoal, on_end: Callable[[GoalHandle], None] | None = None,
              prepare: Callable[[], None] | None = None) -> GoalHandle:
        """
        Take a goal, in place of the present one.

        :param on_end: called with the handle once the outcome is known.
        :param prepare: what has to be done before, while the robot stands and has no goal: it
            backs off from its object for that. None for a goal that is pursued at once.
        """
        handle = GoalHandle(goal, on_end)
        self._end_next(GoalOutcome.REPLACED, REPLACED)
        if prepare is None:
            self._end(GoalOutcome.REPLACED, REPLACED)
            self._start(handle)
            return handle
        self._next = _NextGoal(handle, prepare)
        if self._current is None:
            self._pursuit.cancel(REPLACED)
        elif self._current.pending_outcome is None:
            self._abandon(self._current, GoalOutcome.REPLACED)
        self._start_next()
        return handle

    def cancel(self) -> None:
        """Abandon the goal: the robot backs off from the object and stands, then it has ended."""
        if self._next is not None:
            # The robot backs off for it already.
            self._end_next(GoalOutcome.CANCELLED, None)
        elif self._current is not None and self._current.pending_outcome is None:
            self._abandon(self._current, GoalOutcome.CANCELLED)
            self._end_abandoned(self._current)

    def interrupt(self, outcome: GoalOutcome, cause: AnyReport) -> None:
        """
        Note that the robot no longer pursues any goal, present or later.

        :param cause: ``Report`` of why.
        """
        self._end_next(outcome, cause)
        self._end(outcome, cause)
        self._later = []
        self._time = 0.0

    def update(self, time: float) -> None:
        """
        Start goals whose time has come, and notice that the present one has ended.

        :param time: of the newest measurement [s].
        """
        self._time = time
        while self._later and self._later[0].pose.time <= time:
            later = self._later.pop(0)
            self.start(PushGoal(later.pose.pose))
            later.follow()
        if self._current is not None:
            self._update_current(self._current, time)
        self._start_next()

    def on_time_ahead(self, duration: float) -> None:
        """
        Note that clocks were set ahead: that takes no time of a goal.

        :param duration: by how much [s].
        """
        current = self._current
        if current is not None and current.start_time is not None:
            current.start_time += duration

    def _update_current(self, current: GoalHandle, time: float) -> None:
        if current.start_time is None:
            current.start_time = time
        current.elapsed_time = time - current.start_time
        progress = self._pursuit.progress
        if current.pending_outcome is not None:
            self._end_abandoned(current)
        elif progress.outcome is not None:
            self._end(progress.outcome, progress.cause)
        elif current.elapsed_time > current.goal.time_limit:
            self._abandon(current, GoalOutcome.TIMED_OUT)

    def on_odometry_lost(self) -> None:
        """
        Notice that the present goal has ended while no odometry comes, or that its time is over.

        The robot cannot back off then. The time is that since the goal was taken, whatever clocks
        were set to meanwhile.
        """
        current = self._current
        if current is not None:
            current.elapsed_time = max(current.elapsed_time,
                                       self._node.running_time() - current.taken_at)
            if current.pending_outcome is None and current.elapsed_time > current.goal.time_limit:
                self._abandon(current, GoalOutcome.TIMED_OUT)
            if current.pending_outcome is not None:
                self._pursuit.halt(ODOMETRY_LOST)
                self._end(current.pending_outcome, ODOMETRY_LOST)
        self._start_next()

    def feedback(self) -> GoalFeedback:
        """Return the ``GoalFeedback`` of the present goal, or of what the robot does without."""
        current, progress = self._current, self._pursuit.progress
        if current is None:
            return GoalFeedback(progress, 0.0, math.inf)
        if current.pending_outcome is not None:
            # The pursuit knows the goal no more.
            before = current.last_feedback.progress
            progress = progress._replace(position_error=before.position_error,
                                         heading_error=before.heading_error,
                                         pushes=before.pushes, deviation=before.deviation)
        current.last_feedback = GoalFeedback(progress, current.elapsed_time,
                                             current.goal.time_limit - current.elapsed_time)
        return current.last_feedback

    def _start(self, handle: GoalHandle) -> None:
        goal = handle.goal
        self._current = handle
        handle.taken_at = self._node.running_time()
        self._node.reporter.log(OK, f'has a goal at {goal.pose.x:.3f} m, {goal.pose.y:.3f} m, '
                                    f'{goal.pose.theta:.3f} rad')
        self._pursuit.set_goal(goal)

    def _start_next(self) -> None:
        """Start with the goal that waits, where the robot stands."""
        if self._next is None or self._pursuit.is_commanding:
            return
        if self._current is not None:
            self._end(self._current.pending_outcome or GoalOutcome.REPLACED, REPLACED)
        upcoming, self._next = self._next, None
        upcoming.prepare()
        self._start(upcoming.handle)

    def _end_next(self, outcome: GoalOutcome, cause: AnyReport | None) -> None:
        upcoming, self._next = self._next, None
        if upcoming is not None:
            upcoming.handle.end(outcome, cause)

    def _abandon(self, handle: GoalHandle, outcome: GoalOutcome) -> None:
        self.feedback()
        handle.pending_outcome = outcome
        self._pursuit.cancel(ABANDONED[outcome])

    def _end_abandoned(self, handle: GoalHandle) -> None:
        if handle.pending_outcome is not None and not self._pursuit.is_commanding:
            self._end(handle.pending_outcome, self._pursuit.progress.cause)

    def _end(self, outcome: GoalOutcome, cause: AnyReport | None) -> None:
        if self._current is not None:
            self.feedback()
        handle, self._current = self._current, None
        if handle is not None:
            self._node.get_logger().debug(f'goal {outcome.value}: {cause or "as expected"}')
            handle.end(outcome, cause)

    def _note_clock_difference(self, message: Any) -> None:
        stamp = seconds(message.header.stamp)
        difference = stamp - seconds(self._node.now())
        if stamp and abs(difference) > NOTED_CLOCK_DIFFERENCE:
            relation = 'ahead of' if difference > 0.0 else 'behind'
            self._node.get_logger().info(
                f'goal_pose: its stamp is {abs(difference):.1f} s {relation} the clock of this '
                'node; the goal holds from now on all the same')
