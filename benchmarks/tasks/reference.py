"""What tasks are compared with: the best single push as planned, and lower bounds."""

import math

from benchmarks.controller.tables import Job, Record
from benchmarks.tasks.bound import contact_path_bound, gap, least_time
from benchmarks.tasks.cases import draw
from push_model.plan_request import PlanRequest
from push_navigation.settings import DriveSettings
from push_planner.problem import PlanningFailed
from push_planner.steered.task_push import plan_steered_push

# Time of settling, touch and retreat of the single push [s]; chosen.
SWITCH_TIME = 5.0


def refer(job: Job) -> Record:
    """
    Compute what a task on open floor is compared with.

    :param job: keyword arguments of ``draw``.
    :return: dict of numbers: ``least`` [s] and ``least_distance`` [m], the bounds on time and on
        the robot's gap and contact path; ``single`` [s] and ``single_distance`` [m] of the
        fastest single push with its approach, infinite where there is none.
    """
    scenario = draw(**job).scenario
    start, goal = scenario.start.object.pose, scenario.goal.pose
    record: Record = {
        'least': least_time(scenario),
        'least_distance': gap(scenario) + contact_path_bound(scenario.true_object, start, goal),
        'single': math.inf, 'single_distance': math.inf}
    request = PlanRequest(start, scenario.robot_start, goal, scenario.object)
    try:
        plan = plan_steered_push(request, scenario.robot, scenario.planner, DriveSettings())
    except PlanningFailed:
        return record
    return {**record, 'single': SWITCH_TIME + plan.expected_time,
            'single_distance': plan.approach_path.length + plan.trajectory.path_length}
