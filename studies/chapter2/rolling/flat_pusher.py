"""A round object on a flat pusher: alpha over the distance that the contact has rolled."""

import math

from matplotlib.figure import Figure
import numpy as np
from studies.analysis.pushing_location import PushingLocation
from studies.chapter2.rolling import alpha_curve
from studies.chapter2.rolling.round_object import DISTANCE_ORIGIN, friction_center_from_contact
from studies.framework.parameters import Parameter, Values
from studies.framework.study import Finding, Outcome, RunJobs, Study

# Chosen: smooth curves; odd, so that 0 is among the samples.
SAMPLES = 601


def compute(values: Values, _: RunJobs) -> Outcome:
    """Compute alpha over the displacement of the contact, equal on pusher and object."""
    location = PushingLocation(math.inf, values.object_radius,
                               *friction_center_from_contact(values))
    effective_radius = location.rolling[1]
    travel = np.linspace(-values.max_travel, values.max_travel, SAMPLES)
    tables = alpha_curve.compute_tables(location, 'd_pc_m', travel, travel / effective_radius,
                                        lambda rotation: effective_radius * rotation)
    middle = alpha_curve.middle_equilibrium(location)
    return Outcome(tables, {
        'margin': Finding(middle.margin, 'm', 'stability margin R_s - h'),
        'arm': Finding(middle.arm, 'm', 'distance from contact to centre of friction'),
        'edge': Finding(min(map(abs, tables['basin']['d_pc_m']), default=0.0), 'm',
                        'largest displacement of the contact from which the object returns')})


def draw(figure: Figure, outcome: Outcome, _: Values) -> None:
    """Draw alpha over the displacement of the contact."""
    alpha_curve.draw(figure.subplots(), outcome.tables, 'd_pc_m',
                     'displacement of the contact $d_{pc}$ [m]')


STUDIES = (Study('2.9', 'Round object on a flat pusher', (
    Parameter('object_radius', 'm', 'radius of the object at the contact, r_sc', 0.2),
    Parameter('center_distance', 'm', 'distance of the centre of friction, r_fc', 0.1),
    Parameter('beta', 'rad', 'direction of the centre of friction from the normal', math.pi),
    DISTANCE_ORIGIN,
    Parameter('max_travel', 'm', 'range of the displacement that is drawn')),
    compute, draw,
    'The object rolls back from any displacement below {edge:.2f} m, half a revolution.',
    'The normal does not rotate; the centre of friction, {arm:.2f} m ahead, acts like the weight '
    'of a roly-poly toy.'),)
