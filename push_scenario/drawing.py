"""What figure and animation have in common: colours that survive grey print, outlines, frames."""

import math

from matplotlib.patches import Circle, Polygon
import numpy as np
from push_model.geometry import Pose

PLAN, GOAL, INK = '#5A5A5A', '#007A5E', '#202020'
LAW_STYLES = {'open_loop': {'color': '#E58A00', 'linestyle': '-', 'linewidth': 1.8},
              'feedback': {'color': '#0B3C8C', 'linestyle': '-', 'linewidth': 3.0},
              'mpc': {'color': '#E0479E', 'linestyle': (0, (5, 1.5, 1, 1.5)), 'linewidth': 2.0}}
PLAN_STYLE = {'color': PLAN, 'linestyle': (0, (4, 2)), 'linewidth': 1.6}
DISC_SIDES = 60


def outline(obj, pose):
    """
    Outline of an object in the world.

    :param obj: the ``PushedObject``.
    :param pose: its (x, y, theta).
    :return: vertices, shape (k, 2) [m].
    """
    vertices = obj.outline or [(obj.radius * math.cos(angle), obj.radius * math.sin(angle))
                               for angle in np.linspace(0.0, 2 * math.pi, DISC_SIDES)]
    return np.array([Pose(*pose).transform(vertex) for vertex in vertices])


def front(obj, pose):
    """
    Short line that tells an object's front.

    :param obj: the ``PushedObject``.
    :param pose: its (x, y, theta).
    :return: x and y of both ends [m].
    """
    reach = max(x for x, _ in obj.outline) if obj.outline else obj.radius
    ends = [Pose(*pose).transform((share * reach, 0.0)) for share in (0.6, 1.0)]
    return tuple(zip(*ends))


def draw_object(axes, obj, pose, **style):
    """
    Draw an object with a notch that tells its front.

    :param axes: matplotlib axes.
    :param obj: the ``PushedObject``.
    :param pose: its (x, y, theta).
    :param style: of the polygon.
    :return: the artists.
    """
    patch = axes.add_patch(Polygon(outline(obj, pose), closed=True, **style))
    line = axes.plot(*front(obj, pose), color=style.get('edgecolor', INK),
                     linewidth=style.get('linewidth', 1.0), alpha=style.get('alpha'),
                     zorder=style.get('zorder'))
    return [patch, *line]


def draw_robot(axes, radius, pose, **style):
    """
    Draw a robot as a disc with a line that tells its heading.

    :param axes: matplotlib axes.
    :param radius: of the robot [m].
    :param pose: its (x, y, theta).
    :param style: of the disc.
    :return: the artists.
    """
    x, y, theta = pose
    patch = axes.add_patch(Circle((x, y), radius, **style))
    line = axes.plot([x, x + radius * math.cos(theta)], [y, y + radius * math.sin(theta)],
                     color=style.get('edgecolor', INK), linewidth=style.get('linewidth', 1.0),
                     alpha=style.get('alpha'), zorder=style.get('zorder'))
    return [patch, *line]


def set_view(axes, results, margin=0.1):
    """
    Show all that moves, at equal scale.

    :param axes: matplotlib axes.
    :param results: the ``Result`` of each run.
    :param margin: free rim [m].
    """
    scenario = results[0].scenario
    reach = [outline(scenario.object, scenario.goal.pose)]
    for result in results:
        reach += [outline(scenario.object, pose) for pose in result.tape.poses('object')[::25]]
        robots = result.tape.poses('robot')[:, :2]
        reach += [robots + scenario.robot.radius, robots - scenario.robot.radius]
    reach = np.concatenate(reach)
    low, high = reach.min(axis=0) - margin, reach.max(axis=0) + margin
    axes.set_xlim(low[0], high[0])
    axes.set_ylim(low[1], high[1])
    axes.set_aspect('equal')
    axes.set_xlabel('x [m]')
    axes.set_ylabel('y [m]')


def style_axes(axes):
    """
    Give axes a light grid and no upper and right spine.

    :param axes: matplotlib axes.
    """
    axes.grid(color='#D8D8D8', linewidth=0.6)
    axes.set_axisbelow(True)
    for side in ('top', 'right'):
        axes.spines[side].set_visible(False)
