"""A round object on a flat fence: alpha over the way that the contact has rolled."""

import math

import numpy as np
from push_model.analysis.pushing_location import PushingLocation
from push_study.chapter2.rolling import alpha_plot
from push_study.chapter2.rolling.round_on_round import friction_center_at
from push_study.framework.study import Finding, Outcome, Parameter, Study

SAMPLES = 601


def compute(values, batch):
    """
    Alpha over the displacement of the contact, which is the same on fence and object.

    :param values: ``Values``.
    :param batch: not used.
    :return: ``Outcome``.
    """
    location = PushingLocation(math.inf, values.object_radius, *friction_center_at(values))
    effective = location.rolling[1]
    travel = np.linspace(-values.largest_travel, values.largest_travel, SAMPLES)
    tables = alpha_plot.tables(location, 'd_pc_m', travel, travel / effective,
                               lambda turn: effective * turn, math.inf)
    middle = alpha_plot.middle(location)
    return Outcome(tables, {
        'margin': Finding(middle.margin, 'm', 'stability margin R_s - h'),
        'arm': Finding(middle.arm, 'm', 'distance from contact to friction centre'),
        'edge': Finding(min(map(abs, tables['basin']['d_pc_m']), default=0.0), 'm',
                        'largest displacement of the contact from which the object returns')})


def draw(figure, outcome, values):
    """
    Draw alpha over the displacement of the contact.

    :param figure: matplotlib figure.
    :param outcome: the ``Outcome``.
    :param values: ``Values``.
    """
    alpha_plot.draw(figure.subplots(), outcome.tables, 'd_pc_m',
                    'displacement of the contact $d_{pc}$ [m]')


STUDIES = (Study('2.9', 'Round object on a flat fence', (
    Parameter('object_radius', 'm', 'radius of the object at the contact, r_sc', 0.2),
    Parameter('center_distance', 'm', 'distance of the friction centre, r_fc', 0.1),
    Parameter('beta', 'rad', 'direction of the friction centre from the normal', math.pi),
    Parameter('distance_from', '', 'what r_fc counts from: centre (of curvature of the object) '
              'or contact'),
    Parameter('largest_travel', 'm', 'range of the displacement that is drawn')),
    compute, draw,
    'The object rolls back from any place up to {edge:.2f} m, which is half a turn: only there, '
    'with the friction centre furthest ahead, is an unstable equilibrium.',
    'The normal of a fence does not turn; the friction centre, {arm:.2f} m ahead of the contact, '
    'lies before the centre of curvature and moves like the weight of a roly-poly toy.'),)
