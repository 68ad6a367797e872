"""Pushes of the box under a control law while friction changes: simulated, and tabulated."""

import functools
import math
from typing import Any, Literal, NamedTuple, Sequence

from matplotlib.axes import Axes
import numpy as np
from push_control.settings import ControlSettings
from push_model.parameters import Contact, RoundRobot
from push_model.trajectory import PushTrajectory
from push_planner.problem import PlannerSettings
from push_scenario.definition.scenario import Placement, Scenario, Start
from push_scenario.evaluation.metrics import measure
from push_scenario.simulation.loop import simulate
from push_sim_node.disturbance import FrictionChange
from push_sim_node.sensors import SensorSettings
from push_sim_node.simulation import SimulationSettings
from push_sim_node.tape import Tape
from push_study.chapter3.setup import PATH_COLUMNS
from push_study.framework import plot_style
from push_study.framework.box import BOX, box, REAR_FACE
from push_study.framework.parameters import Parameter, Values
from push_study.framework.study import Table

Law = Literal['open_loop', 'feedback']
OPEN_LOOP: Law = 'open_loop'
FEEDBACK: Law = 'feedback'
LAWS: tuple[Law, Law] = (OPEN_LOOP, FEEDBACK)
LABELS: dict[Law, str] = {OPEN_LOOP: 'open loop', FEEDBACK: 'feedback'}
STYLES: dict[Law, dict[str, Any]] = {FEEDBACK: plot_style.series(0),
                                     OPEN_LOOP: plot_style.series(1)}
SETUP = (*BOX, Parameter('robot_radius', 'm', 'radius of the holonomic robot'),
         Parameter('speed', 'm/s', 'planned speed of the contact'),
         Parameter('rate', 'Hz', 'rate of odometry, and of commands'),
         Parameter('center_walk', 'm/sqrt(m)', 'random walk of the centre of friction over the '
                   'distance, as feedback assumes it'))
# Chosen: integration step of the simulation, an eighth of the period of commands [s].
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
        rho_rad (nan without contact) and speed_m_s (of the robot); until the controller ended the
        push.
    :param planned: the planned trajectory.
    :param position_error: of the box at rest [m].
    :param heading_error: likewise [rad].
    :param duration: until the controller ended the push [s].
    """

    path: Table
    planned: PushTrajectory
    position_error: float
    heading_error: float
    duration: float


def push(values: Values, goal: Sequence[float], law: Law,
         changes: Sequence[FrictionChange] = ()) -> ExecutedPush:
    """
    Push the box from the origin, at the middle of its rear face.

    Measurements are exact and without delay; only friction may differ from its nominal value.
    However far from the goal it ends, feedback takes no second approach, so that the results of
    one push are compared.

    :param values: with the parameters ``SETUP``.
    :param goal: (x, y, theta) [m, rad].
    :param law: control law.
    :param changes: of the friction, unknown to planner and controller.
    :return: the push.
    :raises ValueError: for a goal that cannot be reached.
    """
    obj, robot = box(values), RoundRobot(values.robot_radius, 'holonomic')
    return _simulate(Scenario(
        name='push', description='push of a study', object=obj, true_object=obj, robot=robot,
        true_robot=robot, start=Start(contact=Contact('face', REAR_FACE)), goal=Placement(*goal),
        planner=PlannerSettings(pushing_speed=values.speed),
        control=ControlSettings(control_law=law, center_walk=values.center_walk,
                                position_tolerance=NO_TOLERANCE, heading_tolerance=NO_TOLERANCE),
        sensors=SensorSettings(odometry_rate=values.rate), time_limit=TIME_LIMIT,
        simulation=SimulationSettings(step=STEP, friction_changes=tuple(changes))))


# The figures of a push share it. Chosen: more than the pushes of all studies.
@functools.lru_cache(maxsize=128)
def _simulate(scenario: Scenario) -> ExecutedPush:
    result = simulate(scenario)
    metrics = measure(result)
    if result.tape is None or result.plan is None or metrics is None:
        raise ValueError(f'goal: got {scenario.goal}, expected one that can be reached: '
                         f'{result.reason}')
    return ExecutedPush(_path(result.tape, result.duration), result.plan, metrics.position_error,
                        metrics.heading_error, result.duration)


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
    v_x, v_y, _ = planned.contact_twists.T
    speeds = np.hypot(v_x, v_y)
    distances = np.cumsum(0.5 * (speeds[1:] + speeds[:-1]) * np.diff(planned.times))
    angles = np.arctan2(v_y, v_x) - planned.contact_poses[:, 2]
    return {'time_s': planned.times, 'distance_m': np.concatenate([[0.0], distances]),
            'rho_rad': np.remainder(angles + math.pi, 2.0 * math.pi) - math.pi}


def draw_angle(axes: Axes, path: Table, over: str, law: Law) -> None:
    """
    Draw the pushing angle of a push.

    :param axes: to draw on.
    :param path: table of an ``ExecutedPush``.
    :param over: column that is the abscissa, distance_m or time_s.
    :param law: control law.
    """
    axes.plot(path[over], path['rho_rad'], label=LABELS[law], zorder=3.0, **STYLES[law])
    axes.set_ylabel('pushing angle $\\rho$ [rad]')
    axes.set_xlabel({'distance_m': DISTANCE_LABEL, 'time_s': 'time [s]'}[over])
