"""
What tasks are compared with: the best single push as planned, and lower bounds.

They depend on the task alone, so that they are computed once and serve every method.
"""

import dataclasses
import math

from benchmarks.controller.tables import Job, Record
from benchmarks.tasks.bound import contact_path_bound, gap, least_time
from benchmarks.tasks.cases import draw, SEQUENCES, with_method
import numpy as np
from push_planner.problem import PlanningFailed
from push_planner.sequence.planner import plan_task
from push_planner.settings import TaskSettings


def refer(job: Job) -> Record:
    """
    Compute what a task on open floor is compared with.

    :param job: keyword arguments of ``draw``.
    :return: dict of numbers: ``least`` [s] and ``least_distance`` [m], the bounds on time and on
        the robot's gap and contact path; ``single`` [s] and ``single_distance`` [m] of the
        fastest single push with its approach, infinite where there is none.
    """
    scenario = with_method(draw(**job), SEQUENCES).scenario
    start, goal = scenario.start.object.pose, scenario.goal.pose
    record: Record = {
        'least': least_time(scenario),
        'least_distance': gap(scenario) + contact_path_bound(scenario.true_object, start, goal),
        'single': math.inf, 'single_distance': math.inf}
    planning = TaskSettings() if scenario.task is None else scenario.task.planning
    try:
        found = plan_task(scenario.object, scenario.robot, start, scenario.robot_start, goal,
                          scenario.planner, task=dataclasses.replace(planning, max_pushes=1))
    except PlanningFailed:
        return record
    poses = found.trajectory.robot_poses
    pushed = float(np.hypot(*np.diff(poses[:, :2], axis=0).T).sum())
    return {**record, 'single': found.single_push_time,
            'single_distance': found.approach_path.length + pushed}
