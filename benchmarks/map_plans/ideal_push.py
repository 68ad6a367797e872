"""
Whether any pushes at all bring an object away from walls: an argument that knows no planner.

A robot that knows its position, and keeps 3 cm clear, drives wherever its floor leads. Where it
touches the object, it pushes with any force of the friction cone. The object moves as on the
ellipsoid of limit forces, the velocity of its friction centre along the force f, and

    omega = (p x f) / rho^2,

with the contact p from there, and the radius of gyration rho of the supports. Walls do not act. A
search over such pushes, the farthest first, tells whether the object can leave; it is optimistic,
but for its grid of contacts and poses.
"""

import enum
import heapq
import math
from typing import NamedTuple

from benchmarks.map_plans.instances import Instance
from benchmarks.tasks.public_maps import contact_cells
import numpy as np
from push_model.contact import find_contact
from push_model.friction import friction_center
from push_model.geometry import distance, FloatArray, Pose
from scipy.ndimage import label

# Clearance of the robot, and distance from its start at which an object is away from its walls
# [m]: of the aims of maps, and chosen.
ROBOT_CLEARANCE = 0.03
AWAY = 0.4
# Lengths of pushes, and steps at which they are looked at [m].
LENGTHS = 0.03, 0.06, 0.12, 0.24
STEP = 0.015
# Overlap that pushes may add, as those of the planner [m].
NEW_OVERLAP = 0.003
# Forces from one edge of the friction cone to the other; nodes that a search expands; distance and
# rotation within which poses are the same [m, rad]; chosen.
FORCES = 3
MAX_NODES = 100
SAME_POSITION, SAME_HEADING = 0.04, 0.2


class Escape(enum.Enum):
    """Whether ideal pushes bring an object away."""

    POSSIBLE = 'possible'
    IMPOSSIBLE = 'impossible'
    UNKNOWN = 'unknown'


class _Node(NamedTuple):
    """Pose of the object, and position of the robot."""

    pose: Pose
    robot: tuple[float, float]


def find_escape(instance: Instance) -> Escape:
    """
    Tell whether ideal pushes bring the object ``AWAY`` from where it starts.

    :param instance: the task.
    """
    floor, obj = instance.occupancy_map, instance.obj
    allowed = min(0.0, floor.object_clearance(obj, [instance.start])) - NEW_OVERLAP
    nodes = [(0.0, _Node(instance.start, instance.robot_start[:2]))]
    visited = {_cell(instance.start)}
    for _ in range(MAX_NODES):
        if not nodes:
            return Escape.IMPOSSIBLE
        _, node = heapq.heappop(nodes)
        for pushed in _pushes(instance, node, allowed):
            away = distance(pushed.pose, instance.start)
            if away >= AWAY:
                return Escape.POSSIBLE
            cell = _cell(pushed.pose)
            if cell not in visited:
                visited.add(cell)
                heapq.heappush(nodes, (-away, pushed))
    return Escape.UNKNOWN


def _cell(pose: Pose) -> tuple[int, int, int]:
    return (round(pose.x / SAME_POSITION), round(pose.y / SAME_POSITION),
            round(pose.theta / SAME_HEADING))


def _pushes(instance: Instance, node: _Node, allowed: float) -> list[_Node]:
    """List where the pushes from a node lead; the object may overlap by as much as allowed [m]."""
    floor, obj, radius = instance.occupancy_map, instance.obj, instance.robot.radius
    center = np.array(friction_center(obj))
    feet = np.array([(foot.x, foot.y) for foot in obj.supports]) - center
    square = float(np.average((feet ** 2).sum(axis=1), weights=obj.capacities))
    cone = math.atan(obj.contact_friction_coefficient)
    steps = np.rint(np.array(LENGTHS) / STEP).astype(int)
    ends: list[_Node] = []
    for robot in _contact_positions(instance, node):
        nearest = find_contact(obj, node.pose, robot.tolist(), radius)
        along = (radius + nearest.gap) * np.array([math.cos(nearest.gamma),
                                                   math.sin(nearest.gamma)])
        to_object = node.pose.inverse()
        arm = np.array(to_object.transform((robot + along).tolist())) - center
        for angle in nearest.gamma - node.pose.theta + np.linspace(-cone, cone, FORCES):
            force = np.array([math.cos(angle), math.sin(angle)])
            omega = float(arm[0] * force[1] - arm[1] * force[0]) / square
            poses = _pushed(node.pose, center, force, omega)
            behind = to_object.transform(robot.tolist())
            robots = np.array([pose.transform(behind) for pose in poses])
            free = ((floor.object_clearances(obj, np.array(poses), 0.01) >= allowed)
                    & (floor.clearance(robots) >= radius))
            count = len(free) if free.all() else int(np.argmin(free))
            ends += [_Node(poses[step - 1], (float(robots[step - 1, 0]),
                                             float(robots[step - 1, 1])))
                     for step in steps if step <= count]
    return ends


def _contact_positions(instance: Instance, node: _Node) -> FloatArray:
    """List where the robot gets to a touch of the object, shape (n, 2) [m]."""
    floor, radius = instance.occupancy_map, instance.robot.radius
    fits = floor.distances[1:-1, 1:-1] > radius + ROBOT_CLEARANCE
    free, touching = contact_cells(floor, fits, instance.obj, node.pose, radius)
    regions = np.empty(free.shape, dtype=np.int_)
    label(free, output=regions)
    column, row = (floor.to_map([node.robot])[0] / floor.resolution).astype(int)
    # The robot itself may stand nearer to wall or object than it will drive.
    around = regions[max(0, row - 2):row + 3, max(0, column - 2):column + 3]
    here = np.argwhere(touching & np.isin(regions, around[around > 0]))
    return floor.from_map(floor.resolution * (here[:, ::-1] + 0.5))


def _pushed(start: Pose, center: FloatArray, force: FloatArray, omega: float) -> list[Pose]:
    """Move the object with a constant force in its own frame; list its poses."""
    # The velocity of the frame is that of the friction centre, less what rotation adds to it.
    step = Pose(STEP * float(force[0] + omega * center[1]),
                STEP * float(force[1] - omega * center[0]), STEP * omega)
    poses: list[Pose] = []
    pose = start
    for _ in range(round(LENGTHS[-1] / STEP)):
        pose = pose @ step
        poses.append(pose)
    return poses
