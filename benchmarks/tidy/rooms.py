"""Random rooms: boxes, cartons, bins and tables within walls; every third with a circle."""

import json
import math
from typing import Any

import numpy as np
from push_model.files.parameter_files import read_object
from push_model.geometry import Pose
from push_model.parameters import PushedObject
from push_planner.rearrangement.footprints import object_gap
from push_scenario.definition.floor_map import FREE, OCCUPIED
from push_scenario.tidying.room import Room, room_from_text

KINDS = ('box_04', 'carton', 'bin', 'coffee_table')
# Numbers of objects, and side of the square floor for them [m]; chosen: 6 m^2 for each.
SIDES = {3: 4.3, 6: 6.1, 9: 7.5, 13: 9.0}
# Least gap between objects at their starts, and at their goals, and to walls [m]; chosen: the
# robot, 0.34 m across, gets between them.
GAP, WALL_GAP = 0.45, 0.5
# Least distance of the robot from objects at first [m].
ROBOT_GAP = 0.3
# Every so many rooms have a circle; lengths of circles.
CIRCLE_PERIOD, CIRCLES = 3, (2, 3)
RESOLUTION = 0.05
DECIMALS = 3
# Errors of measurement, and a lidar by which the robot knows its place.
SENSORS = {'pose_noise': 0.002, 'pose_heading_noise': 0.005, 'pose_latency': 0.08,
           'odometry_scale': 0.02, 'odometry_heading_drift': 0.02, 'lidar': {'rate': 10.0}}


def draw_room(count: int, index: int) -> Room:
    """
    Draw a room.

    :param count: of objects, one of ``SIDES``.
    :param index: of the room, which is its seed.
    """
    rng = np.random.default_rng([count, index])
    side = SIDES[count]
    kinds = [KINDS[int(rng.integers(len(KINDS)))] for _ in range(count)]
    objects = [read_object(kind) for kind in kinds]
    starts = _draw_poses(objects, side, rng)
    goals = _draw_poses(objects, side, rng)
    if index % CIRCLE_PERIOD == 0:
        length = CIRCLES[int(rng.integers(len(CIRCLES)))]
        for first in range(length):
            # Objects of one kind, so that each fits where the other stands.
            kinds[first], objects[first] = kinds[0], objects[0]
        starts = _draw_poses(objects, side, rng)
        goals = _draw_poses(objects, side, rng, starts[1:length] + starts[:1])
    return room_from_text(json.dumps({
        'description': f'{count} objects, room {index}',
        'robot': {'file': 'disc_017.yaml'},
        'start': {'robot': pose_values(_draw_robot(objects, starts, side, rng))},
        'objects': {f'{kind} {number}': {
            'object': {'file': f'{kind}.yaml'}, 'start': pose_values(start),
            'goal': pose_values(goal)}
            for number, (kind, start, goal) in enumerate(zip(kinds, starts, goals))},
        'sensors': SENSORS,
        'simulation': {'seed': index}, 'time_limit': 300,
        'bounds': {'position_error': 0.02, 'heading_error_deg': 2},
        'task': {'map': _walls(side), 'place': {'source': 'scan', 'mount': 'stated'}}}),
        f'{count} objects {index}')


def _walls(side: float) -> dict[str, Any]:
    count = round(side / RESOLUTION) + 2
    rows = [OCCUPIED * count, *[OCCUPIED + FREE * (count - 2) + OCCUPIED] * (count - 2),
            OCCUPIED * count]
    corner = -0.5 * side - RESOLUTION
    return {'resolution': RESOLUTION, 'origin': {'x': corner, 'y': corner},
            'rows': '\n'.join(rows)}


def _draw_poses(objects: list[PushedObject], side: float, rng: np.random.Generator,
                first: list[Pose] | None = None) -> list[Pose]:
    """Draw poses that keep their gaps, after some that are stated."""
    while True:
        poses = list(first or ())
        for obj in objects[len(poses):]:
            pose = _draw_pose(obj, objects, poses, side, rng)
            if pose is None:
                break
            poses.append(pose)
        if len(poses) == len(objects):
            return poses


def _draw_pose(obj: PushedObject, objects: list[PushedObject], poses: list[Pose], side: float,
               rng: np.random.Generator) -> Pose | None:
    """Draw the pose of one object; None where none of many has its gaps."""
    room = 0.5 * side - WALL_GAP - 0.5 * obj.size
    for _ in range(200):
        x, y, theta = rng.uniform((-room, -room, -math.pi), (room, room, math.pi)).tolist()
        pose = Pose(round(x, DECIMALS), round(y, DECIMALS), round(theta, DECIMALS))
        if all(math.dist(pose[:2], there[:2]) > 0.5 * (obj.size + other.size) + GAP
               or object_gap(obj, pose, other, there) > GAP
               for other, there in zip(objects, poses)):
            return pose
    return None


def _draw_robot(objects: list[PushedObject], poses: list[Pose], side: float,
                rng: np.random.Generator) -> Pose:
    room = 0.5 * side - WALL_GAP
    while True:
        x, y, theta = rng.uniform((-room, -room, -math.pi), (room, room, math.pi)).tolist()
        if all(math.dist((x, y), pose[:2]) > 0.5 * obj.size + 0.17 + ROBOT_GAP
               for obj, pose in zip(objects, poses)):
            return Pose(round(x, DECIMALS), round(y, DECIMALS), round(theta, DECIMALS))


def pose_values(pose: Pose) -> dict[str, float]:
    """Write a pose as files have it."""
    return dict(pose._asdict())
