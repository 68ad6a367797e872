"""
Best-first search over straight pushes: weighted A* in (x, y, theta, face), compiled.

A node is a pose of the object, the face that was pushed last and the place of the robot after it.
Its successors are the straight pushes whose first contact the robot reaches, as long as neither
meets an obstacle; the estimate of what remains,

    h = W (1 / v + c_r / 0.8 m) + |theta - theta_goal| (c_r / 0.6 rad + 0.5 s / rad) b(W) + V_1,

charges a push at speed v along the path of length W on the ``DistanceGrid``, and contacts of c_r
each for distance and rotation; b falls from 1 to 0.15 on the last metre and a half, as on a long
path the object is turned in passing. On the last metre h is the cost-to-go V of open floor, if
that is more; V_1 is what that has in excess there. Farther off V misleads: it sees no walls. Nodes
come in the order of g + w h. The search ends at a node from which the floor is open up to the
goal, or in a push that ends at the goal itself.

Functions take only those parts of the ``Problem`` that they read: the time to compile them grows
with the number of arrays in their arguments.
"""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from push_dynamics.compiled import compiled
from push_model.geometry import BoolArray, FloatArray, IntArray, Pose
from push_planner.map_search.object_distance import DistanceGrid, length_at, UNREACHED
from push_planner.map_search.priority_queue import push, remove_first
from push_planner.map_search.robot_reach import fill_reach, needed_gap, path_length
from push_planner.map_search.scene import clearance, object_clearance
from push_primitives.cost_to_go import interpolate_cost, wrapped

# Numbers of a node: pose of the object, cost [s], place of the robot, length of the last push.
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
NODES, QUEUED, EXPANDED, REACH_FILLED, NEAREST = range(5)
COUNTER_SIZE = 5
# Of a node: length of a push from it that ends at the goal [m], the miss of that over the
# tolerances, and the clearance of the object [m].
LENGTH_TO_GOAL, MISS, GAP = range(3)
FINAL_SIZE = 3
# How a search ends, where it finds nothing: all nodes are expanded, or as many as allowed.
EXHAUSTED, LIMIT = -1, -2
# Cells near the goal, where otherwise all corrections would fall into one: side [m], headings of a
# turn; chosen.
FINE_CELL, FINE_HEADINGS = 0.02, 72
FINE_DISTANCE, FINE_ANGLE = 0.25, 0.6
# Distance from the start along either axis within which the object may keep the clearance that it
# has [m]; chosen: along a wall until there is room behind it.
START_RANGE = 0.6
# Distance and rotation after which the estimate charges another contact [m, rad]; fitted to
# plans: without the charge ten times as many nodes are expanded.
CONTACT_DISTANCE, CONTACT_ROTATION = 0.8, 0.6
ROTATION_TIME = 0.5
# Length of the path from which on the cost-to-go of open floor counts [m]; chosen.
CLOSE_DISTANCE = 1.0
PASSING_DISTANCE, LEAST_PASSING = 1.5, 0.15
# From this distance on pushes that end at the goal are sought [m]; chosen.
FINAL_RANGE = 0.6
# A push may end beside the goal by this multiple of the tolerances, if that is this much nearer
# than the object is before it; chosen: the correction that it needs counts in its cost, as this
# part of a contact for each tolerance.
LARGEST_MISS, MISS_RATIO = 5.0, 0.33
MISS_COST = 0.4
# Time that the standard deviation of a last push costs [s/m], as what it misses has to be
# corrected; chosen: 1 cm counts as a fifth of a contact.
SPREAD_COST = 100.0
# Time charged for a place that may be a dead end [s]: where the robot has no room at any two
# opposite faces; or, of a disc, which rolls off along the line to it however it pushes, none to
# push it off an obstacle at this angle [rad], of which one place of the table is certain to have
# most. For the direction of the obstacle the floor is looked at so far from the middle [m].
DEAD_END_COST = 20.0
LEAVING_ANGLE = math.radians(20.0)
GRADIENT_STEP = 0.05
# Steps between the floor is looked at on a line to the goal [m].
OPEN_STEP = 0.1
# Gap before the contact from which on the robot drives straight, and after a push [m].
STANDOFF, RETREAT = 0.06, 0.06
# What clearance the object gains per distance from a start or goal that has less, and the length
# on which it may keep that of the start [m]; chosen: it can slide along a wall for so long.
MARGIN_SLOPE = 0.3
SLIDING_LENGTH = 0.3
# Cosine between the normals of faces that are opposite.
OPPOSITE = -0.9
# Clearance that is no longer looked at [m], the least that start and goal are taken to have, and
# what a push may lose where there is little [m]; chosen.
ENOUGH, LEAST_GAP, LOST_GAP = 0.3, -0.02, 0.003
# First length of which the sweep is looked at: shorter ones move the object by less than a margin.
FIRST_SWEEP = 0.04


class Query(NamedTuple):
    """
    What is searched for, in the frame of the map.

    :param start: ``Pose`` of the object.
    :param robot: ``Pose`` of the robot.
    :param goal: ``Pose`` of the object.
    :param position_tolerance: distance from the goal at which a push ends there [m].
    :param heading_tolerance: likewise [rad].
    :param open_radius: clearance from which on the floor counts as open [m].
    :param object_margin: clearance of the object [m], but at start and goal.
    :param spread_factor: standard deviations of a vertex that are added to it.
    :param goal_margin: clearance of the goal, to which a push may keep there [m].
    :param contact_time: of a contact besides pushing and driving [s].
    :param pushing_speed: [m/s].
    :param robot_speed: [m/s].
    :param closing_time: that the cost-to-go of open floor has in excess at ``CLOSE_DISTANCE`` [s].
    :param weight: of the estimate, at least 1.
    :param max_expansions: number of nodes that are expanded at most.
    :param cell: side of the cells of the lattice, in which only the cheapest node is kept [m].
    :param headings: of a turn that it distinguishes.
    :param dense_range: distance of the object from its start, along either axis, within which it
        is pushed at all places and with all tilts [m].
    :param half: half the side of the window in which the robot comes from one contact to another.
    :param first_half: likewise to the first contact.
    """

    start: Pose
    robot: Pose
    goal: Pose
    position_tolerance: float
    heading_tolerance: float
    open_radius: float
    object_margin: float
    spread_factor: float
    goal_margin: float
    contact_time: float
    pushing_speed: float
    robot_speed: float
    closing_time: float
    weight: float
    max_expansions: int
    cell: float
    headings: int
    dense_range: float
    half: int
    first_half: int


class OpenFloor(NamedTuple):
    """Cost-to-go of open floor; fields as of ``CostToGo``."""

    values: NDArray[np.float32]
    distances: FloatArray
    headings: FloatArray


class Guide(NamedTuple):
    """
    What the estimate reads of map and object.

    :param grid: ``DistanceGrid`` to the goal.
    :param open_floor: ``OpenFloor``.
    """

    grid: DistanceGrid
    open_floor: OpenFloor


class Choices(NamedTuple):
    """
    Pushes to choose from; fields as of ``Pushes``.

    The first axis of ``means``, ``spreads`` and ``last`` has first pushes, of a robot whose place
    is as uncertain as it is now, and later ones, of a robot that is localized. In ``last`` 0 is
    for pushes that are not allowed.
    """

    faces: IntArray
    starts: FloatArray
    lengths: FloatArray
    means: FloatArray
    spreads: FloatArray
    last: IntArray
    coarse: BoolArray
    is_end: BoolArray
    middles: FloatArray
    normals: FloatArray


class Problem(NamedTuple):
    """
    All that a search reads.

    :param scene: ``Scene``.
    :param choices: ``Choices``.
    :param guide: ``Guide``.
    :param margins: ``RobotMargins``.
    :param first_margins: likewise on the way to the first push.
    :param query: ``Query``.
    """

    scene: Any
    choices: Choices
    guide: Guide
    margins: Any
    first_margins: Any
    query: Query


class Memory(NamedTuple):
    """
    All that a search writes.

    :param nodes: shape (n, ``NODE_SIZE``).
    :param links: shape (n, ``LINK_SIZE``).
    :param keys: of the queue, shape (2 n,).
    :param items: of the queue, shape (2 n,).
    :param slots: hash table of lattice cells, shape (k, ``SLOT_SIZE``), k a power of two.
    :param reach: ``Reach``.
    :param pose: of the object that is being looked at, shape (3,).
    :param final: of the push that is, shape (``FINAL_SIZE``,).
    :param counters: shape (``COUNTER_SIZE``,).
    """

    nodes: FloatArray
    links: IntArray
    keys: FloatArray
    items: IntArray
    slots: IntArray
    reach: Any
    pose: FloatArray
    final: FloatArray
    counters: IntArray


@compiled
def search(problem: Any, memory: Any) -> int:
    """
    Search.

    :param problem: ``Problem``.
    :param memory: ``Memory``, with all slots -1 and all counters 0.
    :return: number of the node at which the search ends, ``EXHAUSTED`` or ``LIMIT``.
    """
    query, guide, counters = problem.query, problem.guide, memory.counters
    node, link = memory.nodes[0], memory.links[0]
    node[X], node[Y], node[THETA] = query.start.x, query.start.y, query.start.theta
    node[COST], node[LENGTH] = 0.0, 0.0
    node[ROBOT_X], node[ROBOT_Y] = query.robot.x, query.robot.y
    link[FACE], link[PARENT], link[PUSH], link[FINAL], link[CLOSED] = -1, -1, -1, 0, 0
    counters[NODES] = 1
    nearest = estimate(guide, query, node[X], node[Y], node[THETA], 0)
    if nearest >= UNREACHED:
        return EXHAUSTED
    counters[QUEUED] = push(memory.keys, memory.items, 0, query.weight * nearest, 0)
    while counters[QUEUED] > 0:
        number = memory.items[0]
        counters[QUEUED] = remove_first(memory.keys, memory.items, counters[QUEUED])
        if memory.links[number, CLOSED] == 1:
            continue
        memory.links[number, CLOSED] = 1
        counters[EXPANDED] += 1
        node = memory.nodes[number]
        if number > 0 and (memory.links[number, FINAL] == 1
                           or is_open(problem.scene.floor, query, node[X], node[Y])):
            return number
        remaining = estimate(guide, query, node[X], node[Y], node[THETA], 0)
        if remaining < nearest:
            nearest = remaining
            counters[NEAREST] = number
        room_left = memory.nodes.shape[0] - counters[NODES]
        if (counters[EXPANDED] >= query.max_expansions
                or room_left < 4 * problem.choices.starts.shape[0]):
            return LIMIT
        _expand(problem, memory, number)
    return EXHAUSTED


@compiled
def estimate(guide: Any, query: Any, x: float, y: float, theta: float, face: int) -> float:
    """
    Estimate the time that remains.

    :param guide: ``Guide``.
    :param query: ``Query``.
    :param x: of the object in the frame of the map [m].
    :param y: likewise [m].
    :param theta: likewise [rad].
    :param face: that was pushed last.
    :return: time [s], ``UNREACHED`` where there is no path.
    """
    length = length_at(guide.grid, x, y)
    if length >= UNREACHED:
        return UNREACHED
    open_floor = guide.open_floor
    rotation = wrapped(query.goal.theta - theta)
    passing = min(1.0, max(LEAST_PASSING, PASSING_DISTANCE - length))
    time = (length * (1.0 / query.pushing_speed + query.contact_time / CONTACT_DISTANCE)
            + abs(rotation) * passing * (query.contact_time / CONTACT_ROTATION + ROTATION_TIME))
    if length > CLOSE_DISTANCE:
        return time + query.closing_time
    c, s = math.cos(theta), math.sin(theta)
    d_x, d_y = query.goal.x - x, query.goal.y - y
    return max(time, interpolate_cost(
        open_floor.values, open_floor.distances, open_floor.headings, c * d_x + s * d_y,
        c * d_y - s * d_x, rotation, face))


@compiled
def is_open(floor: Any, query: Any, x: float, y: float) -> bool:
    """
    Tell whether the floor is open from a place of the object to the goal.

    :param floor: ``Floor``.
    :param query: ``Query``.
    :param x: of the object in the frame of the map [m].
    :param y: likewise [m].
    """
    needed, goal = query.open_radius, query.goal
    if clearance(floor, x, y) < needed:
        return False
    d_x, d_y = goal.x - x, goal.y - y
    count = 1 + int(math.sqrt(d_x * d_x + d_y * d_y) / OPEN_STEP)
    for k in range(count, 0, -1):
        part = k / count
        if clearance(floor, x + part * d_x, y + part * d_y) < needed:
            return False
    return True


@compiled
def _expand(problem: Any, memory: Any, number: int) -> None:
    """Add the successors of a node."""
    node, query, choices = memory.nodes[number], problem.query, problem.choices
    belief = _belief(number)
    memory.counters[REACH_FILLED] = 0
    d_x, d_y = query.goal.x - node[X], query.goal.y - node[Y]
    is_near = d_x * d_x + d_y * d_y < FINAL_RANGE * FINAL_RANGE
    memory.final[LENGTH_TO_GOAL] = 0.0
    memory.final[GAP] = UNREACHED
    away = max(abs(query.start.x - node[X]), abs(query.start.y - node[Y]))
    is_dense = away < query.dense_range
    if away < START_RANGE:
        memory.final[GAP] = max(LEAST_GAP, object_clearance(
            problem.scene, node[X], node[Y], node[THETA], ENOUGH) - LOST_GAP)
    for begin in range(choices.starts.shape[0]):
        last = choices.last[belief, begin]
        if last <= 0:
            continue
        if is_near:
            _find_final_length(query, choices.means[belief, begin], choices.lengths, last, node,
                               memory.final)
        if not (is_dense or choices.coarse[begin] or memory.final[LENGTH_TO_GOAL] > 0.0):
            continue
        travel = _travel(problem, memory, number, begin)
        if travel < UNREACHED:
            _add_pushes(problem, memory, number, begin, travel, is_dense)


@compiled
def _belief(number: int) -> int:
    """Return the place on the first axis of ``Choices`` of the pushes from a node."""
    return min(number, 1)


@compiled
def _find_final_length(query: Any, means: Any, lengths: Any, last_step: int, node: Any,
                       final: Any) -> None:
    """Write after which length a push ends at the goal, 0 where it passes it by, and its miss."""
    c, s = math.cos(node[THETA]), math.sin(node[THETA])
    d_x, d_y = query.goal.x - node[X], query.goal.y - node[Y]
    x, y, theta = c * d_x + s * d_y, c * d_y - s * d_x, wrapped(query.goal.theta - node[THETA])
    before = ((x * x + y * y) / (query.position_tolerance * query.position_tolerance)
              + theta * theta / (query.heading_tolerance * query.heading_tolerance))
    least = min(LARGEST_MISS * LARGEST_MISS, max(1.0, MISS_RATIO * MISS_RATIO * before))
    found = 0.0
    for step in range(1, last_step + 1):
        first, last = means[step - 1], means[step]
        u, v = last[0] - first[0], last[1] - first[1]
        square = u * u + v * v
        if square <= 0.0:
            continue
        t = min(1.0, max(0.0, ((x - first[0]) * u + (y - first[1]) * v) / square))
        e_x, e_y = x - first[0] - t * u, y - first[1] - t * v
        e_theta = theta - first[2] - t * (last[2] - first[2])
        error = ((e_x * e_x + e_y * e_y) / (query.position_tolerance * query.position_tolerance)
                 + e_theta * e_theta / (query.heading_tolerance * query.heading_tolerance))
        if error < least:
            least = error
            found = lengths[step - 1] + t * (lengths[step] - lengths[step - 1])
    final[LENGTH_TO_GOAL], final[MISS] = found, math.sqrt(least)


@compiled
def _travel(problem: Any, memory: Any, number: int, begin: int) -> float:
    """Find the length of the robot's path to a first contact [m], ``UNREACHED`` for none."""
    node, start, query = memory.nodes[number], problem.choices.starts[begin], problem.query
    u = start[0] - STANDOFF * math.cos(start[2])
    v = start[1] - STANDOFF * math.sin(start[2])
    c, s = math.cos(node[THETA]), math.sin(node[THETA])
    x, y = node[X] + c * u - s * v, node[Y] + s * u + c * v
    scene, counters = problem.scene, memory.counters
    margins = problem.first_margins if number == 0 else problem.margins
    straight = math.sqrt((x - node[ROBOT_X]) ** 2 + (y - node[ROBOT_Y]) ** 2)
    if clearance(scene.floor, x, y) < scene.robot_radius + needed_gap(margins, straight):
        return UNREACHED
    half = query.first_half if number == 0 else query.half
    if counters[REACH_FILLED] == 0:
        fill_reach(scene, margins, node, (node[ROBOT_X], node[ROBOT_Y]), half, memory.reach)
        counters[REACH_FILLED] = 1
    return path_length(memory.reach, node, half, x, y)


@compiled
def _add_pushes(problem: Any, memory: Any, number: int, begin: int, travel: float,
                is_dense: bool) -> None:
    """Add pushes that begin alike, and end after several lengths or at the goal."""
    choices, query, node = problem.choices, problem.query, memory.nodes[number]
    belief = _belief(number)
    cost = node[COST] + query.contact_time + travel / query.robot_speed
    final_length = memory.final[LENGTH_TO_GOAL]
    for step in range(1, choices.last[belief, begin] + 1):
        length = choices.lengths[step]
        if choices.lengths[step - 1] < final_length <= length:
            memory.pose[0], memory.pose[1] = query.goal.x, query.goal.y
            memory.pose[2] = query.goal.theta
            correction = (SPREAD_COST * choices.spreads[belief, begin, step]
                          + MISS_COST * query.contact_time * memory.final[MISS])
            _append(problem, memory, number, begin, final_length,
                    cost + final_length / query.pushing_speed + correction)
        if length < FIRST_SWEEP:
            continue
        _place(choices.means[belief, begin, step], node, memory.pose)
        if not _is_free(problem, memory, number, begin, step):
            return
        if (is_dense or choices.coarse[begin]) and choices.is_end[step]:
            _add_node(problem, memory, number, begin, length,
                      cost + length / query.pushing_speed)


@compiled
def _place(mean: Any, node: Any, pose: Any) -> None:
    """Write the pose of the object after a mean displacement."""
    c, s = math.cos(node[THETA]), math.sin(node[THETA])
    pose[0] = node[X] + c * mean[0] - s * mean[1]
    pose[1] = node[Y] + s * mean[0] + c * mean[1]
    pose[2] = node[THETA] + mean[2]


@compiled
def _is_free(problem: Any, memory: Any, number: int, begin: int, step: int) -> bool:
    """Tell whether object and robot are free after a length of a push, the object at a pose."""
    scene, query, choices, pose = problem.scene, problem.query, problem.choices, memory.pose
    length, spread = choices.lengths[step], choices.spreads[_belief(number), begin, step]
    margin = query.object_margin + query.spread_factor * spread
    # What start and goal lack cannot be had near them.
    margin = min(margin, memory.final[GAP] + MARGIN_SLOPE * max(0.0, length - SLIDING_LENGTH))
    d_x, d_y = query.goal.x - pose[0], query.goal.y - pose[1]
    margin = min(margin, query.goal_margin + MARGIN_SLOPE * math.sqrt(d_x * d_x + d_y * d_y))
    if object_clearance(scene, pose[0], pose[1], pose[2], margin) < margin:
        return False
    x, y = _robot_place(choices.starts[begin], memory.nodes[number], length)
    return clearance(scene.floor, x, y) >= scene.robot_radius + problem.margins.obstacles


@compiled
def _robot_place(start: Any, node: Any, length: float) -> tuple[float, float]:
    """Find the place of the robot on the line of a push."""
    u = start[0] + length * math.cos(start[2])
    v = start[1] + length * math.sin(start[2])
    c, s = math.cos(node[THETA]), math.sin(node[THETA])
    return node[X] + c * u - s * v, node[Y] + s * u + c * v


@compiled
def _add_node(problem: Any, memory: Any, number: int, begin: int, length: float,
              cost: float) -> None:
    """Add the end of a push, unless one in the same cell of the lattice is as cheap."""
    pose = memory.pose
    is_disc = problem.scene.vertices.shape[0] == 0
    if _is_dead_end(problem, pose):
        cost += DEAD_END_COST
    cell = _cell_number(problem.query, pose, problem.choices.faces[begin], is_disc)
    slots, slot = memory.slots, _find_slot(memory.slots, cell)
    if slots[slot, CELL] == cell:
        other = slots[slot, CELL_NODE]
        if memory.nodes[other, COST] <= cost + 1e-9:
            return
        memory.links[other, CLOSED] = 1
    added = memory.counters[NODES]
    if _append(problem, memory, number, begin, length, cost):
        memory.links[added, FINAL] = 0
        slots[slot, CELL], slots[slot, CELL_NODE] = cell, added


@compiled
def _append(problem: Any, memory: Any, number: int, begin: int, length: float,
            cost: float) -> bool:
    """Append the end of a push, taken to be at the goal; tell whether there is a path on."""
    pose, query, counters = memory.pose, problem.query, memory.counters
    start, face = problem.choices.starts[begin], problem.choices.faces[begin]
    remaining = estimate(problem.guide, query, pose[0], pose[1], pose[2], face)
    if remaining >= UNREACHED:
        return False
    added = counters[NODES]
    node, link = memory.nodes[added], memory.links[added]
    node[X], node[Y], node[THETA], node[COST], node[LENGTH] = (
        pose[0], pose[1], pose[2], cost, length)
    node[ROBOT_X], node[ROBOT_Y] = _robot_place(start, memory.nodes[number], length - RETREAT)
    link[FACE], link[PARENT], link[PUSH], link[FINAL], link[CLOSED] = face, number, begin, 1, 0
    counters[NODES] = added + 1
    counters[QUEUED] = push(memory.keys, memory.items, counters[QUEUED],
                            cost + query.weight * remaining, added)
    return True


@compiled
def _is_dead_end(problem: Any, pose: Any) -> bool:
    """Tell whether the robot has no room where the object may have to be pushed next."""
    scene, choices = problem.scene, problem.choices
    needed = scene.robot_radius + problem.margins.obstacles
    if clearance(scene.floor, pose[0], pose[1]) >= scene.outer_radius + STANDOFF + 2.0 * needed:
        return False
    if scene.vertices.shape[0] == 0:
        return not _leaves_obstacle(scene, pose, needed)
    middles, normals = choices.middles, choices.normals
    for first in range(middles.shape[0]):
        if not _has_room(scene.floor, pose, middles[first], normals[first], needed):
            continue
        for second in range(first):
            cosine = (normals[first, 0] * normals[second, 0]
                      + normals[first, 1] * normals[second, 1])
            if cosine < OPPOSITE and _has_room(scene.floor, pose, middles[second],
                                               normals[second], needed):
                return False
    return True


@compiled
def _leaves_obstacle(scene: Any, pose: Any, needed: float) -> bool:
    """Tell whether the robot has room to push a disc off the nearest obstacle."""
    x, y = pose[0], pose[1]
    u = clearance(scene.floor, x + GRADIENT_STEP, y) - clearance(scene.floor, x - GRADIENT_STEP, y)
    v = clearance(scene.floor, x, y + GRADIENT_STEP) - clearance(scene.floor, x, y - GRADIENT_STEP)
    norm = math.sqrt(u * u + v * v)
    if norm < GRADIENT_STEP:
        # Between obstacles.
        return True
    away = scene.outer_radius + scene.robot_radius + STANDOFF
    back, aside = away * math.sin(LEAVING_ANGLE) / norm, away * math.cos(LEAVING_ANGLE) / norm
    return (clearance(scene.floor, x - back * u - aside * v, y - back * v + aside * u) >= needed
            or clearance(scene.floor, x - back * u + aside * v, y - back * v - aside * u)
            >= needed)


@compiled
def _has_room(floor: Any, pose: Any, middle: Any, normal: Any, needed: float) -> bool:
    """Tell whether the robot has room before the middle of a face."""
    u, v = middle[0] - STANDOFF * normal[0], middle[1] - STANDOFF * normal[1]
    c, s = math.cos(pose[2]), math.sin(pose[2])
    x, y = pose[0] + c * u - s * v, pose[1] + s * u + c * v
    return clearance(floor, x, y) >= needed


@compiled
def _cell_number(query: Any, pose: Any, face: int, is_disc: bool) -> int:
    """Return the number of the cell of the lattice in which a pose lies."""
    goal, cell, headings, kind = query.goal, query.cell, query.headings, 0
    if (abs(goal.x - pose[0]) < FINE_DISTANCE and abs(goal.y - pose[1]) < FINE_DISTANCE
            and abs(wrapped(goal.theta - pose[2])) < FINE_ANGLE):
        cell, headings, kind = FINE_CELL, FINE_HEADINGS, 1
    elif is_disc:
        # How a disc is turned, and where it was pushed, matters at its goal only.
        headings, face = 1, 0
    column, row = int(math.floor(pose[0] / cell)), int(math.floor(pose[1] / cell))
    heading = int(math.floor(pose[2] * headings / (2.0 * math.pi) + 0.5)) % headings
    number = (column * 1048576 + row) * 128 + heading
    return (number * 64 + face) * 2 + kind


@compiled
def _find_slot(slots: Any, cell: int) -> int:
    """Find the slot of a cell in the hash table, or the free one for it."""
    mask = slots.shape[0] - 1
    # Spreads the numbers of neighbouring cells; without overflow, compiled or not.
    slot = ((cell ^ (cell >> 17) ^ (cell >> 31)) & 0xFFFFFFFF) * 40503 & mask
    while slots[slot, CELL] not in (-1, cell):
        slot = (slot + 1) & mask
    return slot
