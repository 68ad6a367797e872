"""A flat face on a round robot: alpha over rho for three positions of the centre of friction."""

import math

from matplotlib.figure import Figure
import numpy as np
from studies.analysis.pushing_location import PushingLocation
from studies.chapter2.rolling import alpha_curve
from studies.chapter2.rolling.sliding import (
    CONTACT_FRICTION, rolling_range, SUPPORT_SPREAD,
)
from studies.framework.parameters import Parameter, Values
from studies.framework.study import Finding, Outcome, RunJobs, Study

# Chosen: smooth curves; odd, so that rho = 0 is among the samples.
SAMPLES = 401


def compute(values: Values, _: RunJobs) -> Outcome:
    """Compute alpha over the pushing angle."""
    location = PushingLocation(values.robot_radius, math.inf, values.ahead, values.aside)
    rho = np.linspace(-values.max_rho, values.max_rho, SAMPLES)
    tables = alpha_curve.compute_tables(location, 'rho_rad', rho, location.rotation_at(rho),
                                        location.rho)
    rolling = rolling_range(location, values.support_spread, values.contact_friction,
                            values.max_rho)
    margin = alpha_curve.middle_equilibrium(location).margin
    basin = min(map(abs, tables['basin']['rho_rad']), default=0.0)
    tables['rolling'] = {'low_rad': [rolling.low], 'high_rad': [rolling.high]}
    return Outcome(tables, {
        'rolls': Finding(rolling.high, 'rad', 'greatest pushing angle of a contact that has '
                         'rolled, where the force leaves the friction cone'),
        'margin': Finding(margin, 'm', 'stability margin R_e cos(rho) - h'),
        'beyond': Finding(max(0.0, -margin), 'm', 'centre of friction beyond the robot centre'),
        'basin': Finding(basin, 'rad', 'largest pushing angle from which the object returns')})


def draw(figure: Figure, outcome: Outcome, values: Values) -> None:
    """Draw alpha over rho, and where the contact would slide."""
    axes, rolling = figure.subplots(), outcome.tables['rolling']
    alpha_curve.draw(axes, outcome.tables, 'rho_rad', 'pushing angle $\\rho$ [rad]')
    alpha_curve.draw_rolling_range(axes, rolling['low_rad'][0], rolling['high_rad'][0],
                                   values.contact_friction)


def _kind(margin: float) -> str:
    """Name what a stability margin [m] means."""
    if abs(margin) <= alpha_curve.NO_MARGIN:
        return 'marginal'
    return 'stable' if margin > 0.0 else 'unstable'


def _title(values: Values) -> str:
    location = PushingLocation(values.robot_radius, math.inf, values.ahead, values.aside)
    kind = _kind(alpha_curve.middle_equilibrium(location).margin)
    return f'Flat object on a curved pusher: {kind}'


OBSERVATIONS = {
    'stable': 'The object returns to the middle from up to {basin:.2f} rad if the contact holds, '
    'from {rolls:.2f} rad with the friction that is marked.',
    'marginal': 'Alpha passes 0 in the middle without slope (stability margin {margin:.2f} m). '
    'The contact slides beyond {rolls:.2f} rad.',
    'unstable': 'The arrows lead away from the middle; from {rolls:.2f} rad on the contact '
    'slides.'}
EXPLANATIONS = {
    'stable': 'The centre of friction is nearer to the contact than the centre of the robot, by '
    '{margin:.2f} m.',
    'marginal': 'The centre of friction is as far from the contact as the centre of the robot.',
    'unstable': 'The centre of friction is further away than the centre of the robot, by '
    '{beyond:.2f} m.'}


def _study(figure: str, ahead: float) -> Study:
    return Study(figure, _title, (
        Parameter('robot_radius', 'm', 'radius of the pusher, r_pc', 0.5),
        Parameter('aside', 'm', 'centre of friction to the left of the contact, t_fc', 0.0),
        Parameter('ahead', 'm', 'centre of friction ahead of the contact, n_fc', ahead),
        CONTACT_FRICTION, SUPPORT_SPREAD,
        Parameter('max_rho', 'rad', 'range of the pushing angle that is drawn')),
        compute, draw, lambda findings: OBSERVATIONS[_kind(findings['margin'])],
        lambda findings: EXPLANATIONS[_kind(findings['margin'])])


STUDIES = (_study('2.11', 0.3), _study('2.12', 0.5), _study('2.13', 0.7))
