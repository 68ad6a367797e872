"""The planner's answer, which checks itself."""

import dataclasses

from push_model.trajectory import PushTrajectory
from push_planner.plan_file import read_plan, save_plan
from push_planner.problem import PushProblem
from push_planner.verification import re_integrate


@dataclasses.dataclass(frozen=True, eq=False)
class Plan:
    """
    A push that reaches its goal.

    :param problem: the ``PushProblem`` that it answers.
    :param trajectory: ``PushTrajectory`` in the world; twists are those after a switch.
    :param pushing_angles: pushing angle at the begin and the end of each piece, linear in the way
        of the contact between, from the normal to the velocity imposed at the contact [rad].
    :param segment_ends: way of the contact at the end of each piece, increasing [m].
    :param speeds: speed of the contact at the begin and the end of each piece; its square is
        linear in the way between [m/s].
    :param switches: ``Switch`` of every jump, the first touch included: the impulse it takes.
    :param report: what there is to know of the plan, a dict of names to numbers and texts.
    """

    problem: PushProblem
    trajectory: PushTrajectory
    pushing_angles: tuple
    segment_ends: tuple
    speeds: tuple
    switches: tuple
    report: dict

    def verify(self):
        """
        Integrate the push anew, independently of how the plan was found.

        :return: ``push_planner.verification.Verification``.
        """
        return re_integrate(self)

    def save(self, path):
        """
        Write the plan to a file.

        :param path: where, by convention ``*.npz``.
        """
        save_plan(self, path)

    @classmethod
    def load(cls, path):
        """
        Read a plan that ``save`` wrote.

        :param path: the file.
        :raises ValueError: where it is no plan.
        """
        return cls(**read_plan(path))
