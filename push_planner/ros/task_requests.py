"""Tasks over ROS 2: from requests and maps to plans, and the words for diagnostics."""

from typing import Any, Mapping, NamedTuple

from push_model.geometry import Pose
from push_model.plan_request import PlanFailure, PlanRequest
from push_navigation.footprint_clearing import FootprintClearing
from push_navigation.occupancy_map import OccupancyMap
from push_planner.planned_pushes import planned_pushes
from push_planner.problem import PlanningFailed
from push_planner.ros.parameters import PlannerParameters
from push_planner.ros.planning_markers import pushes_markers, refusal_markers
from push_planner.ros.primitive_loader import PrimitiveLoader
from push_planner.straight.map_search.planner import warm_up as warm_up_search
from push_planner.straight.map_search.remaining_pushes import RemainingPushes
from push_planner.straight.planner import warm_up
from push_planner.task_plan import TaskPlan
from push_planner.task_planner import plan_for_request
from push_ros.conversions.markers import MarkerHeader
from push_ros.conversions.plan import to_path_message, to_plan_message
from push_ros.conversions.plan_request import from_request_message
from push_ros.map_reader import MapChange, MapReader, ReadMap

# Namespace of the markers of what is planned.
MARKERS = 'planning'


class Description(NamedTuple):
    """Description of a plan in diagnostics: a sentence, and values by name."""

    text: str
    values: Mapping[str, Any]


class TaskPlanMessages(NamedTuple):
    """
    A planned push, as it is published.

    :param plan: ``trajectory_msgs/JointTrajectory``.
    :param path: ``nav_msgs/Path`` of the object, through the remaining pushes as well.
    :param description: ``Description`` for diagnostics.
    """

    plan: Any
    path: Any
    description: Description


class TaskRequestHandler:
    """Plans the pushes of tasks, in a map where there is one."""

    def __init__(self, parameters: PlannerParameters, frame: str) -> None:
        """
        Start on open floor, and compile what a request needs meanwhile.

        :param frame: id of the world frame.
        """
        self._frame = frame
        self._map_reader = MapReader(frame, parameters.map_settings)
        self._map: ReadMap | None = None
        # That of the last plan, without the footprints of object and robot.
        self._planned_map: OccupancyMap | None = None
        self.clearing = FootprintClearing(parameters.map_settings, parameters.object,
                                          parameters.robot)
        self._cleared_object = parameters.object
        self._loader = PrimitiveLoader()
        self._remaining: RemainingPushes | None = None
        self.set_parameters(parameters)
        # Compiles the planner and makes the table of the object where there is none yet.
        self._loader.prepare(
            lambda: warm_up(parameters.object, parameters.robot, parameters.drive))

    def set_parameters(self, parameters: PlannerParameters) -> None:
        """Plan with other parameters from the next request on."""
        self._parameters = parameters

    def on_map(self, message: Any) -> None:
        """
        Start to read the map; ``take_map`` returns it.

        :param message: ``nav_msgs/OccupancyGrid``.
        """
        self._map_reader.start(message)

    @property
    def reads_map(self) -> bool:
        """Tell whether there is a map to be taken, now or later."""
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
        update = self._map_reader.take()
        if update is None:
            return None
        if self._map is None:
            parameters = self._parameters
            self._loader.prepare(
                lambda: warm_up_search(parameters.object, parameters.robot, parameters.drive))
        self._map = update
        # Its cells tell which of those of the object are still shown in later ones.
        self.clearing.clear(update.occupancy_map, update.stamp)
        return None if update.change is not MapChange.NEW else update.message

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
        :raises MessageRefused: where it cannot be used.
        """
        return from_request_message(message, self._frame)

    @property
    def is_ready(self) -> bool:
        """Tell whether a request would be planned at once."""
        return not self._loader.is_busy

    def prepares(self, request: PlanRequest) -> bool:
        """Load what pushes do to the object of a request; tell whether that takes a while."""
        parameters = self._parameters
        return self._loader.loads(request, parameters.robot, parameters.drive)

    def plan(self, request: PlanRequest) -> TaskPlan:
        """
        Plan for a request, with the poses that it states.

        :raises PlanningFailed: where there is no plan.
        """
        parameters = self._parameters
        self._planned_map = self._map_for(request)
        plan = plan_for_request(request, parameters.robot, parameters.planner, parameters.drive,
                                self._planned_map, remaining=self._remaining)
        self._remaining = plan.remaining
        return plan

    def markers(self, request: PlanRequest, task_plan: TaskPlan, stamp: Any) -> Any:
        """
        Draw the pushes of the last plan.

        :param request: for which it was made.
        :param stamp: ``builtin_interfaces/Time``.
        :return: ``visualization_msgs/MarkerArray``.
        """
        parameters = self._parameters
        pushes = planned_pushes(task_plan, request.obj, parameters.robot, parameters.drive,
                                self._planned_map)
        return pushes_markers(MarkerHeader(stamp, self._frame, MARKERS), request.obj,
                              parameters.robot, pushes)

    def refusal_markers(self, request: PlanRequest | None, failure: PlanningFailed,
                        stamp: Any) -> Any:
        """
        Draw what stands against a plan.

        :param request: that is refused; None where it cannot be read.
        :param stamp: ``builtin_interfaces/Time``.
        :return: ``visualization_msgs/MarkerArray``.
        """
        parameters = self._parameters
        return refusal_markers(
            MarkerHeader(stamp, self._frame, MARKERS),
            parameters.object if request is None else request.obj, parameters.robot,
            failure.marks)

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

    def messages(self, task_plan: TaskPlan, stamp: Any) -> TaskPlanMessages:
        """
        Convert a plan to messages.

        :param stamp: ``builtin_interfaces/Time`` of the request, or of the measurements.
        """
        trajectory = task_plan.trajectory
        poses = trajectory.object_poses.tolist()
        if task_plan.remaining is not None:
            poses += [push.end for push in task_plan.remaining.pushes]
        return TaskPlanMessages(to_plan_message(trajectory, stamp, self._frame),
                                to_path_message(poses, stamp, self._frame),
                                _description(task_plan))


def _description(plan: TaskPlan) -> Description:
    """Describe a plan in words and values."""
    count = 1 if plan.remaining is None else 1 + len(plan.remaining.pushes)
    noun = 'push' if count == 1 else 'pushes'
    text = (f'has planned {count} {noun} of expected {plan.expected_time:.1f} s in all, the first '
            f'of {plan.length:.2f} m')
    outlook = plan.trajectory.outlook
    stated = {}
    if outlook is not None:
        text += f'; {outlook}'
        stated = outlook.values()
    return Description(text, {
        **plan.report, **stated, 'robot_start': Pose(*plan.trajectory.robot_poses[0].tolist())})
