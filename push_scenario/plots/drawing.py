"""What figure and animation of a task have in common: phases, colours, marks, walls."""

import math
from typing import NamedTuple

from matplotlib.colors import ListedColormap
from matplotlib.patches import Circle, Polygon
import numpy as np
from push_control.task.status import TaskState
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


PUSH_COLORS = ('#0B3C8C', '#E58A00', '#C2185B', '#00838F', '#6A3D9A', '#8C6D1F')
ALONE, WALL, TROUBLE = '#7A7A7A', '#5C5C5C', '#B3261E'
ALONE_STYLE = {'color': ALONE, 'linestyle': (0, (1, 1.6)), 'linewidth': 1.6}


class Phase(NamedTuple):
    """
    Rows of a tape during one state of the supervisor.

    :param state: the ``TaskState``.
    :param rows: slice of the tape, one row of the next state included.
    :param number: of the push, the first one 0; None where it does not push.
    :param trouble: why it was entered, empty where all went as it should.
    """

    state: TaskState
    rows: slice
    number: int | None
    trouble: str

    @property
    def color(self):
        """Colour of the push, or that of a robot alone."""
        return ALONE if self.number is None else PUSH_COLORS[self.number % len(PUSH_COLORS)]


def phases_of(result):
    """
    Cut a tape at the changes of state.

    :param result: the ``TaskResult``.
    :return: list of ``Phase``, in order.
    """
    time, history, pushes = result.tape['time'], result.history, 0
    ends = [change.time for change in history[1:]] + [time[-1]]
    phases = []
    for change, end in zip(history, ends):
        first, last = np.searchsorted(time, (change.time, end))
        number = pushes if change.state is TaskState.PUSH else None
        pushes += number is not None
        phases.append(Phase(change.state, slice(int(first), int(last) + 1), number,
                            change.reason if change is not history[0] else ''))
    return phases


def draw_map(axes, scenario):
    """
    Draw the occupied cells of the map, if there is one.

    :param axes: matplotlib axes.
    :param scenario: the ``Scenario``.
    """
    occupancy_map = scenario.task.occupancy_map
    if occupancy_map is None:
        return
    rows, columns = occupancy_map.occupied.shape
    grid = occupancy_map.resolution * np.stack(np.meshgrid(
        np.arange(columns + 1), np.arange(rows + 1)), axis=-1)
    x, y = occupancy_map.from_map(grid.reshape(-1, 2)).T.reshape(2, rows + 1, columns + 1)
    axes.pcolormesh(x, y, np.ma.masked_equal(occupancy_map.occupied, False),
                    cmap=ListedColormap([WALL]), zorder=1)


def draw_goals(axes, scenario, time=np.inf):
    """
    Draw where the object shall go; a goal that another takes the place of is thin.

    :param axes: matplotlib axes.
    :param scenario: the ``Scenario``.
    :param time: now; goals that are given later are left out [s].
    :return: the artists.
    """
    goals = [scenario.goal] + [later.goal for later in scenario.task.goals if later.time <= time]
    artists = []
    for goal in goals:
        last = goal is goals[-1]
        artists += draw_object(axes, scenario.object, goal.pose, facecolor='none', edgecolor=GOAL,
                               linewidth=2.6 if last else 1.2, linestyle=(0, (2, 1)),
                               alpha=1.0 if last else 0.6, zorder=5)
    return artists


def draw_shoves(axes, result):
    """
    Draw an arrow for every shove of the object.

    :param axes: matplotlib axes.
    :param result: the ``TaskResult``.
    """
    time, poses = result.tape['time'], result.tape.poses('object')
    for shove in result.scenario.simulation.object_displacements:
        row = int(np.searchsorted(time, shove.time))
        if 0 < row < len(time):
            axes.annotate('', poses[row, :2], poses[row - 1, :2], zorder=9, arrowprops={
                'arrowstyle': '-|>', 'color': TROUBLE, 'linewidth': 2.0, 'shrinkA': 0.0,
                'shrinkB': 0.0, 'mutation_scale': 16.0})


def set_task_view(axes, results, margin=0.12):
    """
    Show the map, or all that moves where there is none, at equal scale.

    :param axes: matplotlib axes.
    :param results: the ``TaskResult`` of each run.
    :param margin: free rim [m].
    :return: width and height of what is shown [m].
    """
    scenario = results[0].scenario
    occupancy_map = scenario.task.occupancy_map
    if occupancy_map is not None:
        rows, columns = occupancy_map.occupied.shape
        far = occupancy_map.resolution * np.array([[0, 0], [columns, 0], [0, rows], [columns, rows]])
        reach, margin = occupancy_map.from_map(far), 0.0
    else:
        goals = [scenario.goal] + [later.goal for later in scenario.task.goals]
        reach = [outline(scenario.object, goal.pose) for goal in goals]
        for result in results:
            reach += [outline(scenario.object, pose) for pose in result.tape.poses('object')[::25]]
            robots = result.tape.poses('robot')[:, :2]
            reach += [robots + scenario.robot.radius, robots - scenario.robot.radius]
        reach = np.concatenate(reach)
    low, high = reach.min(axis=0) - margin, reach.max(axis=0) + margin
    axes.set_xlim(low[0], high[0])
    axes.set_ylim(low[1], high[1])
    axes.set_aspect('equal')
    return high - low


def draw_push_number(axes, number, place):
    """
    Write the number of a push.

    :param axes: matplotlib axes.
    :param number: of the push, the first one 0.
    :param place: (x, y) [m].
    """
    color = PUSH_COLORS[number % len(PUSH_COLORS)]
    axes.text(*place, str(number + 1), ha='center', va='center', fontsize=10, zorder=12,
              color='white', bbox={'boxstyle': 'circle,pad=0.22', 'facecolor': color,
                                   'edgecolor': INK, 'linewidth': 0.6})
