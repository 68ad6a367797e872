"""What a replay sees of the nodes: who speaks, the plan, the time, the end."""

from push_model.geometry import distance
from push_ros.diagnostics import ERROR
from push_ros.elements import NANOSECONDS
from push_ros.interfaces import CONTROLLER, TOPICS
from push_ros.messages import from_object_pose_message
from push_ros.plan_messages import from_plan_message
from push_ros.recorder import stamp_of
from push_scenario.closed_loop import Progress
from rclpy.serialization import deserialize_message


class Watcher:
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
            if status.name == CONTROLLER and values.get('phase') in ('done', 'failed') \
                    and self.end_time is None:
                self.phase, self.reason = values['phase'], values['reason']
                self.end_time = float(values['time'])

    def _tell(self):
        if self._progress is None or self._object_pose is None:
            return
        message = _message('object_pose', self._object_pose)
        pose = from_object_pose_message(message, message.header.frame_id).pose
        stage = 'planning' if self.plan is None else 'pushing'
        stage = stage if self.end_time is None else 'settling'
        self._progress(Progress(stage, self.time, distance(pose, self._goal)))


def _message(topic, data):
    return deserialize_message(data, TOPICS[topic].type)
