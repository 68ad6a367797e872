"""A task: the controller's node brings the object to its goal, with as many pushes as it takes."""

from push_control.ros.task_report import TaskReporter
from push_control.task.status import TaskState
from push_control.task.supervisor import Supervisor
from push_ros.conversions.map import from_map_message
from push_ros.conversions.measurements import from_object_pose_message
from push_ros.conversions.plan import from_plan_message
from push_ros.conversions.plan_request import to_request_message
from push_ros.conversions.primitives import exact_stamp, MessageRefused, NANOSECONDS, nanoseconds

NO_PLAN = 'the planner has found none, and says why on diagnostics'
# A stamp farther ahead is of another clock [s].
LONGEST_AHEAD = 3600.0


class TaskMode:
    """
    What the controller's node does in a task; a ``Supervisor`` decides.

    A goal whose stamp is ahead of the measurements waits until then. ``awaits_plan``: whether a
    plan is wanted.
    """

    needs, awaited = 'goal_pose', 'a goal'

    def __init__(self, node, parts, frame, running):
        """
        Wait for a goal.

        :param node: the ``ControllerNode``.
        :param parts: what a ``Supervisor`` is made of: ``PushedObject``, ``RoundRobot``,
            ``ControlSettings``, ``DriveSettings``, ``SupervisionSettings``.
        :param frame: id of the world frame.
        :param running: whether to begin as soon as a goal comes.
        """
        self._parts, self._frame = parts, frame
        self._running, self._workspace = running, None
        self._requests = node.requests
        self._report = TaskReporter(node, *parts[:2], frame)
        self.forget()

    @property
    def is_set(self):
        """Whether there is a goal."""
        return self._goal is not None

    @property
    def is_active(self):
        """Whether it is at a task."""
        return self._running and self.is_set

    @property
    def awaits_plan(self):
        """Whether a plan is wanted."""
        return self._supervisor.plan_request is not None

    def repeat(self):
        """Say at the next measurement what it does, changed or not."""
        self._report.repeat()

    def forget(self):
        """Begin anew."""
        self._supervisor = Supervisor(*self._parts)
        self._supervisor.set_map(self._workspace)
        self._goal = self._asked = self._observation = None
        self._later, self._request_stamp = [], 0
        self.repeat()

    def on_goal(self, message):
        """
        Take a goal, or keep it until its time has come.

        :param message: ``geometry_msgs/PoseStamped``.
        :raises MessageRefused: where it cannot be used; the former one stays.
        """
        goal = from_object_pose_message(message, self._frame, 'goal_pose')
        now = self._observation.time if self._observation is not None else 0.0
        if 0.0 < goal.time - now <= LONGEST_AHEAD:
            self._later = sorted([*self._later, goal])
        else:
            self._set_goal(goal.pose)

    def on_map(self, message):
        """
        Take a map, for the next way.

        :param message: ``nav_msgs/OccupancyGrid``.
        :raises MessageRefused: where it cannot be used; the former one stays.
        """
        self._workspace = from_map_message(message, self._frame)
        self._supervisor.set_map(self._workspace)
        self._report.has_map(message)

    def on_plan(self, message):
        """
        Take the plan that was asked for; one that was not is ignored.

        :param message: ``trajectory_msgs/MultiDOFJointTrajectory``.
        :raises MessageRefused: where it cannot be used; another one is asked for.
        """
        stamp = message.header.stamp
        if not self.awaits_plan or nanoseconds(stamp) != self._request_stamp:
            return
        if not message.points:
            self._supervisor.on_planning_failed(NO_PLAN)
            return
        try:
            target = from_plan_message(message, self._frame)
        except MessageRefused as error:
            self._supervisor.on_planning_failed(str(error))
            raise
        self._supervisor.take(target)
        self._report.draw_plan(target, stamp)

    def start(self):
        """Begin the task, anew where it was begun before."""
        self._running = True
        self._supervisor.set_goal(self._goal)
        self._supervisor.resume()

    def stop(self):
        """Give up the task; another start begins it anew."""
        self._running = False
        self._supervisor.stop('was stopped')

    def pause(self):
        """Stand until told to go on; return (success, sentence)."""
        state = self._supervisor.status.state
        if state.is_standing:
            return False, f'does not move: is {state.value}'
        self._supervisor.pause()
        return True, 'paused'

    def resume(self):
        """Go on after a pause; return (success, sentence)."""
        state = self._supervisor.status.state
        if state is not TaskState.PAUSED:
            return False, f'is not paused: is {state.value}'
        self._supervisor.resume()
        return True, 'goes on'

    def step(self, observation, dt):
        """
        Answer a measurement, and ask for a plan where one is wanted.

        :param observation: ``Observation``.
        :param dt: time since the last one [s].
        :return: ``Twist``.
        """
        self._observation = observation
        while self._later and self._later[0].time <= observation.time:
            self._set_goal(self._later.pop(0).pose)
        command = self._supervisor.step(observation, dt)
        wanted = self._supervisor.plan_request
        if wanted is not self._asked and wanted is not None:
            # Of its own, so that answers can be told apart.
            newest = round(observation.time * NANOSECONDS)
            self._request_stamp = max(newest, self._request_stamp + 1)
            self._requests.publish(to_request_message(
                wanted, exact_stamp(self._request_stamp), self._frame))
        self._asked = wanted
        return command

    def report(self, stamp, time):
        """
        Report what has changed, and draw now and then.

        :param stamp: of the measurement.
        :param time: of the newest measurement [s].
        """
        self._report.report(self._supervisor.status, stamp, time)
        if self._observation is not None:
            self._report.draw(self._supervisor.status, self._observation, stamp)

    def _set_goal(self, pose):
        self._goal = pose
        if self._running:
            self._supervisor.set_goal(pose)
