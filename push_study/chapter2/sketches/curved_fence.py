"""Sketch of a flat object on a curved fence, before and after rolling on it."""

import math

import numpy as np
from push_model.analysis.pushing_location import pushing_location
from push_model.contact import rolling_constants
from push_model.parameters import Contact
from push_study.chapter2.sketches.model import UNEVEN_BOX, uneven_box
from push_study.chapter2.sketches.push_instant import at_turn
from push_study.framework import paper, sketch, sketch_body
from push_study.framework.study import Finding, Outcome, Parameter, Study

BEHIND = Contact('face', 3)
PARAMETERS = UNEVEN_BOX + (
    Parameter('robot_radius', 'm', 'radius of the robot, R_p'),
    Parameter('turn', 'rad', 'of the box, rolled on the robot, theta'))


def rolled(values, turn):
    """
    Place the box on the robot, rolled from the middle of its face.

    :param values: ``Values``.
    :param turn: of the box [rad].
    :return: ``PushInstant``, the robot at the origin, the push along x.
    """
    obj = uneven_box(values)
    return at_turn(obj, pushing_location(obj, BEHIND, values.robot_radius), turn, 1.0)


def compute(values, batch):
    """
    Compute angles and lengths of the sketch.

    :param values: ``Values``.
    :param batch: not used.
    :return: ``Outcome``.
    """
    location = pushing_location(uneven_box(values), BEHIND, values.robot_radius)
    shots = [rolled(values, turn) for turn in (0.0, values.turn)]
    table = {'theta_rad': [0.0, values.turn], 'alpha_rad': [now.alpha for now in shots],
             'rho_rad': [now.push_angle - now.state.gamma for now in shots],
             'contact_x_m': [now.contact[0] for now in shots],
             'contact_y_m': [now.contact[1] for now in shots]}
    travel = rolling_constants(values.robot_radius, math.inf)[1] * values.turn
    findings = {'ahead': Finding(location.normal_distance, 'm', 'friction centre ahead of the face, n_f'),
                'aside': Finding(location.tangential_distance, 'm', 'friction centre beside the contact, t_f'),
                'rho': Finding(math.degrees(table['rho_rad'][1]), 'deg', 'rho after rolling'),
                'alpha': Finding(math.degrees(table['alpha_rad'][1]), 'deg',
                                 'alpha after rolling'),
                'travel': Finding(travel, 'm', 'way of the contact along the face')}
    return Outcome({'geometry': table}, findings)


def draw(figure, outcome, values):
    """
    Draw the box before and after rolling.

    :param figure: matplotlib figure.
    :param outcome: the ``Outcome``.
    :param values: ``Values``.
    """
    axes = figure.subplots()
    sketch.sheet(axes)
    before, now = rolled(values, 0.0), rolled(values, values.turn)
    sketch_body.solid(axes, before.obj, before.pose, ghost=True)
    sketch_body.solid(axes, now.obj, now.pose)
    sketch_body.disc(axes, now.robot, now.robot_radius, (-0.7, 0.9))
    at, center = now.contact, now.friction_centre
    old = now.pose.transform((before.state.c_x, before.state.c_y))
    foot = np.add(old, now.along(0.5 * math.pi, outcome.findings['aside'].value))
    sketch_body.point(axes, now.robot, '$P$', 180.0)
    sketch.arrow(axes, now.robot, now.along(0.0, now.robot_radius), '$R_p$', paper.GREY, 0.5)
    sketch.arrow(axes, at, now.along(0.0, 0.33), '$n$')
    sketch.arrow(axes, at, now.along(0.5 * math.pi, 0.16), '$t$')
    sketch.arrow(axes, at, (0.36, 0.0), '$v$', sketch.PUSH)
    sketch.line(axes, at, center)
    sketch.angle(axes, at, 0.27, now.state.gamma, 0.0, '$\\rho$')
    sketch.angle(axes, at, 0.2, -now.alpha, 0.0, '$\\alpha$')
    sketch.dimension(axes, old, at, '$R_p \\theta$', 0.05, 1, 14.0)
    sketch.dimension(axes, foot, old, '$t_f$', -0.03, -1, 11.0)
    sketch.dimension(axes, foot, center, '$n_f$', 0.0, -1)
    sketch_body.point(axes, before.contact, color=paper.GREY)
    sketch_body.point(axes, at, '$C$', 160.0, 13.0, sketch.FORCE)
    sketch_body.point(axes, center, '$F$', 0.0, 10.0, sketch.FLOOR)


STUDIES = (Study(
    '2.10', 'Geometry of a flat object on a curved fence', PARAMETERS, compute, draw,
    'As the box turns (dashed: before), the contact C rolls {travel:.2f} m along the face; rho is '
    'then {rho:.0f} degrees, alpha {alpha:.0f} degrees.',
    'The normal of the face turns with the box, and rolling makes equal ways on fence and face, '
    'so that n_f, t_f, R_p and theta give both angles.', (6.4, 4.6)),)
