"""
Plan the next push of a task in a map.

Where the floor is open from the object to its goal, the push is selected as on open floor. Else a
search finds a chain of straight pushes to the goal, or to where the floor is open up to it; its
first push is planned exactly, the others when their turn comes.
"""

from collections.abc import Iterator
import contextlib
import functools
import math
from typing import NamedTuple

import numpy as np
from push_model.geometry import BoolArray, distance, FloatArray, Pose, wrap_angle
from push_model.parameters import PushedObject, RoundRobot
from push_model.plan_request import HEADING_TOLERANCE, PlanFailure, PlanRequest
from push_model.trajectory import PushStyle
from push_navigation import visibility
from push_navigation.floor import make_floor
from push_navigation.map_clearance import CERTAIN, MapClearance, MapContext
from push_navigation.obstacle import inflate
from push_navigation.occupancy_map import OccupancyMap
from push_navigation.path_planner import CLEARANCE_STEPS
from push_navigation.settings import DriveSettings
from push_planner.problem import PlanningFailed
from push_planner.refusal_marks import RefusalMarks
from push_planner.settings import PlannerSettings
from push_planner.straight.map_search.object_distance import (
    distance_grid, DistanceGrid, length_at, UNREACHED)
from push_planner.straight.map_search.problem import FREE
from push_planner.straight.map_search.pushes import make_pushes, Pushes
from push_planner.straight.map_search.refusal_memory import Question, RefusalMemory
from push_planner.straight.map_search.refusals import (
    first_failure, MapPoses, Refusals, SHUT_IN_DISTANCE)
from push_planner.straight.map_search.remaining_pushes import (
    expected_end, is_as_expected, pushes_after_first, RemainingPushes)
from push_planner.straight.map_search.scene import make_scene
from push_planner.straight.map_search.search import (
    FINE, MapSearch, Margins, SearchEnd, SearchResult, SearchSettings)
from push_planner.straight.planner import (
    ApproachPaths, checked_request, friction_belief, lay_out, plan_straight_push,
    position_uncertainty, primitives_for, StraightPlan)
from push_planner.straight.trajectory import greatest_speed
from push_primitives.cost_settings import CONTACT_PATHS
from push_primitives.selection import SelectedPush, UNSURE_DEVIATION
from push_primitives.store import PushPrimitives
from push_primitives.weights import sample_weights

# Part of the clearance of the settings that the object keeps, besides the uncertainty of a push;
# chosen: half of 5 cm leaves doors of 1.25 times the width of the object.
OBJECT_FRACTION = 0.5
# Standard deviations of a push that are added to the clearance of the object, for each of the
# ``CLEARANCE_STEPS``, of which the later ones are only for where nothing is found before; and the
# most expansions of each search. Chosen: in public maps, narrow passages and at walls only nine of
# 154 first plans need more; there the next search finds chains that are as quick.
STD_FACTORS = (1.0, 0.5, 0.0)
MAX_EXPANSIONS = (300, 150, 250)
# The last search goes farther, or where all was searched the robot does: round through rooms.
LAST_EXPANSIONS, WIDE_EXPANSIONS = 4000, 300
MIN_FRACTION = CLEARANCE_STEPS[-1][0]
# Part of the tolerances within which a last push ends, as planned.
GOAL_FRACTION = 0.7
# Work of all searches of a request, as of ``Query``, and of a path to a first push in the same
# units; measured at 0.11 to 0.14 us each, so that a refusal takes two seconds at most.
MAX_WORK, PATH_WORK = 14_000_000, 300_000
# First pushes whose paths are planned, until one is found, and where the robot goes round through
# other rooms, which takes ten times as long to search.
MAX_FIRST_PUSHES, MAX_WIDE_PUSHES = 12, 3
# The same of all margins together; chosen: the path to each takes up to 0.1 s.
MAX_BLOCKED = 16
# Overlap of object and obstacles that is taken for an error of its pose [m], besides half a cell,
# by which the map may be wrong; chosen.
MAX_OVERLAP = 0.02
# Headings at the goal that are tried where any does, to either side of the present one; chosen.
HEADING_STEP, HEADING_STEPS = math.radians(15.0), 12
# Points on the line to the goal at which the floor is looked at.
LINE_SAMPLES = 40
# Rounding of positions [m].
SAME_POSITION = 1e-6
# Cells of the map of a plan that only warms up [m].
WARM_UP_RESOLUTION = 0.05


# A task asks the same again while it waits for another map.
REFUSALS = RefusalMemory()


class MapPlan(NamedTuple):
    """
    Plan in a map.

    :param first: ``StraightPlan`` of the first push.
    :param remaining: ``RemainingPushes`` after it; none where the floor is open up to the goal.
    :param expansions: number of nodes that the search expanded, 0 where it was not needed.
    """

    first: StraightPlan
    remaining: RemainingPushes
    expansions: int = 0


def plan_push_in_map(request: PlanRequest, robot: RoundRobot, settings: PlannerSettings,
                     drive: DriveSettings, occupancy_map: OccupancyMap, *,
                     remaining: RemainingPushes | None = None) -> MapPlan:
    """
    Plan the next push of a task in a map.

    :param request: ``PlanRequest``, with what has been learned so far.
    :param remaining: ``RemainingPushes`` of the previous plan; their first push is next where the
        last one has ended as planned, and it is still free.
    :raises PlanningFailed: with the reason.
    """
    question = Question(request, robot, settings, drive, occupancy_map)
    refusal = REFUSALS.recall(question)
    if refusal is not None:
        raise refusal
    checked = checked_request(request, robot)
    try:
        return _plan_checked(checked, robot, settings, drive, occupancy_map, remaining)
    except PlanningFailed as failure:
        REFUSALS.add(question, failure)
        raise


def _plan_checked(request: PlanRequest, robot: RoundRobot, settings: PlannerSettings,
                  drive: DriveSettings, occupancy_map: OccupancyMap,
                  remaining: RemainingPushes | None) -> MapPlan:
    """Plan with any heading at the goal where that does, and with the stated one."""
    max_work = MAX_WORK
    if request.is_heading_free:
        max_work //= 2
        free = _with_any_heading(request, occupancy_map, remaining)
        with contextlib.suppress(PlanningFailed):
            return _MapPlanner(free, robot, settings, drive, occupancy_map,
                               max_work).plan(remaining)
        request = request._replace(heading_tolerance=HEADING_TOLERANCE)
    return _MapPlanner(request, robot, settings, drive, occupancy_map, max_work).plan(remaining)


def warm_up(obj: PushedObject, robot: RoundRobot, drive: DriveSettings) -> None:
    """Search once, so that the first request does not wait for the compiler."""
    extent = max((math.hypot(*corner) for corner in obj.outline), default=obj.radius)
    # A room in which the floor is not open.
    half = extent + 2.0 * robot.radius
    if not math.isfinite(half):
        return
    count = math.ceil(2.0 * half / WARM_UP_RESOLUTION)
    room = OccupancyMap(WARM_UP_RESOLUTION, Pose(-half, -half, 0.0),
                        np.zeros((count, count), dtype=np.bool_))
    beside = Pose(-extent - 0.9 * robot.radius, 0.0, 0.0)
    with contextlib.suppress(PlanningFailed):
        plan_push_in_map(PlanRequest(Pose(0.0, 0.0, 0.0), beside, Pose(0.05, 0.0, 0.0), obj),
                         robot, PlannerSettings(), drive, room)
    # The path to a first push beside the object follows no grid.
    margins = MapClearance(MapContext(room), robot.radius, beside[:2], 0.0, 0.0)
    visibility.warm_up(visibility.make_visibility(
        margins, inflate(obj.outline, obj.radius, robot.radius), Pose(0.0, 0.0, 0.0)))


def _with_any_heading(request: PlanRequest, occupancy_map: OccupancyMap,
                      remaining: RemainingPushes | None) -> PlanRequest:
    """Choose the heading at the goal: as now, or as near to it as there is room."""
    goal = request.goal
    if remaining is not None and distance(remaining.goal, goal) <= SAME_POSITION:
        return request._replace(goal=remaining.goal)
    steps = sorted(range(-HEADING_STEPS, HEADING_STEPS), key=abs)
    turns = [step * HEADING_STEP for step in steps]
    poses = [Pose(goal.x, goal.y, wrap_angle(request.object_pose.theta + turn)) for turn in turns]
    free = next((pose for pose in poses
                 if occupancy_map.object_clearance(request.obj, [pose]) >= 0.0), poses[0])
    return request._replace(goal=free)


class _Known(NamedTuple):
    """
    Pushes and paths for one request.

    :param poses: ``MapPoses``.
    :param refusals: ``Refusals``.
    :param primitives: ``PushPrimitives``.
    :param weights: of the samples of friction, shape (K,).
    :param pushes: ``Pushes``.
    :param paths: ``ApproachPaths``.
    :param search: ``MapSearch``.
    """

    poses: MapPoses
    refusals: Refusals
    primitives: PushPrimitives
    weights: FloatArray
    pushes: Pushes
    paths: ApproachPaths
    search: MapSearch


class _MapPlanner:
    """Planner of one request."""

    def __init__(self, request: PlanRequest, robot: RoundRobot, settings: PlannerSettings,
                 drive: DriveSettings, occupancy_map: OccupancyMap, max_work: int) -> None:
        self._request = request
        self._robot = robot
        self._settings = settings
        self._drive = drive
        self._map = occupancy_map
        self._remaining_work = max_work
        # No push makes a new overlap, but one within the tolerance of the goal.
        measured = MAX_OVERLAP + 0.5 * occupancy_map.resolution
        for name, pose, overlap in (
                ('object stands', request.object_pose, measured),
                ('goal is', request.goal, min(MAX_OVERLAP, request.position_tolerance))):
            if occupancy_map.object_clearance(request.obj, [pose]) < -overlap:
                raise PlanningFailed(
                    PlanFailure.NOT_FREE, f'the {name} at {pose.x:.2f} m, {pose.y:.2f} m, where '
                    'the map has an obstacle or ends', marks=RefusalMarks(overlap=pose))
        self._scene = make_scene(occupancy_map, request.obj, robot.radius)
        self._open_radius = (self._scene.outer_radius + drive.standoff
                             + 2.0 * (robot.radius + drive.clearance))

    def plan(self, remaining: RemainingPushes | None) -> MapPlan:
        """Use the open-floor plan if it is free; otherwise continue the chain or search."""
        return self._plan_on_open_floor() or self._search(remaining)

    def _plan_on_open_floor(self) -> MapPlan | None:
        """Plan as without a map; None where the floor is not open, or the push not free."""
        request, margin = self._request, OBJECT_FRACTION * self._drive.map_clearance
        line = np.linspace(request.object_pose[:2], request.goal[:2], LINE_SAMPLES)
        if self._map.clearance(line).min() < self._open_radius:
            return None
        paths = ApproachPaths(request, self._robot, self._settings, self._drive, self._map)
        try:
            plan = plan_straight_push(request, self._robot, self._settings, self._drive,
                                      paths=paths)
        except PlanningFailed:
            return None
        finally:
            self._remaining_work -= PATH_WORK * paths.count
        trajectory = plan.trajectory
        is_free = (self._map.object_is_free(request.obj, trajectory.object_poses, margin)
                   and self._map.robot_is_free(self._robot, trajectory.robot_poses, margin))
        return MapPlan(plan, RemainingPushes(request.goal)) if is_free else None

    def _search(self, remaining: RemainingPushes | None) -> MapPlan:
        """Continue the previous chain where that is possible, else search for one."""
        known = self._prepare()
        return self._continue(remaining, known) or self._find_pushes(known)

    def _prepare(self) -> _Known:
        """
        Prepare pushes, paths and the search.

        :raises PlanningFailed: where the floor is too narrow for the object.
        """
        request, scene = self._request, self._scene
        to_map = self._map.origin.inverse()
        poses = MapPoses(to_map @ request.object_pose, to_map @ request.robot_pose,
                         to_map @ request.goal)
        needed = scene.inner_radius + MIN_FRACTION * OBJECT_FRACTION * self._drive.map_clearance
        grid = _distance_grid(self._map, (poses.goal.x, poses.goal.y), needed)
        refusals = Refusals(self._map, scene, poses)
        if length_at(grid, poses.start.x, poses.start.y) >= UNREACHED:
            raise refusals.too_narrow(2.0 * needed)
        primitives = primitives_for(request, self._robot, self._drive)
        weights = sample_weights(primitives.table.friction_samples, friction_belief(request))
        pushes = make_pushes(primitives, request.obj, self._robot.radius, weights,
                             is_localized=request.robot_deviation <= UNSURE_DEVIATION)
        search = MapSearch(scene, pushes, grid, primitives.cost_to_go,
                           self._search_settings(primitives))
        paths = ApproachPaths(request, self._robot, self._settings, self._drive, self._map)
        return _Known(poses, refusals, primitives, weights, pushes, paths, search)

    def _find_pushes(self, known: _Known) -> MapPlan:
        """
        Search for a chain of pushes, with the widest margins first.

        :raises PlanningFailed: where there is none whose first push the robot can reach.
        """
        failures: list[SearchResult] = []
        expansions = 0
        is_exhausted = False
        # Pushes whose start the robot does not get to; paths do not depend on the margins.
        blocked = np.zeros(len(known.pushes.primitives), dtype=np.bool_)
        for margins in self._margins():
            if (self._remaining_work <= 0 or np.count_nonzero(blocked) >= MAX_BLOCKED
                    or (margins.is_wide and not is_exhausted)):
                break
            for result in self._alternatives(known, margins, blocked):
                expansions += result.expansions
                self._remaining_work -= result.work
                is_exhausted = result.end is SearchEnd.EXHAUSTED
                if result.end is not SearchEnd.FOUND:
                    failures.append(result)
                    break
                # The search sees the robot's path on a grid only.
                start = known.pushes.starts[result.pushes[0].push_index]
                time = known.paths.travel_time(Pose(*start.tolist()))
                self._remaining_work -= PATH_WORK
                if math.isfinite(time):
                    return self._lay_out(result, time, known, expansions)
        raise self._refuse(known, failures)

    def _alternatives(self, known: _Known, margins: Margins,
                      blocked: BoolArray) -> Iterator[SearchResult]:
        """
        Generate the best chains that start differently, and at last what ends them.

        :param blocked: whether a push may not come first; those that came first are added.
        """
        for _ in range(MAX_WIDE_PUSHES if margins.is_wide else MAX_FIRST_PUSHES):
            if self._remaining_work <= 0:
                return
            result = known.search.run(
                *known.poses, margins._replace(max_work=self._remaining_work), blocked)
            yield result
            if result.end is not SearchEnd.FOUND:
                return
            blocked[result.pushes[0].push_index] = True

    def _lay_out(self, result: SearchResult, travel_time: float, known: _Known,
                 expansions: int) -> MapPlan:
        """Plan the first push of a chain exactly; the robot takes a time to its start [s]."""
        push = result.pushes[0]
        pushing_time = push.length / greatest_speed(self._robot, self._settings)
        selected = SelectedPush(
            int(known.pushes.primitives[push.push_index]), push.length, known.weights, travel_time,
            result.cost - pushing_time, result.cost)
        is_last = distance(push.end, known.poses.goal) == 0.0
        first = self._first(selected, known,
                            PushStyle.STRAIGHT if is_last else PushStyle.WAYPOINT)
        first.report.update({
            'pushes_in_map': len(result.pushes), 'expansions': expansions,
            'chain_time': result.cost, 'least_chain_time': result.least_cost})
        remaining = pushes_after_first(result, known.pushes, self._map.origin, self._request.goal)
        return MapPlan(first, remaining, expansions)

    def _first(self, selected: SelectedPush, known: _Known, style: PushStyle) -> StraightPlan:
        start = known.primitives.table.starts[selected.primitive]
        return lay_out(self._request, self._robot, self._settings, known.primitives, selected,
                       path=known.paths.to(Pose(*start.tolist())), style=style)

    def _continue(self, remaining: RemainingPushes | None, known: _Known) -> MapPlan | None:
        """Continue a chain where its next push is free; None where it is not."""
        request = self._request
        if (remaining is None or request.cone_fraction < 1.0
                or not remaining.continues_from(request.object_pose, request.goal)):
            return None
        margins = next(self._margins())
        if known.search.is_goal_enclosed(known.poses.start, known.poses.goal, margins):
            # What a push has missed counts here.
            return None
        first = remaining.pushes[0]
        options = np.flatnonzero(known.pushes.primitives == first.primitive)
        if not options.size:
            return None
        option = int(options[0])
        end = expected_end(known.pushes, option, first.length, known.poses.start)
        if not is_as_expected(first, self._map.origin @ end):
            return None
        blocked = np.ones(len(known.pushes.primitives), dtype=np.bool_)
        blocked[option] = False
        # The node of the object, from which only this push leads.
        result = known.search.run(
            *known.poses, margins._replace(max_expansions=2), blocked)
        time = known.paths.travel_time(Pose(*known.pushes.starts[option].tolist()))
        away = np.hypot(*(result.nodes[1:, :2] - end[:2]).T)
        if away.min(initial=math.inf) > SAME_POSITION or not math.isfinite(time):
            return None
        expected = (first.remaining_time + time
                    + first.length / greatest_speed(self._robot, self._settings))
        plan = self._first(
            SelectedPush(first.primitive, first.length, known.weights, time,
                         first.remaining_time, expected), known, PushStyle.WAYPOINT)
        plan.report.update({'pushes_in_map': len(remaining.pushes), 'expansions': 0})
        return MapPlan(plan, remaining._replace(pushes=remaining.pushes[1:]))

    def _margins(self) -> Iterator[Margins]:
        """Generate margins, the widest first."""
        uncertainty = position_uncertainty(self._request)
        margins: Margins | None = None
        for (fraction, sigmas), std_factor, limit in zip(CLEARANCE_STEPS, STD_FACTORS,
                                                         MAX_EXPANSIONS):
            drive = self._drive.with_clearances(fraction)
            margins = Margins(OBJECT_FRACTION * drive.map_clearance, std_factor,
                              drive.map_clearance, drive.clearance, uncertainty, sigmas, limit)
            yield margins
        if margins is not None:
            last = margins._replace(max_expansions=LAST_EXPANSIONS, lattice=FINE)
            yield last
            yield last._replace(max_expansions=WIDE_EXPANSIONS, is_wide=True)

    def _search_settings(self, primitives: PushPrimitives) -> SearchSettings:
        request, costs = self._request, primitives.settings
        contact_time = (costs.contact_time + costs.push_time
                        + CONTACT_PATHS[costs.drive] / costs.robot_speed)
        return SearchSettings(
            GOAL_FRACTION * request.position_tolerance,
            FREE if request.is_heading_free else GOAL_FRACTION * request.heading_tolerance,
            request.position_tolerance, self._open_radius, contact_time,
            greatest_speed(self._robot, self._settings),
            costs.robot_speed)

    def _refuse(self, known: _Known, results: list[SearchResult]) -> PlanningFailed:
        """Find out why no chain was found whose first push the robot reaches."""
        result = first_failure(results)
        if result is None or known.paths.is_too_uncertain:
            if self._needs_certainty(known):
                return known.refusals.too_uncertain(known.pushes, known.paths)
        clearance = MIN_FRACTION * self._drive.map_clearance
        if result is None:
            return known.refusals.no_face(known.pushes, clearance)
        if result.end is SearchEnd.EXHAUSTED and result.farthest < SHUT_IN_DISTANCE:
            return known.refusals.shut_in(result, known.pushes, clearance)
        return known.refusals.incomplete(result)

    def _needs_certainty(self, known: _Known) -> bool:
        """Tell whether the robot would get to a first push if it knew its position."""
        if known.paths.is_too_uncertain:
            return True
        *_, last = self._margins()
        blocked = np.zeros(len(known.pushes.primitives), dtype=np.bool_)
        certain = last._replace(uncertainty=CERTAIN, max_expansions=2)
        return known.search.run(*known.poses, certain, blocked).farthest > 0.0


# A task asks for the same goal again and again; a grid of a flat takes a megabyte.
@functools.lru_cache(maxsize=4)
def _distance_grid(occupancy_map: OccupancyMap, goal: tuple[float, float],
                   needed: float) -> DistanceGrid:
    return distance_grid(make_floor(occupancy_map), goal, needed)
