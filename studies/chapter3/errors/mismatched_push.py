"""Errors at the goal of plans that are executed on objects other than the nominal one."""

import dataclasses
import functools
import itertools
from typing import Any, Sequence

import numpy as np
from push_model.parameters import PushedObject, Support
from push_planner.steered.plan import Plan
from push_planner.steered.planner import plan_push
from studies.chapter3.errors.mismatch_rollout import rollout
from studies.chapter3.errors.true_object import true_push
from studies.chapter3.setup import push_problem, SEGMENTS, SETUP
from studies.framework.box import box
from studies.framework.parameters import Parameter, Values
from studies.framework.study import Record, RunJobs, Table

PARAMETERS = (*SETUP, SEGMENTS,
              Parameter('support_spread', '', 'distance of the support points from the middle, '
                        'over that of the corners'),
              Parameter('errors', '', 'errors, relative to the nominal value'),
              Parameter('speeds', 'm/s', 'speeds of the contact'),
              Parameter('open_loop_speed', 'm/s', 'speed of the open-loop robots'),
              Parameter('symmetrical_goal', 'm, m, rad', 'goal with the heading of the start, '
                        'which a bend to each side leads to'),
              Parameter('robot_radius', 'm', 'radius of the wide robot'),
              Parameter('wide_goal', 'm, m, rad', 'goal of the wide robot, which does not reach '
                        'the others'))
# The point senses the contact normal and keeps its pushing angles to it; the open-loop robots
# move as if the plan came true.
SENSING_POINT = 'sensing point'
SYMMETRICAL = 'sensing point, symmetrical goal'
OPEN_LOOP_POINT = 'open-loop point'
OPEN_LOOP_WIDE = 'open-loop wide robot'
ROBOTS = (SENSING_POINT, SYMMETRICAL, OPEN_LOOP_POINT, OPEN_LOOP_WIDE)
SENSING = (SENSING_POINT, SYMMETRICAL)
# Column of a record -> field of ``Rollout``.
RECORD_FIELDS = {'position_error_m': 'position_error', 'heading_error_rad': 'heading_error',
                 'friction_usage': 'friction_usage'}
JOB_COLUMNS = {'kind': 'kind', 'robot': 'robot', 'speed_m_s': 'speed', 'error': 'error'}


@dataclasses.dataclass(frozen=True)
class MismatchedPush:
    """
    A push that is planned for one object and executed on another.

    A job is a dict with ``kind`` and ``error`` of ``true_object.true_push``, ``speed`` [m/s] and
    ``robot``, one of ``ROBOTS``. A record has the columns ``RECORD_FIELDS``.

    :param object: the nominal object.
    :param goal: (x, y, theta) [m, rad].
    :param cone_margin: fraction of the friction angle that the plan may use.
    :param segments: number of constant pushing angles.
    :param robot_radius: of the wide robot [m].
    :param symmetrical_goal: of ``SYMMETRICAL``, likewise.
    :param wide_goal: of ``OPEN_LOOP_WIDE``, likewise.
    """

    object: PushedObject
    goal: tuple[float, float, float]
    cone_margin: float
    segments: int
    robot_radius: float
    symmetrical_goal: tuple[float, float, float]
    wide_goal: tuple[float, float, float]

    @classmethod
    def of(cls, values: Values) -> 'MismatchedPush':
        """
        Make the push of a study.

        :param values: with the parameters ``PARAMETERS``.
        :return: the push.
        """
        supports = tuple(Support(values.support_spread * x, values.support_spread * y,
                                 values.friction_coefficient) for x, y in box(values).outline)
        return cls(box(values, supports=supports), tuple(values.goal), values.cone_margin,
                   int(values.segments), values.robot_radius, tuple(values.symmetrical_goal),
                   tuple(values.wide_goal))

    def __call__(self, job: dict[str, Any]) -> Record:
        """
        Execute one push.

        :param job: see above.
        :return: its record.
        """
        true = true_push(self.object, job['kind'], job['error'])
        executed = rollout(self.plan(job['speed'], job['robot']), true.obj, true.speed_scale,
                           open_loop=job['robot'] not in SENSING)
        return {name: float(getattr(executed, field)) for name, field in RECORD_FIELDS.items()}

    def plan(self, speed: float, robot: str) -> Plan:
        """
        Plan the push that a robot executes.

        :param speed: of the contact [m/s].
        :param robot: one of ``ROBOTS``.
        :return: the plan.
        """
        goal = {SYMMETRICAL: self.symmetrical_goal, OPEN_LOOP_WIDE: self.wide_goal}.get(
            robot, self.goal)
        radius = self.robot_radius if robot == OPEN_LOOP_WIDE else 0.0
        return _plan(push_problem(dataclasses.replace(self, goal=goal), speed, self.segments,
                                  radius=radius, obj=self.object))


# Many errors are executed with one plan. Chosen: more than the speeds and robots of a study.
_plan = functools.lru_cache(maxsize=32)(plan_push)


def error_table(values: Values, run_jobs: RunJobs, kinds: Sequence[str],
                robots: Sequence[str] = ROBOTS) -> Table:
    """
    Execute plans with every error.

    :param values: with the parameters ``PARAMETERS``.
    :param run_jobs: of the study.
    :param kinds: of the errors.
    :param robots: some of ``ROBOTS``; ``SENSING_POINT`` pushes at all speeds, others at one.
    :return: table with the columns ``JOB_COLUMNS`` and ``RECORD_FIELDS``.
    """
    errors = sorted({0.0, *values.errors})
    jobs: list[dict[str, Any]] = []
    for kind, robot in itertools.product(kinds, robots):
        speeds = values.speeds if robot == SENSING_POINT else [values.open_loop_speed]
        jobs += [{'kind': kind, 'robot': robot, 'speed': speed, 'error': error}
                 for speed, error in itertools.product(speeds, errors)]
    records = run_jobs(MismatchedPush.of(values), jobs)
    table = {column: np.array([job[key] for job in jobs]) for column, key in JOB_COLUMNS.items()}
    table.update((column, np.array([record[column] for record in records]))
                 for column in RECORD_FIELDS)
    return table


def worst(table: Table, errors: Sequence[float] = (), column: str = 'position_error_m',
          **selected: Any) -> float:
    """
    Find the largest value among rows.

    :param table: of ``error_table``.
    :param errors: magnitudes of the errors that count; empty for all.
    :param column: of which.
    :param selected: column name -> value of the rows that count.
    :return: the value.
    """
    rows = np.ones(len(table['error']), bool)
    if errors:
        rows = np.isclose(np.abs(table['error'])[:, None], list(errors)).any(axis=1)
    for name, value in selected.items():
        rows = rows & (table[name] == value)
    return float(table[column][rows].max())
