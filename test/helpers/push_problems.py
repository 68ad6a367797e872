"""Pushes that several planner tests ask for."""

import math
from typing import Any, Mapping

from helpers.objects import bin_, box
from push_model.geometry import Pose
from push_model.parameters import Contact, PushedObject, RoundRobot
from push_planner.problem import PlannerSettings, PushProblem
from push_planner.steered.plan import Plan
from push_planner.steered.planner import plan_push
import pytest

DIFFERENTIAL = RoundRobot(radius=0.17, drive='differential')
HOLONOMIC = RoundRobot(radius=0.17, drive='holonomic')
VERTEX, MIRRORED_VERTEX = Contact('vertex', 0), Contact('vertex', 3)
FACE = Contact('face', 3)
ROUND = Contact('round', 0, math.pi)
DIAGONAL = math.pi / 4


def vertex_problem(goal: Pose, robot: RoundRobot = DIFFERENTIAL, normal: float = 0.0,
                   heading: float = 0.0, obj: PushedObject | None = None,
                   start: Pose = Pose(0.0, 0.0, -DIAGONAL), **settings: Any) -> PushProblem:
    """
    Push a box at vertex 0; in the start pose's axes turned by 45 degrees, straight ahead is +x.

    :param goal: ``Pose`` in the world.
    :param normal: gamma - psi [rad].
    :param heading: phi - psi [rad].
    """
    ahead = start.theta + DIAGONAL
    return PushProblem(obj or box(), robot, VERTEX, start, ahead + normal, ahead + heading, goal,
                       PlannerSettings(**settings))


def face_problem(goal: Pose, robot: RoundRobot = HOLONOMIC, start: Pose = Pose(0.0, 0.0, 0.0),
                 offset: float = 0.0, **settings: Any) -> PushProblem:
    """Push a box at its face 3, whose normal is the object's +x axis."""
    return PushProblem(box(), robot, Contact('face', 3, offset), start, start.theta, start.theta,
                       goal, PlannerSettings(**settings))


def round_problem(goal: Pose, robot: RoundRobot = HOLONOMIC, start: Pose = Pose(0.0, 0.0, 0.0),
                  **settings: Any) -> PushProblem:
    """Push a bin along its +x axis."""
    return PushProblem(bin_(), robot, ROUND, start, start.theta, start.theta, goal,
                       PlannerSettings(**settings))


def plan_fixtures(problems: Mapping[str, PushProblem]) -> tuple[Any, Any]:
    """
    Make the fixtures ``plans``, all plans of a module, and ``answer``, one after the other.

    :param problems: name -> what is planned, once in the module.
    """
    @pytest.fixture(scope='module')
    def plans() -> dict[str, Plan]:
        return {name: plan_push(problem) for name, problem in problems.items()}

    @pytest.fixture(params=problems)
    def answer(request: pytest.FixtureRequest, plans: dict[str, Plan]) -> Plan:
        return plans[request.param]

    return plans, answer
