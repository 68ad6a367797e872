"""The planner's answer, which checks itself."""

import dataclasses

from push_model.trajectory import PushTrajectory
from push_planner.problem import PushProblem
from push_planner.verification import re_integrate


@dataclasses.dataclass(frozen=True, eq=False)
class Plan:
    """
    A push that reaches its goal.

    :param problem: the ``PushProblem`` that it answers.
    :param trajectory: ``PushTrajectory`` in the world; twists are those after a switch.
    :param pushing_angles: pushing angle of each segment, from the normal to the velocity imposed
        at the contact [rad].
    :param segment_ends: way of the contact at the end of each segment, increasing [m].
    :param switches: ``Switch`` at the begin of each segment: the impulse that the jump takes; the
        first is the first touch.
    :param report: what there is to know of the plan, a dict of names to numbers and texts.
    """

    problem: PushProblem
    trajectory: PushTrajectory
    pushing_angles: tuple
    segment_ends: tuple
    switches: tuple
    report: dict

    def verify(self):
        """
        Integrate the push anew, independently of how the plan was found.

        :return: ``push_planner.verification.Verification``.
        """
        return re_integrate(self)
