"""
Bases that do not do what they are told, of which nothing is stated, and the aims of their tasks.

Every task runs three times: with a base that is learned, with the same base of which nothing is
learned, and with a good base.
"""

import math
from typing import Any, Mapping, NamedTuple, Sequence

from benchmarks.controller.tables import Job
from benchmarks.tasks.varieties import task_key
import numpy as np
from push_sim_node.drive_imperfections import DriveImperfections, SpeedFactor

# How a task treats its base: as the robot does by default; without learning; without faults.
LEARNED = 'learned'
NOT_LEARNED = 'nothing learned'
GOOD = 'good base'
TREATMENTS = (LEARNED, NOT_LEARNED, GOOD)


class BadBase(NamedTuple):
    """
    One base.

    :param robot: true values of the robot that differ from the stated ones, by field.
    :param drive: ``DriveImperfections``.
    :param sensors: settings of the sensors that differ, by field.
    :param mass_ratio: true mass of the object over what it is without this.
    :param success_aim: least success of tasks whose object it has the force for [%].
    :param time_aim: greatest median of the time over that of a good base.
    """

    robot: Mapping[str, float] = {}
    drive: DriveImperfections = DriveImperfections()
    sensors: Mapping[str, float] = {}
    mass_ratio: float = 1.0
    success_aim: float = 97.0
    time_aim: float = 1.15


# Yaw rates of wheels that have a least speed belong to holonomic bases [rad/s]. The index of a
# base enters seeds: append only.
DRAWN = 'drawn'
BAD_BASES: dict[str, BadBase] = {
    'wheels from 0.05 m/s on': BadBase({'min_speed': 0.05, 'min_yaw_rate': 0.1},
                                       success_aim=99.0),
    'wheels from 0.08 m/s on': BadBase({'min_speed': 0.08, 'min_yaw_rate': 0.15},
                                       success_aim=99.0),
    'from 0.08 m/s on, behind the lag': BadBase(
        drive=DriveImperfections(output_min_speed=0.08, output_min_yaw_rate=0.15), time_aim=1.5),
    'from 0.02 m/s on, 0.1 s late': BadBase({'min_speed': 0.02, 'dead_time': 0.1}),
    '0.3 s late': BadBase({'dead_time': 0.3}, success_aim=99.0, time_aim=1.2),
    'steps of 0.01 m/s': BadBase({'speed_step': 0.01}),
    'stiction 1.3': BadBase({'min_speed': 0.05, 'min_yaw_rate': 0.1},
                            DriveImperfections(start_ratio=1.3)),
    'sag by a fifth': BadBase(drive=DriveImperfections(sag=0.2)),
    'smoother of 0.3 m/s^2': BadBase(drive=DriveImperfections(
        smoother_acceleration=0.3, smoother_yaw_acceleration=2.0)),
    'half speed for 5 s': BadBase(drive=DriveImperfections(
        speed_factors=(SpeedFactor(6.0, 11.0, 0.5),))),
    'creep of 8 % at 15 N': BadBase(drive=DriveImperfections(wheel_creep=0.08 / 15.0)),
    'one wheel 10 % slow': BadBase(drive=DriveImperfections(left_wheel_factor=0.9)),
    'spinning beyond 10 N': BadBase({'max_push_force': 10.0}),
    'spinning beyond 20 N': BadBase({'max_push_force': 20.0}),
    'spinning beyond 30 N': BadBase({'max_push_force': 30.0}),
    '0.2 s late': BadBase({'dead_time': 0.2}, success_aim=99.0, time_aim=1.2),
    'from 0.05 m/s on, behind the lag': BadBase(
        drive=DriveImperfections(output_min_speed=0.05, output_min_yaw_rate=0.1), time_aim=1.5),
    DRAWN: BadBase(success_aim=98.0, time_aim=1.5),
    'odometry in steps of 5 mm, 1 deg': BadBase(sensors={
        'odometry_step': 0.005, 'odometry_angle_step': math.radians(1.0)}),
    'from 0.06 m/s on, behind the lag, 0.2 s late': BadBase(
        {'dead_time': 0.2}, DriveImperfections(output_min_speed=0.06, output_min_yaw_rate=0.12),
        time_aim=1.5),
    'spinning beyond 20 N, object of 50 times its mass': BadBase(
        {'max_push_force': 20.0}, mass_ratio=50.0)}
# Of drawn bases: greatest least speed [m/s], and yaw rate for each m/s of it [rad/m]; part of
# those with the limit before the lag; greatest dead time [s]; range of the lag [s]. Set for tasks.
MAX_LEAST_SPEED = 0.09
YAW_RATE_RATIO = 2.0
BEFORE_LAG = 0.6
MAX_DEAD_TIME = 0.3
LAGS = 0.04, 0.15


def bad_base(variety: str, rng: np.random.Generator) -> BadBase:
    """
    Return a base.

    :param variety: key of ``BAD_BASES``.
    :param rng: generator for those that are drawn.
    """
    base = BAD_BASES[variety]
    if variety != DRAWN:
        return base
    is_before = bool(rng.uniform() < BEFORE_LAG)
    speed = float(rng.uniform(0.0, MAX_LEAST_SPEED))
    yaw_rate = YAW_RATE_RATIO * speed
    robot = {'dead_time': float(rng.uniform(0.0, MAX_DEAD_TIME)),
             'time_constant': float(rng.uniform(*LAGS))}
    if is_before:
        return base._replace(robot={**robot, 'min_speed': speed, 'min_yaw_rate': yaw_rate})
    return base._replace(robot=robot, drive=DriveImperfections(
        output_min_speed=speed, output_min_yaw_rate=yaw_rate))


def compared_jobs(jobs: Sequence[Job]) -> list[Job]:
    """
    List what tasks are compared with: nothing learned in each of them, and good bases.

    :param jobs: of ``varied_jobs``.
    """
    good: dict[tuple[str, str, int], Job] = {}
    for job in jobs:
        key = part, kind, seed = task_key(job)
        good.setdefault(key, {'part': part, 'kind': kind, 'seed': seed, 'base': GOOD})
    return [*({**job, 'base': NOT_LEARNED} for job in jobs), *good.values()]


def treatment(job: dict[str, Any]) -> str:
    """
    Tell how a job treats its base.

    :param job: of any part.
    :return: one of ``TREATMENTS``.
    """
    return job.get('base', LEARNED)
