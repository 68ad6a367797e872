"""A round object on a round robot whose contact slides: figure 2.8."""

import math

from matplotlib.axes import Axes
from matplotlib.figure import Figure
import numpy as np
from push_model.geometry import FloatArray
from studies.analysis.pushing_location import PushingLocation
from studies.chapter2.rolling import alpha_curve
from studies.chapter2.rolling.round_object import DISTANCE_ORIGIN, pushing_location_of
from studies.chapter2.rolling.sliding import (
    CONTACT_FRICTION, push_from, rolling_range, slow_motion, SUPPORT_SPREAD,
)
from studies.framework import plot_style
from studies.framework.parameters import Parameter, Values
from studies.framework.study import Finding, Outcome, RunJobs, Study, Table

# Chosen: smooth curves; odd, so that rho = 0 is among the samples.
SAMPLES = 601
# Chosen: steps of an integrated push, and releases among which the border is searched, twice.
STEPS = 241
RELEASES = 17
# The robot has passed the object, and contact is lost; to the accuracy of the steps [rad].
PASSED = 0.5 * math.pi - 0.02


def compute(values: Values, _: RunJobs) -> Outcome:
    """Compute where rolling ends, and integrate pushes from there on."""
    location = pushing_location_of(values)
    support_distance, friction = values.support_spread, values.contact_friction
    rho = np.linspace(-values.max_rho, values.max_rho, SAMPLES)
    rotations = location.rotation_at(rho)
    tables = alpha_curve.compute_tables(location, 'rho_rad', rho, rotations, location.rho)
    motion = slow_motion(location, support_distance, friction, rotations, rho)
    tables['alpha'].update(
        rolls=(motion.slides == 0).astype(int), force_angle_rad=motion.force_angles,
        turn=np.where(np.abs(motion.yaw_rates) > alpha_curve.NO_MARGIN,
                      np.sign(motion.yaw_rates), 0.0))
    rolling = rolling_range(location, support_distance, friction, values.max_rho)
    # An equilibrium of a rolling contact means nothing where the contact slides.
    middle = alpha_curve.middle_equilibrium(location)
    tables['equilibria'] = {'rho_rad': [middle.rho], 'margin_m': [middle.margin]}
    border = _border(location, values)
    tables['basin'] = {'rho_rad': [-border, border], 'limit': ['slides off', 'slides off']}
    releases, lost, lost_distance = _releases(location, values)
    tables['releases'] = releases
    turns_away = rho[(rho > rolling.high) & (motion.yaw_rates < 0.0)]
    return Outcome(tables, {
        'cone': Finding(math.atan(friction), 'rad', 'half-angle of the friction cone'),
        'edge': Finding(rolling.high, 'rad', 'pushing angle at which the contact force leaves '
                        'the cone, and rolling ends'),
        **{name: Finding(rolling_range(location, other, friction, values.max_rho).high, 'rad',
                         f'the same with support points {other:g} m from the centre of friction')
           for name, other in zip(('edge_narrow', 'edge_wide'), values.other_spreads)},
        'lost': Finding(lost, 'rad', 'least of the releases drawn after which contact is lost'),
        'lost_distance': Finding(lost_distance, 'm', 'distance after which it is, there'),
        'border': Finding(border, 'rad', 'pushing angle from which the object slides off'),
        'back': Finding(float(turns_away.min(initial=rho[-1])), 'rad', 'pushing angle from which '
                        'the object rotates away')})


def _releases(location: PushingLocation, values: Values) -> tuple[Table, float, float]:
    """
    Integrate the pushes that are drawn.

    :return: (their table, least release after which contact is lost [rad], distance after which
        it is [m]); nan where it never is.
    """
    distances = np.linspace(0.0, values.distance, STEPS)
    released = push_from(location, values.support_spread, values.contact_friction,
                         np.array(values.releases), distances)
    table: Table = {'distance_m': distances}
    for index, start in enumerate(values.releases):
        table[f'rho_{start:g}_rad'] = released.rho[:, index]
        table[f'slides_{start:g}'] = released.slides[:, index].astype(int)
    # Of each release, the first sample at which the robot has passed the object, 0 for none.
    passes = (released.rho >= PASSED).argmax(axis=0)
    lost = np.flatnonzero(passes)
    if not len(lost):
        return table, math.nan, math.nan
    return table, float(values.releases[lost[0]]), float(distances[passes[lost[0]]])


def _border(location: PushingLocation, values: Values) -> float:
    """Find the release between those after which rho falls and those after which it grows."""
    low, high = 0.0, values.max_rho
    distances = np.linspace(0.0, values.distance, STEPS)
    for _ in range(2):
        starts = np.linspace(low, high, RELEASES)
        ends = push_from(location, values.support_spread, values.contact_friction, starts,
                         distances).rho[-1]
        grows = ends > starts
        if not grows.any():
            return float(values.max_rho)
        low, high = starts[max(0, int(np.argmax(grows)) - 1)], starts[int(np.argmax(grows))]
    return float(0.5 * (low + high))


def draw(figure: Figure, outcome: Outcome, values: Values) -> None:
    """Draw alpha over rho, and rho of pushes from several states."""
    above, below = figure.subplots(2, 1, height_ratios=(1.5, 1.0))
    alpha_curve.draw(above, outcome.tables, 'rho_rad', 'pushing angle $\\rho$ [rad]')
    _draw_releases(below, outcome.tables['releases'], values)


def _draw_releases(axes: Axes, table: Table, values: Values) -> None:
    distances: FloatArray = table['distance_m']
    for start in values.releases:
        rho, slides = table[f'rho_{start:g}_rad'], table[f'slides_{start:g}'] == 1
        if (rho >= PASSED).any():
            end = int(np.argmax(rho >= PASSED))
            axes.plot(distances[end], rho[end], 'x', color=plot_style.UNSTABLE, markersize=7.0,
                      markeredgewidth=2.0, zorder=4.0)
            rho = np.where(distances <= distances[end], rho, math.nan)
        for where, dashes in ((~slides, '-'), (slides, plot_style.DASHED)):
            axes.plot(distances, plot_style.split_where(where, rho), linestyle=dashes,
                      color=plot_style.STABLE)
    axes.set_xlim(0.0, values.distance)
    axes.set_ylim(0.0, 0.55 * math.pi)
    axes.set_xlabel('distance pushed [m]; cross: the robot has passed, contact is lost')
    axes.set_ylabel('$\\rho$ [rad]')


STUDIES = (Study('2.8', 'Round object on a round robot: rolling (solid) and sliding (dashed)', (
    Parameter('robot_radius', 'm', 'radius of the robot, r_pc', 0.5),
    Parameter('object_radius', 'm', 'radius of the object at the contact, r_sc', 0.2),
    Parameter('center_distance', 'm', 'distance of the centre of friction, r_fc', 0.1),
    Parameter('beta', 'rad', 'direction of the centre of friction from the normal', math.pi),
    CONTACT_FRICTION._replace(captioned=0.5), DISTANCE_ORIGIN, SUPPORT_SPREAD,
    Parameter('other_spreads', 'm', 'support points nearer and further apart, for comparison'),
    Parameter('releases', 'rad', 'pushing angles at which the pushes below begin'),
    Parameter('distance', 'm', 'distance of these pushes'),
    Parameter('max_rho', 'rad', 'range of the pushing angle that is drawn')),
    compute, draw,
    'Rolling ends at {edge:.2f} rad ({edge_narrow:.2f} to {edge_wide:.2f} rad, by support '
    'pattern), before the push leaves the friction cone ({cone:.3f} rad). A sliding object '
    'returns from up to {border:.2f} rad; from {lost:.2f} rad the robot passes it after '
    '{lost_distance:.1f} m.',
    'The contact force leans further out of the cone than the push.', (6.4, 6.2)),)
