"""Sketch 2.10 of a flat object on a curved pusher, before and after rolling on it."""

import math

from matplotlib.figure import Figure
import numpy as np
from push_model.contact import rolling_constants
from push_model.parameters import Contact
from studies.analysis.pushing_location import pushing_location, PushingLocation
from studies.chapter2.sketches.push_instant import instant_at_rotation, PushInstant
from studies.chapter2.sketches.sliding_object import UNEVEN_BOX, uneven_box
from studies.framework import plot_style, sketch
from studies.framework.box import REAR_FACE
from studies.framework.parameters import Parameter, Values
from studies.framework.study import Finding, Outcome, RunJobs, Study

PARAMETERS = (
    *UNEVEN_BOX,
    Parameter('robot_radius', 'm', 'radius of the robot, R_p'),
    Parameter('rotation', 'rad', 'rotation of the box, rolled on the robot, theta'))


def rolled_instant(values: Values, rotation: float) -> PushInstant:
    """
    Place the box on the robot, rolled from the middle of its face.

    :param values: with the parameters ``PARAMETERS``.
    :param rotation: of the box [rad].
    :return: the instant, the robot at the origin, the push along x.
    """
    return instant_at_rotation(uneven_box(values), _location(values), rotation, speed=1.0)


def compute(values: Values, _: RunJobs) -> Outcome:
    """Compute angles and lengths of the sketch."""
    location = _location(values)
    instants = [rolled_instant(values, rotation) for rotation in (0.0, values.rotation)]
    table = {'theta_rad': [0.0, values.rotation],
             'alpha_rad': [instant.alpha for instant in instants],
             'rho_rad': [instant.rho for instant in instants],
             'contact_x_m': [instant.contact[0] for instant in instants],
             'contact_y_m': [instant.contact[1] for instant in instants]}
    travel = rolling_constants(values.robot_radius, math.inf)[1] * values.rotation
    findings = {
        'ahead': Finding(location.normal_distance, 'm',
                         'centre of friction ahead of the face, n_f'),
        'aside': Finding(location.tangential_distance, 'm',
                         'centre of friction to the left of the contact, t_f'),
        'rho': Finding(math.degrees(table['rho_rad'][1]), 'deg', 'rho after rolling'),
        'alpha': Finding(math.degrees(table['alpha_rad'][1]), 'deg', 'alpha after rolling'),
        'travel': Finding(travel, 'm', 'travel of the contact along the face')}
    return Outcome({'geometry': table}, findings)


def draw(figure: Figure, outcome: Outcome, values: Values) -> None:
    """Draw the box before and after rolling."""
    axes = figure.subplots()
    sketch.set_up(axes)
    before, now = rolled_instant(values, 0.0), rolled_instant(values, values.rotation)
    sketch.pushed_object(axes, before.obj, before.pose, ghost=True)
    sketch.pushed_object(axes, now.obj, now.pose)
    sketch.robot(axes, now.robot, now.robot_radius, (-0.7, 0.9))
    contact, center = now.contact, now.friction_center
    # On the rotated box: the contact before rolling, and the foot of the perpendicular from F.
    old_contact = now.pose.transform((before.state.c_x, before.state.c_y))
    below_center = np.add(old_contact,
                          now.from_normal(0.5 * math.pi, outcome.findings['aside'].value))
    sketch.point(axes, now.robot, '$P$', 180.0)
    sketch.arrow(axes, now.robot, now.from_normal(0.0, now.robot_radius), '$R_p$',
                 plot_style.GREY, at=0.5)
    sketch.arrow(axes, contact, now.from_normal(0.0, 0.33), '$n$')
    sketch.arrow(axes, contact, now.from_normal(0.5 * math.pi, 0.16), '$t$')
    sketch.arrow(axes, contact, (0.36, 0.0), '$v$', sketch.PUSH)
    sketch.line(axes, contact, center)
    sketch.angle(axes, contact, 0.27, (now.state.gamma, 0.0), '$\\rho$')
    sketch.angle(axes, contact, 0.2, (-now.alpha, 0.0), '$\\alpha$')
    sketch.dimension(axes, old_contact, contact, '$R_p \\theta$', shift=0.05, gap=14.0)
    sketch.dimension(axes, below_center, old_contact, '$t_f$', shift=-0.03, side=-1, gap=11.0)
    sketch.dimension(axes, below_center, center, '$n_f$', side=-1)
    sketch.point(axes, before.contact, color=plot_style.GREY)
    sketch.point(axes, contact, '$C$', 160.0, 13.0, sketch.FORCE)
    sketch.point(axes, center, '$F$', 0.0, 10.0, sketch.FLOOR)


def _location(values: Values) -> PushingLocation:
    return pushing_location(uneven_box(values), Contact('face', REAR_FACE), values.robot_radius)


STUDIES = (Study(
    '2.10', 'Geometry of a flat object on a curved pusher', PARAMETERS, compute, draw,
    'As the box rotates (dashed: before), the contact C rolls {travel:.2f} m; rho is then '
    '{rho:.0f} degrees, alpha {alpha:.0f} degrees.',
    'Rolling covers equal distances on pusher and face.', (6.4, 4.6)),)
