"""
Successors of a node: pushes whose first contact the robot reaches, while nothing is in the way.

A push ends after one of several lengths, or at the goal itself.
"""

import math
from typing import Any

from push_dynamics.compiled import compiled
from push_navigation.floor import clearance
from push_planner.straight.map_search.chance import failure_cost
from push_planner.straight.map_search.dead_ends import is_dead_end, STANDOFF
from push_planner.straight.map_search.estimate import estimate, heading_error
from push_planner.straight.map_search.lattice import cell_key, find_slot, is_rolled
from push_planner.straight.map_search.object_distance import UNREACHED
from push_planner.straight.map_search.priority_queue import push
from push_planner.straight.map_search.problem import (
    CELL, CELL_NODE, CLOSED, COST, FACE, FINAL, FREE, GAP, LENGTH, LENGTH_TO_GOAL, MISS, NODES,
    PARENT, PUSH, QUEUED, REACHABLE_FILLED, ROBOT_X, ROBOT_Y, THETA, WORK, X, Y,
)
from push_planner.straight.map_search.pushes import FIRST, LATER
from push_planner.straight.map_search.reachable_set import (
    fill_reachable_set, needed_gap, path_length,
)
from push_planner.straight.map_search.scene import object_clearance

# Distance from the start along either axis within which the object may keep the clearance that it
# has [m]; chosen: along a wall until there is room behind it.
START_RANGE = 0.6
# From this distance on pushes that end at the goal are sought [m]; chosen.
FINAL_RANGE = 0.6
# A push may end beside the goal by this multiple of the tolerances, if that is this much nearer
# than the object is before it; chosen: the correction that it needs counts in its cost, as this
# part of a contact for each tolerance.
MAX_MISS, MISS_RATIO = 5.0, 0.33
# The same ratio where no push leads back from the goal: anything better is worth a push; chosen.
ENCLOSED_MISS_RATIO = 0.8
MISS_COST = 0.4
# Time that the standard deviation of a last push costs [s/m], as what it misses has to be
# corrected; chosen: 1 cm counts as a fifth of a contact.
STD_COST = 100.0
# Time charged for a position that may be a dead end [s]; chosen: several pushes.
DEAD_END_COST = 20.0
# Gap to which the robot backs off after a push [m].
RETREAT = 0.06
# What clearance the object gains per distance from a start or goal that has less, and the length
# on which it may keep that of the start [m]; chosen: it can slide along a wall for so long.
MARGIN_SLOPE = 0.3
SLIDING_LENGTH = 0.3
# Clearance that is no longer looked at [m]; what a push may lose where there is little [m]; and by
# how much it may overlap more than it does, at first [m] and for each length of it [m/m], no more
# than it may lose. Chosen: along a wall a box turns by some degrees, and a disc rolls, until the
# wall guides them.
ENOUGH, LOST_GAP, NEW_OVERLAP, SLIDING_SLOPE = 0.3, 0.018, 0.003, 0.1
# First length of which the sweep is looked at: shorter ones move the object by less than a margin.
FIRST_SWEEP = 0.04
# Work of a look at the clearances of a pose in a sweep [grid points of the robot's paths];
# measured with a table among clutter.
SWEEP_WORK = 2


@compiled
def expand(problem: Any, memory: Any, parent: int) -> None:
    """
    Add the successors of a node.

    :param problem: ``Problem``.
    :param memory: ``Memory``.
    :param parent: index of the node.
    """
    node, query, pushes = memory.nodes[parent], problem.query, problem.pushes
    stage = _stage(parent)
    memory.counters[REACHABLE_FILLED] = 0
    d_x, d_y = query.goal.x - node[X], query.goal.y - node[Y]
    is_near = d_x * d_x + d_y * d_y < FINAL_RANGE * FINAL_RANGE
    memory.final[LENGTH_TO_GOAL] = 0.0
    memory.final[GAP] = UNREACHED
    away = max(abs(query.start.x - node[X]), abs(query.start.y - node[Y]))
    is_disc = problem.scene.vertices.shape[0] == 0
    is_dense = away < query.lattice.dense_range or is_rolled(query, is_disc, node[X], node[Y])
    if away < START_RANGE:
        memory.final[GAP] = object_clearance(
            problem.scene, node[X], node[Y], node[THETA], ENOUGH)
    for option in range(pushes.starts.shape[0]):
        last = pushes.last[stage, option]
        if last <= 0:
            continue
        if is_near:
            _find_final_length(query, pushes.means[stage, option], pushes.lengths, last, node,
                               memory.final)
        if not (is_dense or pushes.coarse[option] or memory.final[LENGTH_TO_GOAL] > 0.0):
            continue
        travel = _travel(problem, memory, parent, option)
        if travel < UNREACHED:
            _add_pushes(problem, memory, parent, option, travel, is_dense)


@compiled
def least_gap(gap: float, length: float) -> float:
    """
    Compute to what clearance a push may come at a start or goal [m].

    :param gap: clearance of the object there [m].
    :param length: of the push [m].
    """
    overlap = min(LOST_GAP, NEW_OVERLAP + SLIDING_SLOPE * length)
    return max(gap - LOST_GAP, min(gap, 0.0) - overlap)


@compiled
def _stage(parent: int) -> int:
    """Tell whether pushes from a node are ``FIRST`` or ``LATER`` ones."""
    return FIRST if parent == 0 else LATER


@compiled
def _find_final_length(query: Any, means: Any, lengths: Any, last_step: int, node: Any,
                       final: Any) -> None:
    """Write after which length a push ends at the goal, 0 where it passes it by, and its miss."""
    c, s = math.cos(node[THETA]), math.sin(node[THETA])
    d_x, d_y = query.goal.x - node[X], query.goal.y - node[Y]
    x, y, theta = c * d_x + s * d_y, c * d_y - s * d_x, heading_error(query, node[THETA])
    before = _squared_miss(query, x, y, theta)
    ratio = ENCLOSED_MISS_RATIO if query.is_goal_enclosed else MISS_RATIO
    least = min(MAX_MISS * MAX_MISS, max(1.0, ratio * ratio * before))
    length = 0.0
    for step in range(1, last_step + 1):
        first, last = means[step - 1], means[step]
        fraction = _nearest_fraction(first, last, x, y)
        if fraction < 0.0:
            continue
        miss = _squared_miss(query, x - first[0] - fraction * (last[0] - first[0]),
                             y - first[1] - fraction * (last[1] - first[1]),
                             theta - first[2] - fraction * (last[2] - first[2]))
        if miss < least:
            least = miss
            length = lengths[step - 1] + fraction * (lengths[step] - lengths[step - 1])
    final[LENGTH_TO_GOAL], final[MISS] = length, math.sqrt(least)


@compiled
def _squared_miss(query: Any, x: float, y: float, theta: float) -> float:
    """Square of the distance from the goal, in tolerances of position and heading."""
    position, heading = query.settings.position_tolerance, query.settings.heading_tolerance
    return (x * x + y * y) / (position * position) + theta * theta / (heading * heading)


@compiled
def _nearest_fraction(first: Any, last: Any, x: float, y: float) -> float:
    """Find which part of the line between two poses comes nearest to a point, -1 for no line."""
    along_x, along_y = last[0] - first[0], last[1] - first[1]
    square = along_x * along_x + along_y * along_y
    if square <= 0.0:
        return -1.0
    return min(1.0, max(0.0, ((x - first[0]) * along_x + (y - first[1]) * along_y) / square))


@compiled
def _travel(problem: Any, memory: Any, parent: int, option: int) -> float:
    """Find the length of the robot's path to a first contact [m], ``UNREACHED`` for none."""
    node, start, query = memory.nodes[parent], problem.pushes.starts[option], problem.query
    u = start[0] - STANDOFF * math.cos(start[2])
    v = start[1] - STANDOFF * math.sin(start[2])
    c, s = math.cos(node[THETA]), math.sin(node[THETA])
    x, y = node[X] + c * u - s * v, node[Y] + s * u + c * v
    scene, counters = problem.scene, memory.counters
    margins = problem.first_margins if parent == 0 else problem.margins
    straight = math.sqrt((x - node[ROBOT_X]) ** 2 + (y - node[ROBOT_Y]) ** 2)
    if clearance(scene.floor, x, y) < scene.robot_radius + needed_gap(margins, straight):
        return UNREACHED
    half = query.first_half if parent == 0 else query.half
    if counters[REACHABLE_FILLED] == 0:
        counters[WORK] += fill_reachable_set(
            scene, margins, node, (node[ROBOT_X], node[ROBOT_Y]), half, memory.reachable)
        counters[REACHABLE_FILLED] = 1
    return path_length(memory.reachable, node, half, x, y)


@compiled
def _add_pushes(problem: Any, memory: Any, parent: int, option: int, travel: float,
                is_dense: bool) -> None:
    """Add pushes that start alike, and end after several lengths or at the goal."""
    pushes, query, node = problem.pushes, problem.query, memory.nodes[parent]
    stage = _stage(parent)
    cost = node[COST] + query.settings.contact_time + travel / query.settings.robot_speed
    final_length = memory.final[LENGTH_TO_GOAL]
    for step in range(1, pushes.last[stage, option] + 1):
        length = pushes.lengths[step]
        if pushes.lengths[step - 1] < final_length <= length:
            memory.pose[0], memory.pose[1] = query.goal.x, query.goal.y
            memory.pose[2] = _final_heading(query, pushes.means[stage, option, step], node)
            if _has_room_at_goal(problem, memory.pose):
                std, miss = pushes.stds[stage, option, step], memory.final[MISS]
                correction = (STD_COST * std + MISS_COST * query.settings.contact_time * miss
                              + failure_cost(query, miss, std, 0.0))
                _append(problem, memory, parent, option, final_length,
                        cost + final_length / query.settings.pushing_speed + correction)
        if length < FIRST_SWEEP:
            continue
        _write_pose(pushes.means[stage, option, step], node, memory.pose)
        memory.counters[WORK] += SWEEP_WORK
        if not _is_free(problem, memory, parent, option, step):
            return
        if (is_dense or pushes.coarse[option]) and pushes.is_end[step]:
            _add_node(problem, memory, parent, option, step,
                      cost + length / query.settings.pushing_speed)


@compiled
def _final_heading(query: Any, mean: Any, node: Any) -> float:
    """Heading of the object after a push that ends at the goal [rad]."""
    if query.settings.heading_tolerance >= FREE:
        return node[THETA] + mean[2]
    return query.goal.theta


@compiled
def _has_room_at_goal(problem: Any, pose: Any) -> bool:
    """Tell whether there is room at the goal for the heading with which the object comes there."""
    if problem.query.settings.heading_tolerance < FREE:
        return True
    needed = least_gap(problem.query.goal_gap, 0.0)
    return object_clearance(problem.scene, pose[0], pose[1], pose[2], needed) >= needed


@compiled
def _write_pose(mean: Any, node: Any, pose: Any) -> None:
    """Write the pose of the object after a mean displacement."""
    c, s = math.cos(node[THETA]), math.sin(node[THETA])
    pose[0] = node[X] + c * mean[0] - s * mean[1]
    pose[1] = node[Y] + s * mean[0] + c * mean[1]
    pose[2] = node[THETA] + mean[2]


@compiled
def _is_free(problem: Any, memory: Any, parent: int, option: int, step: int) -> bool:
    """Tell whether object and robot are free after a length of a push, the object at a pose."""
    scene, query, pushes, pose = problem.scene, problem.query, problem.pushes, memory.pose
    length, std = pushes.lengths[step], pushes.stds[_stage(parent), option, step]
    margin = query.object_margin + query.std_factor * std
    # What start and goal lack cannot be had near them.
    margin = min(margin, least_gap(memory.final[GAP], length)
                 + MARGIN_SLOPE * max(0.0, length - SLIDING_LENGTH))
    d_x, d_y = query.goal.x - pose[0], query.goal.y - pose[1]
    margin = min(margin, least_gap(query.goal_gap, length)
                 + MARGIN_SLOPE * math.sqrt(d_x * d_x + d_y * d_y))
    if object_clearance(scene, pose[0], pose[1], pose[2], margin) < margin:
        return False
    x, y = _robot_position(pushes.starts[option], memory.nodes[parent], length)
    return clearance(scene.floor, x, y) >= scene.robot_radius + problem.margins.obstacles


@compiled
def _robot_position(start: Any, node: Any, length: float) -> tuple[float, float]:
    """Find the position of the robot on the line of a push."""
    u = start[0] + length * math.cos(start[2])
    v = start[1] + length * math.sin(start[2])
    c, s = math.cos(node[THETA]), math.sin(node[THETA])
    return node[X] + c * u - s * v, node[Y] + s * u + c * v


@compiled
def _add_node(problem: Any, memory: Any, parent: int, option: int, step: int,
              cost: float) -> None:
    """Add the end of a push, unless one in the same cell of the lattice is as cheap."""
    pose, query, scene, pushes = memory.pose, problem.query, problem.scene, problem.pushes
    length = pushes.lengths[step]
    is_disc = scene.vertices.shape[0] == 0
    remaining = math.sqrt((query.goal.x - pose[0]) ** 2 + (query.goal.y - pose[1]) ** 2)
    if query.is_goal_enclosed and remaining < FINAL_RANGE:
        cost += failure_cost(query, 0.0, pushes.stds[_stage(parent), option, step], remaining)
    elif is_dead_end(scene, pushes, problem.margins.obstacles, pose):
        cost += DEAD_END_COST
    cell = cell_key(problem.query, pose, problem.pushes.faces[option], is_disc)
    slots, slot = memory.slots, find_slot(memory.slots, cell)
    if slots[slot, CELL] == cell:
        other = slots[slot, CELL_NODE]
        if memory.nodes[other, COST] <= cost + 1e-9:
            return
        memory.links[other, CLOSED] = 1
    added = memory.counters[NODES]
    if _append(problem, memory, parent, option, length, cost):
        memory.links[added, FINAL] = 0
        slots[slot, CELL], slots[slot, CELL_NODE] = cell, added


@compiled
def _append(problem: Any, memory: Any, parent: int, option: int, length: float,
            cost: float) -> bool:
    """Append the end of a push, taken to be at the goal; tell whether there is a path on."""
    pose, query, counters = memory.pose, problem.query, memory.counters
    start, face = problem.pushes.starts[option], problem.pushes.faces[option]
    remaining = estimate(problem.guide, query, pose[0], pose[1], pose[2], face)
    if remaining >= UNREACHED:
        return False
    added = counters[NODES]
    node, link = memory.nodes[added], memory.links[added]
    node[X], node[Y], node[THETA], node[COST], node[LENGTH] = (
        pose[0], pose[1], pose[2], cost, length)
    node[ROBOT_X], node[ROBOT_Y] = _robot_position(start, memory.nodes[parent], length - RETREAT)
    link[FACE], link[PARENT], link[PUSH], link[FINAL], link[CLOSED] = face, parent, option, 1, 0
    counters[NODES] = added + 1
    counters[QUEUED] = push(memory.keys, memory.items, counters[QUEUED],
                            cost + query.settings.weight * remaining, added)
    return True
