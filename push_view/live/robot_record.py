"""What is measured and reported of a robot, as messages of the page."""

from collections.abc import Sequence
import math

from push_control.perception.view import UNSEEN_TIME, View
from push_control.task.status import StateChange, TaskState
from push_model.base_knowledge import BaseKnowledge
from push_model.geometry import Pose
from push_model.parameters import PushedObject, RoundRobot
from push_model.plan_request import PlanFailure
from push_model.signals import ObjectPose, Odometry
from push_model.trajectory import PushTrajectory
from push_navigation.occupancy_map import OccupancyMap
from push_planner.refusal_marks import RefusalMarks
from push_view.live.measured_contact import MeasuredContact
from push_view.messages import (
    base_message, goal_message, later_push, map_message, push_message, refusal_message,
    rows_message, scene_message, state_message, view_message,
)
from push_view.server.message_log import MessageLog

COLUMNS = ('time', 'object_x', 'object_y', 'object_theta', 'robot_x', 'robot_y', 'robot_theta',
           'robot_v_x', 'robot_v_y', 'robot_omega', 'force_n', 'force_t', 'contact_x', 'contact_y',
           'normal', 'gap', 'object_seen')
# Least time between two rows [s]; chosen: what a screen needs.
ROW_PERIOD = 0.04
# Time by which stamps must go back for a new run [s]; chosen: more than messages are out of order.
RESTART_TIME = 1.0


class RobotRecorder:
    """
    Turns measurements of a robot into rows, and the rest into events; time starts with them.

    :param log: where the messages go.
    :param title: of the page.
    :param obj: the nominal ``PushedObject``.
    :param robot: the ``RoundRobot``.
    """

    def __init__(self, log: MessageLog, title: str, obj: PushedObject,
                 robot: RoundRobot) -> None:
        self._log = log
        self._scene = scene_message(
            title, obj, robot, COLUMNS,
            description='A robot as it is measured and as it reports itself.')
        self._contact = MeasuredContact(obj, robot)
        self._robot = robot
        self._object_pose: Pose | None = None
        # When the object was last seen, and the view that explains why it is not.
        self._seen_at = -math.inf
        self._view: View | None = None
        self._goal: Pose | None = None
        self._map: OccupancyMap | None = None
        # The newest plan and path, each with the stamp of its request [s].
        self._plan: tuple[float, PushTrajectory] | None = None
        self._planned_path: tuple[float, tuple[Pose, ...]] = -math.inf, ()
        self._start_time: float | None = None
        self._time = -math.inf
        self._start()

    @property
    def time(self) -> float:
        """Time of the last row since the first measurement [s]; 0 before."""
        return max(0.0, self._time)

    def on_odometry(self, odometry: Odometry) -> None:
        """Add a row, where the last one is old enough."""
        if self._start_time is None:
            self._start_time = odometry.time
        time = odometry.time - self._start_time
        if time < self._time - RESTART_TIME:
            self._start_time, time = odometry.time, 0.0
            self._start()
        if time < self._time + ROW_PERIOD:
            return
        self._time = time
        unknown = (math.nan,) * 3
        self._log.add(rows_message([(
            time, *(unknown if self._object_pose is None else self._object_pose), *odometry.pose,
            *odometry.twist, *self._contact.values(time, self._object_pose, odometry.pose),
            float(self._is_seen(odometry.time)))]))

    def on_contact_force(self, force: tuple[float, float]) -> None:
        """
        Take note of the force of the robot on the object, which the next row shows.

        :param force: (f_x, f_y), axes of the object frame [N].
        """
        self._contact.on_force(self.time, force)

    def move_goal(self, correction: Pose) -> None:
        """
        Move the goal with the frame that it was given in.

        :param correction: ``Pose`` that takes the former goal to the new one.
        """
        if self._goal is not None:
            self.on_goal(correction @ self._goal)

    def move_map(self, correction: Pose) -> None:
        """
        Move the map with its frame.

        :param correction: ``Pose`` that takes its former origin to the new one.
        """
        if self._map is not None:
            self.on_map(self._map.moved(correction))

    def on_object_pose(self, measured: ObjectPose) -> None:
        """Take note of where the object is."""
        self._object_pose = measured.pose
        self._seen_at = measured.time

    def on_goal(self, pose: Pose) -> None:
        """
        Show a goal.

        :param pose: goal ``Pose`` of the object.
        """
        self._goal = pose
        self._log.add(goal_message(self.time, pose))

    def on_plan(self, trajectory: PushTrajectory, stamp: float) -> None:
        """
        Show a plan.

        :param stamp: of its request, which its path has too [s].
        """
        self._plan = stamp, trajectory
        self._show_plan()

    def on_planned_path(self, poses: Sequence[Pose], stamp: float) -> None:
        """
        Show where the object comes to stand after later pushes.

        :param poses: of the object, along the push of the plan and after each later one.
        :param stamp: of the request [s].
        """
        self._planned_path = stamp, tuple(poses)
        if self._plan is not None and self._plan[0] == stamp:
            self._show_plan()

    def _show_plan(self) -> None:
        """Show the plan, with its later pushes where they are known already."""
        if self._plan is None:
            return
        (stamp, trajectory), (path_stamp, poses) = self._plan, self._planned_path
        later = poses[len(trajectory.times):] if path_stamp == stamp else ()
        self._log.add({**push_message(self.time, trajectory),
                       'later': [later_push(pose) for pose in later]})

    def on_refusal(self, code: PlanFailure, text: str, marks: RefusalMarks) -> None:
        """
        Show why there is no plan, unless it is shown.

        :param text: why, one sentence.
        """
        if (code, text) != self._refusal:
            self._refusal = code, text
            self._log.add(refusal_message(self.time, code, text, marks))

    def forget_refusal(self) -> None:
        """Take note that the planner has found a plan, or waits for a request."""
        self._refusal = None

    def on_map(self, occupancy_map: OccupancyMap) -> None:
        """Show a map."""
        self._map = occupancy_map
        self._log.add(map_message(self.time, occupancy_map))

    def on_state(self, state: TaskState, reason: str) -> None:
        """
        Show a state, unless it is shown.

        :param reason: why, one sentence; empty where all goes as it should.
        """
        if (state, reason) != self._state:
            self._state = state, reason
            self._log.add(state_message(StateChange(self.time, state, reason)))

    def on_view(self, view: View) -> None:
        """Show from where the object is seen, unless that is shown."""
        if view != self._view:
            self._view = view
            self._log.add(view_message(view, self._robot))

    def on_base(self, base: BaseKnowledge) -> None:
        """Show what the controller knows of the base, unless it is shown."""
        if base != self._base:
            self._base = base
            self._log.add(base_message(self.time, base))

    def _is_seen(self, time: float) -> bool:
        """Tell whether poses come, or nothing is stated of when they do not."""
        return self._view is None or time - self._seen_at < UNSEEN_TIME

    def _start(self) -> None:
        """Show a new run, with what still holds of the former one."""
        self._time = -math.inf
        self._base: BaseKnowledge | None = None
        self._state: tuple[TaskState, str] | None = None
        self._refusal: tuple[PlanFailure, str] | None = None
        self._log.clear()
        self._log.add(self._scene)
        if self._view is not None:
            self._log.add(view_message(self._view, self._robot))
        if self._map is not None:
            self._log.add(map_message(0.0, self._map))
        if self._goal is not None:
            self._log.add(goal_message(0.0, self._goal))
