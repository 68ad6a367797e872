"""Sketch of how the mass must lie for the friction of unequal supports to be balanced."""

from matplotlib.patches import Circle
import numpy as np
from push_model.friction import friction_center
from push_model.geometry import Pose
from push_model.parameters import PushedObject, Support
from push_study.framework import scenes, sketch, sketch_body
from push_study.framework.study import Finding, Outcome, Parameter, Study
from scipy.optimize import root

SIZE = 0.075


def loaded(values, center):
    """
    Make the box with rough feet on the right and its mass centre somewhere.

    :param values: ``Values``.
    :param center: mass centre (x, y) [m].
    :return: ``PushedObject``.
    """
    outline = scenes.corners(values.box_length, values.box_width)
    feet = tuple(Support(x, y, values.friction_right if y < 0.0 else values.friction_coefficient)
                 for x, y in outline)
    return PushedObject(values.mass, supports=feet, outline=outline, center_of_mass=tuple(center))


def balanced(values):
    """
    Find the mass centre with which the friction centre is in the middle.

    :param values: ``Values``.
    :return: ``PushedObject``.
    """
    found = root(lambda center: friction_center(loaded(values, center)), (0.0, 0.0), tol=1e-12)
    return loaded(values, found.x.tolist())


def compute(values, batch):
    """
    Compute loads and friction of the supports of the balanced box.

    :param values: ``Values``.
    :param batch: not used.
    :return: ``Outcome``.
    """
    obj = balanced(values)
    middle, center = friction_center(loaded(values, (0.0, 0.0))), friction_center(obj)
    return Outcome({'supports': {'x_m': [foot.x for foot in obj.supports],
                                 'y_m': [foot.y for foot in obj.supports],
                                 'load_N': obj.loads, 'capacity_N': obj.capacities}}, {
        'shift': Finding(obj.center_of_mass[1], 'm', 'mass centre left of the middle'),
        'off': Finding(float(np.hypot(*center)), 'm', 'friction centre from the middle'),
        'before': Finding(-middle[1], 'm', 'friction centre right of the middle with the mass '
                                           'centre in the middle'),
        'capacity': Finding(float(np.ptp(obj.capacities)), 'N',
                            'difference between the supports in their greatest friction')})


def draw(figure, outcome, values):
    """
    Draw the box from above, loads as discs and greatest friction as rings.

    :param figure: matplotlib figure.
    :param outcome: the ``Outcome``.
    :param values: ``Values``.
    """
    axes = figure.subplots()
    sketch.sheet(axes)
    obj, table = balanced(values), outcome.tables['supports']
    sketch_body.solid(axes, obj, Pose(0.0, 0.0, 0.0))
    largest = max(table['load_N'])
    for number, (x, y, load, capacity) in enumerate(zip(*table.values()), 1):
        axes.add_patch(Circle((x, y), SIZE * (load / largest) ** 0.5, facecolor='#C9D3E8',
                              edgecolor=sketch.FORCE, zorder=1.5))
        axes.add_patch(Circle((x, y), SIZE * (capacity / largest) ** 0.5, facecolor='none',
                              edgecolor=sketch.FLOOR, linestyle=(0, (3, 1.5)), linewidth=1.4,
                              zorder=1.6))
        side = 0.0 if x > 0.0 else 180.0
        sketch.label(axes, (x + (0.03 if x > 0.0 else -0.03), y),
                     f'$N_{number}$ = {load:.1f} N\n$\\mu N_{number}$ = {capacity:.1f} N', side,
                     58.0, size=8.0)
    sketch_body.mass_centre(axes, obj.center_of_mass, '$G$', 0.0, 12.0)
    sketch_body.point(axes, friction_center(obj), '$F$', 0.0, 11.0, sketch.FLOOR)
    sketch.dimension(axes, friction_center(obj), obj.center_of_mass,
                     f'{1e3 * obj.center_of_mass[1]:.0f} mm', 0.06, 1, 22.0)
    axes.plot([], [], 'o', color=sketch.FORCE, markerfacecolor='#C9D3E8', markersize=9.0,
              label='load (area)')
    axes.plot([], [], 'o', color=sketch.FLOOR, markerfacecolor='none', markersize=9.0,
              label='greatest friction (area, same scale)')
    axes.legend(loc='lower center', bbox_to_anchor=(0.5, -0.14), ncols=2)
    axes.set_xlim(-0.75 * values.box_length - 0.17, 0.75 * values.box_length + 0.17)


STUDIES = (Study(
    '2.30', 'Mass distribution for balanced support friction',
    (*scenes.BOX[:4], Parameter('friction_right', '', 'friction of the supports on the right')),
    compute, draw,
    'The feet on the right rub more; with the mass centre G {shift:.3f} m to the left of the '
    'middle all four bear the same friction and the friction centre F is in the middle.',
    'Loads balance about G, so it takes load off the rough feet; with G in the middle, F would '
    'lie {before:.3f} m to the right.', (6.4, 4.6)),)
