"""Moves of one object while the others stand: whether there is a way, and how long it takes."""

import functools
import math
from typing import NamedTuple

import numpy as np
from push_model.geometry import BoolArray, FloatArray, IntArray, Pose, wrap_angle
from push_model.parameters import RoundRobot
from push_navigation.settings import DriveSettings
from push_planner.rearrangement.object_floor import descend, path_length
from push_planner.rearrangement.placements import GOAL, Layout, Placements
from push_planner.straight.map_search.estimate import (
    CONTACT_DISTANCE, CONTACT_ROTATION, MIN_PASSING, PASSING_DISTANCE, ROTATION_TIME)
from push_planner.straight.map_search.object_distance import DistanceGrid
from push_primitives.cost_settings import CONTACT_PATHS, CostSettings

# Gap between two objects below which they stand in each other's place [m]; chosen: below what
# goals side by side state, above their rounding.
MIN_GAP = 0.005
# The same beside an object that is still to be moved [m]; chosen: a cell of a map that the other
# covers, and what an object keeps from it.
MIN_GAP_TO_LEAVE = 0.08
# Time by which a move is longer where the robot has no room at any face of the object, at its
# start or its end [s]; chosen: two contacts, so that objects go to narrow places first.
CROWDED_TIME = 10.0
# Radius within which all free floor is next to the robot, in grid points; chosen: it may touch an
# object at first.
SEARCH_RADIUS = 2
# Layouts whose free floor is kept in memory; chosen: some 0.1 MB each.
MAX_LAYOUTS = 256

# Numbers of connected parts of the floor on which the robot can be.
Regions = frozenset[int]


class MoveOption(NamedTuple):
    """
    Move that can be made.

    :param layout: of all objects after it.
    :param regions: ``Regions`` in which the robot may be then.
    :param time: with the robot's way to the object [s].
    """

    layout: Layout
    regions: Regions
    time: float


class MoveEvaluator:
    """
    Evaluates moves.

    :param placements: ``Placements``.
    :param robot: the ``RoundRobot``.
    :param robot_pose: its ``Pose`` at first, in the frame of the map.
    :param drive: ``DriveSettings``.
    """

    def __init__(self, placements: Placements, robot: RoundRobot, robot_pose: Pose,
                 drive: DriveSettings) -> None:
        self._placements = placements
        self._robot_pose = robot_pose
        self._costs = CostSettings(robot_speed=drive.limited_to(robot).speed, drive=robot.drive)
        self.goal_grid = functools.lru_cache(maxsize=None)(self._goal_grid)
        self._robot_grid = functools.lru_cache(maxsize=None)(self._make_robot_grid)
        self.robot_floor = functools.lru_cache(maxsize=MAX_LAYOUTS)(self._robot_floor)

    def first_regions(self, layout: Layout) -> Regions:
        """Return the ``Regions`` in which the robot may be at first: those next to it."""
        floor, parts = self._placements.floor, self.robot_floor(layout).ravel()
        is_free = parts > 0
        away = np.hypot(*(floor.centers[is_free] - self._robot_pose[:2]).T)
        radius = max(SEARCH_RADIUS * floor.spacing, away.min(initial=math.inf))
        return frozenset(parts[is_free][away <= radius].tolist())

    def evaluate(self, layout: Layout, regions: Regions, index: int, place: int,
                 last: tuple[int, int] | None) -> MoveOption | None:
        """
        Evaluate a move.

        :param layout: before it.
        :param regions: in which the robot may be before it.
        :param index: of the object that is moved.
        :param place: where to.
        :param last: object and place of the move before; None at first.
        :return: None where there is no way.
        """
        if not self.has_room(layout, index, place) or not self.is_reached(layout, regions, index):
            return None
        after = (*layout[:index], place, *layout[index + 1:])
        stands = self._regions_of_faces(after, index)
        if not stands.any():
            return None
        length = path_length(self.grid(layout, regions, index, place),
                             self._placements.pose(index, layout[index]))
        if math.isinf(length):
            return None
        crowded = sum(1.0 - np.count_nonzero(faces) / len(faces) for faces in (
            stands, self._regions_of_faces(layout, index)))
        time = (self._pushing_time(length, index, layout[index], place)
                + self.transit_time(index, layout[index], last) + CROWDED_TIME * crowded)
        return MoveOption(after, frozenset(stands[stands > 0].tolist()), time)

    def grid(self, layout: Layout, regions: Regions, index: int, place: int) -> DistanceGrid:
        """
        Find the ways of an object to a place past all others.

        What is moved to a temporary place starts towards where the robot pushes it, at a face
        that it gets to: what stands in a door leaves it on the other side. To its goal an object
        may be pushed through the door and back.

        :param layout: before the move.
        :param regions: in which the robot may be before it.
        :param index: of the object.
        :param place: where to.
        """
        placements = self._placements
        distances = placements.eased_at(placements.obstacles(layout, index), index,
                                        (layout[index], place))
        if place != GOAL:
            distances = np.where(self._is_off_pushes(layout, regions, index), np.float32(0.0),
                                 distances)
        far, _ = placements.needed(index)
        return placements.floor.lengths_to(placements.pose(index, place), distances, far)

    def has_room(self, layout: Layout, index: int, place: int) -> bool:
        """Tell whether an object fits between the others at a place."""
        return not self.overlapped(layout, index, place)

    def overlapped(self, layout: Layout, index: int, place: int) -> list[int]:
        """List the objects in whose place an object would stand, or that could not leave."""
        bodies = self._placements.bodies
        return [other for other, other_place in enumerate(layout) if other != index
                and self._placements.gap(index, place, other, other_place) < (
                    MIN_GAP if bodies[other].is_placed(other_place) else MIN_GAP_TO_LEAVE)]

    def is_reached(self, layout: Layout, regions: Regions, index: int) -> bool:
        """Tell whether the robot gets to a face of an object."""
        return bool(regions & set(self._regions_of_faces(layout, index).tolist()))

    def least_time(self, index: int, place: int) -> float:
        """Return the time to push an object from a place to its goal, were it alone [s]."""
        length = path_length(self.goal_grid(index), self._placements.pose(index, place))
        return self._pushing_time(length, index, place, GOAL)

    def transit_time(self, index: int, place: int, last: tuple[int, int] | None) -> float:
        """
        Return the time of the robot's way to an object past walls alone [s].

        :param last: object and place at which it is; None for its start.
        """
        start = self._robot_pose if last is None else self._placements.pose(*last)
        here = self._placements.pose(index, place)
        length = path_length(self._robot_grid(index, place), start)
        if math.isinf(length):
            length = math.dist(start[:2], here[:2])
        return length / self._costs.robot_speed

    def robot_path(self, index: int, place: int, last: tuple[int, int] | None) -> FloatArray:
        """
        Return the robot's way to an object past walls alone, shape (n, 2) [m].

        :param index: of the object.
        :param place: at which it stands.
        :param last: object and place at which the robot is; None for its start.
        """
        start = self._robot_pose if last is None else self._placements.pose(*last)
        grid, here = self._robot_grid(index, place), self._placements.pose(index, place)
        if math.isinf(path_length(grid, start)):
            return np.array([start[:2], here[:2]])
        return descend(grid, start, here)

    def _is_off_pushes(self, layout: Layout, regions: Regions, index: int) -> BoolArray:
        """Tell which grid points round an object lie where no push of the robot leads."""
        placements, place = self._placements, layout[index]
        is_reached = np.isin(self._regions_of_faces(layout, index), list(regions))
        return placements.floor.off_directions(
            placements.pose(index, place), placements.end_radius(index),
            placements.push_directions(index, place)[is_reached])

    def _pushing_time(self, length: float, index: int, start: int, end: int) -> float:
        placements, costs = self._placements, self._costs
        body = placements.bodies[index]
        rotation = 0.0
        if body.obj.outline:
            rotation = abs(wrap_angle(placements.pose(index, end).theta
                                      - placements.pose(index, start).theta))
        contact_time = (costs.contact_time + costs.push_time
                        + CONTACT_PATHS[costs.drive] / costs.robot_speed)
        passing = min(1.0, max(MIN_PASSING, PASSING_DISTANCE - length))
        return (length / costs.pushing_speed
                + contact_time * (1.0 + length / CONTACT_DISTANCE)
                + rotation * passing * (contact_time / CONTACT_ROTATION + ROTATION_TIME))

    def _goal_grid(self, index: int) -> DistanceGrid:
        """Find the ways of an object to its goal past walls alone, as wide as near the ends."""
        placements = self._placements
        _, near = placements.needed(index)
        return placements.floor.lengths_to(placements.pose(index, GOAL), placements.floor.walls,
                                           near)

    def _make_robot_grid(self, index: int, place: int) -> DistanceGrid:
        """Find the ways of the robot to an object past walls alone; it starts at its middle."""
        placements = self._placements
        return placements.floor.lengths_to(placements.pose(index, place), placements.floor.walls,
                                           placements.robot_needed)

    def _robot_floor(self, layout: Layout) -> IntArray:
        """Label the connected parts of the floor on which the robot can be; 0 elsewhere."""
        placements = self._placements
        return placements.floor.connected_parts(
            placements.obstacles(layout) >= placements.robot_needed)

    def _regions_of_faces(self, layout: Layout, index: int) -> IntArray:
        """Return the part of the floor from which each face is pushed; 0 without room."""
        return self._placements.floor.values_at(
            self.robot_floor(layout), self._placements.stands(index, layout[index]))
