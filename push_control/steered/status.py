"""What the controller of a push does, and how it goes."""

import dataclasses
import enum
from typing import Any

from push_control.steered.laws.steering_law import SolverFailure
from push_model.events import PushEvent
from push_model.geometry import Pose


class Phase(enum.Enum):
    """Phase of the controller."""

    IDLE = 'idle'
    PUSHING = 'pushing'
    # The robot stands until the measurements can be used again.
    WAITING = 'waiting'
    DONE = 'done'
    FAILED = 'failed'

    @property
    def has_ended(self) -> bool:
        """Tell whether the push is over, for better or worse."""
        return self in (Phase.DONE, Phase.FAILED)


@dataclasses.dataclass(frozen=True)
class ControllerStatus:
    """
    Status of the controller, with its reason; errors are those of its estimate.

    :param phase: the ``Phase``.
    :param reason: one sentence on what is out of the ordinary, empty while all is well.
    :param event: code of that, None while all is well.
    :param position_error: distance of the object from its goal [m].
    :param heading_error: object heading minus that of the goal [rad].
    :param remaining_distance: arc length that the flat output has left to go [m].
    :param travelled_distance: path length of the contact since the start [m].
    :param friction_center: estimate in the object frame (x, y) [m].
    :param push_direction: estimated effective robot heading [rad].
    :param object_pose: estimated ``Pose`` of the object, one drive lag ahead.
    :param robot_pose: ``Pose`` of the robot at that time, as it must be to touch the object.
    :param in_contact: whether the robot touches the object, as far as is known.
    :param replan_requested: whether the push has failed, but a plan from here may succeed.
    :param path_replans: number of paths drawn since the plan.
    :param reapproaches: number of further approaches to the goal.
    :param slips: number of times that the contact was detected to slide.
    :param contact_losses: number of times that contact was detected to be lost.
    :param rejected_poses: number of measured poses outside the gate.
    :param solver_failures: number of times that the closed-form law replaced the solver.
    :param solver_failure: why it did so last, None while it did not.
    """

    phase: Phase = Phase.IDLE
    reason: str = ''
    event: PushEvent | None = None
    position_error: float = 0.0
    heading_error: float = 0.0
    remaining_distance: float = 0.0
    travelled_distance: float = 0.0
    friction_center: tuple[float, float] = (0.0, 0.0)
    push_direction: float = 0.0
    object_pose: Pose = Pose(0.0, 0.0, 0.0)
    robot_pose: Pose = Pose(0.0, 0.0, 0.0)
    in_contact: bool = True
    replan_requested: bool = False
    path_replans: int = 0
    reapproaches: int = 0
    slips: int = 0
    contact_losses: int = 0
    rejected_poses: int = 0
    solver_failures: int = 0
    solver_failure: SolverFailure | None = None

    def values(self) -> dict[str, Any]:
        """
        Give what is to be published or written.

        :return: dict of field names to numbers and words; codes as their text, or empty.
        """
        values = {**vars(self), 'phase': self.phase.value, 'solver_failure': (
            '' if self.solver_failure is None else self.solver_failure.value)}
        # The reason says the same in words.
        del values['event']
        return values
