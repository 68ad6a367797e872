"""Sketches of the case studies: a box pushed at a corner, on a side, and ahead of its load."""

import math

from push_model.analysis.stability import equilibrium_at
from push_model.contact import face_normal
from push_model.friction import friction_center
from push_model.geometry import Pose
from push_model.parameters import Contact
from push_model.quasi_static import vehicle
from push_study.chapter2.corner_push.scene import FRICTION, MASS, push_direction, pushed_box, SHAPE
from push_study.chapter2.side_push import scene as side_push
from push_study.framework import paper, scenes, sketch, sketch_body
from push_study.framework.study import Finding, Outcome, Parameter, Study
from push_study.maps.perimeter import push_through_center

ORIGIN = Pose(0.0, 0.0, 0.0)
RADIUS = Parameter('robot_radius', 'm', 'radius of the robot, R_p')


def _places(**places):
    return {'places': {'place': list(places), 'x_m': [place[0] for place in places.values()],
                       'y_m': [place[1] for place in places.values()]}}


def compute_corner(values, batch):
    """
    Compute the vehicle view of a box that is pushed at a corner.

    :param values: ``Values``.
    :param batch: not used.
    :return: ``Outcome``.
    """
    obj = pushed_box(values, values.mass, values.friction_coefficient)
    view = vehicle(obj, obj.outline[0])
    alpha = push_direction(values) - view.angle
    return Outcome(_places(C=view.contact_point, F=friction_center(obj), z=view.flat_output), {
        'alpha': Finding(math.degrees(alpha), 'deg', 'angle from the line C to F to the push'),
        'arm': Finding(view.arm, 'm', 'from the corner to the friction centre, r'),
        'wheelbase': Finding(view.wheelbase, 'm', 'wheelbase of the vehicle, L')})


def draw_corner(figure, outcome, values):
    """
    Draw the box that is pushed at a corner.

    :param figure: matplotlib figure.
    :param outcome: the ``Outcome``.
    :param values: ``Values``.
    """
    axes = figure.subplots()
    sketch.sheet(axes)
    obj = pushed_box(values, values.mass, values.friction_coefficient)
    view, push = vehicle(obj, obj.outline[0]), push_direction(values)
    at, center = view.contact_point, friction_center(obj)
    sketch_body.solid(axes, obj, ORIGIN)
    back = Pose(*at, push).transform((-values.robot_radius, 0.0))
    sketch_body.disc(axes, back, values.robot_radius)
    sketch.line(axes, at, view.flat_output)
    length = 0.75 * view.arm
    sketch.arrow(axes, at, (length * math.cos(push), length * math.sin(push)), '$v_C$',
                 sketch.PUSH)
    sketch.angle(axes, at, 0.55 * view.arm, view.angle, push, '$\\alpha$')
    sketch.dimension(axes, at, view.flat_output, '$L$', 0.06)
    sketch_body.point(axes, at, '$C$', 205.0, 12.0, sketch.FORCE)
    sketch_body.mass_centre(axes, center, '$G, F$', -45.0, 17.0)
    sketch_body.point(axes, view.flat_output, '$z$', -30.0, 10.0)


def on_side(values):
    """
    Find the push on a side of a box, through its friction centre.

    :param values: ``Values``.
    :return: (``PushedObject``, ``PushingLocation``, its ``Equilibrium``).
    """
    obj = scenes.box(values)
    location = push_through_center(obj, Contact('face', 3, values.offset), values.robot_radius)
    return obj, location, equilibrium_at(location, 0.0)


def compute_side(values, batch):
    """
    Compute lengths and angles of a push on a side.

    :param values: ``Values``.
    :param batch: not used.
    :return: ``Outcome``.
    """
    obj, _, rest = on_side(values)
    at = -0.5 * values.box_length, values.offset
    robot = at[0] - values.robot_radius, at[1]
    return Outcome(_places(C=at, P=robot, F=friction_center(obj)), {
        'arm': Finding(rest.arm, 'm', 'from the contact to the friction centre, h'),
        'rho': Finding(math.degrees(rest.rho), 'deg', 'pushing angle rho through F'),
        'margin': Finding(rest.margin, 'm', 'stability margin R_e cos(rho) - h')})


def draw_side(figure, outcome, values):
    """
    Draw the robot that pushes on a side.

    :param figure: matplotlib figure.
    :param outcome: the ``Outcome``.
    :param values: ``Values``.
    """
    axes = figure.subplots()
    sketch.sheet(axes)
    obj, location, rest = on_side(values)
    table = outcome.tables['places']
    at, robot, center = list(zip(table['x_m'], table['y_m']))
    sketch_body.solid(axes, obj, ORIGIN)
    sketch_body.disc(axes, robot, values.robot_radius)
    normal = face_normal(obj, 3)
    push = normal + rest.rho
    sketch.arrow(axes, at, (0.34, 0.0), '$n$')
    sketch.arrow(axes, robot, (at[0] - robot[0], 0.0), '$R_p$', paper.GREY, 0.5)
    sketch.arrow(axes, at, (0.36 * math.cos(push), 0.36 * math.sin(push)), '$v$', sketch.PUSH)
    sketch.angle(axes, at, 0.29, normal, push, '$\\rho$', gap=9.0)
    sketch.dimension(axes, at, center, '$h$', -0.09, -1)
    sketch_body.point(axes, robot, '$P$', 180.0)
    sketch_body.point(axes, at, '$C$', 130.0, 12.0, sketch.FORCE)
    sketch_body.point(axes, center, '$F$', 75.0, 11.0, sketch.FLOOR)


def compute_load(values, batch):
    """
    Tell for each distance of the friction centre whether the push is stable.

    :param values: ``Values``.
    :param batch: not used.
    :return: ``Outcome``.
    """
    margins = [values.robot_radius - distance for distance in values.distances]
    centers = [friction_center(side_push.box(values, distance)) for distance in values.distances]
    return Outcome({'centres': {'distance_m': list(values.distances),
                                'x_m': [center[0] for center in centers],
                                'margin_m': margins}}, {
        'radius': Finding(values.robot_radius, 'm', 'radius of the robot'),
        'stable': Finding(float(sum(margin > 0.0 for margin in margins)), '',
                          'number of stable places of the friction centre')})


def draw_load(figure, outcome, values):
    """
    Draw the box with the places of its friction centre.

    :param figure: matplotlib figure.
    :param outcome: the ``Outcome``.
    :param values: ``Values``.
    """
    axes = figure.subplots()
    sketch.sheet(axes)
    table, edge = outcome.tables['centres'], -0.5 * values.box_length
    sketch_body.solid(axes, side_push.box(values, values.distances[0]), ORIGIN)
    robot = edge - values.robot_radius, 0.0
    sketch_body.disc(axes, robot, values.robot_radius)
    sketch.arrow(axes, (robot[0], 0.0), (values.robot_radius, 0.0), '$R_p$', paper.GREY, 0.5)
    sketch.dimension(axes, (edge, 0.0), (edge + values.robot_radius, 0.0), '$R_p$', 0.12)
    for x, distance, margin in zip(table['x_m'], table['distance_m'], table['margin_m']):
        color = paper.STABLE if margin > 0.0 else paper.UNSTABLE
        axes.plot(x, 0.0, 'o', markersize=7.0, color=color, zorder=4.0,
                  markerfacecolor=color if margin > 0.0 else 'white')
        sketch.label(axes, (x, 0.0), f'{1e3 * distance:.0f}', -90.0, 13.0, color)
    sketch.label(axes, (edge + 0.125, 0.0), 'distance of $F$ from $C$ [mm]', -90.0, 30.0)
    sketch_body.point(axes, robot, '$P$', 180.0)
    sketch_body.point(axes, (edge, 0.0), '$C$', 130.0, 12.0, sketch.FORCE)


STUDIES = (
    Study('2.18', 'Case study 1: a box pushed at a corner', SHAPE + (MASS, FRICTION, RADIUS),
          compute_corner, draw_corner,
          'The corner C moves at a constant angle of {alpha:.0f} degrees to the line from C to '
          'the friction centre F, {arm:.2f} m away.',
          'Seen as a vehicle with C as its steered axle and the point z, which never moves '
          'sideways, as its other axle, the box has a wheelbase of {wheelbase:.2f} m.',
          (6.4, 4.6)),
    Study('2.27', 'Case study 2: a round robot pushes a box on a side',
          scenes.BOX + (RADIUS, Parameter('offset', 'm', 'contact left of the middle of the '
                                                         'face')),
          compute_side, draw_side,
          'From the contact C the push goes through the friction centre F, {arm:.2f} m away, at '
          '{rho:.0f} degrees to the normal of the side.',
          'There it is in equilibrium, with a margin of {margin:.2f} m: R_p cos(rho) is greater '
          'than h, so a small turn dies out.', (6.4, 4.2)),
    Study('2.31', 'Case study 3: the load moves away from the robot',
          (Parameter('distances', 'm', 'friction centre ahead of the contact',
                     [0.05, 0.1, 0.15, 0.2]), RADIUS) + scenes.BOX,
          compute_load, draw_load,
          'Four places of the friction centre F ahead of the contact C; {stable:.0f} of them '
          '(filled) lie within a distance R_p.',
          'A push on a flat side is stable as long as F is nearer to C than the centre of '
          'the robot, {radius:.2f} m.', (6.4, 4.2)))
