"""A flat face on a round robot: alpha over rho for three places of the friction centre."""

import math

import numpy as np
from push_model.analysis.pushing_location import PushingLocation
from push_study.chapter2.rolling import alpha_plot
from push_study.framework.study import Finding, Outcome, Parameter, Study

SAMPLES = 401
WHERE = (('2.11', 0.3, 'stable',
          'Left of the middle alpha is above 0 and the object turns clockwise, which makes rho '
          'grow; right of it, the other way: it comes back to rho = 0 from as far as '
          '{basin:.2f} rad.',
          'The friction centre is nearer to the contact than the centre of the robot, by '
          '{margin:.2f} m: as the face rolls, the contact overtakes it.'),
         ('2.12', 0.5, 'marginal',
          'Alpha passes 0 at rho = 0 without slope (stability margin {margin:.2f} m), and '
          'further out the arrows lead away.',
          'The friction centre is as far from the contact as the centre of the robot, so that '
          'for small turns the contact rolls just as far as the friction centre swings; for '
          'larger ones it falls behind.'),
         ('2.13', 0.7, 'unstable',
          'The slope at rho = 0 has changed its sign: the arrows lead away from it.',
          'The friction centre lies further away than the centre of the robot, by '
          '{lack:.2f} m, and swings out further than the contact rolls.'))


def compute(values, batch):
    """
    Alpha over the pushing angle.

    :param values: ``Values``.
    :param batch: not used.
    :return: ``Outcome``.
    """
    location = PushingLocation(values.robot_radius, math.inf, values.ahead, values.aside)
    rho = np.linspace(-values.largest_rho, values.largest_rho, SAMPLES)
    tables = alpha_plot.tables(location, 'rho_rad', rho, location.rotation_at(rho), location.rho,
                               math.inf)
    margin = alpha_plot.middle(location).margin
    basin = min(map(abs, tables['basin']['rho_rad']), default=0.0)
    return Outcome(tables, {
        'margin': Finding(margin, 'm', 'stability margin R_e cos(rho) - h'),
        'lack': Finding(max(0.0, -margin), 'm', 'friction centre beyond the robot centre'),
        'basin': Finding(basin, 'rad', 'largest pushing angle from which the object returns')})


def draw(figure, outcome, values):
    """
    Draw alpha over rho.

    :param figure: matplotlib figure.
    :param outcome: the ``Outcome``.
    :param values: ``Values``.
    """
    alpha_plot.draw(figure.subplots(), outcome.tables, 'rho_rad', 'pushing angle $\\rho$ [rad]')


def _study(figure, ahead, kind, seen, why):
    return Study(figure, f'Flat object on a curved fence: {kind}', (
        Parameter('robot_radius', 'm', 'radius of the fence, r_pc', 0.5),
        Parameter('aside', 'm', 'friction centre beside the contact, t_fc', 0.0),
        Parameter('ahead', 'm', 'friction centre ahead of the contact, n_fc', ahead),
        Parameter('largest_rho', 'rad', 'range of the pushing angle that is drawn')),
        compute, draw, seen, why)


STUDIES = tuple(_study(*row) for row in WHERE)
