"""A round object on a round robot: alpha over rho, with the friction centre on its axis or off."""

import math

import numpy as np
from push_model.analysis.pushing_location import PushingLocation
from push_study.chapter2.rolling import alpha_plot
from push_study.framework.study import Finding, Outcome, Parameter, Study

SAMPLES = 601
ORIGINS = ('centre', 'contact')
RETURNS = ('Inside the shaded band the arrows turn the object back to rho = 0; the band ends at '
           '{edge:.3f} rad on either side, at the unstable equilibria.')
ROLLS = ('At rho = 0 the friction centre is {arm:.2f} m ahead of the contact, less than the '
         'effective radius of {effective:.2f} m, so that the contact rolls further than the '
         'friction centre swings')


def friction_center_at(values):
    """
    Place the friction centre at the reference, where the push goes along the normal.

    The captions leave open from where r_fc counts; for beta = pi the friction centre is on the
    line from the contact to the centre of curvature either way, and beta below pi is to its left.

    :param values: ``Values`` with object_radius, center_distance, beta and distance_from.
    :return: (ahead, aside) of the contact [m].
    :raises ValueError: for another origin.
    """
    if values.distance_from not in ORIGINS:
        raise ValueError(f'distance_from: got {values.distance_from!r}, expected one of '
                         f'{", ".join(ORIGINS)}')
    along = values.center_distance * math.cos(values.beta)
    aside = values.center_distance * math.sin(values.beta)
    return values.object_radius + along if values.distance_from == 'centre' else -along, aside


def compute(values, batch):
    """
    Alpha over the pushing angle, while the contact does not slide.

    :param values: ``Values``.
    :param batch: not used.
    :return: ``Outcome``.
    """
    return _compute(values, math.inf)


def compute_with_sliding(values, batch):
    """
    Alpha over the pushing angle, with the friction of the contact.

    :param values: ``Values``.
    :param batch: not used.
    :return: ``Outcome``.
    """
    return _compute(values, values.contact_friction)


def draw(figure, outcome, values):
    """
    Draw alpha over rho.

    :param figure: matplotlib figure.
    :param outcome: the ``Outcome``.
    :param values: ``Values``.
    """
    alpha_plot.draw(figure.subplots(), outcome.tables, 'rho_rad', 'pushing angle $\\rho$ [rad]')


def _compute(values, contact_friction):
    location = PushingLocation(values.robot_radius, values.object_radius,
                               *friction_center_at(values))
    rho = np.linspace(-values.largest_rho, values.largest_rho, SAMPLES)
    tables = alpha_plot.tables(location, 'rho_rad', rho, location.rotation_at(rho), location.rho,
                               contact_friction)
    middle = alpha_plot.middle(location)
    low, high = tables['basin']['rho_rad'] or (middle.rho, middle.rho)
    force = tables['alpha']['force_alpha_rad']
    away = rho[(rho > high) & (force > 0.0)]
    return Outcome(tables, {
        'equilibrium': Finding(middle.rho, 'rad', 'pushing angle of the middle equilibrium'),
        'margin': Finding(middle.margin, 'm', 'stability margin R_e cos(rho) - h'),
        'low': Finding(low, 'rad', 'lower end of the basin'),
        'edge': Finding(high, 'rad', 'upper end of the basin'),
        'back': Finding(away.min(initial=rho[-1]), 'rad', 'pushing angle from which on the object '
                        'turns away'),
        'arm': Finding(middle.arm, 'm', 'distance from contact to friction centre there'),
        'effective': Finding(location.rolling[1], 'm', 'effective radius')})


def _study(figure, title, geometry, seen, why, extra=(), function=compute):
    robot, distance, beta = geometry
    return Study(figure, title, (
        Parameter('robot_radius', 'm', 'radius of the robot, r_pc', robot),
        Parameter('object_radius', 'm', 'radius of the object at the contact, r_sc', 0.2),
        Parameter('center_distance', 'm', 'distance of the friction centre, r_fc', distance),
        Parameter('beta', 'rad', 'direction of the friction centre from the normal', beta),
        *extra,
        Parameter('distance_from', '', 'what r_fc counts from: centre (of curvature of the '
                  'object) or contact'),
        Parameter('largest_rho', 'rad', 'range of the pushing angle that is drawn')),
        function, draw, seen, why)


STUDIES = (
    _study('2.6', 'Round object on a round robot', (0.5, 0.1, math.pi), RETURNS, ROLLS + '.'),
    _study('2.7', 'Round object on a large round robot', (2.0, 0.15, math.pi), RETURNS,
           ROLLS + '; rho changes little, as the normal of a large robot hardly turns with '
           'the object.'),
    _study('2.8', 'Round object on a round robot that it may slide on', (0.5, 0.1, math.pi),
           'The push leaves the friction cone at {edge:.3f} rad, where rolling ends and sliding '
           'begins (dashed); the arrows still turn the object back up to {back:.2f} rad, where '
           'alpha has long changed its sign.',
           'The force cannot leave the cone: it stays on its edge, and passes the friction '
           'centre on the side that turns the object back.',
           (Parameter('contact_friction', '', 'friction coefficient at the contact', 0.5),),
           compute_with_sliding),
    _study('2.14', 'Friction centre off the axis', (0.5, 0.085, 2.9),
           'The stable equilibrium has moved to rho = {equilibrium:.2f} rad, and the basin is '
           'lopsided: from {low:.2f} to {edge:.2f} rad.',
           'The friction centre lies to the left of the normal, so that a push along the normal '
           'turns the object counter-clockwise, until it has rolled to where the push leads '
           'through the friction centre.'))
