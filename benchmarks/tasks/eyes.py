"""
Eyes of the robot: views with limits, own cameras, poses that are late or flipped, maps that jump.

Every task on open floor comes once with each, and once always seen.
"""

import dataclasses
import math
from typing import Any, Mapping, NamedTuple, Sequence

from benchmarks.controller.tables import Job
from benchmarks.tasks.varieties import task_key
from push_scenario.definition.expected_poses import with_sensors
from push_scenario.definition.scenario import Scenario
from push_sim_node.camera import CameraSettings

# How a task is compared: with the object always seen.
ALWAYS_SEEN = 'always seen'
# Radius of the robots of tasks [m].
RADIUS = 0.17
OWN_CAMERA = CameraSettings(
    place='robot', reference='robot', mount_x=0.1, half_angle=math.radians(34.5), nearest=0.25,
    is_blind_in_contact=True, noise_per_distance=0.005,
    heading_noise_per_distance=math.radians(1.0))
OWN_POSES = {'pose_rate': 10.0, 'pose_latency': 0.15, 'pose_noise': 2e-3,
             'pose_heading_noise': math.radians(0.5), 'camera': OWN_CAMERA}
# Of a robot that motion capture sees, to 1 mm and 0.1 degrees.
LOCALIZED = {'odometry_reference': 'absolute', 'odometry_position_noise': 1e-3,
             'odometry_heading_noise': math.radians(0.1)}


class Eyes(NamedTuple):
    """
    One way to see the object.

    :param sensors: settings of the sensors that differ, by field.
    :param position_tolerance: for which the task is done [m].
    :param heading_tolerance: the same [rad].
    :param is_moved: whether somebody moves the object while it is not seen.
    :param success_aim: least success [%].
    :param is_stated: whether the aim is for tasks that are done within what they state, as
        nobody can know more; else for those within the tolerances.
    :param time_aim: greatest median of the time over that of the same task always seen; None
        where none was set.
    """

    sensors: Mapping[str, Any]
    position_tolerance: float = 0.01
    heading_tolerance: float = math.radians(1.0)
    is_moved: bool = False
    success_aim: float = 99.0
    time_aim: float | None = 1.25
    is_stated: bool = False


def _jumps(position: float, heading: float, period: float) -> dict[str, Any]:
    """Let a localized robot jump, by root mean squares over both axes [m] and of the heading."""
    return {**LOCALIZED, 'odometry_jump': position / math.sqrt(2.0),
            'odometry_heading_jump': heading, 'odometry_jump_period': period}


# The index enters seeds: append only.
EYES: dict[str, Eyes] = {
    'beyond a gap of 0.15 m': Eyes({'camera': CameraSettings(
        place='robot', nearest=RADIUS + 0.15)}),
    'within 40 deg': Eyes({'camera': CameraSettings(
        place='robot', half_angle=math.radians(40.0))}),
    'both': Eyes({'camera': CameraSettings(
        place='robot', half_angle=math.radians(40.0), nearest=RADIUS + 0.15)}),
    'own camera, robot localized': Eyes({**OWN_POSES, **LOCALIZED}, success_aim=98.0,
                                        time_aim=None),
    'own camera, map jumps by 15 mm, 0.5 deg': Eyes(
        {**OWN_POSES, **_jumps(0.015, math.radians(0.5), 5.0)}, 0.02, math.radians(2.0),
        success_aim=95.0, time_aim=None),
    'own camera, odometry alone': Eyes(OWN_POSES, 0.02, math.radians(2.0), success_aim=95.0,
                                       time_aim=None, is_stated=True),
    '5 Hz, 0.3 s late': Eyes({'pose_rate': 5.0, 'pose_latency': 0.3}, time_aim=1.5),
    '2 Hz, 0.5 s late': Eyes({'pose_rate': 2.0, 'pose_latency': 0.5}, success_aim=95.0,
                             time_aim=1.5),
    'yaw noise of 3 deg, stated': Eyes({'pose_heading_noise': math.radians(3.0)},
                                       success_aim=97.0, time_aim=1.5),
    'flips of a tag, one in ten': Eyes(
        {'pose_flip_probability': 0.1, 'pose_flip': 'mirrored_tilt'}, success_aim=97.0,
        time_aim=1.5),
    'room camera, map jumps by 100 mm, 2 deg': Eyes(
        {'camera': CameraSettings(place='room', mount_y=-5.0),
         **_jumps(0.1, math.radians(2.0), 20.0)}, success_aim=97.0, time_aim=None),
    'own camera, carried away unseen': Eyes({**OWN_POSES, **LOCALIZED}, is_moved=True,
                                            success_aim=95.0, time_aim=None),
    'room camera, hidden by the robot': Eyes({'camera': CameraSettings(
        place='room', mount_y=-5.0)})}


def eyes_scenario(scenario: Scenario, eyes: Eyes) -> Scenario:
    """
    Let the robot of a task see with other eyes, of which it knows what is stated of them.

    :param scenario: of a task.
    """
    seen = with_sensors(scenario, dataclasses.replace(scenario.sensors, **eyes.sensors))
    task = seen.task
    if task is None:
        raise ValueError('scenario.task: got none, expected a task')
    return dataclasses.replace(seen, task=dataclasses.replace(
        task, supervision=dataclasses.replace(
            task.supervision, position_tolerance=eyes.position_tolerance,
            heading_tolerance=eyes.heading_tolerance)))


def seen_jobs(jobs: Sequence[Job]) -> list[Job]:
    """
    List what tasks are compared with: each of them once, always seen.

    :param jobs: of ``varied_jobs``.
    """
    return [{'part': part, 'kind': kind, 'seed': seed, 'base': ALWAYS_SEEN}
            for part, kind, seed in dict.fromkeys(map(task_key, jobs))]
