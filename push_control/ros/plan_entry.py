"""The one entry of plans: requested from the planner, checked, and handed to the supervisor."""

import math
from typing import Any

from push_control.events import no_plan, TaskEvent
from push_control.perception.object_at_rest import has_moved
from push_control.ros.floor import LiveMap
from push_control.ros.parameters import ControllerParameters
from push_control.ros.plan_requests import PlanRequester
from push_control.ros.task_report import TaskReporter
from push_control.steered.plan_check import check_plan, ExpectedPush
from push_control.task.status import TaskState
from push_control.task.supervisor import Supervisor
from push_model.events import AnyReport
from push_model.geometry import Pose
from push_model.observation import Observation
from push_model.plan_request import PlanRequest
from push_model.trajectory import PushTrajectory
from push_ros.background import Background
from push_ros.conversions.plan import from_plan_message, plan_failure
from push_ros.conversions.primitives import seconds
from push_ros.node import PushNode

# Time that preparing a plan may take before the node goes on meanwhile [s]; chosen: a file takes
# some tens of milliseconds, what is in memory far less.
PREPARATION_TIME = 0.1


class PlanEntry:
    """
    Requests the plans that a supervisor needs, and hands it those that may be driven.

    ``parameters``: the present ``ControllerParameters``. ``refusal``: ``Report`` of why there is
    no plan to the newest goal while the push to the one before goes on; else None.
    """

    def __init__(self, node: PushNode, parameters: ControllerParameters, floor: LiveMap,
                 reporter: TaskReporter) -> None:
        """
        Start without a request.

        :param floor: with the map to which plans have to keep.
        """
        options, self._frame = parameters.options, parameters.frames.world_frame
        self.parameters = parameters
        self._floor = floor
        self._reporter = reporter
        self._background = Background('plan')
        self._requester = PlanRequester(node, self._frame, is_lockstep=options.lockstep)

    def reset(self, supervisor: Supervisor) -> None:
        """Forget all requests, and serve a supervisor from now on."""
        self._supervisor = supervisor
        self._requester.reset()
        self.refusal: AnyReport | None = None
        # Message of a plan that is being prepared.
        self._unprepared: Any = None
        # Stamp of a plan that nobody has requested, and time of the first measurement [s].
        self._plan_stamp = math.inf
        self._first_time: float | None = None

    @property
    def accepts_unrequested(self) -> bool:
        """Tell whether plans are driven that were not requested."""
        options = self.parameters.options
        return options.accept_unrequested_plans and self._supervisor.keeps_plan

    # Plans that come.

    def on_plan(self, message: Any, *, is_started: bool) -> None:
        """
        Set the plan that was requested; one that was not is reported, and not driven.

        One that comes after its request has timed out is set where the object has not moved. With
        ``accept_unrequested_plans`` a single push takes any that starts where the object is, but
        for answers to requests that were given up.

        :param is_started: whether the robot may move; else the plan waits for the start.
        :raises MessageRefused: where it cannot be used: the robot stands.
        """
        awaited, answered = (self._supervisor.plan_request,
                             self._requester.request_answered_by(message))
        failure = plan_failure(message)
        if awaited is None or answered is None:
            if failure is None:
                self._on_unrequested(message, is_started)
        elif failure is not None:
            if answered is awaited:
                self._supervisor.on_planning_failed(
                    failure, f'{failure.value} (details in the diagnostics of the planner)')
                self._note_refusal(no_plan(failure, failure.value))
        elif not has_moved(answered.object_pose, awaited.object_pose, self.parameters.supervision):
            plan = self._read(message, awaited)
            if self._is_prepared(plan):
                self._take(plan, message.header.stamp, is_started)
            else:
                self._unprepared = message

    def _is_prepared(self, plan: PushTrajectory) -> bool:
        """Prepare a plan beside the node where that takes long; in lockstep time waits for it."""
        preparation = self._supervisor.preparation(plan)
        if preparation is None or self.parameters.options.lockstep:
            return True
        self._background.start(preparation)
        self._background.wait(PREPARATION_TIME)
        return not self._background.is_busy

    def _take(self, plan: PushTrajectory, stamp: Any, is_started: bool) -> None:
        """Hand on a plan that was requested, or keep it for the start."""
        self._requester.forget_unanswered()
        self.refusal = None
        self._plan_stamp = math.inf
        if is_started:
            self._supervisor.set_plan(plan)
        else:
            self._supervisor.keep_plan(plan, TaskEvent.AWAITS_START.report())
        self._reporter.show_plan(plan, stamp)

    def _on_unrequested(self, message: Any, is_started: bool) -> None:
        """
        Report a plan that no open request awaits, or drive it where that is allowed.

        One whose request was given up is for a goal that nobody has any more.
        """
        if not self.accepts_unrequested or self._requester.has_requested(message):
            self._requester.report_unrequested(message)
            return
        plan, stamp = self._read(message, None), message.header.stamp
        self.refusal = None
        self._plan_stamp = seconds(stamp)
        if not is_started:
            self._supervisor.keep_plan(plan, TaskEvent.AWAITS_START.report())
        elif self._is_plan_old:
            self._supervisor.keep_plan(plan, TaskEvent.PLAN_OLDER_THAN_NODE.report())
        else:
            self._supervisor.drive(plan)
        self._reporter.show_goal(Pose(*plan.object_poses[-1].tolist()))
        self._reporter.show_plan(plan, stamp)

    def _read(self, message: Any, request: PlanRequest | None) -> PushTrajectory:
        """Read a plan, and refuse one that cannot be driven, or leads elsewhere."""
        try:
            plan = from_plan_message(message, self._frame)
            ends = self._supervisor.expected_ends(request)
            check_plan(plan, ExpectedPush(self.parameters.object, self.parameters.robot,
                                          ends, self._floor.occupancy_map))
        except ValueError as error:
            self._supervisor.on_plan_refused()
            raise self._requester.refusal(error) from error
        return plan

    @property
    def _is_plan_old(self) -> bool:
        """Tell whether a plan was latched before this node had measured anything."""
        return self._first_time is not None and self._plan_stamp < self._first_time

    def forget_plan_age(self) -> None:
        """Note that somebody wants the plan that there is to be driven, old as it may be."""
        self._plan_stamp = math.inf

    # Plans that are awaited.

    def check(self, observation: Observation, *, is_started: bool) -> None:
        """
        Note before a step that a plan is prepared, is older than the node, or does not come.

        :param observation: the newest ``Observation``.
        :param is_started: whether the robot may move.
        :raises MessageRefused: where one that is prepared cannot be used any more.
        """
        supervisor, time = self._supervisor, observation.time
        if self._first_time is None:
            self._first_time = time
            if is_started and self._is_plan_old:
                supervisor.interrupt(TaskEvent.PLAN_OLDER_THAN_NODE.report())
        if self._unprepared is not None:
            if not self._background.is_busy:
                message, self._unprepared = self._unprepared, None
                self.on_plan(message, is_started=is_started)
            return
        timeout = self.parameters.supervision.plan_timeout
        if supervisor.plan_request is not None and self._requester.is_overdue(time, timeout):
            silence = self._requester.report_silence(timeout)
            supervisor.on_plan_overdue(silence)
            self._note_refusal(silence)

    def on_time_ahead(self, duration: float) -> None:
        """Note that clocks were set ahead, as of ``PlanRequester.on_time_ahead``."""
        self._requester.on_time_ahead(duration)

    def update(self, time: float) -> None:
        """
        Publish a request that is new.

        :param time: of the newest measurement [s].
        """
        self._requester.update(self._supervisor.plan_request, time)

    def _note_refusal(self, cause: AnyReport) -> None:
        """Report that there is no plan to a goal while the push to the one before goes on."""
        if self._supervisor.state is TaskState.PUSH:
            self.refusal = cause
            self._reporter.report_error(str(cause))
