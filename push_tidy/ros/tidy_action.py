"""The action ``push_objects``: one goal at a time, with feedback, cancellation and a result."""

import math
from typing import Any, Callable, NamedTuple

from builtin_interfaces.msg import Duration
from push_control.task.code_text import code_names
from push_model.events import codes, sentence
from push_model.parameters import RoundRobot
from push_model.plan_request import ANY_HEADING, GoalTolerances
from push_navigation.settings import DriveSettings
from push_ros.conversions.measurements import from_object_pose_message
from push_ros.conversions.primitives import MessageRefused, seconds, to_stamp
from push_ros.deferring_server import DeferringActionServer
from push_ros.node import PushNode
from push_ros.node_settings import TidyOptions
from push_ros.object_catalogue import ObjectCatalogue
from push_ros.push_interfaces import PushInterfaces, TIDY_ACTION
from push_tidy.ros.tidy_run import RoomInputs, RunPorts, RunState, TidyRun
from push_tidy.tidy_supervisor import ObjectGoal, ObjectState, TidySupervisor
from rclpy.action.server import CancelResponse, GoalResponse, ServerGoalHandle

STATES = {state: index for index, state in enumerate(ObjectState)}


class TidyParameters(NamedTuple):
    """
    What goals are pursued with.

    :param robot: the nominal ``RoundRobot``.
    :param drive: ``DriveSettings``.
    :param options: ``TidyOptions``.
    """

    robot: RoundRobot
    drive: DriveSettings
    options: TidyOptions

    @property
    def names(self) -> list[str]:
        """Names of all objects."""
        return [entry.name for entry in self.options.objects]


class _RefusedGoal(ValueError):
    """A goal that cannot be used, with the name of its error code."""

    def __init__(self, code: str, reason: str) -> None:
        super().__init__(reason)
        self.code = code


class TidyActionServer:
    """
    Serves ``push_objects``; while a goal is pursued another one is rejected.

    ``run``: the present ``TidyRun``, or None.
    """

    def __init__(self, node: PushNode, parameters: TidyParameters, interfaces: PushInterfaces,
                 inputs: RoomInputs, make_ports: Callable[[Callable[[], None]], RunPorts]) -> None:
        """
        Wait for goals.

        :param inputs: ``RoomInputs``.
        :param make_ports: takes what is called after each change, and returns the ``RunPorts``.
        """
        self._node = node
        self._parameters = parameters
        self._interfaces = interfaces
        self._inputs = inputs
        self._ports = make_ports(self._on_change)
        self._catalogue = ObjectCatalogue(parameters.options.object_folder)
        self._handle: ServerGoalHandle | None = None
        self.run: TidyRun | None = None
        self._server = DeferringActionServer(
            node, interfaces.tidy_action, TIDY_ACTION, goal_callback=self._answer_goal,
            handle_accepted_callback=self._on_goal, cancel_callback=self._on_cancel)

    def close(self) -> None:
        """End the goal, and serve no more."""
        if self.run is not None:
            self.run.cancel('the node has ended')
        self._server.destroy()

    def _answer_goal(self, _: Any) -> GoalResponse:
        if self.run is None:
            return GoalResponse.ACCEPT
        self._node.get_logger().warning(f'{TIDY_ACTION}: a goal is rejected, as one is pursued')
        return GoalResponse.REJECT

    def _on_goal(self, handle: ServerGoalHandle) -> None:
        handle.execute()
        request = handle.request
        try:
            goals = self._goals_of(request)
        except _RefusedGoal as error:
            self._node.get_logger().error(f'{TIDY_ACTION}: {error}')
            self._finish(handle, error.code, str(error), self._interfaces.tidy_action.Result())
            return
        supervisor = TidySupervisor(
            list(goals.values()), self._parameters.robot, self._parameters.drive,
            needs_all=request.all_or_none, time_limit=seconds(request.time_limit) or math.inf)
        self._handle = handle
        self.run = TidyRun(goals, supervisor, self._inputs, self._ports,
                           options=self._parameters.options,
                           start=seconds(self._node.now()))

    def _goals_of(self, request: Any) -> dict[str, ObjectGoal]:
        """Read a goal; objects that it does not name may stand anywhere."""
        names, options = list(request.object_names), self._parameters.options
        if not names or len(names) != len(request.goal_poses) or len(set(names)) < len(names):
            raise _RefusedGoal('INVALID_GOAL', f'goal: got the names {names} and '
                               f'{len(request.goal_poses)} poses, expected one pose for each of '
                               'some different names')
        unknown = sorted(set(names) - set(self._parameters.names))
        if unknown:
            raise _RefusedGoal('UNKNOWN_OBJECT', f'goal: got {", ".join(unknown)}, expected names '
                               f'among {", ".join(self._parameters.names)}')
        poses = dict(zip(names, request.goal_poses))
        goals: dict[str, ObjectGoal] = {}
        for name in self._parameters.names:
            try:
                obj = self._catalogue.find(name)
                pose = None if name not in poses else from_object_pose_message(
                    poses[name], self._ports.frame, f'goal_poses of {name}').pose
            except (MessageRefused, ValueError) as error:
                raise _RefusedGoal('INVALID_GOAL', str(error)) from error
            heading = request.heading_tolerance or options.heading_tolerance
            goals[name] = ObjectGoal(name, obj, pose, GoalTolerances(
                request.position_tolerance or options.position_tolerance,
                heading if obj.outline else ANY_HEADING))
        return goals

    def _on_cancel(self, handle: ServerGoalHandle) -> CancelResponse:
        """Accept, and begin to back off once the state of the goal is that."""
        executor = self._node.executor
        if executor is None or handle is not self._handle:
            return CancelResponse.REJECT
        executor.create_task(self._cancel)
        return CancelResponse.ACCEPT

    def _cancel(self) -> None:
        if self.run is not None:
            self.run.is_cancelled = True
            self.run.cancel('cancelled')

    def _on_change(self) -> None:
        run, handle = self.run, self._handle
        if run is None or handle is None:
            return
        if run.state is not RunState.ENDED:
            self._publish_feedback(run, handle)
            return
        self.run = self._handle = None
        supervisor = run.supervisor
        failures = supervisor.failures()
        text = '; '.join(f'{name}: {report}' for name, report in failures.items())
        code = 'NONE' if not failures else 'NOT_ALL_PLACED'
        self._finish(handle, 'INTERRUPTED' if run.is_cancelled and failures else code, text,
                     self._interfaces.tidy_action.Result(
                         objects=self._object_messages(run), moves=supervisor.moves,
                         duration=to_stamp(run.elapsed, Duration)))

    def _publish_feedback(self, run: TidyRun, handle: ServerGoalHandle) -> None:
        message = self._interfaces.tidy_action.Feedback(
            objects=self._object_messages(run), placed=run.supervisor.placed_count,
            goals=run.supervisor.goal_count, text=run.text,
            elapsed_time=to_stamp(run.elapsed, Duration),
            estimated_time_remaining=to_stamp(run.supervisor.plan.time, Duration))
        if run.feedback is not None:
            message.status = run.feedback.status
        handle.publish_feedback(message)

    def _object_messages(self, run: TidyRun) -> list[Any]:
        messages: list[Any] = []
        for name, status in run.supervisor.statuses().items():
            position, heading = run.errors(name)
            messages.append(self._interfaces.object_status(
                object_name=name, state=STATES[status.state], position_error=position,
                heading_error=heading, codes=code_names(codes(status.failure)),
                text=sentence(status.failure) or status.state.value))
        return messages

    def _finish(self, handle: ServerGoalHandle, code: str, text: str, result: Any) -> None:
        """End a goal of a client."""
        result.error_code = getattr(self._interfaces.tidy_action.Result, code)
        result.error_msg = text
        if code == 'NONE':
            handle.succeed()
        elif handle.is_cancel_requested:
            handle.canceled()
        else:
            handle.abort()
        self._server.answer(handle, result)
