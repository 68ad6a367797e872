"""
Candidate solutions of a task: single pushes and push sequences.

The first push of a candidate is solved lazily, in the order of the expected time: see
``solve_in_order``. A candidate never changes; solving it makes a ``SolvedCandidate`` or a
``RejectedCandidate``.
"""

import abc
import dataclasses
import math
from typing import Callable, Iterable, NamedTuple, Sequence, TypeVar, Union

import numpy as np
from push_model.geometry import Pose, wrap_angle
from push_model.trajectory import PushTrajectory
from push_navigation.path import NoPathFound, Path
from push_navigation.settings import DriveSettings
from push_planner.plan import Plan
from push_planner.problem import PlanningFailed, PushProblem
from push_planner.sequence.costs import plan_approach
from push_planner.sequence.miss_probability import miss_probability
from push_planner.sequence.steps import PlannedPush, SequenceStep
from push_planner.single_push.contact_sites import robot_start
from push_planner.single_push.planner import plan_push
from push_planner.single_push.site_selection import ROUTE_SLACK

# Least limit of the path length of a push [m]: one that is accepted as a setting.
MIN_PATH_LIMIT = 0.01
# Plans are shorter than the path that is ranked first, by 20 % at most in 40 random tasks.
PATH_LIMIT_RATIO = 1.25
# Programs that are solved for a push at most, chosen: a candidate that needs more is left for the
# next one.
MAX_SOLVES = 8
# Rotation of an object that counts as none [rad], chosen: 2 degrees.
STRAIGHT_TOLERANCE = 0.035
# Part of the time of the best solution that a sequence must promise to be solved: the estimate of
# its time is a few percent off.
PROMISING_RATIO = 0.97


class CandidateReport(NamedTuple):
    """
    What became of a candidate, or what is known of it.

    :param sites: contact sites of its pushes, in words.
    :param duration: of everything [s].
    :param expected_correction: time of correcting a miss of the last push, times its
        probability [s].
    :param rejection: why it has no solution; empty if it has one.
    """

    sites: str
    duration: float
    expected_correction: float
    rejection: str

    def __str__(self) -> str:
        """Write it in one line."""
        times = f'{self.duration:.1f} + {self.expected_correction:.1f} s'
        return f'{self.sites}: {self.rejection or times}'


@dataclasses.dataclass(frozen=True, eq=False)
class SolvedCandidate:
    """
    A candidate whose first push is planned.

    :param pushes: ``PlannedPush`` of all pushes.
    :param plan: ``Plan`` of the first push.
    :param approach_path: ``Path`` of the robot to where the straight approach to it begins.
    :param later_steps: ``SequenceStep`` of each push but the first.
    :param duration: of everything [s].
    :param expected_correction: time of correcting a miss of the last push, times its
        probability [s].
    """

    pushes: tuple[PlannedPush, ...]
    plan: Plan
    approach_path: Path
    later_steps: tuple[SequenceStep, ...]
    duration: float
    expected_correction: float

    @property
    def expected_time(self) -> float:
        """Time of everything, and of what may come after it [s]."""
        return self.duration + self.expected_correction

    @property
    def report(self) -> CandidateReport:
        """``CandidateReport``."""
        return CandidateReport(_sites(self.pushes), self.duration, self.expected_correction, '')


@dataclasses.dataclass(frozen=True, eq=False)
class RejectedCandidate:
    """
    A candidate without solution.

    :param report: ``CandidateReport`` with the reason.
    """

    report: CandidateReport


Outcome = Union[SolvedCandidate, RejectedCandidate]


@dataclasses.dataclass(frozen=True, eq=False)
class Candidate(abc.ABC):
    """
    A single push or a sequence whose first push is still to be solved.

    :param problem: ``PushProblem`` of the first push.
    :param pushes: ``PlannedPush`` of all pushes, about.
    :param duration: of everything, about or at least [s].
    :param expected_correction: time of correcting a miss of the last push, times its
        probability, about or at least [s].
    :param correction_time: time that correcting a miss takes [s].
    """

    problem: PushProblem
    pushes: tuple[PlannedPush, ...]
    duration: float
    expected_correction: float
    correction_time: float

    @property
    def expected_time(self) -> float:
        """Time of everything, and of what may come after it, about or at least [s]."""
        return self.duration + self.expected_correction

    @property
    def time_to_beat(self) -> float:
        """Time above which no other candidate is of use [s]."""
        return math.inf

    @property
    def optimality_ratio(self) -> float:
        """Part of the time of a solution from which on this candidate is not worth solving."""
        return 1.0

    @property
    def later_steps(self) -> tuple[SequenceStep, ...]:
        """``SequenceStep`` of each push but the first."""
        return ()

    def solve(self, robot_pose: Pose, drive: DriveSettings,
              time_limit: float = math.inf) -> Outcome:
        """
        Plan the robot's path to the first push, and the push.

        :param robot_pose: ``Pose`` of the robot.
        :param drive: ``DriveSettings``.
        :param time_limit: time above which a solution is of no use [s].
        :return: ``SolvedCandidate`` or ``RejectedCandidate``.
        """
        problem = self._limited_problem(time_limit)
        try:
            path = plan_approach(problem.robot, problem.obj, problem.start, robot_pose,
                                 robot_start(problem), drive)
            plan = plan_push(problem, max_solves=MAX_SOLVES)
        except NoPathFound as failure:
            return self._rejected(f'no path for the robot: {failure.reason}')
        except PlanningFailed as failure:
            return self._rejected(failure.reason)
        return self._solved(plan, path)

    def _solved(self, plan: Plan, path: Path) -> SolvedCandidate:
        """Replace the estimates of the first push by its plan."""
        first = self.pushes[0]
        trajectory = plan.trajectory
        planned = first._replace(
            robot_end=Pose(*map(float, trajectory.robot_poses[-1])), duration=trajectory.duration,
            path_length=plan.report['path_length'])
        return SolvedCandidate(
            (planned, *self.pushes[1:]), plan, path, self.later_steps,
            self.duration + (trajectory.duration - first.duration), self._correction_after(plan))

    def _rejected(self, reason: str) -> RejectedCandidate:
        return RejectedCandidate(CandidateReport(_sites(self.pushes), self.duration,
                                                 self.expected_correction, reason))

    def _limited_problem(self, time_limit: float) -> PushProblem:
        """Return the problem of the first push, limited to solutions that are of use."""
        return self.problem

    @abc.abstractmethod
    def _correction_after(self, plan: Plan) -> float:
        """Return the expected time of corrections once the first push is planned [s]."""


@dataclasses.dataclass(frozen=True, eq=False)
class SinglePushCandidate(Candidate):
    """
    One push to the goal; until it is solved its duration is a lower bound.

    :param time_before: time until the push begins [s].
    :param bound: lower bound of the time of the push [s].
    """

    time_before: float
    bound: float

    @classmethod
    def of(cls, problem: PushProblem, time_before: float, bound: float,
           correction_time: float) -> 'SinglePushCandidate':
        """
        Make a candidate of a push to the goal.

        :param problem: the ``PushProblem``.
        :param time_before: time until the push begins [s].
        :param bound: lower bound of the time of the push [s].
        :param correction_time: time that correcting a miss takes [s].
        """
        robot_pose = robot_start(problem)
        push = PlannedPush(problem.contact, problem.start, problem.goal, robot_pose,
                           problem.goal @ problem.start.inverse() @ robot_pose, bound,
                           bound * problem.settings.pushing_speed)
        # The least rotation, with a long path and a long straight end, misses least.
        rotation = abs(wrap_angle(problem.goal.theta - problem.start.theta))
        least_correction = correction_time * float(miss_probability(
            rotation, math.inf, math.inf, False))
        return cls(problem, (push,), time_before + bound, least_correction, correction_time,
                   time_before, bound)

    @property
    def likely_duration(self) -> float:
        """Time of everything that is to be expected [s]."""
        return self.time_before + self.bound / ROUTE_SLACK

    def _limited_problem(self, time_limit: float) -> PushProblem:
        settings = self.problem.settings
        longest = max(PATH_LIMIT_RATIO * (time_limit - self.time_before) * settings.pushing_speed,
                      MIN_PATH_LIMIT)
        return dataclasses.replace(self.problem, settings=dataclasses.replace(
            settings, max_path_length=min(longest, settings.max_path_length)))

    def _correction_after(self, plan: Plan) -> float:
        shape = _shape_of(plan.trajectory)
        return self.correction_time * float(miss_probability(
            shape.rotation, shape.straight_end, plan.report['path_length'],
            self.problem.contact.kind == 'face'))


@dataclasses.dataclass(frozen=True, eq=False)
class SequenceCandidate(Candidate):
    """
    Several pushes, all but the first of them as the kinematics have them.

    :param steps: ``SequenceStep`` of all pushes.
    :param estimate: time of everything, and of what may come after it, about [s].
    """

    steps: tuple[SequenceStep, ...]
    estimate: float

    @classmethod
    def of(cls, steps: Sequence[SequenceStep], estimate: float,
           correction_time: float) -> 'SequenceCandidate':
        """
        Make a candidate of a sequence.

        :param steps: ``SequenceStep`` of all pushes.
        :param estimate: time of everything, and of what may come after it, about [s].
        :param correction_time: time that correcting a miss takes [s].
        """
        last = steps[-1]
        expected_correction = correction_time * float(miss_probability(
            last.rotation, last.segments[-1].length, last.push.path_length,
            last.problem.contact.kind == 'face'))
        return cls(steps[0].problem, tuple(step.push for step in steps),
                   estimate - expected_correction, expected_correction, correction_time,
                   tuple(steps), estimate)

    @property
    def time_to_beat(self) -> float:
        """Time above which no other candidate is of use [s]."""
        return self.estimate

    @property
    def optimality_ratio(self) -> float:
        """Part of the time of a solution from which on this candidate is not worth solving."""
        return PROMISING_RATIO

    @property
    def later_steps(self) -> tuple[SequenceStep, ...]:
        """``SequenceStep`` of each push but the first."""
        return self.steps[1:]

    def _correction_after(self, plan: Plan) -> float:
        return self.expected_correction


AnyCandidate = TypeVar('AnyCandidate', bound=Candidate)


def solve_in_order(candidates: Iterable[AnyCandidate],
                   solve: Callable[[AnyCandidate, float], Outcome]) -> SolvedCandidate | None:
    """
    Solve candidates, the most promising first, until none that is left can be faster.

    :param candidates: ``Candidate`` iterable; the expected time of each is a lower bound, or an
        estimate that ``optimality_ratio`` allows for.
    :param solve: function of a candidate and of the time above which a solution is of no use [s]
        to its ``Outcome``.
    :return: the fastest ``SolvedCandidate``; None where there is none.
    """
    best: SolvedCandidate | None = None
    in_order = sorted(candidates, key=lambda candidate: candidate.expected_time)
    time_limit = min((candidate.time_to_beat for candidate in in_order), default=math.inf)
    for candidate in in_order:
        if best is not None and (
                candidate.expected_time >= candidate.optimality_ratio * best.expected_time):
            continue
        outcome = solve(candidate, time_limit)
        if isinstance(outcome, SolvedCandidate) and (
                best is None or outcome.expected_time < best.expected_time):
            best = outcome
            time_limit = min(time_limit, best.expected_time)
    return best


class _PushShape(NamedTuple):
    """
    What decides on a miss of a push.

    :param rotation: of the object, to and fro [rad].
    :param straight_end: distance of the robot at its end without rotation [m].
    """

    rotation: float
    straight_end: float


def _shape_of(trajectory: PushTrajectory) -> _PushShape:
    headings = np.unwrap(trajectory.object_poses[:, 2])
    rotated = np.flatnonzero(np.abs(headings - headings[-1]) > STRAIGHT_TOLERANCE)
    end = trajectory.robot_poses[rotated[-1] if len(rotated) else 0:, :2]
    straight = np.hypot(*np.diff(end, axis=0).T).sum()
    return _PushShape(float(np.abs(np.diff(headings)).sum()), float(straight))


def _sites(pushes: Iterable[PlannedPush]) -> str:
    return ', '.join(f'{push.contact.kind} {push.contact.index}' for push in pushes)
