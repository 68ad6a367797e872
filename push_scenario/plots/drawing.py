"""What the figure and the animation of a run share: segments, colours, bodies, goals, the map."""

from collections.abc import Sequence
import math
from typing import Any, NamedTuple

from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, Polygon
import numpy as np
from numpy.typing import NDArray
from push_control.task.status import TaskState
from push_model.geometry import Pose
from push_model.parameters import PushedObject
from push_scenario.definition.scenario import Scenario
from push_scenario.simulation.result import RunResult
from push_sim_node.tape import Tape

FloatArray = NDArray[np.float64]
# (x, y, theta), or a row of an array of them.
PoseLike = Sequence[float] | FloatArray

# Colours that differ for colour-blind readers too; pushes beyond the sixth start over.
PUSH_COLORS = ('#0B3C8C', '#E58A00', '#C2185B', '#00838F', '#6A3D9A', '#8C6D1F')
PLAN, GOAL, INK = '#5A5A5A', '#007A5E', '#202020'
NO_PUSH, WALL, WARNING = '#7A7A7A', '#5C5C5C', '#B3261E'
DASHED_GOAL = (0, (2, 1))
PLAN_STYLE: dict[str, Any] = {'color': PLAN, 'linestyle': (0, (4, 2)), 'linewidth': 1.6}
ROBOT_PATH_STYLE: dict[str, Any] = {'color': NO_PUSH, 'linestyle': (0, (1, 1.6)),
                                    'linewidth': 1.6}
# A disc drawn with so many sides looks round at any size of the figure.
DISC_SIDES = 60
# The object is outlined at every so many rows of the tape to find what a view must show.
VIEW_STRIDE = 25


class StateRows(NamedTuple):
    """
    Rows of a tape during one state.

    :param state: the ``TaskState``; a single push is one segment in the state ``PUSH``.
    :param rows: slice of the tape, one row of the next segment included.
    :param push: number of the push, the first one 0; None where the robot does not push.
    :param reason: why the state was entered, empty where all went as it should.
    """

    state: TaskState
    rows: slice
    push: int | None
    reason: str

    @property
    def color(self) -> str:
        """Colour of the push, or that of a robot that does not push."""
        return NO_PUSH if self.push is None else PUSH_COLORS[self.push % len(PUSH_COLORS)]


def tape_of(result: RunResult) -> Tape:
    """
    Look up the tape of a run that moved.

    :raises ValueError: where the goal was refused and nothing moved.
    """
    if result.tape is None:
        raise ValueError(f'RunResult.tape: got None for {result.scenario.name}, expected a run in '
                         'which something moved')
    return result.tape


def segments_of(result: RunResult) -> list[StateRows]:
    """
    Cut a tape at the changes of state.

    :return: list of ``StateRows``, in order.
    """
    time, history = tape_of(result)['time'], result.history
    ends = [change.time for change in history[1:]] + [time[-1]]
    segments: list[StateRows] = []
    pushes = 0
    for index, (change, end) in enumerate(zip(history, ends)):
        # A state that is entered after the last row has that one.
        first, last = np.minimum(np.searchsorted(time, (change.time, end)), len(time) - 1)
        push = None
        if change.state is TaskState.PUSH:
            push = pushes
            pushes += 1
        segments.append(StateRows(change.state, slice(int(first), int(last) + 1), push,
                                  change.reason if index else ''))
    return segments


def goal_poses(scenario: Scenario, time: float = math.inf) -> list[Pose]:
    """
    Look up the goals that have been given.

    :param time: now [s]; goals that are given later are left out.
    :return: ``Pose`` of each, the valid one last.
    """
    later = scenario.task.goals if scenario.task is not None else ()
    return [scenario.goal.pose] + [goal.goal.pose for goal in later if goal.time <= time]


def outline(obj: PushedObject, pose: PoseLike) -> FloatArray:
    """
    Outline of an object in the world.

    :param pose: its (x, y, theta).
    :return: vertices, shape (k, 2) [m].
    """
    vertices = obj.outline or [(obj.radius * math.cos(angle), obj.radius * math.sin(angle))
                               for angle in np.linspace(0.0, 2 * math.pi, DISC_SIDES)]
    return np.array([Pose(*pose).transform(vertex) for vertex in vertices])


def front(obj: PushedObject, pose: PoseLike) -> tuple[tuple[float, ...], ...]:
    """
    Short line that marks an object's front.

    :param pose: its (x, y, theta).
    :return: x of both ends, y of both ends [m].
    """
    extent = max(x for x, _ in obj.outline) if obj.outline else obj.radius
    ends = [Pose(*pose).transform((ratio * extent, 0.0)) for ratio in (0.6, 1.0)]
    return tuple(zip(*ends))


def draw_object(axes: Axes, obj: PushedObject, pose: PoseLike,
                **style: Any) -> tuple[Polygon, Line2D]:
    """
    Draw an object with a line that marks its front.

    :param axes: matplotlib axes.
    :param pose: its (x, y, theta).
    :param style: of the polygon.
    :return: the artists.
    """
    patch = Polygon(outline(obj, pose), closed=True, **style)
    axes.add_patch(patch)
    line, = axes.plot(*front(obj, pose), color=style.get('edgecolor', INK),
                      linewidth=style.get('linewidth', 1.0), alpha=style.get('alpha'),
                      zorder=style.get('zorder'))
    return patch, line


def draw_robot(axes: Axes, radius: float, pose: PoseLike,
               **style: Any) -> tuple[Circle, Line2D]:
    """
    Draw a robot as a disc with a line that marks its heading.

    :param axes: matplotlib axes.
    :param radius: of the robot [m].
    :param pose: its (x, y, theta).
    :param style: of the disc.
    :return: the artists.
    """
    x, y, theta = pose
    patch = Circle((x, y), radius, **style)
    axes.add_patch(patch)
    line, = axes.plot([x, x + radius * math.cos(theta)], [y, y + radius * math.sin(theta)],
                      color=style.get('edgecolor', INK), linewidth=style.get('linewidth', 1.0),
                      alpha=style.get('alpha'), zorder=style.get('zorder'))
    return patch, line


def draw_map(axes: Axes, scenario: Scenario) -> None:
    """
    Draw the occupied cells of the map, if there is one.

    :param axes: matplotlib axes.
    """
    occupancy_map = None if scenario.task is None else scenario.task.occupancy_map
    if occupancy_map is None:
        return
    rows, columns = occupancy_map.occupied.shape
    grid = occupancy_map.resolution * np.stack(np.meshgrid(
        np.arange(columns + 1), np.arange(rows + 1)), axis=-1)
    x, y = occupancy_map.from_map(grid.reshape(-1, 2)).T.reshape(2, rows + 1, columns + 1)
    axes.pcolormesh(x, y, np.ma.masked_equal(occupancy_map.occupied, False),
                    cmap=ListedColormap([WALL]), zorder=1)


def draw_goals(axes: Axes, scenario: Scenario, time: float = math.inf) -> list[Artist]:
    """
    Draw the goal poses of the object; those that are no longer valid are thin.

    :param axes: matplotlib axes.
    :param time: now; goals that are given later are left out [s].
    :return: the artists.
    """
    *previous, valid = goal_poses(scenario, time)
    artists: list[Artist] = []
    for pose in previous:
        artists += draw_object(axes, scenario.object, pose, facecolor='none', edgecolor=GOAL,
                               linewidth=1.2, linestyle=DASHED_GOAL, alpha=0.6, zorder=5)
    artists += draw_object(axes, scenario.object, valid, facecolor='none', edgecolor=GOAL,
                           linewidth=2.6, linestyle=DASHED_GOAL, alpha=1.0, zorder=5)
    return artists


def draw_displacements(axes: Axes, result: RunResult) -> None:
    """
    Draw an arrow for every disturbance that displaces the object.

    :param axes: matplotlib axes.
    """
    tape = tape_of(result)
    time, poses = tape['time'], tape.poses('object')
    for displacement in result.scenario.simulation.object_displacements:
        row = int(np.searchsorted(time, displacement.time))
        if 0 < row < len(time):
            (x_before, y_before), (x, y) = poses[row - 1:row + 1, :2]
            axes.annotate('', (x, y), (x_before, y_before), zorder=9, arrowprops={
                'arrowstyle': '-|>', 'color': WARNING, 'linewidth': 2.0, 'shrinkA': 0.0,
                'shrinkB': 0.0, 'mutation_scale': 16.0})


def draw_push_number(axes: Axes, push: int, position: PoseLike) -> None:
    """
    Write the number of a push.

    :param axes: matplotlib axes.
    :param push: its number, the first one 0.
    :param position: (x, y) [m].
    """
    color = PUSH_COLORS[push % len(PUSH_COLORS)]
    axes.text(position[0], position[1], str(push + 1), ha='center', va='center', fontsize=10,
              zorder=12, color='white', bbox={'boxstyle': 'circle,pad=0.22', 'facecolor': color,
                                              'edgecolor': INK, 'linewidth': 0.6})


def set_view(axes: Axes, results: Sequence[RunResult], margin: float) -> tuple[float, float]:
    """
    Show the map, or all that moves where there is none, at equal scale.

    :param axes: matplotlib axes.
    :param results: the ``RunResult`` of each run.
    :param margin: free rim without a map [m].
    :return: width and height of what is shown [m].
    """
    low, high = map_extent(results[0].scenario)
    if low is None or high is None:
        shown = _moving_points(results)
        low, high = shown.min(axis=0) - margin, shown.max(axis=0) + margin
    axes.set_xlim(low[0], high[0])
    axes.set_ylim(low[1], high[1])
    axes.set_aspect('equal')
    return float(high[0] - low[0]), float(high[1] - low[1])


def map_extent(scenario: Scenario) -> tuple[FloatArray | None, FloatArray | None]:
    """Return the lower left and upper right corners of the map [m]; None where there is none."""
    occupancy_map = None if scenario.task is None else scenario.task.occupancy_map
    if occupancy_map is None:
        return None, None
    rows, columns = occupancy_map.occupied.shape
    corners = occupancy_map.resolution * np.array([[0, 0], [columns, 0], [0, rows],
                                                   [columns, rows]])
    shown = occupancy_map.from_map(corners)
    return shown.min(axis=0), shown.max(axis=0)


def _moving_points(results: Sequence[RunResult]) -> FloatArray:
    scenario = results[0].scenario
    points = [outline(scenario.object, pose) for pose in goal_poses(scenario)]
    for result in results:
        tape = tape_of(result)
        points += [outline(scenario.object, pose) for pose in tape.poses('object')[::VIEW_STRIDE]]
        robots = tape.poses('robot')[:, :2]
        points += [robots + scenario.robot.radius, robots - scenario.robot.radius]
    return np.concatenate(points)


def style_axes(axes: Axes) -> None:
    """
    Give axes a light grid and no upper and right spine.

    :param axes: matplotlib axes.
    """
    axes.grid(color='#D8D8D8', linewidth=0.6)
    axes.set_axisbelow(True)
    for side in ('top', 'right'):
        axes.spines[side].set_visible(False)
