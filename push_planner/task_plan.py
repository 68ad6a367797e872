"""Plan of the next push of a task."""

from typing import Any, NamedTuple

from push_model.parameters import Contact
from push_model.trajectory import PushTrajectory
from push_navigation.path import Path
from push_planner.straight.map_search.remaining_pushes import RemainingPushes


class TaskPlan(NamedTuple):
    """
    Plan of the next push of a task.

    :param trajectory: its ``PushTrajectory``; the mean effect of a straight push.
    :param contact: ``Contact`` where it starts.
    :param approach_path: ``Path`` of the robot to the first contact of a straight push, to the
        standoff of a steered one.
    :param length: driven length [m].
    :param expected_time: of everything until the object is at its goal [s]; with a steered push
        of this path and of the push.
    :param report: further values by name.
    :param remaining: ``RemainingPushes`` after a push in a map, else None.
    """

    trajectory: PushTrajectory
    contact: Contact
    approach_path: Path
    length: float
    expected_time: float
    report: dict[str, Any]
    remaining: RemainingPushes | None = None
