"""What a replay learns from the messages of the nodes: who is up, the plan, the time, the end."""

from collections.abc import Callable, Iterable
import dataclasses
from typing import Any, NamedTuple

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from push_control.task.code_text import codes_of_text
from push_control.task.status import StateChange, SupervisorStatus, TaskState
from push_model.events import Codes
from push_model.geometry import distance, Pose
from push_model.plan_request import PlanFailure
from push_model.trajectory import PushTrajectory
from push_ros.conversions.measurements import from_object_pose_message
from push_ros.conversions.plan import from_plan_message, plan_failure
from push_ros.conversions.primitives import NANOSECONDS
from push_ros.diagnostics import ERROR, FAILURE, HAS_MAP, status_values, value_text
from push_ros.topics import CONTROLLER, SIM, TOPICS
from push_scenario.dds.recorder import stamp_of
from push_scenario.definition.scenario import Scenario
from push_scenario.simulation.history import StateHistory
from push_scenario.simulation.loop import Progress, ProgressCallback
from push_scenario.simulation.result import Outcome
from rclpy.serialization import deserialize_message


# Topics of which a ``RunMonitor`` reads the messages, and the one more by which it sees progress;
# it needs no others.
READ_TOPICS = ('clock', 'diagnostics', 'push_plan')
PROGRESS_TOPIC = 'object_pose'


class RunEnd(NamedTuple):
    """
    End of a run by the controller's node, and its time.

    :param reason: one sentence.
    :param time: simulated time [s].
    :param codes: of the reason, as of ``Report``.
    """

    outcome: Outcome
    reason: str
    time: float
    codes: Codes = ()


@dataclasses.dataclass
class NodeReport:
    """
    Reports of a node so far.

    :param error: text of its last error, empty without any.
    :param codes: of that error, where it is one of planning.
    :param has_map: whether it has a map.
    """

    error: str = ''
    codes: Codes = ()
    has_map: bool = False


class TaskMonitor:
    """
    Monitor of the supervisor's reports.

    ``history``: ``StateHistory``. ``status``: the last ``SupervisorStatus``.
    """

    def __init__(self) -> None:
        """Start without any report."""
        self.history = StateHistory()
        self.status = SupervisorStatus()

    def update(self, values: dict[str, str]) -> StateChange:
        """
        Take in the diagnostics of a supervisor.

        :param values: texts by key.
        :return: the change to its present state.
        """
        change = StateChange(float(values['since']), TaskState(values['state']),
                             values['reason'], codes=codes_of_text(values.get('codes', '')))
        is_new = change[:2] != (self.status.since, self.status.state)
        recoveries = int(values['recoveries'])
        self.history.update((change,) if is_new else (), recoveries)
        self.status = SupervisorStatus(change.state, change.reason, change.time,
                                       int(values['pushes']), recoveries,
                                       history=self.history.changes, codes=change.codes)
        return change


class RunMonitor:
    """
    Keeps what matters of the messages of a run.

    ``nodes``: ``NodeReport`` by name, of every node that has reported. ``plan``: the first
    ``PushTrajectory``, or None. ``time``: simulated time [s]. ``task``: ``TaskMonitor``.
    ``end``: ``RunEnd``, once the supervisor has ended the run.

    :param progress: called with a ``Progress`` whenever simulated time is known; None for nobody.
    """

    def __init__(self, scenario: Scenario, progress: ProgressCallback | None = None) -> None:
        self.write: Callable[[str, bytes], None] | None = None
        self.nodes: dict[str, NodeReport] = {}
        self.plan: PushTrajectory | None = None
        self.time = 0.0
        self.task = TaskMonitor()
        self.end: RunEnd | None = None
        self._scenario = scenario
        self._progress = progress
        self._object_pose: bytes | None = None

    def on_message(self, topic: str, data: bytes) -> None:
        """
        Evaluate a message, and hand it to ``write`` where that is set.

        :param topic: its topic.
        :param data: the message, serialized.
        """
        if self.write is not None:
            self.write(topic, data)
        if topic == 'diagnostics':
            self._on_diagnostics(_deserialize(topic, data))
        elif topic == 'push_plan' and self.plan is None:
            message = _deserialize(topic, data)
            if plan_failure(message) is None:
                self.plan = from_plan_message(message, message.header.frame_id)
        elif topic == 'object_pose':
            self._object_pose = data
        elif topic == 'clock':
            stamp = stamp_of(topic, data, TOPICS[topic].type)
            if stamp is not None:
                self._advance(stamp / NANOSECONDS)

    def error(self, node: str) -> str:
        """
        Look up the last error of a node, an empty text without any.

        :param node: its name.
        """
        return self.nodes[node].error if node in self.nodes else ''

    def error_codes(self, node: str) -> Codes:
        """
        Look up the codes of the last error of a node; none without any.

        :param node: its name.
        """
        return self.nodes[node].codes if node in self.nodes else ()

    def missing(self, names: Iterable[str]) -> list[str]:
        """
        List reports that have not come.

        :param names: of the nodes that are expected to report.
        """
        return [f'a report of {name}' for name in names if name not in self.nodes]

    def nodes_with_map(self) -> set[str]:
        """Names of the nodes that have a map."""
        return {name for name, report in self.nodes.items() if report.has_map}

    def _on_diagnostics(self, message: DiagnosticArray) -> None:
        for status in message.status:
            report = self.nodes.setdefault(status.name, NodeReport())
            values = status_values(status)
            if status.level == ERROR:
                report.error, report.codes = status.message, _failure_codes(values)
            report.has_map = report.has_map or values.get(HAS_MAP) == value_text(True)
            self._on_status(status, values)

    def _advance(self, time: float) -> None:
        self.time = max(self.time, time)
        self._report_progress()

    def _on_status(self, status: DiagnosticStatus, values: dict[str, str]) -> None:
        if status.name == SIM and 'time' in values:
            # The clock comes best effort: it may be over for a replay that stood still.
            self._advance(float(values['time']))
        if status.name != CONTROLLER or self.end is not None:
            return
        if 'state' in values:
            change = self.task.update(values)
            if change.state.is_final and change.time >= self._last_goal_time:
                self.end = RunEnd(Outcome(change.state.value), change.reason, change.time,
                                  change.codes)

    @property
    def _last_goal_time(self) -> float:
        task = self._scenario.task
        return max((later.time for later in task.goals), default=0.0) if task else 0.0

    @property
    def _stage(self) -> str:
        if self.end is not None:
            return 'settling'
        if self._scenario.task is not None:
            return self.task.status.state.value
        return 'planning' if self.plan is None else 'pushing'

    def _report_progress(self) -> None:
        if self._progress is None or self._object_pose is None:
            return
        message = _deserialize('object_pose', self._object_pose)
        pose: Pose = from_object_pose_message(message, message.header.frame_id).pose
        self._progress(Progress(self._stage, self.time,
                                distance(pose, self._scenario.final_goal)))


def _failure_codes(values: dict[str, str]) -> Codes:
    """Read why there is no plan, from the diagnostics of a planner."""
    return codes_of_text(f'{PlanFailure.__name__}.{values.get(FAILURE, "")}')


def _deserialize(topic: str, data: bytes) -> Any:
    return deserialize_message(data, TOPICS[topic].type)
