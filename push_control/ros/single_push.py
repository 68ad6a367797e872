"""One push: the controller's node follows the plan that there is."""

from push_control.push.controller import Controller
from push_control.push.status import Phase
from push_model.signals import STOP
from push_ros.conversions.markers import GREY, plan_markers, scene_markers
from push_ros.conversions.plan import from_plan_message
from push_ros.conversions.primitives import MessageRefused
from push_ros.diagnostics import ERROR, OK, WARN
from push_ros.node import RateLimiter

LEVELS = {Phase.WAITING: WARN, Phase.FAILED: ERROR}


class SinglePushMode:
    """
    What the controller's node does with one plan at a time.

    ``awaits_plan``: never, a plan is taken when it comes.
    """

    needs, awaited, awaits_plan = 'push_plan', 'a plan', False

    def __init__(self, node, parts, frame, running):
        """
        Wait for a plan.

        :param node: the ``PushNode``.
        :param parts: ``PushedObject`` as believed, ``RoundRobot``, ``ControlSettings``; what comes
            behind is for tasks.
        :param frame: id of the world frame.
        :param running: whether to follow a plan as soon as it comes.
        """
        self._parts, self._frame, self._reporter = parts[:2], frame, node.reporter
        self._controller = Controller(*parts[:3])
        self._running, self._target = running, None
        self._markers, self._marker_rate = node.publisher('markers'), RateLimiter(2.0)
        self._replan = node.trigger_client('planner/replan')
        self._robot_pose, self._said, self._report_rate = None, None, RateLimiter(1.0)

    @property
    def is_set(self):
        """Whether there is a plan."""
        return self._target is not None

    @property
    def is_active(self):
        """Whether it follows a plan."""
        return self._running and self.is_set

    def repeat(self):
        """Say at the next measurement what it does, changed or not."""
        self._said = None

    def forget(self):
        """Begin anew."""
        self._controller.reset()
        self._target = self._robot_pose = self._said = None
        self._report_rate = RateLimiter(1.0)

    def on_plan(self, message):
        """
        Take a plan.

        :param message: ``trajectory_msgs/MultiDOFJointTrajectory``.
        :raises MessageRefused: where it cannot be used; there is none then.
        """
        self._said = None
        try:
            self._target = from_plan_message(message, self._frame)
        except MessageRefused:
            self._target = None
            self._controller.reset()
            raise
        stamp = message.header.stamp
        self._markers.publish(plan_markers(stamp, self._frame, self._target))
        self._reporter.report(OK, 'has a plan' + ('' if self._running else
                                                  ' and waits for controller/start'), stamp)

    def on_goal(self, _):
        """Leave a goal to the planner."""

    def on_map(self, _):
        """Leave obstacles to whoever gives the goal."""

    def start(self):
        """Begin to push."""
        self._controller.reset()
        self._running, self._said = True, None

    def stop(self):
        """Stay stopped."""
        self._running, self._said = False, None
        self._controller.reset()

    def pause(self):
        """Tell that only a task can be paused, as (success, sentence)."""
        return False, 'is not at a task: the parameter task is false'

    resume = pause

    def step(self, observation, dt):
        """
        Answer a measurement.

        :param observation: ``Observation``.
        :param dt: time since the last one [s].
        :return: ``Twist``.
        """
        self._robot_pose = observation.odometry.pose
        return self._controller.step(self._target, observation, dt) if self.is_active else STOP

    def report(self, stamp, time):
        """
        Report what has changed, and draw now and then.

        :param stamp: of the measurement.
        :param time: of the newest measurement [s].
        """
        status = self._controller.status
        changed = (status.phase, status.reason) != self._said
        due = self._report_rate.due(time)
        if changed or due:
            self._said = status.phase, status.reason
            if changed and status.replan_requested:
                self._replan()
            text = status.reason or f'is {status.phase.value}'
            level = LEVELS.get(status.phase, OK if status.event is None else WARN)
            self._reporter.report(level, text, stamp, {'time': time, **status.values()})
        if self._marker_rate.due(time) and self._markers.get_subscription_count():
            self._draw(status, stamp)

    def _draw(self, status, stamp):
        if self._robot_pose is not None and status.phase in (Phase.PUSHING, Phase.WAITING):
            self._markers.publish(scene_markers(
                stamp, self._frame, 'controller', *self._parts, status.object_pose,
                self._robot_pose, GREY))
