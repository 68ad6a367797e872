"""Random pairs of rooms whose door is blocked by one or two objects."""

import json
import math

from benchmarks.tidy.rooms import pose_values, SENSORS
import numpy as np
from push_model.geometry import Pose
from push_scenario.definition.floor_map import FREE, OCCUPIED
from push_scenario.tidying.room import Room, room_from_text

RESOLUTION = 0.05
# Inner sides of both rooms together, width of the door and thickness of its wall [m]; chosen: the
# box, 0.57 m across its corners, comes through, but not past what stands in the door.
LENGTH, WIDTH, DOOR, WALL = 7.0, 4.0, 1.0, 0.2
# Distance of the door from the corners [m].
DOOR_MARGIN = 1.0
BLOCKING = ('bin', 'box_04')
DECIMALS = 3


def draw_door(index: int) -> Room:
    """
    Draw two rooms, and a box that has to come through their door.

    Every other door is blocked by two objects, one before the other. Those of each third have
    their goals where they stand.

    :param index: of the rooms, which is their seed.
    """
    rng = np.random.default_rng([2, index])
    door = round(float(rng.uniform(DOOR_MARGIN - 0.5 * WIDTH, 0.5 * WIDTH - DOOR_MARGIN)), 2)
    box_start = _pose(rng, (-2.7, -1.6), (0.8, 1.3))
    objects = {'box': {'object': {'file': 'box_04.yaml'}, 'start': pose_values(box_start),
                       'goal': pose_values(_pose(rng, (1.6, 2.6), (-1.2, 1.2)))}}
    for number in range(1 + index % 2):
        kind = BLOCKING[int(rng.integers(len(BLOCKING)))]
        place = Pose(0.7 * number + round(float(rng.uniform(-0.08, 0.08)), DECIMALS),
                     door + round(float(rng.uniform(-0.1, 0.1)), DECIMALS),
                     round(float(rng.uniform(-math.pi, math.pi)), DECIMALS))
        objects[f'{kind} {number}'] = {
            'object': {'file': f'{kind}.yaml'}, 'start': pose_values(place),
            **({'goal': pose_values(place)} if index % 3 == 0 else {})}
    return room_from_text(json.dumps({
        'description': f'blocked door {index}', 'robot': {'file': 'disc_017.yaml'},
        'start': {'robot': pose_values(_pose(rng, (-2.7, -1.6), (-1.3, -0.8)))},
        'objects': objects, 'sensors': SENSORS, 'simulation': {'seed': index}, 'time_limit': 300,
        'bounds': {'position_error': 0.02, 'heading_error_deg': 2},
        'task': {'map': {'resolution': RESOLUTION, 'rows': _rows(door),
                         'origin': {'x': -0.5 * LENGTH - RESOLUTION,
                                    'y': -0.5 * WIDTH - RESOLUTION}},
                 'place': {'source': 'scan', 'mount': 'stated'}}}), f'door {index}')


def _pose(rng: np.random.Generator, x: tuple[float, float], y: tuple[float, float]) -> Pose:
    values = rng.uniform((x[0], y[0], -math.pi), (x[1], y[1], math.pi)).tolist()
    return Pose(*(round(value, DECIMALS) for value in values))


def _rows(door: float) -> str:
    """Draw walls round both rooms, and one between them with a door at a height y."""
    columns, count = (round(side / RESOLUTION) + 2 for side in (LENGTH, WIDTH))
    xs = RESOLUTION * (np.arange(columns) - 0.5) - 0.5 * LENGTH
    ys = RESOLUTION * (np.arange(count) - 0.5) - 0.5 * WIDTH
    is_wall = (np.abs(xs) < 0.5 * WALL)[None, :] & (np.abs(ys - door) > 0.5 * DOOR)[:, None]
    is_wall[[0, -1], :] = is_wall[:, [0, -1]] = True
    return '\n'.join(''.join(OCCUPIED if cell else FREE for cell in row) for row in is_wall[::-1])
