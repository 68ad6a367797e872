"""What a supervisor wants: the first push of a chain, the more careful the less bold it is."""

import dataclasses
import functools
import math
from typing import NamedTuple

import numpy as np
from push_model.geometry import distance, Pose
from push_model.plan_request import PlanFailure
from push_navigation.path import Path
from push_navigation.settings import DriveSettings
from push_planner.plan import Plan
from push_planner.problem import check_robot_is_round, PlanningFailed
from push_planner.sequence.candidates import SequenceCandidate, SinglePushCandidate
from push_planner.sequence.clearance import ClearanceCheck
from push_planner.sequence.costs import approach_times, sequence_costs
from push_planner.sequence.primitives import goal_bearing, primitive_table
from push_planner.sequence.search import search
from push_planner.sequence.steps import build_steps, SETTLING
from push_planner.settings import PlannerSettings, TaskSettings
from push_planner.single_push.contact_sites import robot_start, site_problems
from push_planner.single_push.feasibility import check_not_at_goal
from push_planner.single_push.site_selection import bound_site

SINGLES = 3
HOPEFUL = 1.2
# In a map more sequences are tried, with fewer turns each first, with shorter ends last [m].
ALTERNATIVES, TRIALS, TURN_STEPS, NARROW_END = 6, 2, 5, 0.35


class TaskPlan(NamedTuple):
    """
    How to get the object to the goal, and the first push of it.

    :param pushes: ``PlannedPush`` of the whole chain.
    :param plan: the ``Plan`` of the first push.
    :param way: ``Path`` of the robot to where the last straight piece to its contact begins.
    :param duration: of everything, ways, settling and pushes [s].
    :param single: the same of the best single push [s]; infinite where there is none. It is
        solved only where it might be quicker, else about.
    :param report: what the search came to, a dict of names to numbers and texts.
    :param later_steps: ``push_planner.sequence.steps.SequenceStep`` of each push but the first.
    """

    pushes: tuple
    plan: Plan
    way: Path
    duration: float
    single: float
    report: dict
    later_steps: tuple


def _with_room_to_settle(task, robot):
    """Lengthen straight ends: the normal of a differential drive settles over its radius."""
    if robot.drive != 'differential':
        return task
    least = SETTLING * robot.radius
    return dataclasses.replace(task, min_straight=max(task.min_straight, least),
                               min_last_straight=max(task.min_last_straight, least))


class SequencePlanner:
    """One question for a chain, and the work on it."""

    def __init__(self, obj, robot, object_pose, robot_pose, goal, settings, drive, task,
                 occupancy_map):
        """
        Take the question; all as of ``push_planner.sequence.planner.plan_task``, finite.

        :raises PlanningFailed: where object or goal do not fit into the map.
        """
        self.obj, self.robot, self.start, self.here = obj, robot, object_pose, robot_pose
        self.goal, self.settings, self.drive = goal, settings, drive
        self.task = _with_room_to_settle(task, robot)
        self.room = occupancy_map and ClearanceCheck(occupancy_map, obj, robot, object_pose, goal, drive)
        inside = object_pose.inverse()
        self.local_goal, self.local_robot = inside @ goal, inside @ robot_pose
        self.report = {'weighed': 0, 'tried': []}

    def answer(self):
        """
        Solve the most promising until none that is left can be quicker.

        :return: ``TaskPlan``.
        :raises PlanningFailed: with the reason, and the report where the search was done.
        """
        singles = self._singles()
        hopeful = singles if self.room is None else []
        limit = HOPEFUL * min((option.about + option.hazard for option in hopeful),
                              default=math.inf)
        found = self._first(limit, singles)
        most = math.inf if found is None else found.expected
        if most > limit:
            again = self._first(most)
            found = again if again and again.expected < most else found
        if found is None:
            raise self._failure()
        single = min((option.about for option in singles if not option.reason), default=math.inf)
        if len(found.pushes) == 1:
            single = min(single, found.duration)
        reasons = [option.reason for option in singles] + self.refused
        self.report['single'] = reasons[0] if reasons and math.isinf(single) else ''
        return TaskPlan(found.pushes, found.plan, found.way, found.duration, single, self.report,
                        found.later_steps)

    def _first(self, limit, options=()):
        """Look for chains the harder the longer none can be solved."""
        for chains in self._chains(limit):
            found = self._best([*options, *chains])
            if found is not None:
                return found
            options = ()
        return None

    def _best(self, options):
        best, worth = None, min((option.worth for option in options), default=math.inf)
        for option in sorted(options, key=lambda option: option.expected):
            if best is not None and option.expected >= option.optimality_ratio * best.expected:
                continue
            option.solve(self.here, self.drive, worth, self.room)
            self.report['tried'].append(str(option))
            if not option.reason and (best is None or option.expected < best.expected):
                best = option
                worth = min(worth, best.expected)
        return best

    def _singles(self):
        problems = site_problems(self.obj, self.robot, self.start, self.goal, self.settings)
        weighed = [bound_site(problem) for problem in problems]
        self.refused = [site.reason for site in weighed if site.reason]
        places = [self.start.inverse() @ robot_start(site.problem) for site in weighed]
        ways = approach_times(self.robot, self.obj, self.local_robot, tuple(places), self.drive)
        if not np.any(np.isfinite(ways)):
            self.refused.insert(0, 'the robot stands where it cannot get round the object')
        options = [SinglePushCandidate(site.problem, float(way) + self.task.switch_time, site.bound,
                                       self.task.correction_time)
                   for site, way in zip(weighed, ways) if math.isfinite(way + site.bound)]
        return sorted(options, key=lambda option: option.expected)[:SINGLES]

    def _chains(self, limit):
        try:
            table = self._table
        except PlanningFailed as failure:
            self.refused.append(failure.reason)
            yield []
            return
        if self.room is None:
            yield self._laid_out(search(table, self._costs, self.local_goal, self.task, limit))
            return
        excess, asked = self.room.excess(table), self.task
        short = max(asked.min_straight, min(asked.min_last_straight, NARROW_END))
        few = min(TURN_STEPS, asked.rotation_steps)
        for steps, end in ((few, asked.min_last_straight), (few, short),
                           (asked.rotation_steps, asked.min_last_straight), (asked.rotation_steps, short)):
            task = dataclasses.replace(asked, rotation_steps=steps, max_evaluations=TRIALS * asked.max_evaluations,
                                       alternatives=ALTERNATIVES * asked.alternatives,
                                       min_last_straight=end)
            found = search(table, self._costs, self.local_goal, task, limit, excess)
            free = [option for option in self._laid_out(found)
                    if self.room.steps_are_free(option.steps)]
            yield free[:asked.alternatives]

    def _laid_out(self, found):
        self.report['weighed'] += found.weighed
        return [SequenceCandidate(build_steps(chain, self._table, self.start, self.goal, self.settings),
                                  chain.duration, self.task.correction_time) for chain in found.chains]

    @functools.cached_property
    def _table(self):
        return primitive_table(self.obj, self.robot, self.settings, self.task,
                               goal_bearing(self.obj, self.start, self.goal))

    @functools.cached_property
    def _costs(self):
        return sequence_costs(self._table, self.obj, self.robot, self.local_robot, self.settings,
                              self.drive, self.task)

    def _failure(self):
        tried = self.report['tried'] or self.refused
        if self.room is not None:
            self.room = None
            if self._singles() or any(self._chains(math.inf)):
                return PlanningFailed(
                    PlanFailure.BLOCKED, 'the goal is reached only outside the map or through '
                    f'its obstacles: {tried[0]}', self.report)
        return PlanningFailed(PlanFailure.NO_SEQUENCE, 'no chain of pushes to the goal was found: '
                              f'{tried[0]}', self.report)


def plan_task(obj, robot, object_pose, robot_pose, goal, settings=None, drive=None, task=None,
              occupancy_map=None):
    """
    Find the quickest chain of pushes to the goal, the robot's ways included.

    :param obj: the ``PushedObject``.
    :param robot: the ``RoundRobot``.
    :param object_pose: ``Pose`` of the object in the world.
    :param robot_pose: ``Pose`` of the robot in the world, anywhere.
    :param goal: ``Pose`` wanted for the object in the world.
    :param settings: ``PlannerSettings``, or None for the defaults.
    :param drive: ``DriveSettings``, or None for the defaults.
    :param task: ``TaskSettings``, or None for the defaults.
    :param occupancy_map: ``OccupancyMap`` that robot and object keep to; None for open floor.
    :return: ``TaskPlan``.
    :raises PlanningFailed: with the reason.
    """
    check_robot_is_round(robot)
    poses = {'object pose': object_pose, 'robot pose': robot_pose, 'goal': goal}
    for name, pose in poses.items():
        if not Pose(*pose).is_finite():
            raise PlanningFailed(PlanFailure.INVALID_VALUE,
                                 f'the {name} is not finite: {tuple(pose)}')
    settings = settings or PlannerSettings()
    object_pose, robot_pose, goal = (Pose(*map(float, pose)) for pose in poses.values())
    check_not_at_goal(object_pose, goal, settings)
    return SequencePlanner(obj, robot, object_pose, robot_pose, goal, settings, drive or DriveSettings(),
                           task or TaskSettings(), occupancy_map).answer()


SHORT, DETOUR = 1.0, 1.5


def plan_for_request(wanted, robot, settings, drive, task=None, occupancy_map=None):
    """
    Answer a supervisor.

    :param wanted: ``push_model.plan_request.PlanRequest``: poses, goal, object as learnt, boldness.
    :param robot: the ``RoundRobot``.
    :param settings: ``PlannerSettings``.
    :param drive: ``DriveSettings``.
    :param task: ``TaskSettings``, or None for the defaults.
    :param occupancy_map: the ``OccupancyMap``, or None for open floor.
    :return: ``push_planner.sequence.planner.TaskPlan``.
    :raises PlanningFailed: with the reason.
    """
    ask = functools.partial(plan_task, wanted.obj, robot, wanted.object_pose, wanted.robot_pose,
                            wanted.goal, drive=drive, task=task, occupancy_map=occupancy_map)
    if wanted.cone_fraction < 1.0:
        # Long turns miss most: short pushes that come to the same are asked for first.
        far = distance(wanted.object_pose, wanted.goal)
        careful = dataclasses.replace(
            settings, cone_margin=wanted.cone_fraction * settings.cone_margin,
            max_path_length=min(settings.max_path_length, SHORT + DETOUR * far))
        try:
            return ask(careful)
        except PlanningFailed:
            pass
    return ask(settings)
