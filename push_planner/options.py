"""What may be the answer to a task: single pushes and chains, solved when their turn comes."""

import dataclasses
import math

from push_drive.detour import NoWay
from push_drive.way import travel_time
from push_model.geometry import Pose
from push_planner.approaches import way_to
from push_planner.problem import PlanningFailed
from push_planner.pushes import PlannedPush
from push_planner.site_list import robot_start
from push_planner.sites import SLACK
from push_planner.solver import plan

SHORTEST = 0.01
# Plans are shorter than the way that is ranked first, by 20 % at most in 40 random tasks.
LONGER = 1.25


class Option:
    """
    A chain whose first push is still to be solved.

    Attributes: ``duration`` of everything [s], about until it is solved; ``plan`` of the first
    push, None until then; ``way`` to it; ``reason`` why it cannot be, empty while it can;
    ``sure``: share of the time of another solution above which this one is not worth solving;
    ``worth``: time that others must beat [s].
    """

    sure = 1.0
    worth = math.inf

    def __init__(self, problem, duration):
        """
        Take a push as asked for.

        :param problem: ``PushProblem`` of the first push.
        :param duration: of everything, about [s].
        """
        self.problem, self.duration = problem, duration
        self.plan, self.way, self.reason, self.pushes = None, None, '', ()

    def solve(self, robot_pose, drive, worth=math.inf, room=None):
        """
        Find the way to the first push, and plan it.

        :param robot_pose: ``Pose`` of the robot.
        :param drive: ``DriveSettings``.
        :param worth: time above which the answer is of no use [s].
        :param room: ``push_planner.room.Room``, or None for open floor.
        """
        problem = self._limited(worth)
        workspace = room and room.workspace
        try:
            self.way = way_to(problem.robot, problem.obj, problem.start, robot_pose,
                              robot_start(problem), drive, workspace)
            found = plan(problem)
            if room is not None:
                self._fit(found, robot_pose, drive, room)
        except NoWay as failure:
            self.reason = f'no way for the robot, {failure.reason}'
        except PlanningFailed as failure:
            self.reason = failure.reason
        else:
            self._take(found)
            self.plan = found

    def _fit(self, found, robot_pose, drive, room):
        """Refuse what the map does not allow, and count detours."""
        if not room.holds(found.trajectory.object_poses, found.trajectory.robot_poses):
            raise PlanningFailed('the push meets an obstacle or leaves the map')
        self.duration += self._detour(self.problem.start, robot_pose, robot_start(self.problem),
                                      drive, room)

    def _detour(self, object_pose, start, contact_pose, drive, room):
        """Time that a way takes longer in the map [s]."""
        robot = self.problem.robot
        open_, kept = (travel_time(way_to(robot, self.problem.obj, object_pose, start,
                                          contact_pose, drive, workspace), robot, drive)
                       for workspace in (None, room.workspace))
        return kept - open_

    def _limited(self, worth):
        return self.problem

    def _take(self, found):
        raise NotImplementedError

    def __str__(self):
        """Say it in one line."""
        sites = ', '.join(f'{push.contact.kind} {push.contact.index}' for push in self.pushes)
        name = sites or f'{self.problem.contact.kind} {self.problem.contact.index}'
        return f'{name}: {self.reason or f"{self.duration:.1f} s"}'


class SingleOption(Option):
    """
    One push to the goal; until it is solved its duration is a lower bound.

    ``about`` is what is to be expected instead [s].
    """

    def __init__(self, problem, before, bound):
        """
        Take a push to the goal.

        :param problem: the ``PushProblem``.
        :param before: time until it begins [s].
        :param bound: time of the push at least [s].
        """
        super().__init__(problem, before + bound)
        self.before, self.bound, self.about = before, bound, before + bound / SLACK

    def _limited(self, worth):
        settings = self.problem.settings
        longest = LONGER * (worth - self.before) * settings.pushing_speed
        if longest >= settings.max_path_length:
            return self.problem
        longest = max(longest, SHORTEST)
        return dataclasses.replace(self.problem, settings=dataclasses.replace(
            settings, max_path_length=longest))

    def _take(self, found):
        problem, poses = self.problem, found.trajectory.robot_poses
        time = found.trajectory.duration
        self.duration += time - self.bound
        self.about = self.duration
        self.pushes = (PlannedPush(problem.contact, problem.start, problem.goal,
                                   robot_start(problem), Pose(*map(float, poses[-1])), time,
                                   found.report['path_length']),)


class ChainOption(Option):
    """Several pushes, all but the first of them as the algebra has them."""

    sure = 0.97

    def __init__(self, steps, duration):
        """
        Take a chain.

        :param steps: ``push_planner.pushes.Step`` list.
        :param duration: of everything, about [s].
        """
        super().__init__(steps[0].problem, duration)
        self.steps, self.worth = steps, duration
        self.pushes = tuple(step.push for step in steps)

    def _fit(self, found, robot_pose, drive, room):
        super()._fit(found, robot_pose, drive, room)
        for before, after in zip(self.pushes, self.pushes[1:]):
            self.duration += self._detour(before.end, before.robot_end, after.robot_start, drive,
                                          room)

    def _take(self, found):
        first, time = self.pushes[0], found.trajectory.duration
        self.duration += time - first.duration
        end = Pose(*map(float, found.trajectory.robot_poses[-1]))
        self.pushes = (first._replace(robot_end=end, duration=time,
                                      path_length=found.report['path_length']),
                       *self.pushes[1:])
