"""
Best-first search over straight pushes: weighted A* in (x, y, theta, face), compiled.

A node is a pose of the object, the face that was pushed last and the position of the robot after
it. Its ``successors`` are the straight pushes whose first contact the robot reaches, as long as
neither meets an obstacle. Nodes come in the order of g + w h, with the ``estimate`` h of what
remains. The search ends at a node from which the floor is open up to the goal, or in a push that
ends at the goal itself. In front of a goal from which no push leads back it may end before, at the
most promising node.
"""

from push_dynamics.compiled import compiled
from push_planner.straight.map_search.estimate import estimate, is_open
from push_planner.straight.map_search.object_distance import UNREACHED
from push_planner.straight.map_search.priority_queue import push, remove_first
from push_planner.straight.map_search.problem import (
    CLOSED, COST, EXPANDED, FACE, FINAL, LENGTH, Memory, NEAREST, NODES, PARENT, Problem, PUSH,
    Query, QUEUED, ROBOT_X, ROBOT_Y, THETA, WORK, X, Y,
)
from push_planner.straight.map_search.successors import expand

# How a search ends, where it finds nothing: all nodes are expanded, or as many as allowed.
EXHAUSTED, LIMIT = -1, -2
# Work of an expansion besides the robot's paths [grid points].
EXPANSION_WORK = 1000


@compiled
def add_start(query: Query, memory: Memory) -> None:
    """
    Write the first node.

    :param memory: ``Memory``, with all slots -1 and all counters 0.
    """
    node, link = memory.nodes[0], memory.links[0]
    node[X], node[Y], node[THETA] = query.start.x, query.start.y, query.start.theta
    node[COST], node[LENGTH] = 0.0, 0.0
    node[ROBOT_X], node[ROBOT_Y] = query.robot.x, query.robot.y
    link[FACE], link[PARENT], link[PUSH], link[FINAL], link[CLOSED] = -1, -1, -1, 0, 0
    memory.counters[NODES] = 1


@compiled
def search(problem: Problem, memory: Memory) -> int:
    """
    Search.

    :param memory: ``Memory``, with all slots -1 and all counters 0.
    :return: index of the node at which the search ends, ``EXHAUSTED`` or ``LIMIT``.
    """
    query, guide, counters = problem.query, problem.guide, memory.counters
    add_start(query, memory)
    nearest = estimate(guide, query, query.start.x, query.start.y, query.start.theta, 0)
    if nearest >= UNREACHED:
        return EXHAUSTED
    counters[QUEUED] = push(memory.keys, memory.items, 0, query.settings.weight * nearest, 0)
    while counters[QUEUED] > 0:
        index = memory.items[0]
        counters[QUEUED] = remove_first(memory.keys, memory.items, counters[QUEUED])
        if memory.links[index, CLOSED] == 1:
            continue
        memory.links[index, CLOSED] = 1
        counters[EXPANDED] += 1
        node = memory.nodes[index]
        if index > 0 and (memory.links[index, FINAL] == 1
                          or is_open(problem.scene.floor, query, node[X], node[Y])):
            return index
        remaining = estimate(guide, query, node[X], node[Y], node[THETA], 0)
        if remaining < nearest:
            nearest = remaining
            counters[NEAREST] = index
        free_nodes = memory.nodes.shape[0] - counters[NODES]
        counters[WORK] += EXPANSION_WORK
        if (counters[EXPANDED] >= query.max_expansions or counters[WORK] >= query.max_work
                or free_nodes < 4 * problem.pushes.starts.shape[0]):
            return _most_promising(memory) if query.is_goal_enclosed else LIMIT
        expand(problem, memory, index)
    return EXHAUSTED


@compiled
def _most_promising(memory: Memory) -> int:
    """
    Find the node to go to next where pushes to the goal are known, but none that is likely to hit.

    It need not be at the goal: the search starts anew from where the object is then.
    """
    for k in range(memory.counters[QUEUED]):
        if memory.links[memory.items[k], FINAL] == 1:
            return memory.items[0]
    return LIMIT
