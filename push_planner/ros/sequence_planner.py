"""Push sequences over ROS 2: from requests and maps to plans, and the words for diagnostics."""

from typing import Any, Mapping, NamedTuple

from push_model.geometry import Pose
from push_model.plan_request import PlanFailure, PlanRequest
from push_navigation.footprint_clearing import FootprintClearing
from push_navigation.occupancy_map import OccupancyMap
from push_planner.map_search.kept_sequence import KeptSequence
from push_planner.map_search.planner import warm_up as warm_up_search
from push_planner.primitive_push.planner import warm_up
from push_planner.problem import PlanningFailed
from push_planner.ros.parameters import PlannerParameters
from push_planner.ros.primitive_loader import PrimitiveLoader
from push_planner.sequence.planner import plan_for_request, TaskPlan
from push_planner.sequence.steps import sequence_poses
from push_ros.conversions.plan import to_path_message, to_plan_message
from push_ros.conversions.plan_request import from_request_message
from push_ros.map_reader import MapChange, MapReader, ReadMap

# Spacing of the poses in ``planned_path`` [m]; chosen: a smooth line in a display.
PATH_SPACING = 0.05


class Description(NamedTuple):
    """What diagnostics say of a plan: a sentence, and values by name."""

    text: str
    values: Mapping[str, Any]


class SequencePlanMessages(NamedTuple):
    """
    A planned sequence, as it is published.

    :param plan: ``trajectory_msgs/MultiDOFJointTrajectory`` of its first push.
    :param path: ``nav_msgs/Path`` of the object through all pushes.
    :param description: ``Description`` for diagnostics.
    """

    plan: Any
    path: Any
    description: Description


class SequenceRequestHandler:
    """Plans push sequences, in a map where there is one."""

    def __init__(self, parameters: PlannerParameters, frame: str) -> None:
        """
        Start on open floor.

        :param parameters: ``PlannerParameters``.
        :param frame: id of the world frame.
        """
        self._frame = frame
        self._map_reader = MapReader(frame, parameters.map_settings)
        self._map: ReadMap | None = None
        self.clearing = FootprintClearing(parameters.map_settings, parameters.object,
                                          parameters.robot)
        self._cleared_object = parameters.object
        self._loader = PrimitiveLoader()
        # What is left of the last sequence.
        self._kept: KeptSequence | None = None
        self.set_parameters(parameters)
        if self._plans_unsteered_pushes:
            # Compiles the planner and makes the table of the object where there is none yet.
            warm_up(parameters.object, parameters.robot, parameters.drive)

    @property
    def _plans_unsteered_pushes(self) -> bool:
        parameters = self._parameters
        return (parameters.planner.site == 'sequence'
                and parameters.task.method == 'primitives')

    def set_parameters(self, parameters: PlannerParameters) -> None:
        """
        Plan with other parameters from the next request on.

        :param parameters: ``PlannerParameters``.
        """
        self._parameters = parameters

    def on_map(self, message: Any) -> None:
        """
        Begin to read the map; ``take_map`` returns it.

        :param message: ``nav_msgs/OccupancyGrid``.
        """
        self._map_reader.start(message)

    @property
    def reads_map(self) -> bool:
        """Whether there is a map to be taken, now or later."""
        return self._map_reader.is_busy

    def refuse_map(self, reason: str) -> None:
        """
        Plan no more until a map can be used.

        :param reason: why this one cannot, one sentence.
        """
        self._map_reader.refuse(reason)

    def wait_for_map(self) -> None:
        """Wait until the map has been read that came last."""
        self._map_reader.wait()

    def take_map(self) -> Any:
        """
        Use the map that was read, from the next plan on.

        :return: ``nav_msgs/OccupancyGrid`` of a new map; None where there is none.
        :raises MessageRefused: where it cannot be used; there are no plans until one can.
        """
        found = self._map_reader.take()
        if found is None:
            return None
        if self._map is None and self._plans_unsteered_pushes:
            parameters = self._parameters
            warm_up_search(parameters.object, parameters.robot, parameters.drive)
        self._map = found
        # Its cells tell which of those of the object are still shown in later ones.
        self.clearing.clear(found.occupancy_map, found.stamp)
        return None if found.change is not MapChange.NEW else found.message

    def move_map(self, correction: Pose) -> None:
        """
        Move the map with the frame that it is in.

        :param correction: ``Pose`` that takes its former origin to the new one,
            ``correction @ origin``.
        """
        self._map = self._map_reader.move(correction)

    def read(self, message: Any) -> PlanRequest:
        """
        Read a request.

        :param message: ``trajectory_msgs/JointTrajectory``.
        :return: ``PlanRequest``.
        :raises MessageRefused: where it cannot be used.
        """
        return from_request_message(message, self._frame)

    def prepares(self, request: PlanRequest) -> bool:
        """
        Find out what pushes do to the object of a request, and tell whether that takes a while.

        :param request: ``PlanRequest``.
        """
        parameters = self._parameters
        return self._plans_unsteered_pushes and self._loader.loads(
            request, parameters.robot, parameters.drive)

    def plan(self, request: PlanRequest) -> TaskPlan:
        """
        Plan for a request, with the poses that it states.

        :param request: ``PlanRequest``.
        :return: ``TaskPlan``.
        :raises PlanningFailed: where there is no plan.
        """
        parameters = self._parameters
        found = plan_for_request(request, parameters.robot, parameters.planner, parameters.drive,
                                 parameters.task, self._map_for(request), kept=self._kept)
        self._kept = found.kept
        return found

    def _map_for(self, request: PlanRequest) -> OccupancyMap | None:
        """Return the map without the footprints of object and robot."""
        if self._map_reader.fault:
            raise PlanningFailed(PlanFailure.UNUSABLE_MAP, self._map_reader.fault)
        if self._map is None:
            return None
        shape = request.obj.outline, request.obj.radius
        if shape != (self._cleared_object.outline, self._cleared_object.radius):
            self._cleared_object = request.obj
            self.clearing.set_object(request.obj)
        # Where they are now, whatever has been measured before.
        self.clearing.record(self._map.stamp, request.object_pose, request.robot_pose)
        return self.clearing.clear(self._map.occupancy_map, self._map.stamp)

    def messages(self, task_plan: TaskPlan, stamp: Any) -> SequencePlanMessages:
        """
        Convert a plan to messages.

        :param task_plan: ``TaskPlan``.
        :param stamp: ``builtin_interfaces/Time`` of the request, or of the measurements.
        """
        trajectory = task_plan.trajectory
        poses = [*sequence_poses(trajectory, task_plan.later_steps, PATH_SPACING)]
        if task_plan.kept is not None:
            poses += [push.end for push in task_plan.kept.pushes]
        return SequencePlanMessages(to_plan_message(trajectory, stamp, self._frame),
                                    to_path_message(poses, stamp, self._frame),
                                    _description(task_plan))


def _description(task_plan: TaskPlan) -> Description:
    """Describe a sequence in words and values."""
    count, first = len(task_plan.pushes), task_plan.pushes[0]
    noun = 'push' if count == 1 else 'pushes'
    expected = 'expected ' if task_plan.trajectory.style.is_unsteered else ''
    text = (f'has planned {count} {noun} of {expected}{task_plan.duration:.1f} s in all, the '
            f'first of {first.path_length:.2f} m')
    return Description(text, {
        **task_plan.push_report, **task_plan.report.as_values(),
        'single_push': task_plan.single_push_time, 'robot_start': first.robot_start})
