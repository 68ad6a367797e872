"""Sketch of case study 2: a round robot pushes a box on a side."""

import math

from push_model.contact import contact_point
from push_model.parameters import Contact
from push_model.stability import equilibrium_at
from push_study import paper, sketch, sketch_body
from push_study.perimeter import is_stable, push_through_center
from push_study.push_instant import at_turn
from push_study.scenes import BOX, box
from push_study.study import Finding, Outcome, Parameter, Study

PARAMETERS = BOX + (Parameter('robot_radius', 'm', 'radius of the robot, R_p'),
                    Parameter('offset', 'm', 'contact left of the middle of the face'))
FACES = 4


def touching(values, contact):
    """
    Place the robot at a contact of the box, which lies at the origin.

    :param values: ``Values``.
    :param contact: the ``Contact``.
    :return: ``PushInstant``, the push through the friction centre.
    """
    obj = box(values)
    location = push_through_center(obj, contact, values.robot_radius)
    now = at_turn(obj, location, 0.0, 1.0, heading=location.forward)
    return now._replace(state=now.state._replace(x=0.0, y=0.0))


def compute(values, batch):
    """
    Compute places, lengths and angles of the sketch.

    :param values: ``Values``.
    :param batch: not used.
    :return: ``Outcome``.
    """
    obj, contact = box(values), Contact('face', 3, values.offset)
    rest = equilibrium_at(push_through_center(obj, contact, values.robot_radius), 0.0)
    now = touching(values, contact)
    places = now.contact, now.robot, now.friction_centre, contact_point(obj, Contact('face', 3))
    findings = {
        'arm': Finding(rest.arm, 'm', 'from the contact to the friction centre, h'),
        'rho': Finding(math.degrees(rest.rho), 'deg', 'pushing angle rho through F'),
        'cone': Finding(math.degrees(math.atan(obj.contact_friction_coefficient)), 'deg',
                        'greatest pushing angle at which the contact rolls'),
        'margin': Finding(rest.margin, 'm', 'stability margin R_e cos(rho) - h'),
        'stable': Finding(float(is_stable(obj, contact, values.robot_radius)), '',
                          'whether the box returns from a small turn')}
    return Outcome({'places': {'place': ['C', 'P', 'F', 'middle'],
                               'x_m': [place[0] for place in places],
                               'y_m': [place[1] for place in places]}}, findings)


def draw(figure, outcome, values):
    """
    Draw the box, the robot behind it, and where else it might push.

    :param figure: matplotlib figure.
    :param outcome: the ``Outcome``.
    :param values: ``Values``.
    """
    axes, contact = figure.subplots(), Contact('face', 3, values.offset)
    sketch.sheet(axes)
    now = touching(values, contact)
    for face in range(FACES - 1):
        other = touching(values, Contact('face', face))
        sketch_body.disc(axes, other.robot, other.robot_radius, ghost=True)
        sketch.arrow(axes, other.contact, other.along(0.0, 0.08), color=paper.GREY)
    sketch_body.solid(axes, now.obj, now.pose)
    sketch_body.disc(axes, now.robot, now.robot_radius)
    _draw_push(axes, now, outcome.findings)
    middle = contact_point(now.obj, Contact('face', 3))
    sketch.dimension(axes, middle, now.contact, '$d$', -0.03, -1)
    sketch_body.point(axes, now.contact, '$C$', 145.0, 13.0, sketch.FORCE)
    sketch_body.mass_centre(axes, now.friction_centre, '$G, F$', 0.0, 18.0)


def _draw_push(axes, now, findings):
    at, gamma = now.contact, now.state.gamma
    sketch_body.point(axes, now.robot, '$P$', 180.0)
    sketch.arrow(axes, now.robot, now.along(0.0, now.robot_radius), '$R_p$', paper.GREY, 0.4)
    cone = math.radians(findings['cone'].value)
    for side in (-cone, cone):
        end = now.along(side, 0.17)
        sketch.line(axes, at, (at[0] + end[0], at[1] + end[1]), color=paper.GREY,
                    linewidth=1.0, linestyle=(0, (1, 1.5)))
    sketch.angle(axes, at, 0.12, gamma, gamma + cone, '$\\arctan\\,\\mu_c$', paper.GREY, 22.0)
    sketch.arrow(axes, at, now.along(0.0, 0.3), '$n$')
    sketch.arrow(axes, at, now.along(now.push_angle - gamma, 0.13), '$v$', sketch.PUSH)
    sketch.line(axes, at, now.friction_centre)
    sketch.angle(axes, at, 0.23, gamma, now.push_angle, '$\\rho$')
    sketch.dimension(axes, at, now.friction_centre, '$h$', -0.05, -1)


STUDIES = (Study(
    '2.27', 'Case study 2: a box pushed on a side by a round robot', PARAMETERS, compute, draw,
    'The robot touches the box at C and pushes towards its friction centre F, {arm:.2f} m away; '
    'it could push anywhere round the perimeter (dashed).',
    'The contact rolls while rho is within {cone:.0f} degrees of the normal, and a turn dies out '
    'where R_e cos(rho) exceeds h, here by {margin:.2f} m.', (6.0, 5.4)),)
