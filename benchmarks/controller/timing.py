"""
CPU time of every law inside the closed loop, and what exact solutions of its problem would bring.

The pushes are those of ``controller_cases.py``, in one process; the first step of a push, which
builds its tables, does not count.
"""

import math
import time
from typing import NamedTuple

from benchmarks.controller.cases import LONGEST, scenario, STRESSES
from benchmarks.controller.converged import ConvergedLaw
from benchmarks.controller.tables import spread, table, TO_DEGREES
import numpy as np
from push_control.laws.closed_form import ClosedFormLaw
from push_control.laws.mpc import optimal_weights, PredictiveLaw
from push_control.laws.steering_law import SolverReport, SteeringInput, SteeringLaw
from push_control.observation import Observation
from push_control.push.controller import Controller
from push_control.push.status import Phase
from push_model.geometry import distance
from push_model.signals import Odometry
from push_planner.problem import PlanningFailed
from push_planner.single_push.replanning import plan_from_measurements
from push_scenario.simulation.loop import make_simulation

CONVERGED = 'converged ipopt'
LONGEST_TIMED = 25.0
STEERING = {'feedback': lambda _, settings: ClosedFormLaw(settings), 'mpc': PredictiveLaw,
            CONVERGED: ConvergedLaw}


class Timed(NamedTuple):
    """
    One push.

    :param phase: of the controller at the end.
    :param steps: CPU times of the controller's steps [s].
    :param laws: CPU times of the law within them [s].
    :param cost: of the horizon, squared errors and curvature beyond the path's, along the way.
    :param error: (position [m], heading [rad]) of the object at the end.
    :param troubles: number of times that the closed-form law stood in for a solver.
    """

    phase: Phase
    steps: list
    laws: list
    cost: float
    error: tuple
    troubles: int


class Watched(SteeringLaw):
    """A law whose time is taken and whose cost is added up."""

    def __init__(self, law, weights):
        """
        Watch a law.

        :param law: such as ``ClosedFormLaw``.
        :param weights: as ``optimal_weights`` gives them.
        """
        self._law, self._weights = law, weights
        self.times, self.cost = [], 0.0

    @property
    def solver(self) -> SolverReport:
        """Report of the law's solver."""
        return self._law.solver

    def reset(self) -> None:
        """Reset the law."""
        self._law.reset()

    def curvature(self, steering: SteeringInput) -> float:
        """
        Choose as the law does.

        :param steering: ``SteeringInput``.
        :return: curvature [1/m].
        """
        began = time.process_time()
        chosen = self._law.curvature(steering)
        self.times.append(time.process_time() - began)
        track, (lateral, heading, _) = steering.projection, self._weights
        self.cost += steering.distance * (
            lateral * track.lateral_error ** 2 + heading * track.heading_error ** 2
            + (steering.clip(chosen) - track.curvature) ** 2)
        return chosen


class WatchedController(Controller):
    """The controller with a law of the benchmark's."""

    def __init__(self, obj, robot, settings, law):
        """
        Stand idle.

        :param obj: the ``PushedObject`` as believed.
        :param robot: the ``RoundRobot``.
        :param settings: ``ControlSettings``.
        :param law: ``Watched``.
        """
        super().__init__(obj, robot, settings)
        self._law = law


def timed(kind, seed, name):
    """
    Push one case.

    :param kind: one of ``controller_cases.KINDS``.
    :param seed: of the case.
    :param name: one of ``STEERING``.
    :return: ``Timed``, or None where there is no plan, or one that takes long.
    """
    try:
        case, answer = scenario(kind, seed, STRESSES[0])
        if answer.trajectory.duration > LONGEST_TIMED:
            return None
        simulation = make_simulation(case)
        pose, odometry = simulation.next_measurement(), simulation.next_measurement()
        target = plan_from_measurements(case.object, case.robot, pose, odometry, case.goal.pose,
                                        case.planner).plan.trajectory
    except PlanningFailed:
        return None
    law = Watched(STEERING[name](case.robot, case.control), optimal_weights(case.control))
    controller = WatchedController(case.object, case.robot, case.control, law)
    steps = _pushed(simulation, controller, target, Observation(simulation.time, odometry, pose))
    status, truth = controller.status, simulation.truth.object_pose
    error = distance(truth, case.goal.pose), math.remainder(
        truth.theta - case.goal.pose.theta, 2.0 * math.pi)
    return Timed(status.phase, steps[1:], law.times[1:], law.cost, error, status.solver_failures)


def _pushed(simulation, controller, target, observation):
    """Push to the end; return the CPU times of the steps."""
    steps, dt = [], 0.0
    while simulation.time < LONGEST and not controller.status.phase.has_ended:
        began = time.process_time()
        command = controller.step(target, observation, dt)
        steps.append(time.process_time() - began)
        simulation.command(command)
        measured, before = simulation.next_measurement(), observation
        _, odometry, pose = before
        if isinstance(measured, Odometry):
            odometry = measured
        else:
            pose = measured
        observation = Observation(simulation.time, odometry, pose)
        dt = observation.time - before.time
    return steps


def step_table(runs):
    """
    Write times, costs and errors.

    :param runs: name of the law -> list of ``Timed`` of the same cases.
    """
    rows = []
    for name, found in runs.items():
        position, heading = np.abs([run.error for run in found]).T
        rows.append((name, len(found), sum(len(run.steps) for run in found),
                     spread(pooled(found, 'steps'), '.3f', 99),
                     spread(pooled(found, 'laws'), '.3f', 99),
                     f'{sum(run.cost for run in found):.3f}', spread(1e3 * position),
                     spread(TO_DEGREES * heading),
                     sum(run.phase is Phase.DONE for run in found),
                     sum(run.troubles for run in found)))
    return table(['law', 'pushes', 'steps', 'CPU ms per step: median, p99',
                  'the law in it: median, p99', 'closed-loop cost, sum', 'mm median, p95',
                  'deg median, p95', 'done', 'solver failures'], rows)


def pooled(found, name):
    """Gather the CPU times of some pushes [ms], 'steps' or 'laws'."""
    return 1e3 * np.concatenate([getattr(run, name) for run in found])
