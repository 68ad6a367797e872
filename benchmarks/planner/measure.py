"""Figures of one plan: CPU time, errors in an open-loop simulation, duration over a bound."""

import math
import time
from typing import Callable, NamedTuple, Optional, Sequence, TypeVar

from benchmarks.planner.check import Replay, replay
from benchmarks.planner.goals import HEADING_TOLERANCE, POSITION_TOLERANCE
from push_model.geometry import distance
from push_planner.problem import PlanningFailed, PushProblem
from push_planner.steered.plan import Plan
from push_planner.steered.planner import plan_push
from tqdm import tqdm

Item = TypeVar('Item')
Result = TypeVar('Result')


class Answer(NamedTuple):
    """
    Figures of one plan.

    :param problem: the ``PushProblem``.
    :param cpu: CPU time of the plan [s].
    :param duration: of the push [s].
    :param bound: time that the contact's displacement takes [s].
    :param replay: ``Replay``, or None without a plan.
    :param fault: why it does not count as solved, or empty.
    """

    problem: PushProblem
    cpu: float
    duration: float = math.nan
    bound: float = math.nan
    replay: Optional[Replay] = None
    fault: str = ''


def collect(items: Sequence[Item], title: str, work: Callable[[Item], Result]) -> list[Result]:
    """Work on the items with a progress bar until done or stopped; return the results so far."""
    done: list[Result] = []
    try:
        for item in tqdm(items, desc=title):
            done.append(work(item))
    except KeyboardInterrupt:
        print(f'\n{title}: stopped after {len(done)} of {len(items)}')
    return done


def whole_plan(problem: PushProblem, previous: Plan | None = None) -> Plan:
    """
    Plan, and make also what is otherwise made when it is read: samples, switches and report.

    :param problem: the ``PushProblem``.
    :param previous: ``Plan`` to go on from, or None.
    :raises PlanningFailed: where there is no plan.
    """
    plan = plan_push(problem, previous)
    # Reading the report samples the motion.
    _ = plan.report
    return plan


def measure(problem: PushProblem) -> Answer:
    """Plan once, and simulate the plan in open loop."""
    began = time.process_time()
    try:
        plan = whole_plan(problem)
    except PlanningFailed as failure:
        return Answer(problem, time.process_time() - began, fault=str(failure))
    cpu = time.process_time() - began
    driven = replay(plan)
    return Answer(problem, cpu, plan.trajectory.duration, displacement_bound(problem), driven,
                  _fault(problem, driven))


def _fault(problem: PushProblem, driven: Replay) -> str:
    if not driven.position_error <= POSITION_TOLERANCE:
        return f'ends {1e3 * driven.position_error:.1f} mm off when driven'
    if not driven.heading_error <= HEADING_TOLERANCE:
        return f'ends {math.degrees(driven.heading_error):.2f} deg off when driven'
    if not driven.steepest <= problem.friction_angle:
        return 'leaves the friction cone when driven'
    return ''


def displacement_bound(problem: PushProblem) -> float:
    """Return the least time in which the push can get from its start to its goal [s]."""
    settings, c = problem.settings, problem.contact_point
    start, speed = problem.start.transform(c), settings.pushing_speed
    if problem.kind == 'rolling':
        # The contact travels on the object; the robot's centre ends somewhere about the goal.
        radius, extent = problem.robot.radius, max([problem.obj.radius, *(
            math.hypot(*corner) for corner in problem.obj.outline)])
        center = (start[0] - radius * math.cos(problem.normal),
                  start[1] - radius * math.sin(problem.normal))
        return max(0.0, distance(center, problem.goal) - extent - radius) / speed
    if settings.heading_free:
        return max(0.0, distance(start, problem.goal) - math.hypot(*c)) / speed
    return distance(start, problem.goal.transform(c)) / speed
