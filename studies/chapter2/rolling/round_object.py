"""A round object on a round robot: alpha over rho, the centre of friction on its axis or not."""

import math
from typing import NamedTuple

from matplotlib.figure import Figure
import numpy as np
from studies.analysis.pushing_location import PushingLocation
from studies.chapter2.rolling import alpha_curve
from studies.chapter2.rolling.sliding import (
    CONTACT_FRICTION, rolling_range, SUPPORT_SPREAD,
)
from studies.framework.parameters import Parameter, Values
from studies.framework.study import Compute, Draw, Finding, Outcome, RunJobs, Study

# Chosen: smooth curves; odd, so that rho = 0 is among the samples.
SAMPLES = 601
ORIGINS = ('centre', 'contact')
DISTANCE_ORIGIN = Parameter('distance_from', '', 'point from which r_fc is measured: centre (of '
                            'curvature of the object) or contact')
RETURNS = ('Inside the shaded band, up to {edge:.3f} rad, the object returns to rho = 0.')
ROLLS = ('The centre of friction is {arm:.2f} m ahead of the contact, less than the effective '
         'radius of {effective:.2f} m.')


class FromContact(NamedTuple):
    """
    Position of the centre of friction, seen from the contact.

    :param ahead: along the normal [m].
    :param lateral: along the tangent, to the left [m].
    """

    ahead: float
    lateral: float


def friction_center_from_contact(values: Values) -> FromContact:
    """
    Find the centre of friction at the reference, where the push is along the normal.

    The captions leave open from where r_fc is measured; for beta = pi the centre of friction is on
    the line from the contact to the centre of curvature either way, and beta below pi moves it to
    the left.

    :param values: with object_radius, center_distance, beta and distance_from.
    :return: its position.
    :raises ValueError: for another origin.
    """
    if values.distance_from not in ORIGINS:
        raise ValueError(f'distance_from: got {values.distance_from!r}, expected one of '
                         f'{", ".join(ORIGINS)}')
    along = values.center_distance * math.cos(values.beta)
    lateral = values.center_distance * math.sin(values.beta)
    if values.distance_from == 'centre':
        return FromContact(values.object_radius + along, lateral)
    return FromContact(-along, lateral)


def pushing_location_of(values: Values) -> PushingLocation:
    """
    Find the pushing location of a figure.

    :param values: with robot_radius and those of ``friction_center_from_contact``.
    :return: the location.
    """
    return PushingLocation(values.robot_radius, values.object_radius,
                           *friction_center_from_contact(values))


def compute(values: Values, _: RunJobs) -> Outcome:
    """Compute alpha over the pushing angle for a contact that never slides."""
    location = pushing_location_of(values)
    rho = np.linspace(-values.max_rho, values.max_rho, SAMPLES)
    tables = alpha_curve.compute_tables(location, 'rho_rad', rho, location.rotation_at(rho),
                                        location.rho)
    middle = alpha_curve.middle_equilibrium(location)
    low, high = tables['basin']['rho_rad'] or (middle.rho, middle.rho)
    return Outcome(tables, {
        'equilibrium': Finding(middle.rho, 'rad', 'pushing angle of the middle equilibrium'),
        'margin': Finding(middle.margin, 'm', 'stability margin R_e cos(rho) - h'),
        'low': Finding(low, 'rad', 'lower end of the basin'),
        'edge': Finding(high, 'rad', 'upper end of the basin'),
        'arm': Finding(middle.arm, 'm', 'distance from contact to centre of friction there'),
        'effective': Finding(location.rolling[1], 'm', 'effective radius')})


def draw(figure: Figure, outcome: Outcome, _: Values) -> None:
    """Draw alpha over rho."""
    alpha_curve.draw(figure.subplots(), outcome.tables, 'rho_rad', 'pushing angle $\\rho$ [rad]')


def compute_off_axis(values: Values, run_jobs: RunJobs) -> Outcome:
    """Compute alpha over the pushing angle, and where a contact with friction slides."""
    outcome = compute(values, run_jobs)
    frictions = [values.contact_friction, values.low_friction]
    rolling, slippery = (rolling_range(pushing_location_of(values), values.support_spread,
                                       friction, values.max_rho) for friction in frictions)
    outcome.tables['rolling'] = {'contact_friction': frictions,
                                 'low_rad': [rolling.low, slippery.low],
                                 'high_rad': [rolling.high, slippery.high]}
    outcome.findings.update(
        friction=Finding(values.contact_friction, '', 'friction coefficient at the contact'),
        rolls_low=Finding(rolling.low, 'rad', 'least pushing angle of a contact that rolls'),
        rolls_high=Finding(rolling.high, 'rad', 'greatest one'),
        low_friction=Finding(values.low_friction, '', 'lower friction coefficient'),
        slippery_low=Finding(slippery.low, 'rad', 'least pushing angle with that'),
        slippery_high=Finding(slippery.high, 'rad', 'greatest one'))
    return outcome


def draw_off_axis(figure: Figure, outcome: Outcome, _: Values) -> None:
    """Draw alpha over rho, and where the contact would slide."""
    axes = figure.subplots()
    alpha_curve.draw(axes, outcome.tables, 'rho_rad', 'pushing angle $\\rho$ [rad]')
    for friction, low, high in zip(*outcome.tables['rolling'].values()):
        alpha_curve.draw_rolling_range(axes, low, high, friction)


class Geometry(NamedTuple):
    """
    Geometry that the caption of a figure states.

    :param robot_radius: r_pc [m].
    :param center_distance: r_fc [m].
    :param beta: direction of the centre of friction from the normal [rad].
    """

    robot_radius: float
    center_distance: float
    beta: float


def _study(figure: str, title: str, geometry: Geometry, observation: str, explanation: str, *,
           more_parameters: tuple[Parameter, ...] = (), function: Compute = compute,
           drawing: Draw = draw) -> Study:
    return Study(figure, title, (
        Parameter('robot_radius', 'm', 'radius of the robot, r_pc', geometry.robot_radius),
        Parameter('object_radius', 'm', 'radius of the object at the contact, r_sc', 0.2),
        Parameter('center_distance', 'm', 'distance of the centre of friction, r_fc',
                  geometry.center_distance),
        Parameter('beta', 'rad', 'direction of the centre of friction from the normal',
                  geometry.beta),
        *more_parameters, DISTANCE_ORIGIN,
        Parameter('max_rho', 'rad', 'range of the pushing angle that is drawn')),
        function, drawing, observation, explanation)


STUDIES = (
    _study('2.6', 'Round object on a round robot', Geometry(0.5, 0.1, math.pi), RETURNS,
           ROLLS),
    _study('2.7', 'Round object on a large round robot', Geometry(2.0, 0.15, math.pi), RETURNS,
           ROLLS),
    _study('2.14', 'Centre of friction off the axis', Geometry(0.5, 0.085, 2.9),
           'The stable equilibrium is at rho = {equilibrium:.2f} rad, its basin from {low:.2f} to '
           '{edge:.2f} rad.',
           'The force stays in the cone from {rolls_low:.2f} to {rolls_high:.2f} rad at a contact '
           'friction of {friction:g}, from {slippery_low:.2f} to {slippery_high:.2f} rad at '
           '{low_friction:g}.',
           more_parameters=(CONTACT_FRICTION, Parameter(
               'low_friction', '', 'friction of a contact that slides sooner'), SUPPORT_SPREAD),
           function=compute_off_axis,
           drawing=draw_off_axis))
