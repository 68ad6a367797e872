"""
What a search over pushes reads and writes: arrays and small values that compiled code takes.

Functions take only those parts of the ``Problem`` that they read: the time to compile them grows
with the number of arrays in their arguments.
"""

from typing import NamedTuple

from push_model.geometry import FloatArray, IntArray, Pose
from push_planner.straight.map_search.object_distance import DistanceGrid
from push_planner.straight.map_search.pushes import Pushes
from push_planner.straight.map_search.reachable_set import ReachableSet, RobotMargins
from push_planner.straight.map_search.scene import Scene
from push_primitives.cost_to_go import CostGrid

# Values of a node: pose of the object, cost [s], position of the robot, length of the last push.
X, Y, THETA, COST, ROBOT_X, ROBOT_Y, LENGTH = range(7)
NODE_SIZE = 7
# Links of a node: face that was pushed last, node before, push in between, whether that ends at
# the goal, and whether the node is done with.
FACE, PARENT, PUSH, FINAL, CLOSED = range(5)
LINK_SIZE = 5
# Of a slot of the hash table: number of the lattice cell, or -1, and the node in it.
CELL, CELL_NODE = range(2)
SLOT_SIZE = 2
# Counters of a search.
NODES, QUEUED, EXPANDED, REACHABLE_FILLED, NEAREST, WORK = range(6)
COUNTER_SIZE = 6
# Of a node: length of a push from it that ends at the goal [m], the miss of that over the
# tolerances, and the clearance of the object [m].
LENGTH_TO_GOAL, MISS, GAP = range(3)
FINAL_SIZE = 3

# Tolerance of heading where any heading does [rad]: no error counts beside it.
FREE = 1e9


class Lattice(NamedTuple):
    """
    Lattice of poses of the object; of those in one cell only the cheapest is searched from.

    :param cell: side of a cell [m].
    :param headings: number of headings that it distinguishes in a turn; not of a disc.
    :param dense_range: distance of the object from its start, along either axis, within which it
        is pushed at all contact points and at all approach angles [m].
    """

    cell: float
    headings: int
    dense_range: float


class SearchSettings(NamedTuple):
    """
    Weights of a search.

    :param position_tolerance: distance from the goal at which a push ends there [m].
    :param heading_tolerance: likewise [rad]; ``FREE`` where any heading does.
    :param accepted_error: distance from the goal at which the task ends [m].
    :param open_radius: clearance from which on the floor counts as open [m].
    :param contact_time: of a contact besides pushing and driving [s].
    :param pushing_speed: [m/s].
    :param robot_speed: [m/s].
    :param weight: of the estimate, at least 1.
    """

    position_tolerance: float
    heading_tolerance: float
    accepted_error: float
    open_radius: float
    contact_time: float
    pushing_speed: float
    robot_speed: float
    weight: float = 1.5


class Query(NamedTuple):
    """
    Task of a search, in the frame of the map.

    :param start: pose of the object.
    :param robot: pose of the robot.
    :param goal: pose of the object.
    :param settings: ``SearchSettings``.
    :param lattice: ``Lattice``.
    :param object_margin: clearance of the object [m], but at start and goal.
    :param std_factor: standard deviations of a vertex that are added to it.
    :param goal_gap: clearance of the object at the goal [m].
    :param is_goal_enclosed: whether the goal is near, and no push leads back from it.
    :param closing_time: that the cost-to-go of open floor has in excess at ``CLOSE_DISTANCE`` [s].
    :param max_expansions: number of nodes that are expanded at most.
    :param max_work: that they take at most [grid points of the robot's paths].
    :param half: half the side of the window in which the robot comes from one contact to another
        [spacings of its grid].
    :param first_half: likewise to the first contact.
    """

    start: Pose
    robot: Pose
    goal: Pose
    settings: SearchSettings
    lattice: Lattice
    object_margin: float
    std_factor: float
    goal_gap: float
    is_goal_enclosed: bool
    closing_time: float
    max_expansions: int
    max_work: int
    half: int
    first_half: int


class Guide(NamedTuple):
    """
    Arrays of map and object that the estimate reads.

    :param grid: ``DistanceGrid`` to the goal.
    :param open_floor: ``CostGrid`` of open floor.
    """

    grid: DistanceGrid
    open_floor: CostGrid


class Problem(NamedTuple):
    """
    Inputs of a search.

    :param scene: ``Scene``.
    :param pushes: ``Pushes`` that it chooses from.
    :param guide: ``Guide``.
    :param margins: ``RobotMargins``.
    :param first_margins: likewise on the way to the first push.
    :param query: ``Query``.
    """

    scene: Scene
    pushes: Pushes
    guide: Guide
    margins: RobotMargins
    first_margins: RobotMargins
    query: Query


class Memory(NamedTuple):
    """
    Arrays that a search writes.

    :param nodes: shape (n, ``NODE_SIZE``).
    :param links: shape (n, ``LINK_SIZE``).
    :param keys: of the queue, shape (2 n,).
    :param items: of the queue, shape (2 n,).
    :param slots: hash table of lattice cells, shape (k, ``SLOT_SIZE``), k a power of two.
    :param reachable: ``ReachableSet``.
    :param pose: of the object that is being looked at, shape (3,).
    :param final: of the push that is, shape (``FINAL_SIZE``,).
    :param counters: shape (``COUNTER_SIZE``,).
    """

    nodes: FloatArray
    links: IntArray
    keys: FloatArray
    items: IntArray
    slots: IntArray
    reachable: ReachableSet
    pose: FloatArray
    final: FloatArray
    counters: IntArray
