"""Lower bound on the time of a push between two poses."""

import math

from push_model.geometry import wrap_angle
from push_planner.problem import PushProblem
from push_planner.steered.push_parameters import contact_frame

# Stands for no distance [m], so that ratios to the bound are finite.
NO_DISTANCE = 1e-9


def displacement_bound(problem: PushProblem) -> float:
    """
    Time that the followed point needs for its displacement at the pushing speed [s].

    It always holds. The followed point is the contact where it stays in place on the object, else
    the robot's centre. Where the heading is free, only the distance beyond that of the point from
    the object's origin counts, at both ends.
    """
    goal, speed = problem.relative_goal, problem.settings.pushing_speed
    x, y = _followed_point(problem, 0.0)
    if problem.settings.heading_free:
        offsets = 2.0 * math.hypot(x, y)
        return max(math.hypot(goal.x, goal.y) - offsets, NO_DISTANCE) / speed
    end_x, end_y = goal.transform(_followed_point(problem, wrap_angle(goal.theta)))
    return max(math.hypot(end_x - x, end_y - y), NO_DISTANCE) / speed


def _followed_point(problem: PushProblem, rotation: float) -> tuple[float, float]:
    """Followed point in the object frame after a rotation of the object, (x, y) [m]."""
    if problem.kind != 'rolling':
        return problem.contact_point
    delta, c_x, c_y = contact_frame(problem.push_parameters, rotation, 0.0)
    radius = problem.robot.radius
    return c_x - radius * math.cos(delta), c_y - radius * math.sin(delta)
