"""ROS node of the planner."""

import sys

from push_model.geometry import distance, Pose
from push_model.parameters import PushedObject, RoundRobot
from push_navigation.settings import DriveSettings
from push_planner.problem import PlannerSettings, PlanningFailed
from push_planner.ros.sequence_planner import describe_task_plan, SequenceRequestHandler
from push_planner.settings import TaskSettings
from push_planner.single_push.replanning import plan_from_measurements
from push_ros import qos
from push_ros.conversions.measurements import from_object_pose_message, from_odometry_message
from push_ros.conversions.plan import no_plan_message, to_path_message, to_plan_message
from push_ros.conversions.primitives import MessageRefused, nanoseconds
from push_ros.diagnostics import ERROR, HAS_MAP, OK, WARN
from push_ros.executor import run
from push_ros.node import PushNode
from push_ros.node_settings import Frames
from push_ros.topics import PLANNER

SECTIONS = (('object.', PushedObject), ('robot.', RoundRobot), ('planner.', PlannerSettings),
            ('drive.', DriveSettings), ('task.', TaskSettings), ('', Frames))


class PlannerNode(PushNode):
    """
    Plans a push for every goal, or the first of a chain of pushes for every request.

    Subscribes ``odom``, ``object_pose``, ``goal_pose``, ``map``, ``push_request``; publishes
    ``push_plan`` and ``planned_path`` (latched), ``diagnostics``; serves ``planner/replan``.
    Everything is in ``world_frame``; the plan for a goal starts from the newest measurements and
    has their stamp. A goal that comes before them waits for them. While the robot pushes, a new
    goal and ``planner/replan`` are planned from the present motion, at the site where it pushes.
    A failed plan or a refused message leaves the former plan as it is, and is an error on
    ``diagnostics`` with its reason. With ``planner.site`` at ``best`` the plan of a robot at rest
    starts at the quickest site of the object; the diagnostics tell where the robot must stand for
    it, warn where it does not, and list all sites.

    A request is answered with its own stamp; where there is no plan, or the request is refused,
    by an empty one and an error. With ``planner.site`` at ``sequence`` a goal is not planned for,
    only ``planner/replan`` and requests are. Chains keep to the ``map``, if there is one.
    Parameters: ``object.*`` and ``robot.*`` as believed, ``planner.*``, ``drive.*``, ``task.*``,
    frames.
    """

    def __init__(self):
        super().__init__(PLANNER, SECTIONS)
        self._obj, self._robot, self._planner, drive, task, self._frames = self.settings
        self._chains = SequenceRequestHandler(self._obj, (self._robot, self._planner, drive, task),
                                              self._frames.world_frame)
        self._odometry = self._object_pose = self._goal = self._last_goal = self._former = None
        self._plan = self.publisher('push_plan')
        self._path = self.publisher('planned_path')
        self.subscribe('odom', self._on_odometry, qos=qos.NEWEST)
        self.subscribe('object_pose', self._on_object_pose, qos=qos.NEWEST)
        self.subscribe('goal_pose', self._on_goal)
        self.subscribe('map', self._on_map)
        self.subscribe('push_request', self._on_request)
        self.serve_trigger('planner/replan', self._replan)
        self._report(OK, 'waits for a goal')

    def _on_odometry(self, message):
        self._odometry = message
        self._try()

    def _on_object_pose(self, message):
        self._object_pose = message
        self._try()

    def _on_goal(self, message):
        try:
            self._goal = from_object_pose_message(message, self._frames.world_frame,
                                                  'goal_pose').pose
        except MessageRefused as error:
            self._report(ERROR, str(error))
            return
        if self._planner.site == 'sequence':
            self._last_goal, self._goal = self._goal, None
            self._report(OK, 'has a goal and waits for a request')
            return
        self._report(OK, 'plans')
        self._try()

    def _on_map(self, message):
        try:
            self._report(OK, self._chains.on_map(message), {HAS_MAP: True})
        except MessageRefused as error:
            self._report(ERROR, str(error))

    def _on_request(self, message):
        stamp = message.header.stamp
        try:
            self._publish_chain(self._chains.answer(message), stamp)
        except (MessageRefused, PlanningFailed) as failure:
            self._plan.publish(no_plan_message(stamp, self._frames.world_frame))
            self._report(ERROR, str(failure), _told(getattr(failure, 'report', {})))

    def _replan(self):
        if self._last_goal is None:
            return False, 'has not got a goal yet'
        if self._missing():
            return False, f'has not got {self._missing()} yet'
        self._goal = None
        return self._plan_to(self._last_goal)

    def _missing(self):
        return ' and '.join(name for name, message in (('odom', self._odometry),
                                                       ('object_pose', self._object_pose))
                            if message is None)

    def _try(self):
        if self._goal is None:
            return
        if self._missing():
            self._report(WARN, f'has a goal and waits for {self._missing()}')
            return
        goal, self._goal = self._goal, None
        self._last_goal = goal
        self._plan_to(goal)

    def _plan_to(self, goal):
        """Plan and publish; return whether there is a plan, and what was reported."""
        world = self._frames.world_frame
        try:
            odometry = from_odometry_message(self._odometry, world)
            measured = from_object_pose_message(self._object_pose, world)
            if self._planner.site == 'sequence':
                chain = self._chains.plan(measured.pose, odometry.pose, goal)
                return True, self._publish_chain(chain, self._stamp())
            choice = plan_from_measurements(self._obj, self._robot, measured, odometry, goal,
                                            self._planner, previous=self._former)
        except MessageRefused as error:
            return False, self._report(ERROR, str(error))
        except PlanningFailed as failure:
            return False, self._report(ERROR, failure.reason, _told(failure.report))
        self._former = choice.plan
        return True, self._publish(choice, odometry.pose)

    def _publish(self, choice, robot_pose):
        answer = choice.plan
        stamp, world = self._stamp(), self._frames.world_frame
        self._plan.publish(to_plan_message(answer.trajectory, stamp, world))
        self._path.publish(to_path_message(answer.trajectory.object_poses.tolist(), stamp, world))
        begin = Pose(*answer.trajectory.robot_poses[0].tolist())
        text = (f'has planned a push of {answer.trajectory.duration:.1f} s and '
                f'{answer.trajectory.path_length:.2f} m')
        away = distance(begin, robot_pose) > self._planner.contact_tolerance
        if away:
            text += f' for a robot at {begin.x:.3f} m, {begin.y:.3f} m, {begin.theta:.3f} rad'
        return self._report(WARN if away else OK, text, {
            **answer.report, 'robot_start': tuple(begin),
            'present_speed': answer.problem.motion.speed, **_told({'sites': choice.candidates})})

    def _publish_chain(self, chain, stamp):
        plan, path = self._chains.messages(chain, stamp)
        self._plan.publish(plan)
        self._path.publish(path)
        return self._report(OK, *describe_task_plan(chain))

    def _report(self, level, text, values=None):
        self.reporter.report(level, text, self._stamp(), values)
        return text

    def _stamp(self):
        stamps = [message.header.stamp for message in (self._odometry, self._object_pose)
                  if message is not None]
        return max(stamps, key=nanoseconds) if stamps else self.get_clock().now().to_msg()


def _told(report):
    """Give each site a line of its own."""
    sites = report.get('sites', ())
    return {**{key: value for key, value in report.items() if key != 'sites'},
            **{f'site {number}': site for number, site in enumerate(sites, 1)}}


def main(arguments=None):
    """
    Run the planner.

    :param arguments: command line; None for that of the process.
    :return: exit status.
    """
    return run(PlannerNode, arguments)


if __name__ == '__main__':
    sys.exit(main())
