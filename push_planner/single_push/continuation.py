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
from push_planner.collocation.formulation import formulate_on, Formulation
from push_planner.collocation.interior_point import Iterate
from push_planner.collocation.mesh import build_mesh
from push_planner.collocation.push_solver import push_solver
from push_planner.collocation.resampling import Meshed, resample
from push_planner.initial_guess.dubins_routes import shortest_length
from push_planner.integration.refinement import RefinedPush
from push_planner.plan import Plan
from push_planner.problem import PushProblem
from push_planner.single_push.assembly import finish, SolvedPush
from push_planner.single_push.feasibility import check_feasibility

# Name of the route in reports.
ROUTE = 'previous plan'
# A push that is longer than a new route by this ratio is not gone on with. Chosen.
NEARLY_SHORTEST = 1.1
# Distance that counts as much as a radian of heading where the present pose is looked for on the
# previous path [m]. Chosen: the size of a pushed object.
HEADING_WEIGHT = 0.3
# Least path length that is worth going on with [m].
MIN_REST = 0.02
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

    :param problem: the ``PushProblem``.
    :param previous: ``Plan`` for nearly the same push.
    :return: ``Plan``; None where it takes more than to go on, as another contact, much shorter
        routes, or a solution that is not accepted.
    :raises PlanningFailed: where the problem is refused.
    """
    solved = previous.source
    if not isinstance(solved, SolvedPush) or not _is_alike(problem, previous.problem):
        return None
    check_feasibility(problem)
    resumed = _resume(problem, previous, solved)
    if resumed is None:
        return None
    formulation = resumed.formulation
    result = push_solver(formulation.dimensions).resume(formulation, resumed.iterate)
    if result.solution is None:
        return None
    path_length = result.solution.free_length + formulation.mesh.fixed_length
    shortest = shortest_length(problem, solved.turns, resumed.final_straight)
    if path_length > min(NEARLY_SHORTEST * shortest, problem.settings.max_path_length):
        return None
    plan, _ = finish(problem, formulation, result, solved.turns, resumed.refined)
    if plan is not None:
        plan.report.update(route=ROUTE, final_straight=resumed.final_straight,
                           attempts=[f'{ROUTE} of {path_length:.2f} m: solved'])
    return plan


def _is_alike(one: PushProblem, other: PushProblem) -> bool:
    """Whether two programs have the same rows."""
    return (one.kind == other.kind and one.contact.kind == other.contact.kind
            and one.contact.index == other.contact.index and one.settings == other.settings
            and len(one.obj.supports) == len(other.obj.supports)
            and has_heights(one.obj) == has_heights(other.obj))


def _resume(problem: PushProblem, previous: Plan, solved: SolvedPush) -> Optional[Resumed]:
    """Carry a solution over; None where next to nothing of the push is left."""
    former, program, refined = previous.problem, solved.formulation, solved.refined
    rotation, final_straight = refined.solution.nodes[-1, 2], previous.report['final_straight']
    if (problem.start, problem.normal, problem.heading, problem.motion) == (
            former.start, former.normal, former.heading, former.motion):
        formulation = formulate_on(problem, program.mesh, program.dimensions.straight_end,
                                   rotation)
        return Resumed(formulation, solved.iterate, final_straight, refined)
    free_length = refined.solution.free_length
    done = _path_done(previous, problem.start)
    rest = free_length + program.mesh.fixed_length - done
    if rest < MIN_REST:
        return None
    final_straight = min(final_straight, MAX_STRAIGHT_FRACTION * rest)
    mesh = build_mesh(problem, rest, final_straight)
    rotated = wrap_angle(problem.start.theta - former.start.theta)
    # The rotation so far may be more than pi.
    so_far = float(np.interp(done, np.append(0.0, np.cumsum(
        program.mesh.step_lengths(free_length))), refined.solution.nodes[:, 2]))
    rotated = so_far + wrap_angle(rotated - so_far)
    formulation = formulate_on(problem, mesh, program.dimensions.straight_end, rotation - rotated)
    frame = former.start.inverse() @ problem.start
    iterate = resample(
        solved.iterate, Meshed(program.dimensions, program.mesh, free_length),
        Meshed(formulation.dimensions, mesh, max(rest - mesh.fixed_length, 0.1 * rest)), done,
        Pose(frame.x, frame.y, rotated))
    return Resumed(formulation, iterate, final_straight, None)


def _path_done(previous: Plan, start: Pose) -> float:
    """Path length of the contact up to the pose of a plan that is nearest to the start [m]."""
    motion = previous.trajectory
    rotation = motion.object_poses[:, 2] - start.theta
    distance = np.hypot(*(motion.object_poses[:, :2] - np.array(start[:2])).T)
    nearest = int(np.argmin(distance + HEADING_WEIGHT * np.abs(wrap_angles(rotation))))
    speed = np.hypot(*motion.contact_twists[:nearest + 1, :2].T)
    steps = 0.5 * np.diff(motion.times[:nearest + 1]) * (speed[1:] + speed[:-1])
    return float(steps.sum())
