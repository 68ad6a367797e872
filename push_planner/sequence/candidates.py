"""What may be the answer to a task: single pushes and chains, solved when their turn comes."""

import dataclasses
import math

import numpy as np
from push_model.geometry import Pose, wrap_angle
from push_navigation.path import NoPathFound
from push_navigation.speed_profile import travel_time
from push_planner.problem import PlanningFailed
from push_planner.sequence.costs import plan_approach
from push_planner.sequence.miss_probability import miss_probability
from push_planner.sequence.steps import PlannedPush
from push_planner.single_push.contact_sites import robot_start
from push_planner.single_push.planner import plan_push, PlanRequirements
from push_planner.single_push.site_selection import ROUTE_SLACK

SHORTEST = 0.01
# Plans are shorter than the way that is ranked first, by 20 % at most in 40 random tasks.
LONGER = 1.25
MOST, IN_MAP = 8, 3
ASIDE = 0.1
# Turn of an object that counts as none [rad].
STILL = 0.035


class Candidate:
    """
    A chain whose first push is still to be solved.

    Attributes: ``pushes``; ``duration`` of everything [s], about until it is solved; ``hazard``:
    time that mending a miss of the last push takes, times its chance [s]; ``plan`` of the first
    push, None until then; ``way`` to it; ``reason`` why it cannot be, empty while it
    can; ``optimality_ratio``: share of the time of another solution above which this one is not worth
    solving; ``worth``: time that others must beat [s]; ``later_steps``: ``push_planner.sequence.steps.SequenceStep`` of
    each push but the first.
    """

    later_steps = ()
    optimality_ratio = 1.0
    worth = math.inf

    def __init__(self, problem, pushes, duration, hazard):
        """
        Take a chain.

        :param problem: ``PushProblem`` of the first push.
        :param pushes: ``PlannedPush`` of all pushes, about.
        :param duration: of everything, about [s].
        :param hazard: see above [s].
        """
        self.problem, self.pushes = problem, tuple(pushes)
        self.duration, self.hazard = duration, hazard
        self.plan, self.way, self.reason = None, None, ''

    @property
    def expected(self):
        """Time of everything, and of what may come after it [s]."""
        return self.duration + self.hazard

    def solve(self, robot_pose, drive, worth=math.inf, room=None):
        """
        Find the way to the first push, and plan it.

        :param robot_pose: ``Pose`` of the robot.
        :param drive: ``DriveSettings``.
        :param worth: time above which the answer is of no use [s].
        :param room: ``push_planner.sequence.clearance.ClearanceCheck``, or None for open floor.
        """
        problem = self._limited(worth)
        try:
            self.way = plan_approach(problem.robot, problem.obj, problem.start, robot_pose,
                                     robot_start(problem), drive, room and room.occupancy_map)
            found = plan_push(problem, requirements=self._requirements(room))
            if room is not None:
                self.duration += self._detours(robot_pose, drive, room)
        except NoPathFound as failure:
            self.reason = f'no way for the robot, {failure.reason}'
        except PlanningFailed as failure:
            self.reason = failure.reason
        else:
            self._take(found)

    def _take(self, found):
        first, trajectory = self.pushes[0], found.trajectory
        self.duration += trajectory.duration - first.duration
        end = Pose(*map(float, trajectory.robot_poses[-1]))
        first = first._replace(robot_end=end, duration=trajectory.duration,
                               path_length=found.report['path_length'])
        self.plan, self.pushes = found, (first, *self.pushes[1:])

    def _detours(self, robot_pose, drive, room):
        """Time that ways take longer in the map [s]."""
        robot, obj, first = self.problem.robot, self.problem.obj, self.pushes[0]
        ends = [(first.start, robot_pose, first.robot_start)]
        ends += [(before.end, before.robot_end, after.robot_start)
                 for before, after in zip(self.pushes, self.pushes[1:])]
        times = [[travel_time(plan_approach(robot, obj, *end, drive, occupancy_map), robot, drive)
                  for end in ends] for occupancy_map in (room.occupancy_map, None)]
        return sum(times[0]) - sum(times[1])

    def _limited(self, worth):
        return self.problem

    def _requirements(self, room):
        return PlanRequirements(max_solves=MOST) if room is None else PlanRequirements(None, room.fault, IN_MAP)

    def __str__(self):
        """Say it in one line."""
        sites = ', '.join(f'{push.contact.kind} {push.contact.index}' for push in self.pushes)
        return f'{sites}: {self.reason or f"{self.duration:.1f} + {self.hazard:.1f} s"}'


class SinglePushCandidate(Candidate):
    """One push to the goal; until it is solved its duration is a lower bound."""

    def __init__(self, problem, before, bound, correction_time):
        """
        Take a push to the goal.

        :param problem: the ``PushProblem``.
        :param before: time until it begins [s].
        :param bound: time of the push at least [s].
        :param correction_time: time that mending a miss takes [s].
        """
        place = robot_start(problem)
        push = PlannedPush(problem.contact, problem.start, problem.goal, place,
                           problem.goal @ problem.start.inverse() @ place, bound,
                           bound * problem.settings.pushing_speed)
        least = correction_time * float(miss_probability(
            abs(wrap_angle(problem.goal.theta - problem.start.theta)), math.inf, math.inf, False))
        super().__init__(problem, (push,), before + bound, least)
        self._before, self._about = before, before + bound / ROUTE_SLACK
        self._mending_time = correction_time

    @property
    def about(self):
        """Time that is to be expected, or that it takes once it is solved [s]."""
        return self.duration if self.plan else self._about

    def _take(self, found):
        super()._take(found)
        turned, straight = _end_of(found.trajectory)
        self.hazard = self._mending_time * float(miss_probability(
            turned, straight, found.report['path_length'], self.problem.contact.kind == 'face'))

    def _limited(self, worth):
        settings = self.problem.settings
        longest = max(LONGER * (worth - self._before) * settings.pushing_speed, SHORTEST)
        return dataclasses.replace(self.problem, settings=dataclasses.replace(
            settings, max_path_length=min(longest, settings.max_path_length)))


class SequenceCandidate(Candidate):
    """Several pushes, all but the first of them as the algebra has them."""

    optimality_ratio = 0.97

    def __init__(self, steps, expected, correction_time):
        """
        Take a chain.

        :param steps: ``push_planner.sequence.steps.SequenceStep`` list.
        :param expected: time of everything, and of what may come after it, about [s].
        :param correction_time: time that mending a miss takes [s].
        """
        last = steps[-1]
        hazard = correction_time * float(miss_probability(
            sum(abs(length * curvature) for length, curvature in last.segments), last.segments[-1][0],
            last.push.path_length, last.problem.contact.kind == 'face'))
        super().__init__(steps[0].problem, [step.push for step in steps], expected - hazard,
                         hazard)
        self.steps, self.later_steps, self.worth = steps, tuple(steps[1:]), expected

    def _requirements(self, room):
        if room is None:
            return super()._requirements(room)
        return PlanRequirements(self.steps[0].route(ASIDE), room.fault, IN_MAP)


def _end_of(trajectory):
    """Angle by which a push turns the object, to and fro [rad], and its straight end [m]."""
    headings, places = np.unwrap(trajectory.object_poses[:, 2]), trajectory.robot_poses[:, :2]
    off = np.flatnonzero(np.abs(headings - headings[-1]) > STILL)
    end = np.hypot(*np.diff(places[off[-1] if len(off) else 0:], axis=0).T).sum()
    return float(np.abs(np.diff(headings)).sum()), float(end)
