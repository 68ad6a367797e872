"""Task: the controller's node pushes repeatedly until the object is at its goal."""

from pathlib import Path
import time
from typing import Any

from push_control.observation import Observation
from push_control.ros.knowledge import KnowledgeFile, KnowledgeMemory
from push_control.ros.measurements import CovarianceCheck
from push_control.ros.mode import ControllerParameters, Mode
from push_control.ros.task_report import TaskReporter
from push_control.task.status import TaskState
from push_control.task.supervisor import Supervisor
from push_model.geometry import Pose
from push_model.plan_request import PlanFailure, PlanRequest
from push_model.signals import ObjectPose, Twist
from push_navigation.occupancy_map import OccupancyMap
from push_ros.conversions.map import from_map_message
from push_ros.conversions.measurements import from_object_pose_message
from push_ros.conversions.plan import from_plan_message, plan_failure
from push_ros.conversions.plan_request import to_request_message
from push_ros.conversions.primitives import exact_stamp, MessageRefused, NANOSECONDS, nanoseconds
from push_ros.node import PushNode, ServiceAnswer
from push_ros.node_settings import ControllerOptions

# A stamp farther ahead is of another clock [s]; chosen: longer than any task.
LONGEST_AHEAD = 3600.0


class PlanRequester:
    """
    Publishes plan requests, each with a stamp of its own, and recognizes their answers.

    :param publisher: of ``push_request``.
    :param frame: id of the world frame.
    """

    def __init__(self, publisher: Any, frame: str) -> None:
        self._publisher = publisher
        self._frame = frame
        self.reset()

    def reset(self) -> None:
        """Forget the request."""
        self._request: PlanRequest | None = None
        self._stamp = 0

    def update(self, request: PlanRequest | None, time: float) -> None:
        """
        Publish a request that is new.

        :param request: the present ``PlanRequest``, or None.
        :param time: of the newest measurement [s].
        """
        if request is not None and request is not self._request:
            self._stamp = max(round(time * NANOSECONDS), self._stamp + 1)
            self._publisher.publish(to_request_message(request, exact_stamp(self._stamp),
                                                       self._frame))
        self._request = request

    def is_answered_by(self, message: Any) -> bool:
        """
        Tell whether a plan answers the last request.

        :param message: message with a header.
        """
        return nanoseconds(message.header.stamp) == self._stamp


class GoalSchedule:
    """Goals whose stamps are ahead of the measurements; they hold from that time on."""

    def __init__(self) -> None:
        self._goals: list[ObjectPose] = []

    def add(self, goal: ObjectPose, now: float) -> bool:
        """
        Keep a goal until its time has come.

        :param goal: ``ObjectPose``, with the time from which on it holds.
        :param now: time of the newest measurement [s].
        :return: whether it is kept; else it holds now.
        """
        is_ahead = 0.0 < goal.time - now <= LONGEST_AHEAD
        if is_ahead:
            self._goals = sorted([*self._goals, goal])
        return is_ahead

    def take_due(self, now: float) -> list[Pose]:
        """
        Take the goals whose time has come.

        :param now: time of the newest measurement [s].
        :return: goal poses, the oldest first.
        """
        due = [goal.pose for goal in self._goals if goal.time <= now]
        self._goals = self._goals[len(due):]
        return due


class TaskMode(Mode):
    """Lets a ``Supervisor`` bring the object to its goal, with as many pushes as it takes."""

    required_topic = 'goal_pose'
    awaited = 'a goal'
    stops_on_refused_plan = False
    reports_events = True

    def __init__(self, node: PushNode, parameters: ControllerParameters, frame: str,
                 options: ControllerOptions) -> None:
        """
        Wait for a goal.

        :param node: the ``PushNode``.
        :param parameters: ``ControllerParameters``.
        :param frame: id of the world frame.
        :param options: ``ControllerOptions``.
        :raises ValueError: where ``knowledge_file`` cannot be read.
        """
        self._parameters = parameters
        self._frame = frame
        self._is_started = not options.wait_for_start
        file = KnowledgeFile(Path(options.knowledge_file)) if options.knowledge_file else None
        self._memory = KnowledgeMemory(parameters.object, parameters.supervision, file, time.time)
        self._covariance_check = CovarianceCheck(parameters.supervision)
        self._occupancy_map: OccupancyMap | None = None
        self._requester = PlanRequester(node.publisher('push_request'), frame)
        self._reporter = TaskReporter(node, parameters.object, parameters.robot, frame)
        self.reset()

    @property
    def is_set(self) -> bool:
        """Whether there is a goal."""
        return self._goal is not None

    @property
    def is_active(self) -> bool:
        """Whether a task is under way."""
        return self._is_started and self.is_set

    @property
    def awaits_plan(self) -> bool:
        """Whether a plan was requested and has not come yet."""
        return self._supervisor.plan_request is not None

    def reset(self) -> None:
        """Forget everything but the map and what was learned of the object."""
        self._supervisor = Supervisor(*self._parameters, knowledge=self._memory.recall())
        self._supervisor.set_map(self._occupancy_map)
        self._goal: Pose | None = None
        self._later_goals = GoalSchedule()
        self._observation: Observation | None = None
        self._requester.reset()
        self.report_again()

    def on_goal(self, message: Any) -> None:
        """
        Set a goal, or keep it until its time has come.

        :param message: ``geometry_msgs/PoseStamped``.
        :raises MessageRefused: where it cannot be used; the former one stays.
        """
        goal = from_object_pose_message(message, self._frame, 'goal_pose')
        now = 0.0 if self._observation is None else self._observation.time
        if not self._later_goals.add(goal, now):
            self._set_goal(goal.pose)

    def on_map(self, message: Any) -> None:
        """
        Set the map for the next path.

        :param message: ``nav_msgs/OccupancyGrid``.
        :raises MessageRefused: where it cannot be used; the former one stays.
        """
        self._occupancy_map = from_map_message(message, self._frame)
        self._supervisor.set_map(self._occupancy_map)
        self._reporter.report_map(message)

    def on_plan(self, message: Any) -> None:
        """
        Set the plan that was requested; one that was not is ignored.

        :param message: ``trajectory_msgs/MultiDOFJointTrajectory``.
        :raises MessageRefused: where it cannot be used; another one is requested.
        """
        if not self.awaits_plan or not self._requester.is_answered_by(message):
            return
        failure = plan_failure(message)
        if failure is not None:
            self._supervisor.on_planning_failed(
                failure, f'{failure.value} (details in the diagnostics of the planner)')
            return
        try:
            plan = from_plan_message(message, self._frame)
        except MessageRefused as error:
            self._supervisor.on_planning_failed(PlanFailure.INVALID_PLAN, str(error))
            raise
        self._supervisor.set_plan(plan)
        self._reporter.draw_plan(plan, message.header.stamp)

    def start(self) -> None:
        """Start the task; over again where it was started before."""
        self._is_started = True
        self._supervisor.set_goal(self._goal)
        self._supervisor.resume()

    def stop(self) -> None:
        """Abandon the task, until ``start`` starts it over."""
        self._is_started = False
        self._supervisor.stop('stopped')

    def pause(self) -> ServiceAnswer:
        """Stand until ``resume``."""
        state = self._supervisor.status.state
        if state.is_standing:
            return ServiceAnswer(False, f'nothing to pause: the task is {state.value}')
        self._supervisor.pause()
        return ServiceAnswer(True, 'paused')

    def resume(self) -> ServiceAnswer:
        """Go on after a pause."""
        state = self._supervisor.status.state
        if state is not TaskState.PAUSED:
            return ServiceAnswer(False, f'nothing to resume: the task is {state.value}')
        self._supervisor.resume()
        return ServiceAnswer(True, 'resumed')

    def step(self, observation: Observation, dt: float) -> Twist:
        """
        Answer a measurement, and request a plan where the supervisor needs one.

        :param observation: ``Observation``.
        :param dt: time since the last one [s].
        :return: ``Twist``.
        """
        self._observation = observation
        for goal in self._later_goals.take_due(observation.time):
            self._set_goal(goal)
        command = self._supervisor.step(observation, dt)
        self._requester.update(self._supervisor.plan_request, observation.time)
        if self._memory.is_due(self._supervisor.status.state):
            self._reporter.warn(self._memory.keep(self._supervisor.knowledge), observation)
        self._reporter.warn(self._covariance_check.update(observation.odometry), observation)
        return command

    def report(self, stamp: Any, time: float) -> None:
        """
        Report what has changed, and draw markers now and then.

        :param stamp: ``builtin_interfaces/Time`` of the measurement.
        :param time: of the newest measurement [s].
        """
        status = self._supervisor.status
        self._reporter.report(status, stamp, time)
        if self._observation is not None:
            self._reporter.draw(status, self._observation, stamp)

    def report_again(self) -> None:
        """Report at the next measurement, changed or not."""
        self._reporter.report_again()

    def _set_goal(self, pose: Pose) -> None:
        self._goal = pose
        if self._is_started:
            self._supervisor.set_goal(pose)
