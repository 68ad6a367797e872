"""Sketch 3.13 of where the support points of the tables 3.2 to 3.7 are."""

import math

from matplotlib.figure import Figure
from push_model.friction import c_squared, friction_center
from push_model.geometry import Pose
from push_model.quasi_static import vehicle
from studies.chapter3.errors.mismatched_push import MismatchedPush, PARAMETERS
from studies.framework import plot_style, sketch
from studies.framework.parameters import Values
from studies.framework.study import Finding, Outcome, RunJobs, Study

ORIGIN = Pose(0.0, 0.0, 0.0)
MILLIMETRES = 1e3


def compute(values: Values, _: RunJobs) -> Outcome:
    """Compute positions and loads of the support points."""
    obj = MismatchedPush.of(values).object
    contact = -0.5 * values.box_length, 0.0
    return Outcome({'supports': {
        'x_m': [support.x for support in obj.supports],
        'y_m': [support.y for support in obj.supports],
        'load_N': obj.loads, 'capacity_N': obj.capacities}}, {
        'spread': Finding(math.sqrt(c_squared(obj, 0.0)), 'm', 'root of c^2, the spread of the '
                          'support points along the push'),
        'wheelbase': Finding(vehicle(obj, contact).wheelbase, 'm', 'wheelbase L at the contact'),
        'load': Finding(float(obj.loads[0]), 'N', 'load on each support point')})


def draw(figure: Figure, outcome: Outcome, values: Values) -> None:
    """Draw the box from above, its support points numbered and dimensioned."""
    axes, obj = figure.subplots(), MismatchedPush.of(values).object
    sketch.set_up(axes)
    sketch.pushed_object(axes, obj, ORIGIN)
    table = outcome.tables['supports']
    for index, (x, y) in enumerate(zip(table['x_m'], table['y_m']), 1):
        sketch.label(axes, (x, y), f'$s_{index}$', math.degrees(math.atan2(y, x)), gap=13.0)
    x, y = table['x_m'][2], table['y_m'][2]
    sketch.dimension(axes, (-x, -y), (x, -y), f'{MILLIMETRES * 2.0 * x:.0f} mm', shift=-0.1,
                     side=-1)
    sketch.dimension(axes, (x, -y), (x, y), f'{MILLIMETRES * 2.0 * y:.0f} mm', shift=-0.1,
                     side=-1, gap=22.0)
    contact = -0.5 * values.box_length, 0.0
    sketch.arrow(axes, (contact[0] - 0.16, 0.0), (0.16, 0.0), '$v$', sketch.PUSH, at=0.4)
    sketch.point(axes, contact, '$C$', 40.0, 12.0, sketch.FORCE)
    sketch.mass_center(axes, friction_center(obj), '$G, F$', -45.0, 17.0)
    sketch.line(axes, contact, (0.5 * values.box_length, 0.0), color=plot_style.LIGHT,
                linewidth=0.8)


STUDIES = (Study(
    '3.13', 'Support points of the box in the tables 3.2 to 3.7', PARAMETERS, compute, draw,
    'The box stands on four support points, each with {load:.1f} N.',
    'Their spread along the push, {spread:.2f} m, makes the wheelbase {wheelbase:.3f} '
    'm.', (6.4, 4.6)),)
