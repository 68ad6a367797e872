"""Behaviours: what the robot does in one state of a task, and what all of them know."""

import abc
import enum
from typing import ClassVar, Generic, NamedTuple, TypeVar

from push_control.behaviors.failures import FailureReport
from push_control.goal import TaskFailure, TaskGoal
from push_control.perception.raw_perception import RawPerception
from push_control.settings import ControlSettings
from push_control.steered.start import MAX_OBJECT_OFFSET, MAX_OBJECT_ROTATION
from push_control.steered.status import ControllerStatus
from push_control.supervision_settings import SupervisionSettings
from push_model.events import AnyReport
from push_model.geometry import Pose
from push_model.parameters import PushedObject, RoundRobot
from push_model.plan_request import GoalTolerances, PlanRequest
from push_model.signals import ObjectEstimate, STOP, Twist
from push_model.trajectory import PushTrajectory
from push_navigation.occupancy_map import OccupancyMap
from push_navigation.settings import DriveSettings
from push_safety.status import SafetyReport

# What a behaviour has to know of robot and object.
Perception = TypeVar('Perception', bound=RawPerception, contravariant=True)


class BehaviorContext(NamedTuple):
    """
    Context in which a behaviour acts.

    :param obj: the ``PushedObject`` as identified so far.
    :param occupancy_map: the ``OccupancyMap``, or None on open floor.
    """

    obj: PushedObject
    robot: RoundRobot
    control: ControlSettings
    drive: DriveSettings
    supervision: SupervisionSettings
    occupancy_map: OccupancyMap | None = None


class MeasurementNeed(enum.Enum):
    """Measurements without which a behaviour has to wait."""

    # It stands anyway, or handles their faults itself.
    NONE = 'none'
    ODOMETRY = 'odometry'
    ODOMETRY_AND_OBJECT = 'odometry and object'


class NoPushNeeded(enum.Enum):
    """Why no push is planned next."""

    # The object is at its goal.
    REACHED = 'reached'
    # It may be: it has to be seen from another side.
    UNSEEN = 'unseen'
    # It is not in view: the robot has to look for it.
    OUT_OF_VIEW = 'out of view'


class Abort(NamedTuple):
    """
    The task cannot be done.

    :param failure: the ``TaskFailure``; None where the object may be at its goal.
    :param cause: ``Report`` of why.
    """

    failure: TaskFailure | None
    cause: AnyReport


class Behavior(abc.ABC, Generic[Perception]):
    """
    Behaviour of the robot in one state of a task.

    ``finished``: whether it has ended well. ``failure``: the ``FailureReport`` where it has ended
    otherwise, else None. ``measurement_need``: its ``MeasurementNeed``.
    ``result``: what the end of a behaviour that plans means, where no push follows; else None.
    ``handles_stops``: whether it waits by itself while the safety layer stops the robot, or
    measurements fail; else it ends then. ``plan_request``: the ``PlanRequest`` that waits for its
    plan, or None. ``needs_plan``: whether nothing happens before that comes. ``ends_at_goal``:
    whether the plan has to lead to the goal. ``next_goal``: ``TaskGoal`` to which there is no plan
    yet while it pursues another one, or None.
    """

    measurement_need: MeasurementNeed = MeasurementNeed.ODOMETRY_AND_OBJECT
    handles_stops: ClassVar[bool] = False
    needs_plan: ClassVar[bool] = False
    ends_at_goal: ClassVar[bool] = True

    def __init__(self) -> None:
        """Start."""
        self.finished = False
        self.failure: FailureReport | None = None
        self.result: NoPushNeeded | Abort | None = None
        self.plan_request: PlanRequest | None = None
        self.next_goal: TaskGoal | None = None

    @abc.abstractmethod
    def step(self, perception: Perception, dt: float) -> Twist:
        """
        Compute the command.

        :param perception: ``RawPerception`` of robot and object, or what it needs of it.
        :param dt: time since the last call [s].
        :return: ``Twist``; STOP once there is a ``failure``.
        """

    @abc.abstractmethod
    def pause(self) -> None:
        """Note that the robot stands for now; the next step goes on from wherever it is."""

    def is_blocked(self, occupancy_map: OccupancyMap | None, pose: Pose) -> bool:
        """
        Tell whether a new map has an obstacle in the way where the previous one has none.

        :param occupancy_map: the new ``OccupancyMap``, or None for open floor.
        """
        return False

    @property
    def waiting_cause(self) -> AnyReport | None:
        """``Report`` of what it waits for, or None."""
        return None

    # Stops.

    @property
    def awaits_resume(self) -> bool:
        """Tell whether it waits until somebody lets the robot go on."""
        return False

    def on_safety_report(self, fault: SafetyReport | None, stop: SafetyReport | None) -> None:
        """
        Take note of what the safety layer has found; called before each step.

        :param fault: what is wrong with the newest odometry, or None.
        :param stop: why the robot is stopped, or None where it may move.
        """

    def stop_failure(self, stop: SafetyReport) -> FailureReport | None:
        """
        Tell what a stop shows beside what it says of the base.

        :param stop: why the robot is stopped.
        :return: ``FailureReport``; None where the stop says all.
        """
        return None

    def on_bumped(self, perception: Perception) -> FailureReport | None:
        """
        Take note that the bumper has closed; called before the step with that observation.

        :param perception: as of ``step``.
        :return: ``FailureReport`` where it should have touched nothing; else None.
        """
        return None

    def resume(self) -> bool:
        """Go on after a stop of the base; return whether it does so by itself."""
        return False

    # Goals and plans.

    @property
    def start_limits(self) -> tuple[float, float]:
        """Distance and rotation up to which an object is at the start of a plan [m, rad]."""
        return MAX_OBJECT_OFFSET, MAX_OBJECT_ROTATION

    def take_goal(self, goal: TaskGoal, tolerances: GoalTolerances) -> bool:
        """
        Turn to another goal without a stop.

        :param tolerances: how near to it the object has to come.
        :return: whether it does; else it has to end.
        """
        return False

    def move_goal(self, pose: Pose) -> None:
        """
        Move the goal a little, as where its frame drifts.

        :param pose: goal ``Pose`` of the object.
        """

    def renew_request(self) -> None:
        """Request the plan once more, from where robot and object are at the next step."""
        self.plan_request = None

    def take_plan(self, trajectory: PushTrajectory) -> bool:
        """
        Go on with another plan, without a stop where that is possible.

        :return: whether it does; else it has to end.
        """
        return False

    def goes_on_without_plan(self) -> bool:
        """Take note that there is no plan for the request; return whether it goes on as before."""
        return False

    # A push.

    @property
    def push_cause(self) -> AnyReport | None:
        """``Report`` of what is out of the ordinary in a push; None while all is well."""
        return self.failure

    @property
    def push_status(self) -> ControllerStatus | None:
        """``ControllerStatus`` of a push; None for all other behaviours."""
        return None

    @property
    def object_estimate(self) -> ObjectEstimate | None:
        """``ObjectEstimate`` of a push that estimates by itself; None for all others."""
        return None


class Stand(Behavior[RawPerception]):
    """Stands until the user asks for something else."""

    measurement_need = MeasurementNeed.NONE

    def pause(self) -> None:
        """Do nothing: the robot stands."""

    def step(self, perception: RawPerception, dt: float) -> Twist:
        """Stand."""
        return STOP
