"""Choose the pushes of a task yourself: the one after which the object is nearest to its goal."""

import math
from typing import Any

import numpy as np
from push_model import PlanFailure, PlanRequest, RoundRobot
from push_planner import PlanningFailed, straight_pushes, TaskPlan
from push_scenario import format_report, load_scenario, simulate

# A radian off counts as this distance [m]; and so many of the best pushes are tried.
ARM, TRIED = 0.2, 20


def greedy(request: PlanRequest, robot: RoundRobot, settings: Any, drive: Any,
           occupancy_map: Any = None, *, remaining: Any = None) -> TaskPlan:
    """Plan the push with the least expected error, to whose start the robot finds a path."""
    pushes = straight_pushes(request, robot, settings, drive, occupancy_map)
    x, y, theta = np.moveaxis(pushes.object_poses[:, 1:], -1, 0)  # without those of no length
    turn = np.abs(np.remainder(theta - request.goal.theta + math.pi, 2.0 * math.pi) - math.pi)
    errors = np.hypot(x - request.goal.x, y - request.goal.y) + ARM * turn
    for number in np.argsort(errors, axis=None)[:TRIED].tolist():
        index, step = divmod(number, errors.shape[1])
        try:
            return pushes.plan(index, float(pushes.lengths[step + 1]))
        except PlanningFailed:
            continue
    raise PlanningFailed(PlanFailure.NO_FEASIBLE_SITE, 'no good push can be reached')


def main() -> None:
    """Compare it with the planner of the package."""
    scenario = load_scenario('task_approach')
    print(format_report([simulate(scenario, plan_push=greedy), simulate(scenario)]))


if __name__ == '__main__':
    main()
