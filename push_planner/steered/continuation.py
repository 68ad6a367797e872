"""
Planning on: from a plan to that of nearly the same push, whose start or goal is another one.

The program of the former plan, its solution and its multipliers are carried over: moved into the
frame of the present start, cut off where the object is by now, and put on a mesh for the rest.
From there a few steps of Newton's method lead to the optimum, where that keeps to the same
route. The push is then refined and checked as any other.
"""

from typing import NamedTuple, Optional

import numpy as np
from push_model.friction import has_heights
from push_model.geometry import Pose, wrap_angle, wrap_angles
from push_planner.problem import PushProblem
from push_planner.steered.assembly import finish, SolvedPush
from push_planner.steered.collocation.formulation import (
    followed_point, formulate_on, Formulation, with_goal)
from push_planner.steered.collocation.interior_point import Iterate
from push_planner.steered.collocation.mesh import build_mesh
from push_planner.steered.collocation.push_solver import push_solver
from push_planner.steered.collocation.resampling import Meshed, resample
from push_planner.steered.feasibility import check_feasibility, check_goal
from push_planner.steered.initial_guess.dubins_routes import (
    shortest_length, straight_length, TurnPair)
from push_planner.steered.integration.refinement import RefinedPush
from push_planner.steered.integration.rollout import Rollout
from push_planner.steered.mesh_refinement import MeshSolution, refine_mesh
from push_planner.steered.plan import Plan

# Name of the route in reports.
ROUTE = 'previous plan'
# A push that is longer than a new route by this ratio is not gone on with. Chosen.
NEARLY_SHORTEST = 1.1
# Distance that counts as much as a radian of heading where the present pose is looked for on the
# previous path [m]. Chosen: the size of a pushed object.
HEADING_WEIGHT = 0.3
# Least path length that is worth going on with [m].
MIN_REMAINING = 0.02
# Largest fraction of the rest that its final straight may be. Chosen: a push that is off its path
# by now needs a length to steer back in.
MAX_STRAIGHT_FRACTION = 2.0 / 3.0


class Resumed(NamedTuple):
    """
    A program to go on with.

    :param formulation: ``Formulation``.
    :param iterate: ``Iterate`` to start from.
    :param final_straight: length of the straight push at its end [m].
    :param refined: ``RefinedPush`` on the same mesh; None where there is none.
    """

    formulation: Formulation
    iterate: Iterate
    final_straight: float
    refined: Optional[RefinedPush]


def plan_on(problem: PushProblem, previous: Plan) -> Optional[Plan]:
    """
    Plan on from a plan.

    :param previous: ``Plan`` for nearly the same push.
    :return: ``Plan``; None where it takes more than to go on, as another contact, much shorter
        routes, or a solution that is not accepted.
    :raises PlanningFailed: where the problem is refused.
    """
    solved = previous.motion
    if (not isinstance(solved, SolvedPush) or solved.formulation.dimensions.jumps
            or solved.iterate is None or not _is_alike(problem, previous.problem)):
        return None
    final_straight = previous.notes['final_straight']
    if _starts_alike(problem, solved.problem):
        check_goal(problem)
        resumed = _to_another_goal(problem, solved, solved.iterate, final_straight)
    else:
        check_feasibility(problem)
        resumed = _carried_over(problem, solved, solved.iterate, final_straight)
    if resumed is None:
        return None
    formulation = resumed.formulation
    # On the same mesh the iterate is as it was, its slacks included.
    result = push_solver(formulation.dimensions).resume(formulation, resumed.iterate,
                                                        resumed.refined is not None)
    if resumed.refined is None:
        formulation, result = refine_mesh(problem, MeshSolution(formulation, result))
    if result.solution is None:
        return None
    path_length = result.solution.free_length + formulation.mesh.fixed_length
    if path_length > problem.settings.max_path_length or not _is_nearly_shortest(
            problem, path_length, solved.turns, resumed.final_straight):
        return None
    push, _ = finish(problem, formulation, result, solved.turns, resumed.refined)
    return None if push is None else Plan(problem, push, {
        'iterations': result.iterations, 'route': ROUTE,
        'attempts': [f'{ROUTE} of {path_length:.2f} m: solved'],
        'final_straight': resumed.final_straight})


def _is_alike(one: PushProblem, other: PushProblem) -> bool:
    """Tell whether two programs have the same rows."""
    return (one.kind == other.kind and one.contact.kind == other.contact.kind
            and one.contact.index == other.contact.index and one.settings == other.settings
            and len(one.obj.supports) == len(other.obj.supports)
            and has_heights(one.obj) == has_heights(other.obj))


def _starts_alike(one: PushProblem, other: PushProblem) -> bool:
    """Tell whether two problems that are alike differ in the goal alone."""
    return (one.obj == other.obj and one.robot == other.robot and one.contact == other.contact
            and one.start == other.start and one.normal == other.normal
            and one.heading == other.heading and one.motion == other.motion)


def _is_nearly_shortest(problem: PushProblem, path_length: float, turns: TurnPair,
                        final_straight: float) -> bool:
    """Tell whether no route is much shorter, which mostly takes no route to tell."""
    return (path_length <= NEARLY_SHORTEST * straight_length(problem)
            or path_length <= NEARLY_SHORTEST * shortest_length(problem, turns, final_straight))


def _to_another_goal(problem: PushProblem, solved: SolvedPush, iterate: Iterate,
                     final_straight: float) -> Resumed:
    """Go on with a solution as it is."""
    refined = solved.refined
    rotation = float(refined.solution.nodes[-1, 2])
    return Resumed(with_goal(solved.formulation, problem, rotation), iterate, final_straight,
                   refined)


def _carried_over(problem: PushProblem, solved: SolvedPush, iterate: Iterate,
                  final_straight: float) -> Optional[Resumed]:
    """Carry a solution over to the rest; None where next to nothing of the push is left."""
    old, program, refined = solved.problem, solved.formulation, solved.refined
    rotation = refined.solution.nodes[-1, 2]
    free_length = refined.solution.free_length
    frame = old.start.inverse() @ problem.start
    done, turned = _progress(problem, refined.rollout, frame)
    remaining = free_length + program.mesh.fixed_length - done
    if remaining < MIN_REMAINING:
        return None
    final_straight = min(final_straight, MAX_STRAIGHT_FRACTION * remaining)
    mesh = build_mesh(problem, remaining, final_straight)
    # The rotation so far may be more than pi.
    rotated = turned + wrap_angle(frame.theta - turned)
    formulation = formulate_on(problem, mesh, program.dimensions.straight_end, rotation - rotated)
    resampled = resample(
        iterate, Meshed(program.dimensions, program.mesh, free_length),
        Meshed(formulation.dimensions, mesh, max(remaining - mesh.fixed_length, 0.1 * remaining)),
        done, Pose(frame.x, frame.y, rotated))
    return Resumed(formulation, resampled, final_straight, None)


def _progress(problem: PushProblem, rollout: Rollout, frame: Pose) -> tuple[float, float]:
    """
    Find where on a former path the present start is nearest.

    :param rollout: ``Rollout`` of the former push.
    :param frame: present start in the frame of the former one.
    :return: (path length of the contact [m], rotation of the object [rad]) up to there.
    """
    followed = np.array(frame.transform(followed_point(problem)))
    nodes = rollout.samples
    distance = np.hypot(*(nodes[:, 3:5] - followed).T)
    off = distance + HEADING_WEIGHT * np.abs(wrap_angles(nodes[:, 2] - frame.theta))
    nearest = int(np.argmin(off))
    return float(rollout.s[nearest]), float(nodes[nearest, 2])
