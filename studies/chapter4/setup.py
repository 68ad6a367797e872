"""Pushes of the box under a control law while friction changes: simulated, and tabulated."""

import dataclasses
import functools
import math
from typing import Any, Callable, Literal, NamedTuple, Sequence

from matplotlib.axes import Axes
import numpy as np
from push_control.settings import ControlSettings
from push_control.task.supervisor import Supervisor
from push_model.observation import Observation
from push_model.parameters import Contact, PushedObject, RoundRobot
from push_model.trajectory import PushTrajectory
from push_planner.problem import PlannerSettings
from push_scenario.definition.scenario import Placement, Scenario, Start
from push_scenario.evaluation.metrics import measure
from push_scenario.simulation.loop import (
    first_observation, make_simulation, run_robot, simulate,
)
from push_scenario.simulation.result import RunResult
from push_scenario.simulation.robot_control import RobotControl
from push_scenario.simulation.start import place_robot
from push_sim_node.disturbance import FrictionChange
from push_sim_node.sensors import SensorSettings
from push_sim_node.simulation import Simulation, SimulationSettings
from push_sim_node.tape import Tape
from studies.chapter3.setup import PATH_COLUMNS
from studies.chapter4.object_frame_input import (
    ObjectFrameInput, pushing_angles, travelled_distances)
from studies.chapter4.published_laws import DipoleLaw, ForceAngleLaw
from studies.chapter4.replanned_input import ReplannedInput
from studies.framework import plot_style
from studies.framework.box import BOX, box, REAR_FACE
from studies.framework.parameters import Parameter, Values
from studies.framework.study import Table

Law = Literal['open_loop', 'object_frame', 'replanned', 'feedback', 'own_path', 'kept_path', 'mpc',
              'no_jump_test', 'force_angle', 'dipole']
# The plan, played in the world and in the object's frame, and planned again all the time.
OPEN_LOOP: Law = 'open_loop'
OBJECT_FRAME: Law = 'object_frame'
REPLANNED: Law = 'replanned'
# Both laws on the planned path, with the default settings of the controller.
FEEDBACK: Law = 'feedback'
MPC: Law = 'mpc'
# The same feedback on a path of its own from the first step on; with a plan that it keeps; and
# with a filter that does not test for jumps of the centre of friction.
OWN_PATH: Law = 'own_path'
KEPT_PATH: Law = 'kept_path'
NO_JUMP_TEST: Law = 'no_jump_test'
# Of other authors.
FORCE_ANGLE: Law = 'force_angle'
DIPOLE: Law = 'dipole'
LABELS: dict[Law, str] = {
    OPEN_LOOP: 'open loop, in the world', OBJECT_FRAME: "open loop, in the object's frame",
    REPLANNED: 'planned every 0.5 s',
    FEEDBACK: 'feedback', MPC: 'mpc', OWN_PATH: 'feedback, path of its own',
    KEPT_PATH: 'feedback, threefold threshold',
    NO_JUMP_TEST: 'feedback, no test for jumps', FORCE_ANGLE: 'force angle', DIPOLE: 'dipole'}
STYLES: dict[Law, dict[str, Any]] = {
    FEEDBACK: plot_style.series(0), OPEN_LOOP: plot_style.series(1),
    OBJECT_FRAME: plot_style.series(3), MPC: plot_style.series(2),
    KEPT_PATH: plot_style.series(4), REPLANNED: plot_style.series(5),
    NO_JUMP_TEST: plot_style.series(6), FORCE_ANGLE: plot_style.series(7),
    DIPOLE: plot_style.series(8), OWN_PATH: plot_style.series(9)}
# Fields of ``ControlSettings`` that differ from their defaults. A path of its own is drawn as soon
# as there is any error, which is at once, and none after it.
CONTROL: dict[Law, dict[str, Any]] = {
    OPEN_LOOP: {'control_law': 'open_loop'}, FEEDBACK: {}, MPC: {'control_law': 'mpc'},
    OWN_PATH: {'replan_min_distance': 0.0, 'replan_lateral_error': 1e-3, 'replan_period': 60.0,
               'replan_length_ratio': 10.0},
    # Chosen: three times the defaults, more than the errors of the sensors amount to.
    KEPT_PATH: {'replan_lateral_error': 0.09, 'replan_heading_error': 0.15},
    # Chosen: more than the innovations of any push sum up to.
    NO_JUMP_TEST: {'jump_threshold': 1000.0}}
# What commands the robot in place of the controller.
MakeInput = Callable[[Scenario, Observation, Simulation], RobotControl]
INPUTS: dict[Law, MakeInput] = {OBJECT_FRAME: ObjectFrameInput, REPLANNED: ReplannedInput,
                                FORCE_ANGLE: ForceAngleLaw, DIPOLE: DipoleLaw}
# Errors of the sensors by name: those of benchmarks/controller/cases.py, or none.
SENSORS = {
    'benchmark': SensorSettings(
        pose_rate=20.0, pose_noise=2e-3, pose_heading_noise=math.radians(0.3), pose_latency=0.08,
        pose_drop_probability=0.05, odometry_scale_noise=0.02,
        odometry_heading_drift_noise=0.02),
    'exact': SensorSettings()}
SETUP = (*BOX, Parameter('robot_radius', 'm', 'radius of the holonomic robot'),
         Parameter('speed', 'm/s', 'planned speed of the contact'),
         Parameter('sensors', '', 'errors of the sensors: benchmark (noisy, late and lost poses, '
                   'odometry that drifts) or exact'))
# Chosen: integration step of the simulation, a quarter of the period of commands [s].
STEP = 5e-3
# Chosen: far longer than any of the pushes [s].
TIME_LIMIT = 120.0
# Chosen: tolerances so wide [m, rad] that feedback takes no second approach.
NO_TOLERANCE = 1.0
DISTANCE_LABEL = 'distance travelled by the contact [m]'


class ExecutedPush(NamedTuple):
    """
    One push, simulated to its end.

    :param path: table with the columns ``PATH_COLUMNS``, distance_m (travelled by the contact),
        rho_rad (nan without contact), speed_m_s (of the robot) and new_paths (drawn by feedback so
        far); until the controller ended the push.
    :param planned: the planned trajectory.
    :param position_error: of the object at rest [m].
    :param heading_error: likewise [rad].
    :param duration: until the controller ended the push [s].
    """

    path: Table
    planned: PushTrajectory
    position_error: float
    heading_error: float
    duration: float


def push(values: Values, goal: Sequence[float], law: Law,
         changes: Sequence[FrictionChange] = (), seed: int = 0) -> ExecutedPush:
    """
    Push the box from the origin, at the middle of its rear face.

    Only friction may differ from its nominal value. However far from the goal it ends, feedback
    takes no second approach, so that the results of one push are compared.

    :param values: with the parameters ``SETUP``.
    :param goal: (x, y, theta) [m, rad].
    :param law: control law.
    :param changes: of the friction, unknown to planner and controller.
    :param seed: of the errors of the sensors.
    :return: the push.
    :raises ValueError: for a goal that cannot be reached.
    """
    return simulated(PushSetup.of(values), goal, law, changes, seed)


@dataclasses.dataclass(frozen=True)
class PushSetup:
    """
    Object, robot and measurements of a push.

    :param object: the object.
    :param robot: the robot.
    :param speed: planned speed of the contact [m/s].
    :param sensors: one of ``SENSORS``.
    :param start: where robot and object stand at first.
    """

    object: PushedObject
    robot: RoundRobot
    speed: float
    sensors: str
    start: Start

    @classmethod
    def of(cls, values: Values) -> 'PushSetup':
        """
        Make that of the box, pushed at the middle of its rear face.

        :param values: with the parameters ``SETUP``.
        :return: the setup.
        """
        return cls(box(values), RoundRobot(values.robot_radius, 'holonomic'), values.speed,
                   values.sensors, Start(contact=Contact('face', REAR_FACE)))


def simulated(setup: PushSetup, goal: Sequence[float], law: Law,
              changes: Sequence[FrictionChange] = (), seed: int = 0) -> ExecutedPush:
    """
    Push any object from the origin; see ``push``.

    :param setup: what is pushed.
    :param goal: (x, y, theta) [m, rad].
    :param law: control law; ``OBJECT_FRAME`` takes a holonomic robot.
    :param changes: of the friction, unknown to planner and controller.
    :param seed: of the errors of the sensors.
    :return: the push.
    :raises ValueError: for a goal that cannot be reached, or sensors that are not known.
    """
    if setup.sensors not in SENSORS:
        raise ValueError(f'sensors: got {setup.sensors!r}, expected one of {", ".join(SENSORS)}')
    control = ControlSettings(position_tolerance=NO_TOLERANCE, heading_tolerance=NO_TOLERANCE,
                              **CONTROL.get(law, {}))
    return _simulate(Scenario(
        name='push', description='push of a study', object=setup.object,
        true_object=setup.object, robot=setup.robot, true_robot=setup.robot,
        start=setup.start, goal=Placement(*goal),
        planner=PlannerSettings(pushing_speed=setup.speed), control=control,
        sensors=SENSORS[setup.sensors], time_limit=TIME_LIMIT,
        simulation=SimulationSettings(step=STEP, seed=seed, friction_changes=tuple(changes))),
        INPUTS.get(law))


# The figures of a push share it. Chosen: more than the pushes that figures share.
@functools.lru_cache(maxsize=128)
def _simulate(scenario: Scenario, make_input: MakeInput | None) -> ExecutedPush:
    new_paths: list[tuple[float, int]] = [(0.0, 0)]

    def count_paths(simulation: Simulation, supervisor: Supervisor) -> None:
        new_paths.append((simulation.time, supervisor.status.push.path_replans))

    result = (simulate(scenario, intervene=count_paths) if make_input is None
              else _simulate_input(scenario, make_input))
    metrics = measure(result)
    if result.tape is None or result.plan is None or metrics is None:
        raise ValueError(f'goal: got {scenario.goal}, expected one that can be reached: '
                         f'{result.reason}')
    path = _path(result.tape, result.duration)
    times, counts = np.array(new_paths).T
    path['new_paths'] = counts[np.searchsorted(times, path['time_s'], side='right') - 1]
    return ExecutedPush(path, result.plan, metrics.position_error, metrics.heading_error,
                        result.duration)


def _simulate_input(scenario: Scenario, make_input: MakeInput) -> RunResult:
    """Simulate what is no law of the controller."""
    scenario = place_robot(scenario)
    simulation = make_simulation(scenario)
    observation = first_observation(simulation)
    return run_robot(simulation, make_input(scenario, observation, simulation), scenario,
                     observation)


def _path(tape: Tape, duration: float) -> Table:
    rows = tape['time'] <= duration
    contact = np.column_stack([tape['contact_x'], tape['contact_y'], tape['normal']])
    path: Table = dict(zip(PATH_COLUMNS, (tape['time'], *tape.poses('object').T, *contact.T)))
    steps = np.hypot(*np.diff(contact[:, :2], axis=0).T)
    path.update(distance_m=np.concatenate([[0.0], np.cumsum(steps)]),
                rho_rad=tape['pushing_angle'],
                speed_m_s=np.hypot(tape['robot_v_x'], tape['robot_v_y']))
    return {name: column[rows] for name, column in path.items()}


def planned_input(planned: PushTrajectory) -> Table:
    """
    Tabulate the planned pushing angle.

    :param planned: trajectory.
    :return: table with the columns time_s, distance_m and rho_rad.
    """
    return {'time_s': planned.times, 'distance_m': travelled_distances(planned),
            'rho_rad': pushing_angles(planned)}


def total_variation(path: Table, start: float = 0.0) -> float:
    """
    Sum up all changes of the pushing angle.

    :param path: table of an ``ExecutedPush``.
    :param start: time from which on they count [s].
    :return: sum [rad].
    """
    angles = path['rho_rad'][path['time_s'] >= start]
    return float(np.abs(np.diff(angles[np.isfinite(angles)])).sum())


def draw_angle(axes: Axes, path: Table, over: str, law: Law, **style: Any) -> None:
    """
    Draw the pushing angle of a push.

    :param axes: to draw on.
    :param path: table of an ``ExecutedPush``.
    :param over: column that is the abscissa, distance_m or time_s.
    :param law: control law.
    :param style: keywords of ``plot`` in place of the style of the law.
    """
    axes.plot(path[over], path['rho_rad'], label=LABELS[law], zorder=3.0,
              **(style or STYLES[law]))
    axes.set_ylabel('pushing angle $\\rho$ [rad]')
    axes.set_xlabel({'distance_m': DISTANCE_LABEL, 'time_s': 'time [s]'}[over])
