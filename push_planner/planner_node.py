"""ROS node of the planner."""

import sys
from typing import Any, Mapping, Sequence

from builtin_interfaces.msg import Time
from push_model.geometry import distance, Pose
from push_model.parameters import PushedObject, RoundRobot
from push_model.plan_request import PlanFailure
from push_navigation.settings import DriveSettings
from push_planner.plan import Plan
from push_planner.problem import PlannerSettings, PlanningFailed
from push_planner.ros.sequence_planner import (
    describe_task_plan, PlannerParameters, SequenceRequestHandler,
)
from push_planner.sequence.planner import TaskPlan
from push_planner.settings import TaskSettings
from push_planner.single_push.replanning import plan_from_measurements
from push_planner.single_push.site_selection import SiteChoice
from push_ros import qos
from push_ros.conversions.map import map_text
from push_ros.conversions.measurements import from_object_pose_message, from_odometry_message
from push_ros.conversions.plan import no_plan_message, to_path_message, to_plan_message
from push_ros.conversions.primitives import MessageRefused, nanoseconds
from push_ros.diagnostics import ERROR, FAILURE, HAS_MAP, OK, WARN
from push_ros.executor import run
from push_ros.node import PushNode, ServiceAnswer
from push_ros.node_settings import Frames
from push_ros.topics import PLANNER

SECTIONS = (('object.', PushedObject), ('robot.', RoundRobot), ('planner.', PlannerSettings),
            ('drive.', DriveSettings), ('task.', TaskSettings), ('', Frames))


class MeasurementMessages:
    """
    Newest messages of what a plan starts from; they are converted when a plan is made.

    ``odometry``: ``nav_msgs/Odometry``. ``object_pose``: ``geometry_msgs/PoseStamped``. None
    before the first.
    """

    def __init__(self) -> None:
        self.odometry: Any = None
        self.object_pose: Any = None

    @property
    def missing(self) -> Sequence[str]:
        """Topics on which nothing has come yet."""
        received = {'odom': self.odometry, 'object_pose': self.object_pose}
        return [topic for topic, message in received.items() if message is None]

    @property
    def stamp(self) -> Time | None:
        """Stamp of the newest of them; None before the first."""
        stamps = [message.header.stamp for message in (self.odometry, self.object_pose)
                  if message is not None]
        return max(stamps, key=nanoseconds) if stamps else None


class PlannerNode(PushNode):
    """
    Plans a push for every goal, or the first of a sequence of pushes for every request.

    The plan for a goal starts from the newest measurements and has their stamp; a goal that comes
    before them waits for them. While the robot pushes, a new goal and ``planner/replan`` are
    planned from the present motion, at the site where it pushes. A failed plan or a refused
    message leaves the former plan as it is, and is an error on ``diagnostics`` with its reason.
    With ``planner.site`` at ``best`` the plan of a robot at rest starts at the quickest site of
    the object; the diagnostics say where the robot must stand for it, warn where it does not, and
    list all sites.

    A request is answered by a plan with its own stamp; where there is none, or the request is
    refused, by one without points whose only joint name is the code of the reason. With
    ``planner.site`` at ``sequence`` a goal is not planned for, only ``planner/replan`` and
    requests are. Sequences keep clear of the obstacles of the ``map``, if there is one.

    Publishers
        ``push_plan`` (MultiDOFJointTrajectory, latched); ``planned_path`` (Path, latched);
        ``diagnostics`` (DiagnosticArray).

    Subscribers
        ``odom`` (Odometry) and ``object_pose`` (PoseStamped), best effort; ``goal_pose``
        (PoseStamped); ``map`` (OccupancyGrid, latched); ``push_request`` (JointTrajectory,
        latched).

    Services
        ``planner/replan`` (Trigger).

    ROS parameters
        ``object.*`` and ``robot.*``, nominal; ``planner.*``; ``drive.*`` and ``task.*`` of
        sequences; ``world_frame``, ``object_frame``, ``base_frame``.

    Frames
        Everything is in ``world_frame``.
    """

    def __init__(self) -> None:
        super().__init__(PLANNER, SECTIONS)
        *sections, frames = self.settings
        self._sections = PlannerParameters(*sections)
        self._world_frame: str = frames.world_frame
        self._sequences = SequenceRequestHandler(self._sections, self._world_frame)
        self._latest = MeasurementMessages()
        # A goal that waits for measurements; the last one that was planned for.
        self._goal: Pose | None = None
        self._last_goal: Pose | None = None
        self._former_plan: Plan | None = None
        self._plans = self.publisher('push_plan')
        self._paths = self.publisher('planned_path')
        self.subscribe('odom', self._on_odometry, qos=qos.NEWEST)
        self.subscribe('object_pose', self._on_object_pose, qos=qos.NEWEST)
        self.subscribe('goal_pose', self._on_goal)
        self.subscribe('map', self._on_map)
        self.subscribe('push_request', self._on_request)
        self.serve_trigger('planner/replan', self._replan)
        self._report(OK, 'waits for a goal')

    def _on_odometry(self, message: Any) -> None:
        self._latest.odometry = message
        self._plan_when_measured()

    def _on_object_pose(self, message: Any) -> None:
        self._latest.object_pose = message
        self._plan_when_measured()

    def _on_goal(self, message: Any) -> None:
        try:
            goal = from_object_pose_message(message, self._world_frame, 'goal_pose').pose
        except MessageRefused as error:
            self._report(ERROR, str(error))
            return
        if self._sections.planner.site == 'sequence':
            self._last_goal = goal
            self._report(OK, 'has a goal and waits for a request')
            return
        self._goal = goal
        self._report(OK, 'plans')
        self._plan_when_measured()

    def _on_map(self, message: Any) -> None:
        try:
            self._sequences.on_map(message)
        except MessageRefused as error:
            self._report(ERROR, str(error))
        else:
            self._report(OK, map_text(message), {HAS_MAP: True})

    def _on_request(self, message: Any) -> None:
        stamp = message.header.stamp
        try:
            self._publish_sequence(self._sequences.answer(message), stamp)
        except MessageRefused as error:
            self._refuse(PlanFailure.INVALID_REQUEST, stamp)
            self._report(ERROR, str(error), {FAILURE: PlanFailure.INVALID_REQUEST.name})
        except PlanningFailed as failure:
            self._refuse(failure.code, stamp)
            self._report_failure(failure)

    def _refuse(self, code: PlanFailure, stamp: Time) -> None:
        self._plans.publish(no_plan_message(code, stamp, self._world_frame))

    def _replan(self) -> ServiceAnswer:
        if self._last_goal is None:
            return ServiceAnswer(False, 'has received no goal yet')
        if self._latest.missing:
            return ServiceAnswer(False, f'has received no {" and no ".join(self._latest.missing)}'
                                        ' yet')
        self._goal = None
        return self._plan_to(self._last_goal)

    def _plan_when_measured(self) -> None:
        if self._goal is None:
            return
        if self._latest.missing:
            self._report(WARN, f'has a goal and waits for {" and ".join(self._latest.missing)}')
            return
        self._last_goal = self._goal
        self._goal = None
        self._plan_to(self._last_goal)

    def _plan_to(self, goal: Pose) -> ServiceAnswer:
        """Plan and publish; return whether there is a plan, and what was reported."""
        parameters, stamp = self._sections, self._stamp()
        try:
            odometry = from_odometry_message(self._latest.odometry, self._world_frame)
            measured = from_object_pose_message(self._latest.object_pose, self._world_frame)
            if parameters.planner.site == 'sequence':
                task_plan = self._sequences.plan(measured.pose, odometry.pose, goal)
                return ServiceAnswer(True, self._publish_sequence(task_plan, stamp))
            choice = plan_from_measurements(parameters.object, parameters.robot, measured,
                                            odometry, goal, parameters.planner,
                                            previous=self._former_plan)
        except MessageRefused as error:
            return ServiceAnswer(False, self._report(ERROR, str(error)))
        except PlanningFailed as failure:
            return ServiceAnswer(False, self._report_failure(failure))
        self._former_plan = choice.plan
        return ServiceAnswer(True, self._publish(choice, odometry.pose, stamp))

    def _publish(self, choice: SiteChoice, robot_pose: Pose, stamp: Time) -> str:
        plan, trajectory = choice.plan, choice.plan.trajectory
        self._plans.publish(to_plan_message(trajectory, stamp, self._world_frame))
        self._paths.publish(to_path_message(trajectory.object_poses.tolist(), stamp,
                                            self._world_frame))
        start = Pose(*trajectory.robot_poses[0].tolist())
        text = (f'has planned a push of {trajectory.duration:.1f} s and '
                f'{trajectory.path_length:.2f} m')
        level = OK
        if distance(start, robot_pose) > self._sections.planner.contact_tolerance:
            level = WARN
            text += f' for a robot at {start.x:.3f} m, {start.y:.3f} m, {start.theta:.3f} rad'
        return self._report(level, text, {
            **plan.report, 'robot_start': tuple(start),
            'present_speed': plan.problem.motion.speed, **_one_line_per_site(choice.candidates)})

    def _publish_sequence(self, task_plan: TaskPlan, stamp: Time) -> str:
        messages = self._sequences.messages(task_plan, stamp)
        self._plans.publish(messages.plan)
        self._paths.publish(messages.path)
        return self._report(OK, *describe_task_plan(task_plan))

    def _report(self, level: bytes, text: str, values: Mapping[str, Any] | None = None) -> str:
        """Report, and return the text."""
        self.reporter.report(level, text, self._stamp(), values)
        return text

    def _report_failure(self, failure: PlanningFailed) -> str:
        values = dict(failure.report)
        sites = values.pop('sites', ())
        return self._report(ERROR, failure.reason, {
            FAILURE: failure.code.name, **values, **_one_line_per_site(sites)})

    def _stamp(self) -> Time:
        """Stamp of the newest measurement; the time before the first."""
        stamp = self._latest.stamp
        return self.get_clock().now().to_msg() if stamp is None else stamp


def _one_line_per_site(sites: Sequence[Any]) -> Mapping[str, Any]:
    return {f'site {number}': site for number, site in enumerate(sites, 1)}


def main(arguments: Sequence[str] | None = None) -> int:
    """
    Run the planner.

    :param arguments: command line; None for that of the process.
    :return: exit status.
    """
    return run(PlannerNode, arguments)


if __name__ == '__main__':
    sys.exit(main())
