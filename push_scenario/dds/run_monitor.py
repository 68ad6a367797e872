"""What a replay sees of the nodes: who speaks, the plan, the time, the end."""

import math

from push_control.task.status import StateChange, SupervisorStatus, TaskState
from push_model.geometry import distance
from push_ros.conversions.map import HAS_MAP
from push_ros.conversions.measurements import from_object_pose_message
from push_ros.conversions.plan import from_plan_message
from push_ros.conversions.primitives import NANOSECONDS
from push_ros.diagnostics import ERROR
from push_ros.topics import CONTROLLER, PLANNER, TOPICS
from push_scenario.dds.recorder import stamp_of
from push_scenario.simulation.loop import Progress
from push_scenario.simulation.result import TaskHistory
from rclpy.serialization import deserialize_message

ENDS = ('done', 'failed')


class RunMonitor:
    """
    Keeps what matters of the messages.

    ``heard``: nodes that have reported. ``plan``: the first ``PushTrajectory``, or None.
    ``errors``: dict of nodes to their last error. ``time``: simulated time [s]. ``phase``,
    ``reason``, ``end_time``: the controller's, once it is done or has failed.

    :param goal: ``Pose`` wanted for the object.
    :param progress: called with a ``Progress`` when the clock comes; None for nobody.
    """

    def __init__(self, goal, progress=None):
        self._goal, self._progress, self._object_pose = goal, progress, None
        self.write = None
        self.heard, self.plan, self.errors, self.time = set(), None, {}, 0.0
        self.phase = self.reason = self.end_time = None

    def note(self, topic, data):
        """
        Look at a message, and hand it to ``write`` where there is one.

        :param topic: its topic.
        :param data: the message, serialized.
        """
        if self.write is not None:
            self.write(topic, data)
        if topic == 'diagnostics':
            self._note_diagnostics(_message(topic, data))
        elif topic == 'push_plan' and self.plan is None:
            message = _message(topic, data)
            if message.points:
                self.plan = from_plan_message(message, message.header.frame_id)
        elif topic == 'object_pose':
            self._object_pose = data
        elif topic == 'clock':
            time = stamp_of(topic, data, TOPICS[topic].type) / NANOSECONDS
            self.time = max(self.time, time)
            self._tell()

    def _note_diagnostics(self, message):
        for status in message.status:
            self.heard.add(status.name)
            if status.level == ERROR:
                self.errors[status.name] = status.message
            values = {item.key: item.value for item in status.values}
            self._note_status(status, values)

    def _note_status(self, status, values):
        if status.name == CONTROLLER and values.get('phase') in ENDS and self.end_time is None:
            self.phase, self.reason = values['phase'], values['reason']
            self.end_time = float(values['time'])

    def _stage(self):
        if self.end_time is not None:
            return 'settling'
        return 'planning' if self.plan is None else 'pushing'

    def _tell(self):
        if self._progress is None or self._object_pose is None:
            return
        message = _message('object_pose', self._object_pose)
        pose = from_object_pose_message(message, message.header.frame_id).pose
        self._progress(Progress(self._stage(), self.time, distance(pose, self._goal)))


class TaskWatcher(RunMonitor):
    """
    Keeps besides what the supervisor of a task does.

    ``history``: ``TaskHistory``. ``status``: the last ``SupervisorStatus``. ``single``: time of
    the best single push from the start [s]. ``maps``: nodes that have got a map.

    :param task: the scenario's ``Task``.
    :param goal: ``Pose`` wanted for the object in the end.
    :param progress: called with a ``Progress`` when the clock comes; None for nobody.
    """

    def __init__(self, task, goal, progress=None):
        super().__init__(goal, progress)
        self._last_goal_at = max((later.time for later in task.goals), default=0.0)
        self.history, self.status, self.single = TaskHistory(), SupervisorStatus(), math.nan
        self.maps = set()

    def _note_status(self, status, values):
        if HAS_MAP in status.message:
            self.maps.add(status.name)
        if status.name == PLANNER and 'single_push' in values and math.isnan(self.single):
            self.single = float(values['single_push'])
        if status.name != CONTROLLER or 'state' not in values or self.end_time is not None:
            return
        change = StateChange(float(values['since']), TaskState(values['state']),
                             values['reason'])
        is_new = change[:2] != (self.status.since, self.status.state)
        self.history.note((change,) if is_new else (), int(values['recoveries']))
        self.status = SupervisorStatus(
            change.state, change.reason, change.time, int(values['pushes']),
            int(values['recoveries']), history=self.history.changes)
        if change.state.is_final and change.time >= self._last_goal_at:
            self.phase, self.reason = change.state.value, change.reason
            self.end_time = change.time

    def _stage(self):
        return self.status.state.value


def _message(topic, data):
    return deserialize_message(data, TOPICS[topic].type)
