"""
Plan the fastest sequence of pushes to a goal, and solve its first push.

Candidates are single pushes from all contact sites and sequences of several pushes. They are
ranked by an estimate of the time that everything takes, corrections of a likely miss included,
and solved in that order until none that is left can be faster.
"""

import dataclasses
import functools
import math
from typing import Any, Mapping, NamedTuple, Sequence

import numpy as np
from push_model.geometry import distance, Pose
from push_model.parameters import PushedObject, RoundRobot
from push_model.plan_request import PlanFailure, PlanRequest
from push_model.trajectory import PushTrajectory
from push_navigation.occupancy_map import OccupancyMap
from push_navigation.path import Path
from push_navigation.settings import DriveSettings
from push_planner.map_search.kept_sequence import KeptSequence
from push_planner.map_search.planner import plan_push_in_map
from push_planner.plan import Plan
from push_planner.primitive_push.planner import plan_primitive_push, PrimitivePlan
from push_planner.problem import check_object_stands, check_robot_is_round, PlanningFailed
from push_planner.sequence.candidates import (
    Candidate, CandidateReport, Outcome, RejectedCandidate, SequenceCandidate,
    SinglePushCandidate, solve_in_order, SolvedCandidate,
)
from push_planner.sequence.costs import approach_times, sequence_costs, SequenceCosts
from push_planner.sequence.primitives import goal_bearing, primitive_table, PrimitiveTable
from push_planner.sequence.search import search_sequences
from push_planner.sequence.steps import (
    build_steps, PlannedPush, SequenceStep, SETTLING_RADII,
)
from push_planner.settings import PlannerSettings, TaskSettings
from push_planner.single_push.contact_sites import robot_start, site_problems
from push_planner.single_push.feasibility import check_not_at_goal
from push_planner.single_push.site_selection import bound_site
from push_primitives.simplification import simplified_object

# Single pushes that are candidates, the most promising, chosen to bound the time of planning.
MAX_SINGLE_PUSHES = 3
# Sequences are searched for up to the time of the best single push times this: its time is known
# about only.
SEARCH_LIMIT_RATIO = 1.2
# After failed attempts long rotations, which miss most, are avoided at first: a push may be this
# much longer [m] than the distance to the goal times the ratio.
CAUTIOUS_LENGTH = 1.0
CAUTIOUS_LENGTH_RATIO = 1.5


@dataclasses.dataclass(frozen=True)
class SearchReport:
    """
    How a plan was found.

    :param evaluations: number of sequences that were evaluated.
    :param candidates: ``CandidateReport`` of those that were solved, or tried in vain, in order.
    :param no_single_push: why no single push leads to the goal; empty if one does.
    """

    evaluations: int = 0
    candidates: tuple[CandidateReport, ...] = ()
    no_single_push: str = ''

    def as_values(self) -> dict[str, Any]:
        """Return names and values for diagnostics."""
        return {'evaluations': self.evaluations,
                'candidates': [str(candidate) for candidate in self.candidates],
                'no_single_push': self.no_single_push}


class TaskPlan(NamedTuple):
    """
    Plan of a task: a sequence of steered pushes to the goal, or the next unsteered push.

    :param pushes: ``PlannedPush`` of the whole sequence; the unsteered push.
    :param trajectory: ``PushTrajectory`` of the first push.
    :param approach_path: ``Path`` of the robot to where the straight approach to it begins.
    :param duration: of everything, paths of the robot, settling and pushes [s]; of what is
        expected to follow an unsteered push, too.
    :param single_push_time: the same of the best single push [s]; infinite where there is
        none, nan before an unsteered push. It is solved only where it might be faster, else about.
    :param report: ``SearchReport``.
    :param push_report: further values of the first push by name.
    :param plan: the ``Plan`` of a steered push, else None.
    :param later_steps: ``SequenceStep`` of each push but the first.
    :param kept: ``KeptSequence`` of the unsteered pushes but the first, as far as these are
        planned.
    """

    pushes: tuple[PlannedPush, ...]
    trajectory: PushTrajectory
    approach_path: Path
    duration: float
    single_push_time: float
    report: SearchReport
    push_report: Mapping[str, Any]
    plan: Plan | None = None
    later_steps: tuple[SequenceStep, ...] = ()
    kept: KeptSequence | None = None


@dataclasses.dataclass(frozen=True)
class TaskQuery:
    """
    What a plan is asked for; all as of ``plan_task``, finite.

    :param obj: the ``PushedObject``.
    :param robot: the ``RoundRobot``.
    :param object_pose: ``Pose`` of the object in the world.
    :param robot_pose: ``Pose`` of the robot in the world, anywhere.
    :param goal: goal ``Pose`` of the object in the world.
    :param settings: ``PlannerSettings``.
    :param drive: ``DriveSettings``.
    :param task: ``TaskSettings``.
    """

    obj: PushedObject
    robot: RoundRobot
    object_pose: Pose
    robot_pose: Pose
    goal: Pose
    settings: PlannerSettings
    drive: DriveSettings
    task: TaskSettings

    @property
    def local_goal(self) -> Pose:
        """Goal in the frame of the object."""
        return self.object_pose.inverse() @ self.goal

    @property
    def local_robot_pose(self) -> Pose:
        """``Pose`` of the robot in the frame of the object."""
        return self.object_pose.inverse() @ self.robot_pose


def _with_settling(task: TaskSettings, robot: RoundRobot) -> TaskSettings:
    """Lengthen straight ends: the normal of a differential drive settles over its radius."""
    if robot.drive != 'differential':
        return task
    settling = SETTLING_RADII * robot.radius
    return dataclasses.replace(task, min_straight=max(task.min_straight, settling),
                               min_last_straight=max(task.min_last_straight, settling))


class SequencePlanner:
    """
    Planner of one query.

    :param query: ``TaskQuery``.
    """

    def __init__(self, query: TaskQuery) -> None:
        self._query = query
        self._task = _with_settling(query.task, query.robot)
        self._evaluations = 0
        self._outcomes: dict[Candidate, Outcome] = {}
        self._reports: list[CandidateReport] = []
        self._infeasible: list[str] = []

    def plan(self) -> TaskPlan:
        """
        Solve the most promising candidates until none that is left can be faster.

        :return: ``TaskPlan``.
        :raises PlanningFailed: with the reason, and the report of the search.
        """
        single_pushes = self._single_pushes()
        limit = math.inf
        if single_pushes:
            limit = SEARCH_LIMIT_RATIO * min(single.likely_duration + single.expected_correction
                                             for single in single_pushes)
        found = self._solve_first(limit, single_pushes)
        time = math.inf if found is None else found.expected_time
        if time > limit:
            # Single pushes took longer than expected: so may sequences.
            again = self._solve_first(time)
            if again is not None and again.expected_time < time:
                found = again
        if found is None:
            raise self._failure()
        single_push_time = self._single_push_time(single_pushes)
        if len(found.pushes) == 1:
            single_push_time = min(single_push_time, found.duration)
        no_single_push = ''
        if math.isinf(single_push_time):
            no_single_push = self._first_rejection(single_pushes)
        return TaskPlan(found.pushes, found.plan.trajectory, found.approach_path, found.duration,
                        single_push_time, self._report(no_single_push), found.plan.report,
                        found.plan, found.later_steps)

    def _report(self, no_single_push: str = '') -> SearchReport:
        return SearchReport(self._evaluations, tuple(self._reports), no_single_push)

    def _single_push_time(self, single_pushes: Sequence[SinglePushCandidate]) -> float:
        """Time of the best single push, as solved or else as expected [s]."""
        durations: list[float] = []
        for single in single_pushes:
            outcome = self._outcomes.get(single)
            if outcome is None:
                durations.append(single.likely_duration)
            elif isinstance(outcome, SolvedCandidate):
                durations.append(outcome.duration)
        return min(durations, default=math.inf)

    def _first_rejection(self, single_pushes: Sequence[SinglePushCandidate]) -> str:
        outcomes = [self._outcomes.get(single) for single in single_pushes]
        reasons = [outcome.report.rejection for outcome in outcomes
                   if isinstance(outcome, RejectedCandidate)] + self._infeasible
        return reasons[0] if reasons else ''

    def _solve_first(self, limit: float,
                     single_pushes: Sequence[Candidate] = ()) -> SolvedCandidate | None:
        """Solve single pushes and sequences."""
        return solve_in_order([*single_pushes, *self._sequences(limit)], self._solve)

    def _solve(self, candidate: Candidate, time_limit: float) -> Outcome:
        outcome = candidate.solve(self._query.robot_pose, self._query.drive, time_limit)
        self._outcomes[candidate] = outcome
        self._reports.append(outcome.report)
        return outcome

    def _single_pushes(self) -> list[SinglePushCandidate]:
        """List the most promising single pushes, and note why the others are not feasible."""
        query = self._query
        sites = [bound_site(problem) for problem in site_problems(
            query.obj, query.robot, query.object_pose, query.goal, query.settings)]
        self._infeasible = [site.reason for site in sites if site.reason]
        robot_poses = [query.object_pose.inverse() @ robot_start(site.problem) for site in sites]
        times = approach_times(query.robot, query.obj, query.local_robot_pose,
                               tuple(robot_poses), query.drive)
        if not np.any(np.isfinite(times)):
            self._infeasible.insert(0, 'the robot stands where it cannot get round the object')
        candidates = [SinglePushCandidate.of(site.problem, float(time) + self._task.switch_time,
                                             site.bound, self._task.correction_time)
                      for site, time in zip(sites, times) if math.isfinite(time + site.bound)]
        return sorted(candidates, key=lambda single: single.expected_time)[:MAX_SINGLE_PUSHES]

    def _sequences(self, limit: float) -> list[SequenceCandidate]:
        """List the fastest sequences."""
        try:
            found = search_sequences(self._table, self._costs, self._query.local_goal, self._task,
                                     limit)
        except PlanningFailed as failure:
            self._infeasible.append(failure.reason)
            return []
        query = self._query
        self._evaluations += found.evaluations
        return [SequenceCandidate.of(
            build_steps(sequence, self._table, query.object_pose, query.goal, query.settings),
            sequence.duration, self._task.correction_time) for sequence in found.sequences]

    @functools.cached_property
    def _table(self) -> PrimitiveTable:
        query = self._query
        return primitive_table(query.obj, query.robot, query.settings, self._task,
                               goal_bearing(query.obj, query.object_pose, query.goal))

    @functools.cached_property
    def _costs(self) -> SequenceCosts:
        query = self._query
        return sequence_costs(self._table, query.local_robot_pose, query.settings, query.drive,
                              self._task)

    def _failure(self) -> PlanningFailed:
        reason = str(self._reports[0]) if self._reports else self._infeasible[0]
        return PlanningFailed(PlanFailure.NO_SEQUENCE, 'no push sequence to the goal was found: '
                              f'{reason}', self._report().as_values())


def plan_task(obj: PushedObject, robot: RoundRobot, object_pose: Pose, robot_pose: Pose,
              goal: Pose, settings: PlannerSettings | None = None, *,
              drive: DriveSettings | None = None, task: TaskSettings | None = None) -> TaskPlan:
    """
    Plan the fastest sequence of steered pushes to a goal, the paths of the robot included.

    On open floor; in maps see ``push_planner.map_search``. A fine outline and many supports are
    simplified.

    :param obj: the ``PushedObject``.
    :param robot: the ``RoundRobot``.
    :param object_pose: ``Pose`` of the object in the world.
    :param robot_pose: ``Pose`` of the robot in the world, anywhere.
    :param goal: goal ``Pose`` of the object in the world.
    :param settings: ``PlannerSettings``, or None for the defaults.
    :param drive: ``DriveSettings``, or None for the defaults.
    :param task: ``TaskSettings``, or None for the defaults.
    :return: ``TaskPlan``.
    :raises PlanningFailed: with the reason.
    """
    check_robot_is_round(robot)
    obj = simplified_object(obj)
    check_object_stands(obj)
    poses = {'object pose': object_pose, 'robot pose': robot_pose, 'goal': goal}
    for name, pose in poses.items():
        if not Pose(*pose).is_finite():
            raise PlanningFailed(PlanFailure.INVALID_VALUE,
                                 f'the {name} is not finite: {tuple(pose)}')
    settings = settings or PlannerSettings()
    object_pose, robot_pose, goal = (Pose(*map(float, pose)) for pose in poses.values())
    check_not_at_goal(object_pose, goal, settings)
    return SequencePlanner(TaskQuery(
        obj, robot, object_pose, robot_pose, goal, settings, drive or DriveSettings(),
        task or TaskSettings())).plan()


def plan_for_request(request: PlanRequest, robot: RoundRobot, settings: PlannerSettings,
                     drive: DriveSettings, task: TaskSettings | None = None,
                     occupancy_map: OccupancyMap | None = None, *,
                     kept: KeptSequence | None = None) -> TaskPlan:
    """
    Plan what a supervisor requests, on open floor by the method of the settings.

    Where no unsteered push is possible there, a sequence is sought. Sequences keep to a reduced
    friction cone after failed attempts.

    :param request: ``PlanRequest``.
    :param robot: the ``RoundRobot``.
    :param settings: ``PlannerSettings``.
    :param drive: ``DriveSettings``.
    :param task: ``TaskSettings``, or None for the defaults.
    :param occupancy_map: the ``OccupancyMap``, or None for open floor.
    :param kept: ``KeptSequence`` of the former plan in a map.
    :return: ``TaskPlan``.
    :raises PlanningFailed: with the reason.
    """
    if occupancy_map is not None:
        found = plan_push_in_map(request, robot, settings, drive, occupancy_map, kept=kept)
        return _as_task_plan(found.first, found.later, found.expansions)
    if (task or TaskSettings()).method == 'primitives':
        try:
            return _as_task_plan(plan_primitive_push(request, robot, settings, drive))
        except PlanningFailed as failure:
            # An object whose faces are too short for unsteered pushes may have steered ones.
            if failure.code is not PlanFailure.NO_FEASIBLE_SITE:
                raise
    plan = functools.partial(plan_task, request.obj, robot, request.object_pose,
                             request.robot_pose, request.goal, drive=drive, task=task)
    if request.cone_fraction < 1.0:
        longest = CAUTIOUS_LENGTH + CAUTIOUS_LENGTH_RATIO * distance(request.object_pose,
                                                                     request.goal)
        cautious = dataclasses.replace(
            settings, cone_margin=request.cone_fraction * settings.cone_margin,
            max_path_length=min(settings.max_path_length, longest))
        try:
            return plan(settings=cautious)
        except PlanningFailed:
            pass
    return plan(settings=settings)


def _as_task_plan(found: PrimitivePlan, kept: KeptSequence | None = None,
                  expansions: int = 0) -> TaskPlan:
    trajectory = found.trajectory
    ends = (Pose(*poses[end].tolist())
            for poses in (trajectory.object_poses, trajectory.robot_poses) for end in (0, -1))
    start, end, robot_start, robot_end = ends
    push = PlannedPush(found.contact, start, end, robot_start, robot_end, trajectory.duration,
                       found.length)
    return TaskPlan((push,), trajectory, found.approach_path, found.expected_time, math.nan,
                    SearchReport(expansions), found.report, kept=kept)
