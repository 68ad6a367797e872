"""Diagnostics and markers of a task."""

from typing import Any

from push_control.events import WITHOUT_FAULT
from push_control.ros.scene import EstimatedScene, ScenePublisher
from push_control.task.code_text import code_text
from push_control.task.status import StateChange, SupervisorStatus, TaskState
from push_control.task.supervisor import Supervisor
from push_model.geometry import Pose
from push_model.observation import Observation
from push_model.trajectory import PushTrajectory
from push_ros.conversions.map import map_text
from push_ros.diagnostics import ERROR, HAS_MAP, OK, WARN
from push_ros.node import PushNode, RateLimiter

LEVELS = {TaskState.FAILED: ERROR, TaskState.PAUSED: WARN}
# Most diagnostics per second of measured time without a change [Hz]; chosen: enough to follow a
# task by eye.
REPORT_RATE = 1.0


class TaskReporter:
    """
    Reports every change of state, and draws object, robot, plan and state.

    ``skipped_time``: by how much clocks were set ahead, for which that of the supervisor does not
    count [s].
    """

    def __init__(self, node: PushNode, scene: ScenePublisher) -> None:
        """Start without reports."""
        self._node = node
        self._scene = scene
        self._reporter = node.reporter
        self._history: tuple[StateChange, ...] = ()
        self.skipped_time = 0.0
        self.report_again()

    def report_again(self) -> None:
        """Report the present state next time, changed or not."""
        self._reported: tuple[TaskState, str] | None = None
        self._report_rate = RateLimiter(REPORT_RATE)

    def report(self, supervisor: Supervisor, time: float) -> None:
        """
        Report every change of state, and what the robot waits for.

        :param time: of the newest measurement [s].
        """
        known, self._history = self._history, supervisor.history
        perception = supervisor.perception
        base = perception.base_knowledge
        known_values = {**({} if base is None else base.to_mapping()),
                        **perception.view.to_report()}
        if self._history is not known:
            is_continued = self._history[:len(known)] == known
            for change in self._history[len(known) if is_continued else 0:]:
                self._report(supervisor.status, change, time, known_values, always=True)
        is_due = self._report_rate.due(time)
        if is_due or (supervisor.state, supervisor.reason) != self._reported:
            status = supervisor.status
            present = StateChange(status.since, status.state, status.reason, status.is_requested,
                                  status.codes)
            self._report(status, present, time, known_values, always=False)

    def draw(self, supervisor: Supervisor, time: float) -> None:
        """
        Show object, robot and state.

        :param time: of the newest measurement [s].
        """
        def make_scene() -> EstimatedScene | None:
            status, estimate = supervisor.status, supervisor.object_estimate
            if estimate is None or status.robot_pose is None:
                return None
            return EstimatedScene(status.robot_pose, estimate, status.state is TaskState.PUSH,
                                  _sentence(status.state, status.reason))
        self._scene.publish(time, make_scene)

    def warn(self, text: str, observation: Observation) -> None:
        """
        Report what is not as it should be, beside the state.

        :param text: one sentence; empty where all is well.
        :param observation: ``Observation`` of which it holds.
        """
        if text:
            self._reporter.report(WARN, text, {'time': observation.time}, always=True)

    def report_error(self, text: str) -> None:
        """
        Report what has failed, beside the state.

        :param text: one sentence.
        """
        self._reporter.report(ERROR, text)

    def report_map(self, message: Any) -> None:
        """Report a map."""
        self._reporter.report(OK, map_text(message), {HAS_MAP: True})

    def show_goal(self, goal: Pose | None) -> None:
        """
        Draw the goal, or erase it with the plan.

        :param goal: ``Pose``, or None.
        """
        self._scene.show_goal(goal, self._node.now())

    def move_goal(self, goal: Pose) -> None:
        """Draw the goal elsewhere."""
        self._scene.move_goal(goal, self._node.now())

    def show_plan(self, plan: PushTrajectory, stamp: Any) -> None:
        """
        Draw a plan.

        :param stamp: ``builtin_interfaces/Time`` of the plan.
        """
        self._scene.show_plan(plan, stamp)

    def _report(self, status: SupervisorStatus, change: StateChange, time: float,
                known_values: dict[str, float], *, always: bool) -> None:
        self._reported = change.state, change.reason
        values = {
            'time': time, 'state': change.state.value, 'reason': change.reason,
            'codes': code_text(change.codes), 'since': change.time + self.skipped_time,
            'pushes': status.pushes, 'recoveries': status.recoveries,
            'robot_pose': status.robot_pose}
        if status.goal_deviation is not None:
            values['position_deviation'], values['heading_deviation'] = status.goal_deviation
        values.update({f'push.{key}': value for key, value in status.push.values().items()})
        values.update(known_values)
        is_fault = (bool(change.reason) and not change.is_requested
                    and WITHOUT_FAULT.isdisjoint(change.codes))
        level = LEVELS.get(change.state, WARN if is_fault else OK)
        self._reporter.report(level, f'task: {_sentence(change.state, change.reason)}', values,
                              always)


def _sentence(state: TaskState, reason: str) -> str:
    return f'{state.value}, {reason}' if reason else state.value
