"""What a push may do when nobody knows how four feet share the weight."""

import math

from matplotlib.axes import Axes
from matplotlib.figure import Figure
import numpy as np
from push_control.settings import ControlSettings
from push_model.contact import find_contact
from push_model.geometry import Pose
from push_model.parameters import PushedObject, RoundRobot
from push_model.quasi_static import vehicle
from push_model.signals import Twist
from push_sim_node.plant import Plant
from studies.analysis.unknown_loads import extreme_objects, unknown_loads
from studies.framework import plot_style
from studies.framework.parameters import Parameter, Values
from studies.framework.study import Finding, Outcome, RunJobs, Study, Table
from studies.primitives.setup import MILLIMETRES, named_object, OBJECT

PARAMETERS = (
    OBJECT,
    Parameter('robot_radius', 'm', 'radius of the robot'),
    Parameter('length', 'm', 'driven length of the simulated pushes'),
    Parameter('offset', 'm', 'distance of the simulated pushes from the middle of the face'))
# Places around the outline, chosen: a multiple of 8, so that vertices and middles of the faces of
# a square are among them.
BEARINGS = 144
# Rows of the simulated pushes; chosen for the figure.
SAMPLES = 30
# Speed of the simulated robot [m/s]: that of a slow push.
SPEED = 0.1
# Where the robot is before it is moved to the object [m]; chosen: beyond every outline.
AWAY = 2.0
# Room for the legend above the curves; chosen.
HEADROOM = 1.1
# Columns of the simulated pushes: loads as the object file has them, and the two extremes.
LOADS = {'nominal': 'nominal loads', 'least': 'shortest wheelbase',
         'greatest': 'longest wheelbase'}


def compute(values: Values, _: RunJobs) -> Outcome:
    """Take the ranges around the outline, and simulate one push for each extreme of the loads."""
    obj = named_object(values.object)
    tables = {'around': _around(obj), 'pushes': _pushes(obj, values)}
    return Outcome(tables, _findings(tables, _first_vertex(obj, tables['around']), values))


def _around(obj: PushedObject) -> Table:
    """Wheelbase over the bearing of the contact from the mass centre."""
    bearings = np.linspace(-math.pi, math.pi, BEARINGS + 1)
    rows: list[tuple[float, ...]] = []
    for bearing in bearings.tolist():
        point = _on_outline(obj, bearing)
        ranges = unknown_loads(obj, point)
        nominal = vehicle(obj, point)
        rows.append((bearing, nominal.wheelbase, *ranges.wheelbase, nominal.c_squared,
                     *ranges.c_squared))
    names = ('bearing_rad', 'wheelbase_m', 'least_wheelbase_m', 'greatest_wheelbase_m',
             'c_squared_m2', 'least_c_squared_m2', 'greatest_c_squared_m2')
    return dict(zip(names, np.array(rows).T))


def _on_outline(obj: PushedObject, bearing: float) -> tuple[float, float]:
    """Point of the outline that a line from the mass centre meets."""
    g_x, g_y = obj.center_of_mass
    e_x, e_y = math.cos(bearing), math.sin(bearing)
    if obj.radius:
        return obj.radius * e_x, obj.radius * e_y
    distance = math.inf
    for i, (x, y) in enumerate(obj.outline):
        x_0, y_0 = obj.outline[i - 1]
        # Inward distance of the mass centre from the edge, and what it loses along the line.
        n_x, n_y = y_0 - y, x - x_0
        loss = -(n_x * e_x + n_y * e_y)
        if loss > 0.0:
            distance = min(distance, (n_x * (g_x - x) + n_y * (g_y - y)) / loss)
    return g_x + distance * e_x, g_y + distance * e_y


def _pushes(obj: PushedObject, values: Values) -> Table:
    """Rotation over the driven length, for the nominal loads and the extremes."""
    times = np.linspace(0.0, values.length / SPEED, SAMPLES + 1)
    robot = RoundRobot(values.robot_radius, 'holonomic', time_constant=0.0)
    origin = Pose(0.0, 0.0, 0.0)
    gap = find_contact(obj, origin, (-AWAY, values.offset), robot.radius).gap
    start = Pose(gap - AWAY, values.offset, 0.0)
    point = start.x + robot.radius, values.offset
    extremes = sorted(extreme_objects(obj), key=lambda one: vehicle(one, point).wheelbase)
    columns: Table = {'length_m': SPEED * times}
    for name, one in (('nominal', obj), ('least', extremes[0]), ('greatest', extremes[-1])):
        plant = Plant(one, robot, origin, start)
        rotations = [0.0]
        for duration in np.diff(times).tolist():
            plant.advance(duration, Twist(SPEED, 0.0, 0.0))
            rotations.append(plant.object_pose.theta)
        columns[f'{name}_rad'] = np.array(rotations)
    return columns


def _first_vertex(obj: PushedObject, around: Table) -> int:
    """Row of the first vertex of the outline; of a disc, of where it is zero."""
    x, y = obj.outline[0] if obj.outline else (1.0, 0.0)
    bearing = math.atan2(y - obj.center_of_mass[1], x - obj.center_of_mass[0])
    return int(np.argmin(np.abs(around['bearing_rad'] - bearing)))


def _findings(tables: dict[str, Table], vertex: int, values: Values) -> dict[str, Finding]:
    around, pushes = tables['around'], tables['pushes']
    span = around['greatest_wheelbase_m'] - around['least_wheelbase_m']
    nominal = float(around['c_squared_m2'][vertex])
    ends = [abs(math.degrees(pushes[f'{name}_rad'][-1])) for name in LOADS]
    prior = ControlSettings().c_squared_log_std
    return {
        'least': Finding(float(around['least_wheelbase_m'][vertex]), 'm',
                         'least wheelbase at a vertex'),
        'nominal': Finding(float(around['wheelbase_m'][vertex]), 'm', 'nominal wheelbase'),
        'greatest': Finding(float(around['greatest_wheelbase_m'][vertex]), 'm', 'greatest'),
        'narrowest': Finding(MILLIMETRES * float(span.min()), 'mm',
                             'range of the wheelbase where loads matter least'),
        'least_ratio': Finding(float(around['least_c_squared_m2'][vertex]) / nominal, '',
                               'least c^2 over the nominal one'),
        'greatest_ratio': Finding(float(around['greatest_c_squared_m2'][vertex]) / nominal, '',
                                  'greatest c^2 over the nominal one'),
        'prior_low': Finding(math.exp(-2.0 * prior), '', 'the same at two standard deviations of '
                             'the default of control.c_squared_log_std'),
        'prior_high': Finding(math.exp(2.0 * prior), '', 'likewise, upwards'),
        'length': Finding(values.length, 'm', 'driven length'),
        'offset': Finding(MILLIMETRES * values.offset, 'mm', 'offset of the simulated pushes'),
        **{f'turn_{name}': Finding(end, 'deg', f'rotation at the end, {label}')
           for (name, label), end in zip(LOADS.items(), ends)}}


def draw(figure: Figure, outcome: Outcome, _: Values) -> None:
    """Draw the wheelbase around the outline, and the rotation of the pushes."""
    left, right = figure.subplots(1, 2)
    _draw_ranges(left, outcome.tables['around'])
    pushes = outcome.tables['pushes']
    for index, (name, label) in enumerate(LOADS.items()):
        right.plot(pushes['length_m'], np.degrees(pushes[f'{name}_rad']), label=label,
                   **plot_style.series(index))
    right.set(xlabel='driven length [m]', ylabel='rotation [deg]')
    right.legend()


def _draw_ranges(axes: Axes, around: Table) -> None:
    bearings, style = np.degrees(around['bearing_rad']), plot_style.series(0)
    axes.fill_between(bearings, around['least_wheelbase_m'], around['greatest_wheelbase_m'],
                      color=style['color'], alpha=0.25, linewidth=0.0, label='all loads')
    axes.plot(bearings, around['wheelbase_m'], label=LOADS['nominal'], **style)
    axes.set(xlabel='bearing of the contact from the mass centre [deg]',
             ylabel='wheelbase L [m]', xticks=np.arange(-180, 181, 45),
             ylim=(None, HEADROOM * float(around['greatest_wheelbase_m'].max())))
    axes.legend(ncols=2, loc='upper center')


STUDIES = (
    Study('P.11', 'Loads that nobody knows', PARAMETERS, compute, draw,
          'Statics leaves open how four feet share the weight: the object may stand on either '
          'diagonal. At a vertex the wheelbase is then {least:.3f} to {greatest:.3f} m, '
          '{nominal:.3f} m with nominal loads; in the middle of a face the range is '
          '{narrowest:.0f} mm wide. A straight push of {length:g} m, {offset:.0f} mm beside the '
          'middle, turns the object by {turn_least:.1f} to {turn_greatest:.1f} degrees, '
          '{turn_nominal:.1f} with nominal loads.',
          'The wheelbase is r + c^2 / r, c^2 the mean square of the feet along the push, weighted '
          'by load. Feet on the diagonal along the push add most, those on the other one '
          'nothing; from the middle of a face all feet are equally far. Even friction keeps the '
          'centre of friction below the mass centre. At a vertex c^2 is {least_ratio:.1f} to '
          '{greatest_ratio:.1f} times the nominal one; two standard deviations of the default '
          'prior of the controller are {prior_low:.2f} to {prior_high:.2f} times.', (9.2, 4.4)),)
