"""Places at which objects stand: at first, at their goals, and at temporary ones."""

import functools
import math
from typing import NamedTuple

import numpy as np
from push_model.geometry import FloatArray, Pose
from push_model.parameters import PushedObject, RoundRobot
from push_navigation.occupancy_map import OccupancyMap
from push_navigation.settings import DriveSettings
from push_planner.rearrangement.footprints import faces_of, object_gap, placed_points
from push_planner.rearrangement.object_floor import Field, ObjectFloor
from push_planner.rearrangement.problem import NamedObject
from push_planner.straight.map_search.planner import MIN_FRACTION, OBJECT_FRACTION
from push_planner.straight.map_search.scene import make_scene

# Place of an object in a ``Layout``; from 2 on temporary ones.
START, GOAL = 0, 1
# Place of each object, in the order of their names.
Layout = tuple[int, ...]
# Gap between robot and face from which on it pushes straight [m], and directions from which a
# round object is pushed; chosen: as map search has them, and enough for any direction.
STANDOFF = 0.06
ROUND_FACES = 8


class Body(NamedTuple):
    """
    Object of one name.

    :param name: of it.
    :param obj: the ``PushedObject``.
    :param has_goal: whether it is to be brought to ``GOAL``.
    :param is_at_goal: whether ``START`` is within the tolerances of its goal.
    :param inner_radius: of the greatest disc about its frame that it contains [m].
    :param outer_radius: of the least one that contains it [m].
    """

    name: str
    obj: PushedObject
    has_goal: bool
    is_at_goal: bool
    inner_radius: float
    outer_radius: float

    def is_placed(self, place: int) -> bool:
        """Tell whether it need not be moved from a place."""
        return not self.has_goal or place == GOAL or (place == START and self.is_at_goal)


class Placements:
    """
    Bodies and their places, with distances from each.

    ``bodies``: of each ``Body``. ``floor``: ``ObjectFloor``. Poses are in the frame of the map.

    :param objects: ``NamedObject`` of each, in the order of their names.
    :param robot: the ``RoundRobot``.
    :param drive: ``DriveSettings``.
    :param occupancy_map: the ``OccupancyMap``.
    """

    def __init__(self, objects: tuple[NamedObject, ...], robot: RoundRobot, drive: DriveSettings,
                 occupancy_map: OccupancyMap) -> None:
        self.floor = ObjectFloor(occupancy_map)
        to_map = occupancy_map.origin.inverse()
        self.bodies: list[Body] = []
        self._poses: list[list[Pose | None]] = []
        for item in objects:
            scene = make_scene(occupancy_map, item.obj, robot.radius)
            self.bodies.append(Body(item.name, item.obj, item.goal is not None, item.is_at_goal,
                                    scene.inner_radius, scene.outer_radius))
            self._poses.append([to_map @ item.pose,
                                None if item.goal is None else to_map @ item.goal])
        self._robot_radius = robot.radius
        # What the object keeps at least in the search for its pushes.
        self.object_margin = MIN_FRACTION * OBJECT_FRACTION * drive.map_clearance
        self.robot_margin = MIN_FRACTION * drive.map_clearance
        self.field = functools.lru_cache(maxsize=None)(self._field)
        self.gap = functools.lru_cache(maxsize=None)(self._gap)
        self.stands = functools.lru_cache(maxsize=None)(self._stands)

    def pose(self, index: int, place: int) -> Pose:
        """
        Return the pose of an object at a place.

        :param index: of the object.
        :param place: of it, one that it has.
        """
        pose = self._poses[index][place]
        if pose is None:
            raise ValueError(f'place: got {place} of {self.bodies[index].name}, which has no goal')
        return pose

    def add_place(self, index: int, pose: Pose) -> int:
        """Add a temporary place of an object, and return it."""
        places = self._poses[index]
        if pose in places[GOAL + 1:]:
            return places.index(pose, GOAL + 1)
        places.append(pose)
        return len(places) - 1

    def needed(self, index: int) -> tuple[float, float]:
        """
        Return the distances that the middle of an object keeps on its way, and near its ends [m].

        On the way the robot has to fit behind it.
        """
        inner = self.bodies[index].inner_radius
        return max(inner + self.object_margin, self.robot_needed), inner + self.object_margin

    @property
    def robot_needed(self) -> float:
        """Distance that the middle of the robot keeps [m]."""
        return self._robot_radius + self.robot_margin

    def push_directions(self, index: int, place: int) -> FloatArray:
        """Return unit vectors along which each face of an object is pushed, shape (n, 2)."""
        _, normals = faces_of(self.bodies[index].obj, ROUND_FACES)
        return placed_points(-normals, Pose(0.0, 0.0, self.pose(index, place).theta))

    def obstacles(self, layout: Layout, without: int | None = None) -> Field:
        """
        Compute the distances from walls and objects.

        :param without: object that does not count; None for none.
        """
        distances = self.floor.walls
        for index, place in enumerate(layout):
            if index != without:
                distances = np.minimum(distances, self.field(index, place))
        return distances

    def end_radius(self, index: int) -> float:
        """Return the radius about an end of a way within which the robot passes the object [m]."""
        return self.bodies[index].outer_radius + 2.0 * self._robot_radius

    def eased_at(self, distances: Field, index: int, places: tuple[int, int]) -> Field:
        """
        Let paths of an object be narrower near their ends, where the robot need not be behind it.

        :param places: of the object at both ends.
        """
        far, near = self.needed(index)
        if near >= far:
            return distances
        radius = self.end_radius(index)
        eased = distances.copy()
        for place in places:
            pose = self.pose(index, place)
            eased[self.floor.near(pose.x, pose.y, radius)] += far - near
        return eased

    def _field(self, index: int, place: int) -> Field:
        return self.floor.distances_from(self.bodies[index].obj, self.pose(index, place))

    def _gap(self, index: int, place: int, other: int, other_place: int) -> float:
        first, second = self.bodies[index], self.bodies[other]
        poses = self.pose(index, place), self.pose(other, other_place)
        if math.dist(poses[0][:2], poses[1][:2]) > first.outer_radius + second.outer_radius + 1.0:
            return math.inf
        return object_gap(first.obj, poses[0], second.obj, poses[1])

    def _stands(self, index: int, place: int) -> FloatArray:
        """Return where the robot stands before it pushes at each face, shape (n, 2) [m]."""
        points, normals = faces_of(self.bodies[index].obj, ROUND_FACES)
        away = self._robot_radius + STANDOFF
        return placed_points(points + away * normals, self.pose(index, place))
