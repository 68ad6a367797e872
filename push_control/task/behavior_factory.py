"""Which behaviour acts in which state of a task: what all ways to pursue a goal share."""

import abc
from collections.abc import Callable
from typing import Any, ClassVar

from push_control.behaviors.behavior import Behavior, BehaviorContext, Stand
from push_control.behaviors.progress import ProgressMonitor
from push_control.goal import TaskGoal
from push_control.perception.raw_perception import RawPerception
from push_control.settings import ControlSettings
from push_control.supervision_settings import SupervisionSettings
from push_control.task.state_machine import TransitionTable
from push_control.task.status import TaskState
from push_model.parameters import PushedObject, RoundRobot
from push_model.plan_request import GoalTolerances
from push_model.trajectory import PushTrajectory
from push_navigation.occupancy_map import OccupancyMap
from push_navigation.settings import DriveSettings


class BehaviorFactory(abc.ABC):
    """
    Makes the behaviour of each state.

    A subclass is a way to pursue a goal. ``table``: its ``TransitionTable``. ``keeps_plan``:
    whether a plan is made before the start, which it awaits, and is driven once more by a second
    start; else each start makes another plan. ``occupancy_map``: the ``OccupancyMap``, or None on
    open floor. ``supervision``: the ``SupervisionSettings`` that hold for the object.
    """

    table: ClassVar[TransitionTable]
    keeps_plan: ClassVar[bool]

    def __init__(self, obj: PushedObject, robot: RoundRobot, control: ControlSettings,
                 drive: DriveSettings, supervision: SupervisionSettings) -> None:
        """Start on open floor."""
        self._obj = obj
        self._robot = robot
        self.set_settings(control, drive, supervision)
        self.occupancy_map: OccupancyMap | None = None

    def set_settings(self, control: ControlSettings, drive: DriveSettings,
                     supervision: SupervisionSettings) -> None:
        """Set the settings of the behaviours that are made from now on."""
        self._control = control
        self._drive = drive
        self.supervision = supervision.for_object(self._obj)

    @property
    def tolerances(self) -> GoalTolerances:
        """``GoalTolerances`` of a push that has to come to the goal by itself."""
        return self._control.tolerances

    @abc.abstractmethod
    def new_perception(self, since: float) -> RawPerception:
        """
        Make what the behaviours know of robot and object.

        :param since: time before which object poses tell nothing of where the object is [s].
        """

    @abc.abstractmethod
    def create(self, state: TaskState, target: PushTrajectory | None, goal: TaskGoal | None,
               perception: Any, progress: ProgressMonitor) -> Behavior[Any]:
        """
        Make the behaviour of a state.

        :param target: the ``PushTrajectory``, or None.
        :param goal: the ``TaskGoal``, or None.
        :param perception: what ``new_perception`` has made.
        :param progress: the ``ProgressMonitor`` of the task.
        """

    def preparation(self, target: PushTrajectory,
                    perception: Any) -> Callable[[], object] | None:
        """
        Tell what the behaviours of a plan load or make, which may take long.

        :param target: the plan.
        :param perception: what ``new_perception`` has made.
        :return: what to call before them, on any thread; None where nothing takes long.
        """
        return None

    @abc.abstractmethod
    def rehearse(self) -> None:
        """Compile or load now, with measurements of its own, what a task would wait for."""

    def inspection(self, perception: Any) -> Behavior[Any]:
        """
        Make the behaviour that sees the object from another side; stands where there is none.

        :param perception: what ``new_perception`` has made.
        """
        return Stand()

    def _context(self, obj: PushedObject) -> BehaviorContext:
        """Make the context of a behaviour that acts upon an object."""
        return BehaviorContext(obj, self._robot, self._control, self._drive, self.supervision,
                               self.occupancy_map)
