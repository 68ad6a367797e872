"""Sketches 2.18, 2.27 and 2.31 of the case studies: push at a corner, on a side, shifted load."""

import math
from typing import NamedTuple

from matplotlib.figure import Figure
from push_model.contact import face_normal
from push_model.friction import friction_center
from push_model.geometry import Pose
from push_model.parameters import Contact, PushedObject
from push_model.quasi_static import vehicle
from studies.analysis.pushing_location import PushingLocation
from studies.analysis.stability import Equilibrium, equilibrium_at
from studies.chapter2.corner_push.setup import push_direction, pushed_box, SHAPE
from studies.chapter2.side_push import setup as side_push
from studies.framework import plot_style, sketch
from studies.framework.box import BOX, box, FRICTION, MASS, REAR_FACE
from studies.framework.parameters import Parameter, Values
from studies.framework.study import Finding, Outcome, RunJobs, Study, Table
from studies.maps.perimeter import push_through_center

ORIGIN = Pose(0.0, 0.0, 0.0)
RADIUS = Parameter('robot_radius', 'm', 'radius of the robot, R_p')
OFFSET = Parameter('offset', 'm', 'contact to the left of the middle of the face')
DISTANCES = Parameter('distances', 'm', 'centre of friction ahead of the contact',
                      [0.05, 0.1, 0.15, 0.2])
MILLIMETRES = 1e3


def _points(**points: tuple[float, float]) -> dict[str, Table]:
    return {'points': {'point': list(points), 'x_m': [point[0] for point in points.values()],
                       'y_m': [point[1] for point in points.values()]}}


def compute_corner(values: Values, _: RunJobs) -> Outcome:
    """Compute the vehicle that is equivalent to a box pushed at a corner."""
    obj = pushed_box(values, values.mass, values.friction_coefficient)
    view = vehicle(obj, obj.outline[0])
    alpha = push_direction(values) - view.angle
    points = _points(C=view.contact_point, F=friction_center(obj), z=view.flat_output)
    return Outcome(points, {
        'alpha': Finding(math.degrees(alpha), 'deg', 'angle from the line C to F to the push'),
        'arm': Finding(view.arm, 'm', 'from the corner to the centre of friction, r'),
        'wheelbase': Finding(view.wheelbase, 'm', 'wheelbase of the vehicle, L')})


def draw_corner(figure: Figure, _: Outcome, values: Values) -> None:
    """Draw the box that is pushed at a corner."""
    axes = figure.subplots()
    sketch.set_up(axes)
    obj = pushed_box(values, values.mass, values.friction_coefficient)
    view, push = vehicle(obj, obj.outline[0]), push_direction(values)
    contact, center = view.contact_point, friction_center(obj)
    sketch.pushed_object(axes, obj, ORIGIN)
    robot = Pose(*contact, push).transform((-values.robot_radius, 0.0))
    sketch.robot(axes, robot, values.robot_radius)
    sketch.line(axes, contact, view.flat_output)
    sketch.arrow(axes, contact, sketch.polar(push, 0.75 * view.arm), '$v_C$', sketch.PUSH)
    sketch.angle(axes, contact, 0.55 * view.arm, (view.angle, push), '$\\alpha$')
    sketch.dimension(axes, contact, view.flat_output, '$L$', shift=0.06)
    sketch.point(axes, contact, '$C$', 205.0, 12.0, sketch.FORCE)
    sketch.mass_center(axes, center, '$G, F$', -45.0, 17.0)
    sketch.point(axes, view.flat_output, '$z$', -30.0, 10.0)


class SidePush(NamedTuple):
    """
    A push on a side of a box, through its centre of friction.

    :param obj: the box.
    :param location: where it is pushed.
    :param equilibrium: of that push.
    """

    obj: PushedObject
    location: PushingLocation
    equilibrium: Equilibrium


def push_on_side(values: Values) -> SidePush:
    """
    Find the push on the rear side of a box through its centre of friction.

    :param values: with the parameters ``BOX``, ``OFFSET`` and ``RADIUS``.
    :return: the push.
    """
    obj = box(values)
    contact = Contact('face', REAR_FACE, values.offset)
    location = push_through_center(obj, contact, values.robot_radius)
    return SidePush(obj, location, equilibrium_at(location, 0.0))


def compute_side(values: Values, _: RunJobs) -> Outcome:
    """Compute lengths and angles of a push on a side."""
    push = push_on_side(values)
    contact = -0.5 * values.box_length, values.offset
    robot = contact[0] - values.robot_radius, contact[1]
    return Outcome(_points(C=contact, P=robot, F=friction_center(push.obj)), {
        'arm': Finding(push.equilibrium.arm, 'm', 'from the contact to the centre of friction, h'),
        'rho': Finding(math.degrees(push.equilibrium.rho), 'deg', 'pushing angle rho through F'),
        'margin': Finding(push.equilibrium.margin, 'm', 'stability margin R_e cos(rho) - h')})


def draw_side(figure: Figure, outcome: Outcome, values: Values) -> None:
    """Draw the robot that pushes on a side."""
    axes = figure.subplots()
    sketch.set_up(axes)
    obj, _, equilibrium = push_on_side(values)
    table = outcome.tables['points']
    contact, robot, center = list(zip(table['x_m'], table['y_m']))
    sketch.pushed_object(axes, obj, ORIGIN)
    sketch.robot(axes, robot, values.robot_radius)
    normal = face_normal(obj, REAR_FACE)
    push = normal + equilibrium.rho
    sketch.arrow(axes, contact, (0.34, 0.0), '$n$')
    sketch.arrow(axes, robot, (contact[0] - robot[0], 0.0), '$R_p$', plot_style.GREY, at=0.5)
    sketch.arrow(axes, contact, sketch.polar(push, 0.36), '$v$', sketch.PUSH)
    sketch.angle(axes, contact, 0.29, (normal, push), '$\\rho$')
    sketch.dimension(axes, contact, center, '$h$', shift=-0.09, side=-1)
    sketch.point(axes, robot, '$P$', 180.0)
    sketch.point(axes, contact, '$C$', 130.0, 12.0, sketch.FORCE)
    sketch.point(axes, center, '$F$', 75.0, 11.0, sketch.FLOOR)


def compute_load(values: Values, _: RunJobs) -> Outcome:
    """Compute for each position of the centre of friction whether the push is stable."""
    margins = [values.robot_radius - distance for distance in values.distances]
    centers = [friction_center(side_push.shifted_box(values, distance))
               for distance in values.distances]
    stable = sum(margin > 0.0 for margin in margins)
    table = {'distance_m': list(values.distances), 'x_m': [center[0] for center in centers],
             'margin_m': margins}
    return Outcome({'centers': table}, {
        'radius': Finding(values.robot_radius, 'm', 'radius of the robot'),
        'stable': Finding(float(stable), '', 'number of stable positions of the centre of '
                          'friction')})


def draw_load(figure: Figure, outcome: Outcome, values: Values) -> None:
    """Draw the box with the positions of its centre of friction."""
    axes = figure.subplots()
    sketch.set_up(axes)
    table, edge = outcome.tables['centers'], -0.5 * values.box_length
    sketch.pushed_object(axes, side_push.shifted_box(values, values.distances[0]), ORIGIN)
    robot = edge - values.robot_radius, 0.0
    sketch.robot(axes, robot, values.robot_radius)
    sketch.arrow(axes, robot, (values.robot_radius, 0.0), '$R_p$', plot_style.GREY, at=0.5)
    sketch.dimension(axes, (edge, 0.0), (edge + values.robot_radius, 0.0), '$R_p$', shift=0.12)
    for x, distance, margin in zip(table['x_m'], table['distance_m'], table['margin_m']):
        color = plot_style.STABLE if margin > 0.0 else plot_style.UNSTABLE
        axes.plot(x, 0.0, 'o', markersize=7.0, color=color, zorder=4.0,
                  markerfacecolor=color if margin > 0.0 else 'white')
        sketch.label(axes, (x, 0.0), f'{MILLIMETRES * distance:.0f}', -90.0, gap=13.0,
                     color=color)
    sketch.label(axes, (edge + 0.125, 0.0), 'distance of $F$ from $C$ [mm]', -90.0, gap=30.0)
    sketch.point(axes, robot, '$P$', 180.0)
    sketch.point(axes, (edge, 0.0), '$C$', 130.0, 12.0, sketch.FORCE)


STUDIES = (
    Study('2.18', 'Case study 1: a box pushed at a corner', (*SHAPE, MASS, FRICTION, RADIUS),
          compute_corner, draw_corner,
          'The corner C moves at {alpha:.0f} degrees to the line to F, {arm:.2f} m away.',
          'The box is a vehicle with a wheelbase of {wheelbase:.2f} m, steered at C, with its '
          'fixed axle at z.',
          (6.4, 4.6)),
    Study('2.27', 'Case study 2: a round robot pushes a box on a side', (*BOX, RADIUS, OFFSET),
          compute_side, draw_side,
          'The push passes through the centre of friction F, {arm:.2f} m away, at {rho:.0f} '
          'degrees to the normal.',
          'R_p cos(rho) exceeds h by {margin:.2f} m, so a small rotation dies out.', (6.4, 4.2)),
    Study('2.31', 'Case study 3: robot and box positioned to perform a push',
          (DISTANCES, RADIUS, *BOX), compute_load, draw_load,
          'Of four positions of the centre of friction F, {stable:.0f} (filled) lie nearer to the '
          'contact C than R_p, {radius:.2f} m.',
          'A push on a flat side is stable there.', (6.4, 4.2)))
