"""Pushes of the box under a control law while friction changes: run, and tabled."""

import functools
import math
from typing import NamedTuple

import numpy as np
from push_control.settings import ControlSettings
from push_model.parameters import Contact, RoundRobot
from push_planner.problem import PlannerSettings
from push_scenario.definition.scenario import Placement, Scenario, Start
from push_scenario.evaluation.metrics import measure
from push_scenario.simulation.loop import simulate
from push_sim_node.sensors import SensorSettings
from push_sim_node.simulation import SimulationSettings
from push_study.chapter3.scene import FACE, PATH
from push_study.framework import paper
from push_study.framework.scenes import BOX, box
from push_study.framework.study import Parameter

OPTIMISER, FEEDBACK = LAWS = 'open_loop', 'feedback'
LABELS = {OPTIMISER: 'optimiser', FEEDBACK: 'feedback'}
LOOKS = {law: paper.series(number) for number, law in enumerate((FEEDBACK, OPTIMISER))}
SCENE = (*BOX, Parameter('robot_radius', 'm', 'radius of the holonomic robot'),
         Parameter('speed', 'm/s', 'speed of the contact that is planned'),
         Parameter('rate', 'Hz', 'rate of odometry, and of commands'),
         Parameter('center_walk', 'm/sqrt(m)', 'random walk of the friction centre per way that '
                   'feedback reckons with'))
STEP, LONGEST, NEVER_OFF = 5e-3, 120.0, 1.0
ANGLE_LABEL = 'pushing angle $\\rho$ [rad]'


class Push(NamedTuple):
    """
    One push, played to its end.

    :param path: table with the columns of ``plan_scene.PATH``, way_m (of the contact), rho_rad
        (nan without contact) and speed_m_s (of the robot); until the controller ended the push.
    :param planned: the ``PushTrajectory`` that was planned.
    :param position_error: of the box at rest [m].
    :param heading_error: likewise [rad].
    :param duration: until the controller ended the push [s].
    """

    path: dict
    planned: object
    position_error: float
    heading_error: float
    duration: float


def push(values, goal, law, changes=()):
    """
    Push the box from the origin, at the middle of the face behind.

    Measurements are exact and of the present; only friction may be other than believed. However
    far off it ends, feedback takes no second approach, so that what one push leaves is compared.

    :param values: ``Values`` with the parameters ``SCENE``.
    :param goal: (x, y, theta) [m, rad].
    :param law: one of ``LAWS``.
    :param changes: tuple of ``FrictionChange``, not known to planner and controller.
    :return: ``Push``.
    """
    obj, robot = box(values), RoundRobot(values.robot_radius, 'holonomic')
    return _push(Scenario(
        name='push', description='push of a study', object=obj, true_object=obj, robot=robot,
        true_robot=robot, start=Start(contact=Contact('face', FACE)), goal=Placement(*goal),
        planner=PlannerSettings(pushing_speed=values.speed),
        control=ControlSettings(control_law=law, center_walk=values.center_walk,
                                position_tolerance=NEVER_OFF, heading_tolerance=NEVER_OFF),
        sensors=SensorSettings(odometry_rate=values.rate), time_limit=LONGEST,
        simulation=SimulationSettings(step=STEP, friction_changes=tuple(changes))))


@functools.lru_cache(maxsize=128)
def _push(scenario):
    result = simulate(scenario)
    if result.tape is None:
        raise ValueError(f'goal: got {scenario.goal}, expected one that can be reached: '
                         f'{result.reason}')
    judged = measure(result)
    return Push(_path(result), result.plan, judged.position_error, judged.heading_error,
                result.duration)


def _path(result):
    tape = result.tape
    rows = tape['time'] <= result.duration
    contact = np.column_stack([tape['contact_x'], tape['contact_y'], tape['normal']])
    path = dict(zip(PATH, (tape['time'], *tape.poses('object').T, *contact.T)))
    steps = np.hypot(*np.diff(contact[:, :2], axis=0).T)
    path.update(way_m=np.concatenate([[0.0], np.cumsum(steps)]), rho_rad=tape['pushing_angle'],
                speed_m_s=np.hypot(tape['robot_v_x'], tape['robot_v_y']))
    return {name: column[rows] for name, column in path.items()}


def planned_input(planned):
    """
    Table the pushing angle that was planned.

    :param planned: the ``PushTrajectory``.
    :return: table with the columns time_s, way_m, rho_rad.
    """
    v_x, v_y, _ = planned.contact_twists.T
    speeds = np.hypot(v_x, v_y)
    ways = np.cumsum(0.5 * (speeds[1:] + speeds[:-1]) * np.diff(planned.times))
    turned = np.arctan2(v_y, v_x) - planned.contact_poses[:, 2]
    return {'time_s': planned.times, 'way_m': np.concatenate([[0.0], ways]),
            'rho_rad': np.remainder(turned + math.pi, 2.0 * math.pi) - math.pi}


def draw_angle(axes, path, over, law):
    """
    Draw the pushing angle of a push.

    :param axes: matplotlib axes.
    :param path: table of a ``Push``.
    :param over: the column that it is drawn over.
    :param law: one of ``LAWS``.
    """
    axes.plot(path[over], path['rho_rad'], label=LABELS[law], zorder=3.0, **LOOKS[law])
    axes.set_ylabel(ANGLE_LABEL)
    axes.set_xlabel({'way_m': 'way of the contact [m]', 'time_s': 'time [s]'}[over])
