"""How far the pursuit of a goal has come, from the status of its supervisor."""

from push_control.goal import GoalOutcome, GoalProgress, PushState, TaskFailure
from push_control.task.status import SupervisorStatus, TaskState
from push_model.events import AnyReport
from push_model.geometry import distance, Pose, wrap_angle

OUTCOMES = {TaskState.DONE: GoalOutcome.REACHED, TaskState.FAILED: GoalOutcome.FAILED,
            TaskState.IDLE: GoalOutcome.CANCELLED}
STATES = {TaskState.IDLE: PushState.IDLE, TaskState.PLAN: PushState.PLANNING,
          TaskState.APPROACH: PushState.APPROACHING, TaskState.ALIGN: PushState.ALIGNING,
          TaskState.PUSH: PushState.PUSHING, TaskState.RETREAT: PushState.RETREATING,
          TaskState.DONE: PushState.REACHED, TaskState.FAILED: PushState.FAILED,
          TaskState.PAUSED: PushState.PAUSED, TaskState.LOOK: PushState.LOOKING}


def task_progress(status: SupervisorStatus, cause: AnyReport | None, *,
                  is_started: bool) -> GoalProgress:
    """
    Tell how far a task has come; before its start it has no outcome.

    :param cause: ``Report`` of why its state is as it is, or None.
    :param is_started: whether the robot may move.
    """
    outcome = OUTCOMES.get(status.state) if is_started else None
    if is_started and status.failure is TaskFailure.NO_PLAN:
        outcome = GoalOutcome.NO_PLAN
    return GoalProgress(STATES[status.state], cause, outcome, status.pushes,
                        deviation=status.goal_deviation, outlook=status.outlook)


def with_errors(progress: GoalProgress, measured: Pose, goal: Pose) -> GoalProgress:
    """
    Add how far the object is from its goal.

    :param measured: newest measured ``Pose`` of the object.
    :param goal: its goal ``Pose``.
    """
    return progress._replace(position_error=distance(measured, goal),
                             heading_error=wrap_angle(measured.theta - goal.theta))
