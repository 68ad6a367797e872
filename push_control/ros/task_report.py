"""What the controller's node says and shows of a task."""

from push_control.task.status import StateChange, TaskState
from push_ros.conversions.map import map_text
from push_ros.conversions.markers import GREY, plan_markers, scene_markers, text_markers
from push_ros.diagnostics import ERROR, HAS_MAP, OK, WARN
from push_ros.node import RateLimiter

LEVELS = {TaskState.FAILED: ERROR, TaskState.PAUSED: WARN}


class TaskReporter:
    """Reports every change of state, and draws object, robot, plan and state."""

    def __init__(self, node, obj, robot, frame):
        """
        Begin with nothing said.

        :param node: the ``PushNode``.
        :param obj: the ``PushedObject`` as believed.
        :param robot: the ``RoundRobot``.
        :param frame: id of the world frame.
        """
        self._parts, self._frame, self._reporter = (obj, robot), frame, node.reporter
        self._markers, self._marker_rate = node.publisher('markers'), RateLimiter(2.0)
        self._history = ()
        self.repeat()

    def repeat(self):
        """Say the present state next time, changed or not."""
        self._said, self._rate = None, RateLimiter(1.0)

    def report(self, status, stamp, time):
        """
        Report every change of state, and what is waited for.

        :param status: ``SupervisorStatus``.
        :param stamp: of the measurement.
        :param time: of the newest measurement [s].
        """
        known, self._history = self._history, status.history
        goes_on = status.history[:len(known)] == known
        for change in status.history[len(known) if goes_on else 0:]:
            self._report(status, change, stamp, time, always=True)
        due = self._rate.due(time)
        if due or (status.state, status.reason) != self._said:
            self._report(status, StateChange(status.since, status.state, status.reason), stamp, time)

    def draw(self, status, observation, stamp):
        """
        Draw object, robot and state now and then, where somebody looks.

        :param status: ``SupervisorStatus``.
        :param observation: ``Observation``.
        :param stamp: of the measurement.
        """
        due = self._marker_rate.due(observation.time)
        if not due or observation.object_pose is None \
                or not self._markers.get_subscription_count():
            return
        pushes = status.state is TaskState.PUSH
        pose = status.push.object_pose if pushes else observation.object_pose.pose
        self._markers.publish(scene_markers(
            stamp, self._frame, 'controller', *self._parts, pose, status.robot_pose, GREY))
        self._markers.publish(text_markers(
            stamp, self._frame, 'controller', status.robot_pose,
            _sentence(status.state, status.reason)))

    def has_map(self, message):
        """
        Say that there is a map.

        :param message: ``nav_msgs/OccupancyGrid``.
        """
        self._reporter.report(OK, map_text(message), message.header.stamp, {HAS_MAP: True})

    def draw_plan(self, target, stamp):
        """
        Draw a plan.

        :param target: ``PushTrajectory``.
        :param stamp: of the plan.
        """
        self._markers.publish(plan_markers(stamp, self._frame, target))

    def _report(self, status, now, stamp, time, always=False):
        self._said = now.state, now.reason
        values = {'time': time, 'state': now.state.value, 'reason': now.reason, 'since': now.time,
                  'pushes': status.pushes, 'recoveries': status.recoveries,
                  'robot_pose': status.robot_pose and tuple(status.robot_pose)}
        values.update({f'push.{key}': value for key, value in status.push.values().items()})
        self._reporter.report(LEVELS.get(now.state, WARN if now.reason else OK),
                              f'task: {_sentence(now.state, now.reason)}', stamp, values, always)


def _sentence(state, reason):
    return f'{state.value}, {reason}' if reason else state.value
