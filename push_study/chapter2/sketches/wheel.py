"""Sketch of the analogy: a pushed object is a wheel on a hill, friction its weight."""

import math

import numpy as np
from push_model.analysis.pushing_location import pushing_location
from push_model.analysis.stability import equilibria
from push_model.analysis.time_integration import integrate, straight_push
from push_model.contact import rolling_constants
from push_model.geometry import Pose
from push_model.parameters import Contact, PushedObject, Support
from push_study.chapter2.sketches.push_instant import at_turn
from push_study.framework import paper, sketch, sketch_body
from push_study.framework.study import Finding, Outcome, Parameter, Study

UP, SAMPLES = 0.5 * math.pi, 401
PARAMETERS = (
    Parameter('robot_radius', 'm', 'radius of the robot'),
    Parameter('object_radius', 'm', 'radius of the round object'),
    Parameter('center_distance', 'm', 'mass and friction centre from the middle of the object'),
    Parameter('mass', 'kg', 'mass of the object'),
    Parameter('friction_coefficient', '', 'friction of every support on the floor'),
    Parameter('speed', 'm/s', 'of the robot'),
    Parameter('start_turn', 'rad', 'turn of the object from rest'),
    Parameter('duration', 's', 'of the push'),
    Parameter('largest_turn', 'rad', 'range of the turn that is drawn'))


def wheel(values):
    """
    Make the round object and find where it is pushed.

    :param values: ``Values``.
    :return: (``PushedObject``, ``PushingLocation``), in line with the friction centre.
    """
    radius = values.object_radius
    feet = tuple(Support(radius * x, radius * y, values.friction_coefficient)
                 for x, y in ((-0.9, 0.0), (0.0, -0.9), (0.9, 0.0), (0.0, 0.9)))
    obj = PushedObject(values.mass, 0.0, feet, radius=radius,
                       center_of_mass=(-values.center_distance, 0.0))
    return obj, pushing_location(obj, Contact('round', 0, math.pi), values.robot_radius)


def placed(values, turn):
    """
    Place the object on the robot, the push upwards.

    :param values: ``Values``.
    :param turn: of the object from rest [rad].
    :return: ``PushInstant``, the robot at the origin.
    """
    return at_turn(*wheel(values), turn, values.speed, heading=UP)


def compute(values, batch):
    """
    Compute the height of the friction centre over the turn, and where a push ends.

    :param values: ``Values``.
    :param batch: not used.
    :return: ``Outcome``.
    """
    turns = np.linspace(-values.largest_turn, values.largest_turn, SAMPLES)
    heights = np.array([placed(values, turn).friction_centre[1] for turn in turns])
    obj, location = wheel(values)
    start = placed(values, values.start_turn)
    rolling = rolling_constants(start.robot_radius, start.object_radius)
    times = np.linspace(0.0, values.duration, 60)
    times, states = integrate(obj, rolling, straight_push(0.0, values.speed), start.state, times)
    first = placed(values, 0.0)
    swung = states[:, 2] - first.state.theta
    edges = [abs(one.rotation) for one in equilibria(location) if not one.is_stable]
    findings = {
        'lowest': Finding(float(turns[np.argmin(heights)]), 'rad', 'turn where F is lowest'),
        'settled': Finding(float(swung[-1]), 'rad', 'turn at the end of the push'),
        'edge': Finding(min(edges, default=math.inf), 'rad', 'turn beyond which it tips over'),
        'way': Finding(rolling[1] * values.start_turn, 'm', 'way of the contact, R_e theta')}
    return Outcome({'height': {'theta_rad': turns, 'height_m': heights},
                    'push': {'time_s': times, 'theta_rad': swung}}, findings)


def draw(figure, outcome, values):
    """
    Draw the object on the robot, and the height of its friction centre.

    :param figure: matplotlib figure.
    :param outcome: the ``Outcome``.
    :param values: ``Values``.
    """
    left, right = figure.subplots(1, 2, width_ratios=(1.0, 1.1))
    _draw_wheel(left, placed(values, 0.0), placed(values, values.start_turn))
    table, push = outcome.tables['height'], outcome.tables['push']
    right.plot(table['theta_rad'], table['height_m'], **paper.series(0))
    for index, name, side in ((0, 'start', 0.0), (-1, 'end', 270.0)):
        turn = push['theta_rad'][index]
        at = turn, np.interp(turn, table['theta_rad'], table['height_m'])
        sketch_body.point(right, at, name, side, 11.0 + 9.0 * (side == 0.0), sketch.FLOOR)
    right.set_xlabel('turn of the object $\\theta$ [rad]')
    right.set_ylabel('$F$ ahead of the robot centre $P$ [m]')
    right.margins(y=0.15)


def _draw_wheel(axes, rest, now):
    sketch.sheet(axes)
    sketch_body.solid(axes, rest.obj, rest.pose, ghost=True)
    sketch_body.solid(axes, now.obj, now.pose)
    span = 0.75
    sketch_body.disc(axes, now.robot, now.robot_radius, (UP - span, UP + span))
    _rolled(axes, now.robot, now.robot_radius, rest.state.gamma, now.state.gamma)
    # Where the contact was, on the object: it has rolled away from there.
    old = Pose(0.0, 0.0, now.state.theta).rotate((rest.state.c_x, rest.state.c_y))
    _rolled(axes, now.pose[:2], now.object_radius, math.atan2(old[1], old[0]),
            now.state.gamma + math.pi)
    at, center = now.contact, now.friction_centre
    sketch_body.point(axes, at, '$C$', 262.0, 12.0, sketch.FORCE)
    sketch.label(axes, rest.contact, '$R_e \\theta$', 270.0, 14.0, sketch.FORCE)
    sketch.line(axes, now.pose[:2], center, color=paper.GREY, linewidth=0.8)
    sketch.arrow(axes, center, (0.0, -0.13), '$\\sum f_i$', sketch.FLOOR, 0.45, 270.0,
                 14.0)
    sketch_body.point(axes, center, '$F$', 40.0, 10.0, sketch.FLOOR)
    top = now.pose.x, now.pose.y + now.object_radius
    sketch.arrow(axes, (top[0], top[1] + 0.02), (0.0, 0.13), '$v$', sketch.PUSH)


def _rolled(axes, center, radius, start, end):
    turns = start + np.linspace(0.0, 1.0, 50) * math.remainder(end - start, 2.0 * math.pi)
    axes.plot(center[0] + radius * np.cos(turns), center[1] + radius * np.sin(turns),
              color=sketch.FORCE, linewidth=4.0, solid_capstyle='butt', zorder=2.5)


STUDIES = (Study(
    '2.5', 'The rolling-wheel analogy', PARAMETERS, compute, draw,
    'The contact has rolled {way:.2f} m along either edge (bold); pushed on, the object comes to '
    'rest at {settled:.2f} rad, where its friction centre F lies lowest.',
    'Friction acts at F against the push, as weight acts on a wheel on a hill; beyond '
    '{edge:.2f} rad the hill falls away and the object tips over.', (7.6, 4.2)),)
