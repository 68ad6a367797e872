"""
CPU time and cost of every law in the closed loop.

The pushes are those of ``cases.py``, in one process; the first step of a push, which builds its
tables, does not count.
"""

import math
import time
from typing import Any, Callable, Literal, NamedTuple, Optional, Sequence

from benchmarks.controller.cases import scenario, STRESSES, TIME_LIMIT
from benchmarks.controller.tables import spread, table, TO_DEGREES
import numpy as np
from push_control.settings import ControlSettings
from push_control.steered.controller import Controller
from push_control.steered.laws.closed_form import ClosedFormLaw
from push_control.steered.laws.mpc import HorizonWeights, optimal_weights, PredictiveLaw
from push_control.steered.laws.steering_law import SolverReport, SteeringInput, SteeringLaw
from push_control.steered.status import Phase
from push_model.geometry import distance, FloatArray
from push_model.observation import Observation
from push_model.parameters import PushedObject, RoundRobot
from push_model.signals import ObjectPose, Odometry
from push_model.trajectory import PushTrajectory
from push_planner.problem import PlanningFailed
from push_planner.steered.replanning import plan_from_measurements
from push_scenario.simulation.loop import make_simulation
from push_sim_node.simulation import Simulation

# Duration of plans above which a case is skipped [s]; chosen: longer ones add nothing.
MAX_TIMED = 25.0
STEERING: dict[str, Callable[[RoundRobot, ControlSettings], SteeringLaw]] = {
    'feedback': lambda _, settings: ClosedFormLaw(settings), 'mpc': PredictiveLaw}


class Timed(NamedTuple):
    """
    Figures of one push.

    :param phase: of the controller at the end.
    :param steps: CPU times of the controller's steps [s].
    :param laws: CPU times of the law within them [s].
    :param cost: of the horizon, integrated over the path length: weighted squared errors, and
        squared curvature relative to the path.
    :param error: (position [m], heading [rad]) of the object at the end.
    :param solver_failures: number of steps in which the closed-form law replaced a solver.
    """

    phase: Phase
    steps: list[float]
    laws: list[float]
    cost: float
    error: tuple[float, float]
    solver_failures: int


class InstrumentedLaw(SteeringLaw):
    """Wraps a law; records the CPU time of each step and sums up the cost."""

    def __init__(self, law: SteeringLaw, weights: HorizonWeights) -> None:
        """
        Wrap a law.

        :param law: such as ``ClosedFormLaw``.
        :param weights: as ``optimal_weights`` gives them.
        """
        self._law = law
        self._weights = weights
        self.times: list[float] = []
        self.cost = 0.0

    @property
    def solver(self) -> SolverReport:
        """Report of the law's solver."""
        return self._law.solver

    def reset(self) -> None:
        """Reset the law."""
        self._law.reset()

    def curvature(self, steering: SteeringInput) -> float:
        """
        Choose the curvature as the wrapped law does.

        :param steering: ``SteeringInput``.
        :return: curvature [1/m].
        """
        began = time.process_time()
        chosen = self._law.curvature(steering)
        self.times.append(time.process_time() - began)
        track = steering.projection
        lateral, heading, _ = self._weights
        self.cost += steering.distance * (
            lateral * track.lateral_error ** 2 + heading * track.heading_error ** 2
            + (steering.clip(chosen) - track.curvature) ** 2)
        return chosen


class InstrumentedController(Controller):
    """The controller under a given law."""

    def __init__(self, obj: PushedObject, robot: RoundRobot, settings: ControlSettings,
                 law: SteeringLaw) -> None:
        """
        Start idle.

        :param obj: nominal parameters of the object, a ``PushedObject``.
        :param robot: the ``RoundRobot``.
        :param settings: ``ControlSettings``.
        :param law: ``InstrumentedLaw``.
        """
        super().__init__(obj, robot, settings)
        self._law = law


def timed(kind: str, seed: int, name: str) -> Optional[Timed]:
    """
    Push one case.

    :param kind: one of ``KINDS`` in ``benchmarks.controller.cases``.
    :param seed: of the case.
    :param name: one of ``STEERING``.
    :return: ``Timed``, or None where there is no plan, or a long one.
    """
    try:
        case, plan = scenario(kind, seed, STRESSES[0])
        if plan.trajectory.duration > MAX_TIMED:
            return None
        simulation = make_simulation(case)
        pose, odometry = simulation.next_measurement(), simulation.next_measurement()
        if not (isinstance(pose, ObjectPose) and isinstance(odometry, Odometry)):
            raise RuntimeError(f'measurements: got {pose} and {odometry}, expected an object pose '
                               'and an odometry')
        target = plan_from_measurements(case.object, case.robot, pose, odometry, case.goal.pose,
                                        case.planner).plan.trajectory
    except PlanningFailed:
        return None
    law = InstrumentedLaw(STEERING[name](case.robot, case.control), optimal_weights(case.control))
    controller = InstrumentedController(case.object, case.robot, case.control, law)
    steps = _step_times(simulation, controller, target,
                        Observation(simulation.time, odometry, pose))
    status, truth = controller.status, simulation.truth.object_pose
    error = distance(truth, case.goal.pose), math.remainder(
        truth.theta - case.goal.pose.theta, 2.0 * math.pi)
    return Timed(status.phase, steps[1:], law.times[1:], law.cost, error, status.solver_failures)


def _step_times(simulation: Simulation, controller: Controller, target: PushTrajectory,
                observation: Observation) -> list[float]:
    """Push to the end; return the CPU times of the steps."""
    steps: list[float] = []
    dt = 0.0
    while simulation.time < TIME_LIMIT and not controller.status.phase.has_ended:
        began = time.process_time()
        command = controller.step(target, observation, dt)
        steps.append(time.process_time() - began)
        simulation.command(command)
        measured, before = simulation.next_measurement(), observation
        odometry, pose = before.odometry, before.object_pose
        if isinstance(measured, Odometry):
            odometry = measured
        elif isinstance(measured, ObjectPose):
            pose = measured
        observation = Observation(simulation.time, odometry, pose)
        dt = observation.time - before.time
    return steps


def step_table(runs: dict[str, list[Timed]]) -> str:
    """
    Write times, costs and errors.

    :param runs: name of the law -> list of ``Timed`` of the same cases.
    """
    rows: list[Sequence[Any]] = []
    for name, timed_runs in runs.items():
        position, heading = np.abs([run.error for run in timed_runs]).T
        rows.append((name, len(timed_runs), sum(len(run.steps) for run in timed_runs),
                     spread(cpu_times(timed_runs, 'steps'), '.3f', 99),
                     spread(cpu_times(timed_runs, 'laws'), '.3f', 99),
                     f'{sum(run.cost for run in timed_runs):.3f}', spread(1e3 * position),
                     spread(TO_DEGREES * heading),
                     sum(run.phase is Phase.DONE for run in timed_runs),
                     sum(run.solver_failures for run in timed_runs)))
    return table(['law', 'pushes', 'steps', 'CPU ms per step: median, p99',
                  'the law in it: median, p99', 'closed-loop cost, sum', 'mm median, p95',
                  'deg median, p95', 'done', 'solver failures'], rows)


def cpu_times(timed_runs: Sequence[Timed], name: Literal['steps', 'laws']) -> FloatArray:
    """Gather the CPU times of some pushes [ms], of whole steps or of the law alone."""
    return 1e3 * np.concatenate([getattr(run, name) for run in timed_runs])
