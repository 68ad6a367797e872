"""Sketch 2.30 of where the mass must lie so that unequal support points bear equal friction."""

from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Rectangle
import numpy as np
from push_model.friction import friction_center
from push_model.geometry import Pose
from push_model.parameters import PushedObject
from scipy.optimize import root
from studies.framework import sketch
from studies.framework.box import (
    BOX_LENGTH, BOX_WIDTH, FRICTION, MASS, rectangle, supports_of_two_frictions,
)
from studies.framework.parameters import Parameter, Values
from studies.framework.study import Finding, Outcome, RunJobs, Study, Table

# Chosen: radius of the disc of the largest load [m].
MAX_DISC = 0.075
ORIGIN = Pose(0.0, 0.0, 0.0)
LOAD_FILL = '#C9D3E8'
MILLIMETRES = 1e3


def loaded_box(values: Values, mass_center: Any) -> PushedObject:
    """
    Make the box with rough support points on the right and a given centre of mass.

    :param values: with the parameters of the study.
    :param mass_center: (x, y), object frame [m].
    :return: the box.
    """
    return PushedObject(values.mass, supports=supports_of_two_frictions(values),
                        outline=rectangle(values.box_length, values.box_width),
                        center_of_mass=tuple(mass_center))


def balanced_box(values: Values) -> PushedObject:
    """
    Find the centre of mass for which the centre of friction is in the middle.

    :param values: with the parameters of the study.
    :return: the box.
    """
    solution = root(lambda center: friction_center(loaded_box(values, center)), (0.0, 0.0),
                    tol=1e-12)
    return loaded_box(values, solution.x.tolist())


def compute(values: Values, _: RunJobs) -> Outcome:
    """Compute loads and friction of the support points of the balanced box."""
    obj = balanced_box(values)
    unbalanced = friction_center(loaded_box(values, (0.0, 0.0)))
    center = friction_center(obj)
    table = {'x_m': [support.x for support in obj.supports],
             'y_m': [support.y for support in obj.supports],
             'load_N': obj.loads, 'capacity_N': obj.capacities}
    return Outcome({'supports': table}, {
        'shift': Finding(obj.center_of_mass[1], 'm', 'centre of mass to the left of the middle'),
        'residual': Finding(float(np.hypot(*center)), 'm', 'centre of friction from the middle'),
        'unbalanced': Finding(-unbalanced[1], 'm', 'centre of friction to the right of the '
                              'middle, with the centre of mass in the middle'),
        'capacity_range': Finding(float(np.ptp(obj.capacities)), 'N', 'difference of the greatest '
                                  'friction between support points')})


def draw(figure: Figure, outcome: Outcome, values: Values) -> None:
    """Draw the mass distribution on the left, loads and friction of the supports on the right."""
    left, right = figure.subplots(1, 2, width_ratios=(1.0, 1.75))
    obj = balanced_box(values)
    for axes in (left, right):
        sketch.set_up(axes)
        sketch.pushed_object(axes, obj, ORIGIN)
    _draw_mass(left, obj, values)
    _draw_supports(right, obj, outcome.tables['supports'])
    half_width = 0.75 * values.box_length + 0.17
    right.set_xlim(-half_width, half_width)
    left.set_title('(a) mass distribution', loc='left')
    right.set_title('(b) support points', loc='left')
    sketch.same_scale((left, right))


def _draw_mass(axes: Axes, obj: PushedObject, values: Values) -> None:
    """Draw the share of the mass on either side of the middle, with G and F."""
    shift = obj.center_of_mass[1] / (0.5 * values.box_width)
    # Two halves of the mass, each in the middle of its side: their ratio puts G where it is.
    for side in (1.0, -1.0):
        share = 0.5 * (1.0 + side * 2.0 * shift)
        length, width = values.box_length, 0.5 * values.box_width
        axes.add_patch(Rectangle((-0.5 * length, min(0.0, side * width)), length, width,
                                 facecolor=sketch.FORCE, alpha=0.35 * share, zorder=1.5,
                                 linewidth=0.0))
        sketch.label(axes, (0.12 * length, 0.62 * side * width),
                     f'{share * obj.mass:.2f} kg', 0.0, gap=18.0)
    sketch.mass_center(axes, obj.center_of_mass, '$G$', 0.0, 12.0)
    sketch.point(axes, friction_center(obj), '$F$', 300.0, 13.0, sketch.FLOOR)
    sketch.dimension(axes, friction_center(obj), obj.center_of_mass,
                     f'{MILLIMETRES * obj.center_of_mass[1]:.0f} mm', shift=0.09, gap=22.0)


def _draw_supports(axes: Axes, obj: PushedObject, table: Table) -> None:
    """Draw loads as discs and greatest friction as rings."""
    largest = max(table['load_N'])
    for number, (x, y, load, capacity) in enumerate(zip(*table.values()), 1):
        # Areas in proportion to the forces.
        axes.add_patch(Circle((x, y), MAX_DISC * (load / largest) ** 0.5,
                              facecolor=LOAD_FILL, edgecolor=sketch.FORCE, zorder=1.5))
        axes.add_patch(Circle((x, y), MAX_DISC * (capacity / largest) ** 0.5,
                              facecolor='none', edgecolor=sketch.FLOOR,
                              linestyle=(0, (3, 1.5)), linewidth=1.4, zorder=1.6))
        outward, side = (0.03, 0.0) if x > 0.0 else (-0.03, 180.0)
        sketch.label(axes, (x + outward, y),
                     f'$N_{number}$ = {load:.1f} N\n$\\mu N_{number}$ = {capacity:.1f} N', side,
                     gap=58.0, size=8.0)
    axes.plot([], [], 'o', color=sketch.FORCE, markerfacecolor=LOAD_FILL, markersize=9.0,
              label='load (area)')
    axes.plot([], [], 'o', color=sketch.FLOOR, markerfacecolor='none', markersize=9.0,
              label='greatest friction (area, same scale)')
    axes.legend(loc='lower center', bbox_to_anchor=(0.5, -0.14), ncols=2)


STUDIES = (Study(
    '2.30', '(a) Mass distribution for balanced support friction, (b) the support points',
    (BOX_LENGTH, BOX_WIDTH, MASS, FRICTION,
     Parameter('friction_right', '', 'friction of the support points on the right')),
    compute, draw,
    'The box faces right: its right side is below. The right support points are rougher. With the '
    'centre of mass G {shift:.3f} m left of the middle, all four bear the same friction.',
    'With G in the middle, F would lie {unbalanced:.3f} m to the right.', (8.4, 4.4)),)
