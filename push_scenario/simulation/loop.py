"""
Closed-loop simulation of a scenario in one process, without ROS.

The plant produces one measurement after the other. Each goes to the robot, whose command holds
until the next one; planning takes place in between. After the robot has ended the run, the loop
goes on until everything is at rest.
"""

from collections.abc import Callable
import math
from typing import NamedTuple

from push_control.steered.laws.own_law import check_own_law
from push_control.steered.laws.steering_law import SteeringLaw
from push_control.task.supervisor import Supervisor
from push_localization.localizer import LidarLocalizer
from push_localization.wall_field import WallField
from push_model.geometry import distance
from push_model.observation import Observation
from push_model.signals import LidarScan, ObjectPose, Odometry, RobotPlace
from push_planner.problem import PlanningFailed
from push_planner.task_planner import plan_for_request, PushPlanner
from push_safety.layer import SafetyLayer
from push_safety.protective_field import ProtectiveField
from push_scenario.definition.scenario import Scenario
from push_scenario.simulation.engines import plant_type_of
from push_scenario.simulation.result import Outcome, RunResult
from push_scenario.simulation.robot_control import Ending, make_robot_control, RobotControl
from push_scenario.simulation.start import place_robot
from push_sim_node.plant import Plant
from push_sim_node.simulation import Measurement, Simulation
from push_sim_node.truth import Truth

# What counts as rest: 0.1 mm in a second, chosen far below any motion of interest [m/s, rad/s].
REST_SPEED = 1e-4
REST_YAW_RATE = 1e-3
# Longest wait for rest, chosen above the braking time of the robots in config/robots [s].
SETTLE_TIME = 2.0
# Time from a plan request to its answer [s]: the 95th percentile of benchmarks/tasks on one core.
PLANNING_TIME = 0.1


class Progress(NamedTuple):
    """
    Progress of a run.

    :param stage: ``planning``, ``pushing`` or ``settling``; in a task, the supervisor's state in
        place of ``pushing``.
    :param time: simulated time [s].
    :param distance: from the object to its goal [m].
    """

    stage: str
    time: float
    distance: float


ProgressCallback = Callable[[Progress], None]
Intervention = Callable[[Simulation, Supervisor], None]


def simulate(scenario: Scenario, law: str | type[SteeringLaw] | None = None, *,
             seed: int | None = None, progress: ProgressCallback | None = None,
             intervene: Intervention | None = None, planning_time: float | None = None,
             plan_push: PushPlanner = plan_for_request,
             plant_type: Callable[..., Plant] | None = None) -> RunResult:
    """
    Simulate a scenario: one push, or as many as its task takes.

    :param law: as of ``Scenario.with_law``; None for that of the scenario.
    :param seed: as of ``Scenario.with_seed``; None for that of the scenario.
    :param progress: called with a ``Progress`` at every measurement.
    :param intervene: called before every measurement with the ``Simulation`` and the
        ``Supervisor``, to disturb the one or to redirect the other.
    :param planning_time: in a task, simulated time from a plan request to its answer [s]; None for
        what that usually takes. A single push is planned before time starts to run.
    :param plan_push: the ``PushPlanner`` that answers the plan requests of a task.
    :param plant_type: as of ``Simulation``; None for that of the scenario's engine.
    :raises ValueError: where there is no such law, a single push has a planner of one's own, or
        there is no site for the robot to start from.
    """
    if law is not None:
        scenario = scenario.with_law(law)
    if seed is not None:
        scenario = scenario.with_seed(seed)
    _check_own_parts(scenario, plan_push)
    scenario = place_robot(scenario)
    simulation = make_simulation(scenario, plant_type)
    if progress is not None:
        progress(Progress('planning', 0.0,
                          distance(scenario.start.object.pose, scenario.goal.pose)))
    observation = first_observation(simulation)
    try:
        robot = make_robot_control(scenario, observation,
                                   _planning_time(scenario, planning_time), plan_push)
    except PlanningFailed as failure:
        return RunResult(scenario, scenario.control.control_law, Outcome.REFUSED, failure.reason,
                         codes=(failure.code,))
    return run_robot(simulation, robot, scenario, observation, progress=progress,
                     intervene=intervene)


def run_robot(simulation: Simulation, robot: RobotControl, scenario: Scenario,
              observation: Observation, *, progress: ProgressCallback | None = None,
              intervene: Intervention | None = None,
              localizer: LidarLocalizer | None = None) -> RunResult:
    """
    Let a robot go on from now to the end of a scenario, until everything is at rest.

    :param simulation: that it acts in, from its present time on.
    :param robot: what runs on the robot.
    :param observation: its first measurements.
    :param progress: as of ``simulate``.
    :param intervene: as of ``simulate``.
    :param localizer: what finds the robot by scans already; None for what the scenario has.
    """
    start = simulation.time
    loop = ClosedLoop(simulation, robot, make_safety_layer(scenario), observation, progress,
                      localizer=localizer or make_localizer(scenario),
                      protective_field=make_protective_field(scenario))
    ending = loop.run(start + scenario.time_limit, intervene)
    end = simulation.time
    record = robot.record(ending, end)
    loop.settle()
    return RunResult(scenario, scenario.control.control_law, ending.outcome, ending.reason,
                     simulation.tape, end - start, codes=ending.codes, **record._asdict())


def _check_own_parts(scenario: Scenario, plan_push: PushPlanner) -> None:
    """Check law and planner now: a task may need either late, or never."""
    check_own_law(scenario.control)
    if scenario.task is None and plan_push is not plan_for_request:
        raise ValueError(f'plan_push: got {plan_push!r} for {scenario.name}, a single push, '
                         'expected a scenario with a task')


def _planning_time(scenario: Scenario, planning_time: float | None) -> float:
    if planning_time is not None:
        return planning_time
    return 0.0 if scenario.task is None else PLANNING_TIME


def make_safety_layer(scenario: Scenario) -> SafetyLayer:
    """Make what checks commands and odometry of the robot."""
    task = scenario.task
    is_absolute = task is not None and task.supervision.odometry_reference == 'absolute'
    return SafetyLayer(scenario.robot, scenario.object, is_odometry_absolute=is_absolute,
                       heading_count=scenario.control.heading_count,
                       standstill_limit=scenario.control.standstill_limit)


def make_simulation(scenario: Scenario,
                    plant_type: Callable[..., Plant] | None = None) -> Simulation:
    """
    Make the plant of a scenario, at time 0.

    :param plant_type: as of ``simulate``.
    """
    return Simulation(scenario.true_object, scenario.true_robot, scenario.start.object.pose,
                      scenario.robot_start, scenario.plant_settings, scenario.sensors,
                      plant_type=plant_type or plant_type_of(scenario))


def make_localizer(scenario: Scenario) -> LidarLocalizer | None:
    """Make what finds the robot in the map of a task by scans; None where nothing is to."""
    task = scenario.task
    if task is None or task.place.source != 'scan':
        return None
    localizer = LidarLocalizer(task.place, scenario.object)
    if task.map is not None:
        localizer.set_field(WallField(task.map.resolution, task.map.origin.pose, task.map.occupied,
                                      task.place.wall_offset))
    return localizer


def make_protective_field(scenario: Scenario) -> ProtectiveField | None:
    """Make what slows and stops the robot by scans; None where nothing is to."""
    task = scenario.task
    if task is None or task.place.source != 'scan' or task.place.slow_distance == 0.0:
        return None
    return ProtectiveField(task.place, scenario.robot.radius)


def is_at_rest(truth: Truth) -> bool:
    """
    Tell whether robot and object are at rest.

    :param truth: ``Truth`` of the plant.
    """
    return all(math.hypot(twist.v_x, twist.v_y) < REST_SPEED and abs(twist.omega) < REST_YAW_RATE
               for twist in (truth.object_twist, truth.robot_twist))


def first_observation(simulation: Simulation) -> Observation:
    """
    Wait for the first odometry; an object pose that is measured in the world comes before it.

    :param simulation: the ``Simulation``, at its start.
    """
    object_pose: ObjectPose | None = None
    while True:
        measurement = simulation.next_measurement()
        if isinstance(measurement, Odometry):
            return Observation(simulation.time, measurement, object_pose)
        if isinstance(measurement, ObjectPose):
            object_pose = measurement


class ClosedLoop:
    """Plant and robot: one command for every measurement."""

    def __init__(self, simulation: Simulation, robot: RobotControl, safety: SafetyLayer,
                 observation: Observation, report: ProgressCallback | None = None, *,
                 localizer: LidarLocalizer | None = None,
                 protective_field: ProtectiveField | None = None) -> None:
        """
        Answer the first measurements.

        :param robot: what runs on the robot.
        :param safety: ``SafetyLayer`` between the two.
        :param observation: the first measurements.
        :param report: called with a ``Progress`` at every measurement; None for nobody.
        :param localizer: ``LidarLocalizer`` that finds the robot by scans; None for none.
        :param protective_field: ``ProtectiveField`` that stops the robot by them; None for none.
        """
        self._localizer = localizer
        self._protective_field = protective_field
        if localizer is not None:
            localizer.add_odometry(observation.odometry)
        self._simulation = simulation
        self._robot = robot
        self._observation = observation
        self._report = report
        self._safety = safety
        self._step(0.0)

    @property
    def observation(self) -> Observation:
        """The newest ``Observation``."""
        return self._observation

    def run(self, time_limit: float, intervene: Intervention | None = None) -> Ending:
        """
        Go on until the robot ends the run, or time is up.

        :param time_limit: simulated time after which it is [s].
        :param intervene: called before every measurement; None for nobody.
        """
        start = self._observation.time
        while self._simulation.time < time_limit:
            ending = self._robot.update_plan(self._observation)
            if ending is not None:
                return ending
            if intervene is not None:
                intervene(self._simulation, self._robot.supervisor)
            self.advance()
        return Ending(Outcome.TIME_LIMIT, f'not done after {time_limit - start:g} s')

    def settle(self) -> None:
        """Go on until everything is at rest."""
        end = self._simulation.time + SETTLE_TIME
        rows = len(self._simulation.rows)
        while self._simulation.time < end:
            self.advance('settling')
            # The plant may stand still for an instant, so one row at rest is not enough.
            if is_at_rest(self._simulation.truth) and len(self._simulation.rows) > rows + 1:
                break

    def advance(self, stage: str | None = None) -> None:
        """
        Go on to the next measurement, and answer it.

        :param stage: what to report; None for what the robot does.
        """
        measurement = self._simulation.next_measurement()
        now, before = self._simulation.time, self._observation
        self._observation = self._observed(now, before, measurement)
        self._step(now - before.time)
        if self._report is not None:
            object_pose = self._simulation.plant.object_pose
            self._report(Progress(stage or self._robot.stage, now,
                                  distance(object_pose, self._robot.goal)))

    def _observed(self, now: float, before: Observation,
                  measurement: Measurement) -> Observation:
        """Add a measurement to what was observed before."""
        localizer = self._localizer
        if isinstance(measurement, ObjectPose):
            return before._replace(time=now, object_pose=measurement)
        if isinstance(measurement, Odometry):
            if localizer is not None:
                localizer.add_odometry(measurement)
            return before._replace(time=now, odometry=measurement,
                                   is_bumper_pressed=self._simulation.is_bumper_pressed)
        return before._replace(time=now, place=self._located(measurement) or before.place)

    def _located(self, scan: LidarScan) -> RobotPlace | None:
        """Find the robot by a scan, which comes after the odometry of its end."""
        localizer = self._localizer
        if localizer is None:
            return None
        localizer.add_scan(scan)
        return localizer.locate(self._observation.object_pose)

    def _step(self, dt: float) -> None:
        """Command the robot, through the safety layer."""
        robot = self._robot
        if self._localizer is not None and self._protective_field is not None:
            protection = self._protective_field.decide(self._localizer.unexplained,
                                                       self._observation.odometry)
            self._safety.speed_limit = protection.speed_limit
            robot.supervisor.protect(protection.report)
        self._simulation.command(self._safety.guard(
            self._observation, robot, lambda checked: robot.step(checked, dt)))
