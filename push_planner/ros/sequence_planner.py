"""Chains of pushes: the planner's node asks for them here, and says here what came of it."""

from push_model.plan_request import PlanRequest
from push_planner.sequence.planner import plan_for_request
from push_planner.sequence.steps import sequence_poses
from push_ros.conversions.map import from_map_message, map_text
from push_ros.conversions.plan import to_path_message, to_plan_message
from push_ros.conversions.plan_request import from_request_message

PATH_SPACING = 0.05


class SequenceRequestHandler:
    """Plans chains of pushes, in a map where there is one."""

    def __init__(self, obj, parts, frame):
        """
        Begin on open floor.

        :param obj: the ``PushedObject`` as believed.
        :param parts: ``RoundRobot``, ``PlannerSettings``, ``DriveSettings``, ``TaskSettings``.
        :param frame: id of the world frame.
        """
        self._obj, self._parts, self._frame, self._workspace = obj, parts, frame, None

    def on_map(self, message):
        """
        Take a map; return what to say of it.

        :param message: ``nav_msgs/OccupancyGrid``.
        :raises MessageRefused: where it cannot be used; the former one stays.
        """
        self._workspace = from_map_message(message, self._frame)
        return map_text(message)

    def answer(self, message):
        """
        Plan what is asked for.

        :param message: ``trajectory_msgs/JointTrajectory``.
        :return: ``push_planner.sequence.planner.TaskPlan``.
        :raises MessageRefused: where the request cannot be used.
        :raises PlanningFailed: with the reason.
        """
        return self._plan(from_request_message(message, self._frame, self._obj))

    def plan(self, object_pose, robot_pose, goal):
        """
        Plan from poses, the object as believed.

        :param object_pose: ``Pose`` of the object in the world.
        :param robot_pose: ``Pose`` of the robot in the world.
        :param goal: ``Pose`` wanted for the object.
        :return: ``push_planner.sequence.planner.TaskPlan``.
        :raises PlanningFailed: with the reason.
        """
        return self._plan(PlanRequest(object_pose, robot_pose, goal, self._obj))

    def messages(self, chain, stamp):
        """
        Make messages of the plan of the first push, and of the object's way through all.

        :param chain: ``push_planner.sequence.planner.TaskPlan``.
        :param stamp: of the request, or of the measurements.
        """
        trajectory = chain.plan.trajectory
        poses = sequence_poses(trajectory, chain.later_steps, PATH_SPACING)
        return (to_plan_message(trajectory, stamp, self._frame),
                to_path_message(poses, stamp, self._frame))

    def _plan(self, wanted):
        return plan_for_request(wanted, *self._parts, self._workspace)


def describe_task_plan(chain):
    """
    Say in a sentence, and in a dict of values, what chain was found.

    :param chain: ``push_planner.sequence.planner.TaskPlan``.
    """
    count, first = len(chain.pushes), chain.pushes[0]
    text = (f'has planned {count} push{"es" * (count > 1)} of {chain.duration:.1f} s in all, the '
            f'first of {first.path_length:.2f} m')
    return text, {**chain.plan.report, **chain.report.as_values(),
                  'single_push': chain.single_push_time,
                  'robot_start': tuple(first.robot_start)}
