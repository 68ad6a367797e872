"""
A flat in which one object after the other gets a goal, with nobody there to help.

Drift of odometry, the robot's place and what it knows of each object go on from goal to goal. The
state is stored after each object, so that an interrupted run goes on where it stopped.
"""

import json
import math
from pathlib import Path
import pickle
from typing import NamedTuple

from benchmarks.tidy.doors import RESOLUTION
from benchmarks.tidy.rooms import GAP, KINDS, pose_values, SENSORS, WALL_GAP
import numpy as np
from push_model.events import sentence
from push_model.files.parameter_files import read_object
from push_model.files.whole_file import write_whole
from push_model.geometry import distance, Pose
from push_model.parameters import PushedObject
from push_navigation.occupancy_map import OccupancyMap
from push_planner.rearrangement.footprints import object_gap
from push_scenario.definition.floor_map import FloorMap, FREE, OCCUPIED
from push_scenario.definition.placement import Placement
from push_scenario.evaluation.result_row import Row
from push_scenario.parallel import Progress, source_digest
from push_scenario.simulation.result import Outcome
from push_scenario.tidying.room import Room, room_from_text
from push_scenario.tidying.tidy import goal_of, RoomRun, TidyProgress
from push_tidy.tidy_supervisor import TidySupervisor

# Inner sides [m], and numbers of cells of a door and of a wall; chosen: every object of ``KINDS``
# gets through the doors of 1.2 m in some heading.
LENGTH, WIDTH, DOOR, WALL = 9.0, 7.0, 24, 4
# Objects that stand in it: two of each kind.
COUNT = 2 * len(KINDS)
DECIMALS = 3
STATE = 'state.pickle'


class FlatState(NamedTuple):
    """
    Flat between two objects.

    :param rows: of each goal so far.
    :param run: where all is, and what the robot knows.
    """

    rows: list[Row]
    run: RoomRun


def draw_flat(seed: int) -> Room:
    """
    Draw a flat of three rooms, with objects that stand anywhere in it.

    :param seed: of the poses.
    """
    rng = np.random.default_rng([3, seed])
    rows = _rows()
    origin = Placement(-0.5 * LENGTH - RESOLUTION, -0.5 * WIDTH - RESOLUTION)
    walls = FloorMap(RESOLUTION, rows, origin).occupancy_map
    names = [f'{kind} {number}' for kind in KINDS for number in range(COUNT // len(KINDS))]
    standing: list[tuple[PushedObject, Pose]] = []
    for name in names:
        obj = read_object(name.split()[0])
        standing.append((obj, draw_free_pose(obj, walls, standing, rng)))
    disc = read_object('bin')
    robot = draw_free_pose(disc, walls, standing, rng)
    return room_from_text(json.dumps({
        'description': f'flat {seed}', 'robot': {'file': 'disc_017.yaml'},
        'start': {'robot': pose_values(robot)},
        'objects': {name: {'object': {'file': f'{name.split()[0]}.yaml'},
                           'start': pose_values(pose)}
                    for name, (_, pose) in zip(names, standing)},
        'sensors': SENSORS, 'simulation': {'seed': seed}, 'time_limit': 300,
        'bounds': {'position_error': 0.02, 'heading_error_deg': 2},
        'task': {'map': {'resolution': RESOLUTION, 'rows': rows,
                         'origin': {'x': origin.x, 'y': origin.y}},
                 'place': {'source': 'scan', 'mount': 'stated'}}}), f'flat {seed}')


def draw_free_pose(obj: PushedObject, walls: OccupancyMap,
                   standing: list[tuple[PushedObject, Pose]], rng: np.random.Generator) -> Pose:
    """
    Draw a pose that keeps its gaps from walls and from objects.

    :param walls: the map.
    :param standing: objects and their poses.
    """
    half = 0.5 * LENGTH, 0.5 * WIDTH, math.pi
    while True:
        values = rng.uniform([-value for value in half], half).tolist()
        pose = Pose(*(round(value, DECIMALS) for value in values))
        if walls.object_clearance(obj, [pose]) > WALL_GAP and all(
                object_gap(obj, pose, other, there) > GAP for other, there in standing):
            return pose


def run_flat(seed: int, count: int, folder: Path, progress: Progress) -> list[Row]:
    """
    Give goals to objects one after the other, and store the state after each.

    :param seed: of the flat, and of objects and goals.
    :param count: of goals.
    :param folder: gets the state; made if need be.
    :param progress: called at the start and after each object.
    :return: a row for each goal, those that are stored among them.
    """
    room, path = draw_flat(seed), folder / STATE
    identity = source_digest(run_flat), seed
    state = FlatState([], RoomRun(room))
    if path.is_file():
        stored_identity, stored = pickle.loads(path.read_bytes())
        state = stored if stored_identity == identity else state
    folder.mkdir(parents=True, exist_ok=True)
    while len(state.rows) < count:
        state.rows.append(_goal_row(room, state.run, seed, len(state.rows)))
        write_whole(path, pickle.dumps((identity, state)))
        progress(len(state.rows), count)
    return state.rows


def _goal_row(room: Room, run: RoomRun, seed: int, index: int) -> Row:
    """Bring one object to a goal that is drawn now; others may be moved aside."""
    rng = np.random.default_rng([3, seed, index])
    name = list(room.scenarios)[int(rng.integers(COUNT))]
    standing = [(room.scenarios[other].object, pose) for other, pose in run.poses.items()
                if other != name]
    goal = goal_of(name, room)._replace(pose=draw_free_pose(
        room.scenarios[name].object, room.floor_map.occupancy_map, standing, rng))
    supervisor = TidySupervisor(
        [goal if other == name else goal_of(other, room) for other in room.scenarios],
        room.any_scenario.robot, room.task.drive)
    duration, failed, touches = 0.0, 0, 0
    while (move := supervisor.next_move(run.scene)) is not None:
        result = run.make(move, TidyProgress(supervisor.plan, 0, 1, run.scene.poses))
        is_done = result.run.outcome is Outcome.DONE
        supervisor.end_move(move, None if is_done else result.run.reason)
        duration += result.run.duration
        failed += not is_done
        touches += len(result.touched)
    pose, failure = run.poses[name], supervisor.failures().get(name)
    assert goal.pose is not None
    return {'index': index, 'name': name, 'placed': goal.tolerances.contain(pose, goal.pose),
            'moves': supervisor.moves, 'failed_moves': failed, 'touches': touches,
            'duration': duration, 'position_error': distance(pose, goal.pose),
            'place_error': distance(run.scene.robot_pose, run.robot_pose),
            'reason': '' if failure is None else sentence(failure)}


def flat_table(rows: list[Row]) -> str:
    """Write the table of a flat, and below it why objects are not at their goals."""
    error = [1e3 * row['position_error'] for row in rows if row['placed']]
    place = [1e3 * row['place_error'] for row in rows]
    lines = ['| objects | at their goals | moves, failed | touches | time of all | '
             'error, median | error of the place of the robot, median / most |',
             '| --- | --- | --- | --- | --- | --- | --- |',
             f'| {len(rows)} | {len(error)} | {sum(row["moves"] for row in rows)}, '
             f'{sum(row["failed_moves"] for row in rows)} | '
             f'{sum(row["touches"] for row in rows)} | '
             f'{sum(row["duration"] for row in rows) / 3600.0:.1f} h | '
             f'{np.median(error or [math.nan]):.1f} mm | '
             f'{np.median(place):.0f} / {max(place):.0f} mm |']
    reasons = [f'* object {row["index"]}, {row["name"]}: '
               f'{row["reason"] or "is %.0f mm off" % (1e3 * row["position_error"])}.'
               for row in rows if not row['placed']]
    return '\n'.join([*lines, *([''] if reasons else []), *reasons])


def _rows() -> str:
    """Draw walls round the flat, one between its halves, and one across the right half."""
    columns, count = (round(side / RESOLUTION) + 2 for side in (LENGTH, WIDTH))
    is_wall = np.zeros((count, columns), dtype=np.bool_)
    middle, height = 2 * columns // 5, count // 2
    is_wall[:, middle:middle + WALL] = True
    is_wall[height:height + WALL, middle:] = True
    is_wall[count // 5:count // 5 + DOOR, middle:middle + WALL] = False
    is_wall[height:height + WALL, 3 * columns // 4:3 * columns // 4 + DOOR] = False
    is_wall[[0, -1], :] = is_wall[:, [0, -1]] = True
    return '\n'.join(''.join(OCCUPIED if cell else FREE for cell in row) for row in is_wall[::-1])
