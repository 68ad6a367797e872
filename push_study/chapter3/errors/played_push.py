"""Errors at the goal of plans that are played on what they did not believe."""

import dataclasses
import functools

import numpy as np
from push_model.parameters import PushedObject, Support
from push_planner.single_push.planner import plan_push
from push_study.chapter3.errors.mismatch_rollout import replay
from push_study.chapter3.errors.truth import truth
from push_study.chapter3.scene import push_problem, SCENE, SEGMENTS
from push_study.framework.scenes import box
from push_study.framework.study import Parameter

PARAMETERS = (*SCENE, SEGMENTS,
              Parameter('feet', '', 'distance of the feet from the middle, over that of the '
                        'corners'),
              Parameter('errors', '', 'errors, as shares of what was believed'),
              Parameter('speeds', 'm/s', 'speeds of the contact'),
              Parameter('blind_speed', 'm/s', 'speed of the blind robots'),
              Parameter('robot_radius', 'm', 'radius of the wide robot'))
FELT, BLIND, WIDE = ROBOTS = ('point', 'blind point', 'blind wide robot')
RECORD = {'position_error_m': 'position_error', 'heading_error_rad': 'heading_error',
          'friction_usage': 'friction_usage'}


@dataclasses.dataclass(frozen=True)
class PlayedPush:
    """
    A push that is planned for one object and played on another.

    A job is a dict with ``kind`` and ``error`` of ``plan_errors_truth.truth``, ``speed`` [m/s] and
    ``robot``, one of ``ROBOTS``. The point feels how the object lies, and keeps its pushing angles
    to it; blind robots move as if the plan came true. A record has the keys ``RECORD``.

    :param object: the believed ``PushedObject``.
    :param goal: (x, y, theta) [m, rad].
    :param cone_margin: share of the friction angle that the plan may use.
    :param segments: number of constant pushing angles.
    :param robot_radius: of the wide robot [m].
    """

    object: PushedObject
    goal: tuple
    cone_margin: float
    segments: int
    robot_radius: float

    @classmethod
    def of(cls, values):
        """
        Take the push from the values of a study.

        :param values: ``Values`` with ``PARAMETERS``.
        """
        feet = tuple(Support(values.feet * x, values.feet * y, values.friction_coefficient)
                     for x, y in box(values).outline)
        return cls(box(values, supports=feet), tuple(values.goal), values.cone_margin,
                   int(values.segments), values.robot_radius)

    def __call__(self, job):
        """
        Play one push.

        :param job: the dict.
        :return: the record.
        """
        obj, pace = truth(self.object, job['kind'], job['error'])
        played = replay(self.plan(job['speed'], job['robot']), obj, pace, job['robot'] != FELT)
        return {name: float(getattr(played, field)) for name, field in RECORD.items()}

    def plan(self, speed, robot):
        """
        Plan the push that a robot plays.

        :param speed: of the contact [m/s].
        :param robot: one of ``ROBOTS``.
        :return: ``Plan``.
        """
        radius = self.robot_radius if robot == WIDE else 0.0
        return _plan(push_problem(self, speed, self.segments, radius, obj=self.object))


_plan = functools.lru_cache(maxsize=32)(plan_push)


def error_table(values, batch, kinds, robots=ROBOTS):
    """
    Play plans with every error.

    :param values: ``Values`` with ``PARAMETERS``.
    :param batch: of the study.
    :param kinds: of the errors.
    :param robots: some of ``ROBOTS``; the blind ones push at one speed only.
    :return: table with the columns kind, robot, speed_m_s, error and those of ``RECORD``.
    """
    jobs = [{'kind': kind, 'robot': robot, 'speed': speed, 'error': error}
            for kind in kinds for robot in robots
            for speed in (values.speeds if robot == FELT else [values.blind_speed])
            for error in sorted({0.0, *values.errors})]
    records = batch(PlayedPush.of(values), jobs)
    names = {'kind': 'kind', 'robot': 'robot', 'speed_m_s': 'speed', 'error': 'error'}
    return {**{name: np.array([job[key] for job in jobs]) for name, key in names.items()},
            **{name: np.array([record[name] for record in records]) for name in RECORD}}


def worst(table, errors=(), column='position_error_m', **chosen):
    """
    Largest value among rows.

    :param table: of ``error_table``.
    :param errors: sizes of the errors that count; none for all.
    :param column: of which.
    :param chosen: values of other columns.
    """
    rows = np.isclose(np.abs(table['error'])[:, None], list(errors)).any(axis=1) if errors else (
        np.ones(len(table['error']), bool))
    for name, value in chosen.items():
        rows = rows & (table[name] == value)
    return float(table[column][rows].max())
