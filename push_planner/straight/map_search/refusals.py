"""Refusals of tasks in maps: a code for each cause, with the places and numbers behind it."""

from collections.abc import Sequence
import math
from typing import Any, NamedTuple

import numpy as np
from push_model.geometry import distance, FloatArray, Pose, wrap_angle
from push_model.plan_request import PlanFailure
from push_navigation.occupancy_map import OccupancyMap
from push_planner.problem import PlanningFailed
from push_planner.refusal_marks import FaceMark, NarrowPlace, RefusalMarks
from push_planner.straight.map_search.dead_ends import STANDOFF
from push_planner.straight.map_search.object_distance import narrowest_passage
from push_planner.straight.map_search.pushes import Pushes
from push_planner.straight.map_search.scene import Scene
from push_planner.straight.map_search.search import SearchEnd, SearchResult
from push_planner.straight.planner import ApproachPaths

# A search that has not left this distance has found the object shut in [m].
SHUT_IN_DISTANCE = 1.0
# Distance from its goal up to which a refusal says how far the object is off [m]; chosen: what the
# last pushes of a task bring it.
NEAR_GOAL = 0.1
# Points of a path that are shown, at most; chosen: bends round furniture are seen.
MAX_PATH_POINTS = 40
END_CODES = {SearchEnd.EXHAUSTED: PlanFailure.BLOCKED, SearchEnd.LIMIT: PlanFailure.SEARCH_LIMIT}


class MapPoses(NamedTuple):
    """
    Poses in the frame of the map.

    :param start: ``Pose`` of the object.
    :param robot: ``Pose`` of the robot.
    :param goal: ``Pose`` that the object is to have.
    """

    start: Pose
    robot: Pose
    goal: Pose


class Refusals(NamedTuple):
    """
    Makes the refusals of one request.

    :param occupancy_map: the ``OccupancyMap``.
    :param scene: the ``Scene``.
    :param poses: ``MapPoses``.
    """

    occupancy_map: OccupancyMap
    scene: Scene
    poses: MapPoses

    def too_narrow(self, needed: float) -> PlanningFailed:
        """
        Name the narrowest passage on the widest path of the object.

        :param needed: width [m].
        """
        start, _, goal = self.poses
        passage = narrowest_passage(self.scene.floor, start[:2], goal[:2])
        x, y = self._in_world(passage.x, passage.y)
        return PlanningFailed(
            PlanFailure.BLOCKED, f'the floor is too narrow for the object at {x:.2f} m, {y:.2f} m:'
            f' {passage.width:.2f} m wide, at least {needed:.2f} m needed',
            marks=RefusalMarks(NarrowPlace(x, y, passage.width, needed)))

    def too_uncertain(self, pushes: Pushes, paths: ApproachPaths) -> PlanningFailed:
        """
        Name the place that lacks most room on the best way of the robot, and how uncertain it is.

        :param pushes: ``Pushes``, of which the start with the most room at each face counts.
        :param paths: ``ApproachPaths`` of the robot.
        """
        text = 'the robot does not know its position well enough on its way to the object'
        shortfalls = [shortfall for start in self._roomiest_starts(pushes)
                      if (shortfall := paths.shortfall(start)) is not None]
        if not shortfalls:
            return PlanningFailed(PlanFailure.UNCERTAIN_POSITION, text)
        worst = min(shortfalls, key=lambda place: place.required - place.clearance)
        width, needed = 2.0 * worst.clearance, 2.0 * worst.required
        return PlanningFailed(
            PlanFailure.UNCERTAIN_POSITION, f'{text}: at {worst.x:.2f} m, {worst.y:.2f} m, where '
            f'{width:.2f} m are free, its standard deviation is {worst.deviation:.2f} m, so that '
            f'it needs {needed:.2f} m',
            {'position_deviation': worst.deviation},
            RefusalMarks(NarrowPlace(worst.x, worst.y, width, needed, worst.ellipse),
                         robot_path=_thinned(worst.path)))

    def _roomiest_starts(self, pushes: Pushes) -> list[Pose]:
        """List the start with the most room at each face."""
        room = self.occupancy_map.clearance_in_map_frame(
            *_placed(self.poses.start, pushes.starts[:, :2]).T)
        of_faces = (np.flatnonzero(pushes.faces == face) for face in np.unique(pushes.faces))
        return [Pose(*pushes.starts[indices[np.argmax(room[indices])]].tolist())
                for indices in of_faces]

    def no_face(self, pushes: Pushes, clearance: float) -> PlanningFailed:
        """
        Count the faces that the robot can stand at.

        :param pushes: ``Pushes``.
        :param clearance: that it keeps from obstacles at least [m].
        """
        faces = self._faces(pushes, clearance)
        with_room = sum(face.has_room for face in faces)
        return PlanningFailed(
            PlanFailure.NO_FACE, f'{self._object_text} cannot be pushed away: the robot has room '
            f'at {with_room} of {len(faces)} faces, and reaches none from where a push meets no '
            'obstacle', self._errors, RefusalMarks(faces=faces))

    def shut_in(self, result: SearchResult, pushes: Pushes, clearance: float) -> PlanningFailed:
        """
        Say how far the object can be moved before the robot has no room for another push.

        :param pushes: ``Pushes``.
        :param clearance: that the robot keeps from obstacles at least [m].
        """
        return PlanningFailed(
            PlanFailure.NO_FACE, f'{self._object_text} cannot be pushed away: it moves by '
            f'{result.farthest:.2f} m at most before the robot has no room for another push',
            {'expansions': result.expansions, 'farthest': result.farthest, **self._errors},
            RefusalMarks(faces=self._faces(pushes, clearance)))

    def incomplete(self, result: SearchResult) -> PlanningFailed:
        """Say how near to its goal the object gets, and whether all was searched."""
        nearest = result.pushes[-1].end if result.pushes else self.poses.start
        x, y = self._in_world(*nearest[:2])
        width = 2.0 * float(self.occupancy_map.clearance([(x, y)])[0])
        return PlanningFailed(
            END_CODES[result.end], 'no chain of pushes to the goal was found: the object gets as '
            f'far as {x:.2f} m, {y:.2f} m, where the floor is {width:.2f} m wide ('
            f'{result.end.value}, {result.expansions} expansions)',
            {'expansions': result.expansions}, RefusalMarks(
                NarrowPlace(x, y, width), nearest=self.occupancy_map.origin @ nearest))

    @property
    def _errors(self) -> dict[str, Any]:
        """Distance [m] and rotation [rad] of the object from its goal, for the report."""
        start, _, goal = self.poses
        return {'position_error': distance(start, goal),
                'heading_error': abs(wrap_angle(goal.theta - start.theta))}

    @property
    def _object_text(self) -> str:
        """Name the object by where it is, and where it is near its goal by how far it is off."""
        x, y = self._in_world(*self.poses.start[:2])
        text = f'the object at {x:.2f} m, {y:.2f} m'
        errors = self._errors
        if errors['position_error'] > NEAR_GOAL:
            return text
        return (f'{text}, {1e3 * errors["position_error"]:.0f} mm and '
                f'{math.degrees(errors["heading_error"]):.1f} degrees from its goal,')

    def _faces(self, pushes: Pushes, clearance: float) -> tuple[FaceMark, ...]:
        """Mark where the robot would stand at each face, and whether it has room there."""
        places = _placed(self.poses.start, pushes.middles - STANDOFF * pushes.normals)
        room = self.occupancy_map.clearance_in_map_frame(*places.T) - self.scene.robot_radius
        return tuple(FaceMark(x, y, bool(gap >= clearance)) for (x, y), gap in zip(
            self.occupancy_map.from_map(places).tolist(), room))

    def _in_world(self, x: float, y: float) -> tuple[float, float]:
        (world_x, world_y), = self.occupancy_map.from_map([(x, y)]).tolist()
        return world_x, world_y


def _thinned(points: FloatArray) -> tuple[tuple[float, float], ...]:
    """Choose points of a path that show it, to the centimetre, which is read as text."""
    chosen = np.linspace(0, len(points) - 1, min(len(points), MAX_PATH_POINTS)).round().astype(int)
    return tuple((round(x, 2), round(y, 2)) for x, y in points[chosen].tolist())


def _placed(pose: Pose, points: Any) -> Any:
    """Transform points of the object frame, shape (n, 2)."""
    return np.array([pose.transform(point) for point in np.asarray(points).tolist()])


def first_failure(results: Sequence[SearchResult]) -> SearchResult | None:
    """Return the search that says most: the first in which the object has moved at all."""
    return next((result for result in results if result.farthest > 0.0), None)
