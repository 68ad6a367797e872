"""Search for the chain of straight pushes that brings an object to its goal through a map."""

import enum
import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from push_model.geometry import distance, FloatArray, Pose
from push_navigation.map_clearance import CERTAIN, PositionUncertainty
from push_planner.straight.map_search.dead_ends import is_dead_end
from push_planner.straight.map_search.estimate import CLOSE_DISTANCE, CONTACT_DISTANCE, estimate
from push_planner.straight.map_search.kernel import EXHAUSTED, LIMIT, search
from push_planner.straight.map_search.object_distance import DistanceGrid, UNREACHED
from push_planner.straight.map_search.problem import (
    CLOSED, COST, COUNTER_SIZE, EXPANDED, FACE, FINAL_SIZE, Guide, Lattice, LENGTH, LINK_SIZE,
    Memory, NEAREST, NODE_SIZE, NODES, PARENT, Problem, PUSH, Query, SearchSettings, SLOT_SIZE,
    WORK,
)
from push_planner.straight.map_search.pushes import FIRST, Pushes
from push_planner.straight.map_search.reachable_set import (
    HALF_WINDOW, ReachableSet, RobotMargins, SPACING, WIDE_WINDOW)
from push_planner.straight.map_search.scene import object_clearance, Scene
from push_planner.straight.map_search.successors import ENOUGH, START_RANGE
from push_primitives.cost_to_go import CostToGo

# Nodes of a search, chosen: some ten for each expanded node; and slots of its hash table, a power
# of two that they fill to a quarter.
MAX_NODES = 120000
SLOTS = 1 << 19
# Margins of the window round object and robot in which the robot comes to its first push [m], the
# second where nothing is found in the first, and the largest half side [spacings]; chosen: a robot
# may be two rooms away, and the door to them beyond a third.
WINDOW_MARGINS = 2.0, 10.0
MAX_HALF = 1000
# Places in the queue of grid points that wait; the rim of the area that is filled is shorter.
QUEUE_SIZE = 1 << 16
# Distance from which on the pushes to a goal are planned for what cannot be corrected there [m];
# chosen: those before it are planned anew until then.
CAUTIOUS_RANGE = 1.2
# Length of a path along rows, columns and diagonals over that of the straight one, at most.
GRID_LENGTHENING = math.sqrt(4.0 - 2.0 * math.sqrt(2.0))
# Bearings of the goal over which the cost-to-go is averaged [rad].
BEARINGS = tuple(np.linspace(-math.pi, math.pi, 8, endpoint=False).tolist())


class SearchEnd(enum.Enum):
    """End of a search."""

    FOUND = 'found'
    EXHAUSTED = 'all that can be reached was searched'
    LIMIT = 'the limit of the search was reached'


# Chosen: against the fine one, the coarse one takes a third of the expansions (a tenth where the
# first idea is a dead end) to plans that take 1 % longer in the median of flats and passages.
COARSE, FINE = Lattice(0.18, 12, 0.0), Lattice(0.06, 24, START_RANGE)


class Margins(NamedTuple):
    """
    Margins of a search, and how far it goes.

    :param object: clearance of the object from obstacles [m].
    :param std_factor: standard deviations of a vertex after a push that are added to it.
    :param robot: clearance of the robot from obstacles [m].
    :param robot_to_object: clearance of the robot from the object between pushes [m].
    :param uncertainty: ``PositionUncertainty`` of the robot on its way to the first push.
    :param sigmas: standard deviations of its position by which it keeps clear of obstacles there.
    :param max_expansions: of the search.
    :param max_work: of the search, as of ``Query``.
    :param is_wide: whether the robot may go round through other rooms.
    :param lattice: ``Lattice`` in which it searches.
    """

    object: float  # noqa: A003
    std_factor: float
    robot: float
    robot_to_object: float
    uncertainty: PositionUncertainty = CERTAIN
    sigmas: float = 1.0
    max_expansions: int = 2000
    max_work: int = 1 << 40
    is_wide: bool = False
    lattice: Lattice = COARSE


class SearchPush(NamedTuple):
    """
    A push of a found chain.

    :param push_index: among the ``Pushes``.
    :param length: driven length [m].
    :param start: ``Pose`` of the object before it, in the frame of the map.
    :param end: ``Pose`` of the object after it, expected.
    :param cost: expected time up to there [s].
    """

    push_index: int
    length: float
    start: Pose
    end: Pose
    cost: float


class SearchResult(NamedTuple):
    """
    Result of a search.

    :param end: ``SearchEnd``.
    :param pushes: ``SearchPush`` to the goal, or to where the floor is open up to it; those to the
        position from which least remained, where none was found.
    :param cost: expected time of the pushes and of what remains after them [s].
    :param least_cost: that no chain of the lattice goes below [s].
    :param expansions: number of nodes that were expanded.
    :param work: that they took [grid points of the robot's paths].
    :param farthest: largest distance of the object from its start among all nodes [m].
    :param nodes: (x, y, theta) of all nodes and index of the node before each, or -1, shape
        (n, 4).
    """

    end: SearchEnd
    pushes: tuple[SearchPush, ...]
    cost: float
    least_cost: float
    expansions: int
    work: int
    farthest: float
    nodes: NDArray[np.float64]


class MapSearch:
    """
    Search from one pose of object and robot; all in the frame of the map.

    :param scene: ``Scene``.
    :param pushes: ``Pushes`` to choose from.
    :param grid: ``DistanceGrid`` to the goal.
    :param cost_to_go: ``CostToGo`` of open floor.
    :param settings: ``SearchSettings``.
    """

    def __init__(self, scene: Scene, pushes: Pushes, grid: DistanceGrid, cost_to_go: CostToGo,
                 settings: SearchSettings) -> None:
        self._scene = scene
        self._pushes = pushes
        self._guide = Guide(grid, cost_to_go.grid)
        self._settings = settings
        self._closing_time = _closing_time(cost_to_go, settings)
        self._memory = _memory()

    def run(self, start: Pose, robot: Pose, goal: Pose, margins: Margins,
            blocked: NDArray[np.bool_]) -> SearchResult:
        """
        Search.

        :param blocked: whether a push may not come first, shape (n,).
        """
        problem, memory = self.prepare(start, robot, goal, margins, blocked)
        end = int(search(problem, memory))
        return self._result(problem, memory, end)

    def prepare(self, start: Pose, robot: Pose, goal: Pose, margins: Margins,
                blocked: NDArray[np.bool_]) -> tuple[Problem, Memory]:
        """
        Prepare what a search reads and writes; arguments as of ``run``.

        The memory is good for one search, until the next one is prepared.
        """
        away = max(abs(robot.x - start.x), abs(robot.y - start.y))
        half = WIDE_WINDOW if margins.is_wide else HALF_WINDOW
        first_half = min(MAX_HALF, max(half, math.ceil(
            (away + WINDOW_MARGINS[margins.is_wide]) / SPACING)))
        side = 2 * first_half + 1
        memory = self._memory._replace(reachable=ReachableSet(
            np.empty((side, side)), np.empty((side, side, 2)),
            np.empty(QUEUE_SIZE, dtype=np.int64)))
        memory.slots.fill(-1)
        memory.counters.fill(0)
        last = self._pushes.last.copy()
        last[FIRST, blocked] = 0
        problem = Problem(
            self._scene, self._pushes._replace(last=last), self._guide,
            RobotMargins(margins.robot, margins.robot_to_object), _first_margins(margins),
            Query(start, robot, goal, self._settings, margins.lattice,
                  object_margin=margins.object, std_factor=margins.std_factor,
                  goal_gap=self._clearance(goal),
                  is_goal_enclosed=self.is_goal_enclosed(start, goal, margins),
                  closing_time=self._closing_time,
                  max_expansions=margins.max_expansions, max_work=margins.max_work, half=half,
                  first_half=first_half))
        return problem, memory

    def _clearance(self, pose: Pose) -> float:
        return float(object_clearance(self._scene, *pose, ENOUGH))

    def is_goal_enclosed(self, start: Pose, goal: Pose, margins: Margins) -> bool:
        """Tell whether the goal is near, and no push leads back from it; not of a disc."""
        return (distance(start, goal) < CAUTIOUS_RANGE and len(self._scene.vertices) > 0
                and bool(is_dead_end(self._scene, self._pushes, margins.robot, goal)))

    def _result(self, problem: Problem, memory: Memory, end: int) -> SearchResult:
        ends = {EXHAUSTED: SearchEnd.EXHAUSTED, LIMIT: SearchEnd.LIMIT}
        last = end if end >= 0 else int(memory.counters[NEAREST])
        count = int(memory.counters[NODES])
        nodes, links = memory.nodes[:count], memory.links[:count]
        poses = [Pose(*nodes[last, :3].tolist())]
        pushes: list[SearchPush] = []
        index = last
        while links[index, PARENT] >= 0:
            length, cost = nodes[index, [LENGTH, COST]].tolist()
            option, index = links[index, [PUSH, PARENT]].tolist()
            poses.append(Pose(*nodes[index, :3].tolist()))
            pushes.append(SearchPush(option, length, poses[-1], poses[-2], cost))
        remaining = float(estimate(problem.guide, problem.query, *poses[0],
                                   max(0, links[last, FACE])))
        away = nodes[:, :2] - nodes[0, :2]
        cost = float(nodes[last, COST]) + remaining
        return SearchResult(
            ends.get(end, SearchEnd.FOUND), tuple(pushes[::-1]), cost,
            min(cost, self._least_cost(nodes[links[:, CLOSED] == 0])),
            int(memory.counters[EXPANDED]), int(memory.counters[WORK]),
            float(np.hypot(*away.T).max()),
            np.column_stack([nodes[:, :3], links[:, PARENT].astype(float)]))

    def _least_cost(self, nodes: FloatArray) -> float:
        """
        Bound the time of all chains that go on from nodes which were not expanded [s].

        They take one more contact at least, and the object is pushed along the shortest path.
        """
        if not len(nodes):
            return math.inf
        settings, grid = self._settings, self._guide.grid
        rows, columns = grid.lengths.shape
        row, column = ((nodes[:, axis] / grid.spacing).astype(int) for axis in (1, 0))
        lengths = np.full(len(nodes), UNREACHED)
        # Beside obstacles the nearest grid points may be off the path.
        for i in range(-1, 3):
            for j in range(-1, 3):
                nearby = np.clip(row + i, 0, rows - 1), np.clip(column + j, 0, columns - 1)
                lengths = np.minimum(lengths, grid.lengths[nearby])
        lengths = np.maximum(0.0, lengths / GRID_LENGTHENING)
        return float((nodes[:, COST] + settings.contact_time
                      + lengths / settings.pushing_speed).min())


def _first_margins(margins: Margins) -> RobotMargins:
    uncertainty, sigmas = margins.uncertainty, margins.sigmas
    return RobotMargins(
        margins.robot, margins.robot_to_object, sigmas * uncertainty.position,
        sigmas * uncertainty.slope, sigmas * uncertainty.drift)


def _closing_time(cost_to_go: CostToGo, settings: SearchSettings) -> float:
    """Mean excess of the cost-to-go of open floor, the object turned as at the goal [s]."""
    away = CLOSE_DISTANCE
    times = [cost_to_go.at(Pose(away * math.cos(bearing), away * math.sin(bearing), 0.0),
                           face)
             for bearing in BEARINGS for face in range(len(cost_to_go.values))]
    counted = away * (1.0 / settings.pushing_speed
                      + settings.contact_time / CONTACT_DISTANCE)
    return max(0.0, float(np.mean(times)) - counted)


def _memory() -> Memory:
    nothing = ReachableSet(np.empty((1, 1)), np.empty((1, 1, 2)), np.empty(1, dtype=np.int64))
    return Memory(
        np.empty((MAX_NODES, NODE_SIZE)),
        np.empty((MAX_NODES, LINK_SIZE), dtype=np.int64),
        np.empty(2 * MAX_NODES), np.empty(2 * MAX_NODES, dtype=np.int64),
        np.empty((SLOTS, SLOT_SIZE), dtype=np.int64), nothing, np.empty(3),
        np.empty(FINAL_SIZE), np.zeros(COUNTER_SIZE, dtype=np.int64))
