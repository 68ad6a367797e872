"""Sketch 2.5 of an analogy: a pushed object is a wheel on a hill, with friction as its weight."""

import math
from typing import NamedTuple

from matplotlib.axes import Axes
from matplotlib.figure import Figure
import numpy as np
from push_model.contact import rolling_constants
from push_model.geometry import Pose
from push_model.parameters import Contact, PushedObject, Support
from studies.analysis.pushing_location import pushing_location, PushingLocation
from studies.analysis.stability import equilibria
from studies.analysis.time_integration import integrate, straight_push
from studies.chapter2.sketches.push_instant import instant_at_rotation, Point, PushInstant
from studies.framework import plot_style, sketch
from studies.framework.parameters import Parameter, Values
from studies.framework.study import Finding, Outcome, RunJobs, Study

UP = 0.5 * math.pi
# Chosen: smooth curves; odd, so that rotation 0 is among the samples.
ROTATIONS = 401
TIMES = 60
# Chosen: support points near the rim, as a fraction of the radius.
SUPPORT_RADIUS = 0.9
PARAMETERS = (
    Parameter('robot_radius', 'm', 'radius of the robot'),
    Parameter('object_radius', 'm', 'radius of the round object'),
    Parameter('center_distance', 'm', 'centre of mass and of friction from the middle of the '
              'object'),
    Parameter('mass', 'kg', 'mass of the object'),
    Parameter('friction_coefficient', '', 'friction of every support point on the floor'),
    Parameter('speed', 'm/s', 'speed of the robot'),
    Parameter('initial_rotation', 'rad', 'rotation of the object from rest'),
    Parameter('duration', 's', 'duration of the push'),
    Parameter('max_rotation', 'rad', 'range of the rotation that is drawn'))


class Wheel(NamedTuple):
    """
    A round object and where it is pushed.

    :param obj: the object.
    :param location: in line with its centre of friction.
    """

    obj: PushedObject
    location: PushingLocation


def wheel(values: Values) -> Wheel:
    """
    Make the round object and find where it is pushed.

    :param values: with the parameters ``PARAMETERS``.
    :return: object and location.
    """
    radius = values.object_radius
    supports = tuple(Support(radius * x, radius * y, values.friction_coefficient)
                     for x, y in ((-SUPPORT_RADIUS, 0.0), (0.0, -SUPPORT_RADIUS),
                                  (SUPPORT_RADIUS, 0.0), (0.0, SUPPORT_RADIUS)))
    obj = PushedObject(values.mass, 0.0, supports, radius=radius,
                       center_of_mass=(-values.center_distance, 0.0))
    return Wheel(obj, pushing_location(obj, Contact('round', 0, math.pi), values.robot_radius))


def instant(values: Values, rotation: float) -> PushInstant:
    """
    Place the object on the robot, with the push upwards.

    :param values: with the parameters ``PARAMETERS``.
    :param rotation: of the object from rest [rad].
    :return: the instant, the robot at the origin.
    """
    return instant_at_rotation(*wheel(values), rotation, values.speed, heading=UP)


def compute(values: Values, _: RunJobs) -> Outcome:
    """Compute the height of the centre of friction over the rotation, and where a push ends."""
    rotations = np.linspace(-values.max_rotation, values.max_rotation, ROTATIONS)
    heights = np.array([instant(values, rotation).friction_center[1] for rotation in rotations])
    obj, location = wheel(values)
    start = instant(values, values.initial_rotation)
    rolling = rolling_constants(start.robot_radius, start.object_radius)
    times = np.linspace(0.0, values.duration, TIMES)
    times, states = integrate(obj, rolling, straight_push(0.0, values.speed), start.state, times)
    at_rest = instant(values, 0.0)
    pushed = states[:, 2] - at_rest.state.theta
    unstable = [abs(equilibrium.rotation) for equilibrium in equilibria(location)
                if not equilibrium.is_stable]
    findings = {
        'lowest': Finding(float(rotations[np.argmin(heights)]), 'rad',
                          'rotation at which F is lowest'),
        'final': Finding(float(pushed[-1]), 'rad', 'rotation at the end of the push'),
        'edge': Finding(min(unstable, default=math.inf), 'rad',
                        'rotation beyond which the object tips over'),
        'travel': Finding(rolling[1] * values.initial_rotation, 'm',
                          'travel of the contact, R_e theta')}
    return Outcome({'height': {'theta_rad': rotations, 'height_m': heights},
                    'push': {'time_s': times, 'theta_rad': pushed}}, findings)


def draw(figure: Figure, outcome: Outcome, values: Values) -> None:
    """Draw the object on the robot, steady on the left and disturbed on the right."""
    left, right = figure.subplots(1, 2, sharex=True, sharey=True)
    steady, now = instant(values, 0.0), instant(values, values.initial_rotation)
    for axes, drawn in ((left, steady), (right, now)):
        sketch.set_up(axes)
        sketch.pushed_object(axes, steady.obj, steady.pose, ghost=drawn is now)
        _draw_wheel(axes, drawn)
    _draw_rolled_arcs(right, steady, now)
    left.set_title('(a) steady', loc='left')
    right.set_title('(b) disturbed', loc='left')


def _draw_rolled_arcs(axes: Axes, steady: PushInstant, now: PushInstant) -> None:
    """Mark the arcs over which the contact has rolled, on the robot and on the object."""
    _draw_rolled_arc(axes, now.robot, now.robot_radius, steady.state.gamma, now.state.gamma)
    # Where the contact was on the object, before it has rolled away from there.
    old = Pose(0.0, 0.0, now.state.theta).rotate((steady.state.c_x, steady.state.c_y))
    _draw_rolled_arc(axes, now.pose[:2], now.object_radius, math.atan2(old[1], old[0]),
                     now.state.gamma + math.pi)
    sketch.label(axes, steady.contact, '$R_e \\theta$', 270.0, gap=14.0, color=sketch.FORCE)


def _draw_wheel(axes: Axes, now: PushInstant) -> None:
    sketch.pushed_object(axes, now.obj, now.pose)
    sketch.robot(axes, now.robot, now.robot_radius, (UP - 0.75, UP + 0.75))
    center = now.friction_center
    sketch.point(axes, now.contact, '$C$', 262.0, 12.0, sketch.FORCE)
    sketch.line(axes, now.pose[:2], center, color=plot_style.GREY, linewidth=0.8)
    sketch.arrow(axes, center, (0.0, -0.085), '$\\sum f_i$', sketch.FLOOR, at=0.75, side=270.0,
                 gap=17.0)
    sketch.point(axes, center, '$F$', 40.0, 10.0, sketch.FLOOR)
    top = now.pose.x, now.pose.y + now.object_radius
    sketch.arrow(axes, (top[0], top[1] + 0.02), (0.0, 0.13), '$v$', sketch.PUSH)


def _draw_rolled_arc(axes: Axes, center: Point, radius: float, start: float, end: float) -> None:
    angles = start + np.linspace(0.0, 1.0, 50) * math.remainder(end - start, 2.0 * math.pi)
    axes.plot(center[0] + radius * np.cos(angles), center[1] + radius * np.sin(angles),
              color=sketch.FORCE, linewidth=4.0, solid_capstyle='butt', zorder=2.5)


STUDIES = (Study(
    '2.5', 'The rolling wheel in (a) a steady and (b) a disturbed state', PARAMETERS,
    compute, draw,
    'The contact has rolled {travel:.2f} m along either edge (bold). The object rests at '
    '{final:.2f} rad, where F is lowest.',
    'Friction acts at F as weight does on a wheel; beyond {edge:.2f} rad the object tips '
    'over.', (7.6, 4.2)),)
