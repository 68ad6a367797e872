"""
Random tasks: on open floor, in maps, disturbed; and those of open floor made harder or easier.

Nominal and true parameters differ as in ``benchmarks.controller.cases``. A task is drawn from its
part, kind and seed alone. Variations keep everything else of the task on open floor that has the
same kind and seed, so that both can be compared one by one.
"""

import dataclasses
import math
from typing import Any, Callable, NamedTuple, Optional, Sequence

from benchmarks.controller.cases import SENSORS
from benchmarks.controller.tables import Job
from benchmarks.tasks.bases import bad_base, BAD_BASES, GOOD, LEARNED, NOT_LEARNED
from benchmarks.tasks.drawn_scenario import draw_bodies, make_scenario, ROBOTS, TaskPoses
from benchmarks.tasks.eyes import ALWAYS_SEEN, EYES, eyes_scenario
from benchmarks.tasks.intervention import Disturbance, Intervention
from benchmarks.tasks.maps import (
    draw_floor, drawn_map, FLAT, Floor, inner_reach, MAPS, places, places_in_flat, reach,
)
from benchmarks.tasks.nooks import draw_nook_task, POSSIBLE
from benchmarks.tasks.public_maps import draw_public_task
from benchmarks.tasks.varieties import STRIDE, varied_jobs
import numpy as np
from push_model.contact import find_contact
from push_model.geometry import distance, Pose
from push_model.parameters import PushedObject, RoundRobot
from push_scenario.definition.expected_poses import with_sensors
from push_scenario.definition.scenario import Scenario
from push_scenario.definition.task import Task
from push_sim_node.lidar import LidarSensorSettings
from push_sim_node.sensors import SensorSettings

OPEN = 'open floor'
IN_MAPS = 'maps'
DISTURBED = 'disturbed'
SLIPPERY = 'slippery'
CREEPING = 'creeping'
FRICTIONLESS = 'frictionless'
WHEELS = 'wheels'
TAG = 'tag'
STRICT = 'strict'
INFORMED = 'informed'
FLATS = 'flats'
SPATIAL = 'spatial'
BASES = 'bases'
SPATIAL_BASES = 'spatial bases'
SLOPES = 'slopes'
OWN_EYES = 'eyes'
SPATIAL_EYES = 'spatial eyes'
FAR_ROBOTS = 'far robots'
PUBLIC_MAPS = 'public maps'
WALLS = 'walls'
# The order enters the seeds of the draws: append only.
PARTS = (OPEN, IN_MAPS, DISTURBED, SLIPPERY, CREEPING, FRICTIONLESS, WHEELS, TAG, STRICT,
         INFORMED, FLATS, SPATIAL, BASES, SPATIAL_BASES, SLOPES, OWN_EYES, SPATIAL_EYES,
         FAR_ROBOTS, PUBLIC_MAPS, WALLS)
# Parts whose base does not do what it is told.
BASE_PARTS = (BASES, SPATIAL_BASES)
# Parts whose robots are compared with themselves without a lidar.
LIDAR_PARTS = (FAR_ROBOTS, PUBLIC_MAPS)
# Parts whose object is not always seen.
EYES_PARTS = (OWN_EYES, SPATIAL_EYES)
OBJECTS = ('box_04', 'carton', 'coffee_table', 'bin')
# A table that is 0.9 m long cannot be rotated between the walls, and the other engine has only
# boxes and cylinders; a differential drive cannot hold its contact on a round side.
FITTING = {part: ('box_04', 'carton', 'bin')
           for part in (IN_MAPS, FLATS, SPATIAL, SPATIAL_BASES, SLOPES, SPATIAL_EYES,
                        FAR_ROBOTS)}
KINDS = {part: tuple(f'{name}, {drive}' for name in FITTING.get(part, OBJECTS) for drive in ROBOTS
                     if (name, drive) != ('bin', 'differential'))
         for part in PARTS}
# Range of the distance of goals, and largest distance of the robot from the object at the start
# [m]; chosen: the size of a room.
NEAREST = 0.05
FARTHEST = 3.0
# In a flat the goal is at least so far [m]; chosen: mostly in another room.
FAR_IN_FLAT = 3.0
ROBOT_WITHIN = 2.0
# The same of far robots, whose goals are near [m]; chosen: anywhere in a flat, and one room.
FAR_ROBOT_WITHIN = 10.0
NEAR_IN_FLAT = 1.5
# Sides of the cells of rooms with tasks at walls [m]; chosen: of fine and of coarse maps.
CELLS = 0.025, 0.05, 0.1
# How a task of far robots treats odometry: with a lidar beside it, or alone.
BY_LIDAR, BY_ODOMETRY = 'lidar', 'odometry alone'
# What tasks of round objects at walls are compared with: the same, done with any heading.
ANY_HEADING = 'any heading'
# Least distance of the robot from the object, and of both from obstacles, at the start [m];
# chosen, and apart from the settings, so that tasks stay the same.
CLEARANCE = 0.05
# Latest begin of a disturbance [s], chosen: while most tasks are under way; and longest pose
# drop-out [s], chosen: 40 periods of the pose.
LATEST = 30.0
MAX_DROPOUT = 2.0
# True contact friction of slippery contacts, where 0.5 is believed: range that was set for tasks.
SLIPPERY_FRICTION = 0.15, 0.3
# Slip over the distance pushed at the friction limit; half of it under half the load, which is
# about what pushes have.
CREEP = 0.02
# Relative error of the angles that wheels of a wrong track width tell: set for tasks.
YAW_SCALE = 0.02
# What happens to objects of the part of disturbances; the others belong to other parts.
OPEN_DISTURBANCES = (Disturbance.DISPLACED, Disturbance.ROTATED)
# Poses as a camera sees them on a tag: bias, rate and latency were set for tasks; the heading has
# a bias of half its tolerance, and one pose in fifty is far off.
TAG_SENSORS = {'pose_rate': 10.0, 'pose_latency': 0.15, 'pose_bias': 0.03,
               'pose_heading_bias': math.radians(1.0), 'pose_jump_probability': 0.02,
               'pose_jump': 0.1, 'pose_heading_jump': math.radians(10.0)}
# What a user of such poses sets: the bias, half of which is its root mean square over both axes;
# latency and three periods as the age at which poses are too old; and what moves between two looks
# by no more than the bias has not been moved.
TAG_CONTROL = {'pose_bias': 0.011, 'heading_bias': math.radians(0.5), 'pose_timeout': 0.45}
TAG_SUPERVISION = {'moved_distance': 0.1, 'moved_angle': 0.15}
# True heights of contact and mass centre where 0 is believed [m]; chosen: a bumper, and half the
# height of a box.
HEIGHTS = {'contact_height': 0.08, 'center_of_mass_height': 0.15}
# Slope of the floor [rad]: set for tasks; steeper floors let objects with little friction go.
MAX_SLOPE = math.radians(4.0)
# Noise of the place of a robot that knows where it is [m, rad]: as good as none, but above 0.
INFORMED_NOISE = 1e-4


class Tolerance(NamedTuple):
    """
    Errors of the true object pose at rest that count as success.

    :param position: distance from the goal [m].
    :param heading: error of the heading [rad].
    """

    position: float = 0.01
    heading: float = math.radians(1.0)

    def __str__(self) -> str:
        """Write it as a title."""
        return f'{1e3 * self.position:g} mm, {math.degrees(self.heading):g} deg'


FREE_TOLERANCE = Tolerance(heading=math.tau)
# Set for tasks.
TAG_TOLERANCE = Tolerance(0.02, math.radians(2.0))
STRICT_TOLERANCES = (Tolerance(0.005, math.radians(0.5)), Tolerance(0.003, math.radians(0.3)))


class Case(NamedTuple):
    """
    One task.

    :param scenario: the ``Scenario``.
    :param variety: sort of map, of disturbance or of variation; empty where there is one only.
    :param floor: the ``Floor``, or None for open floor.
    :param intervention: ``Intervention`` that disturbs it, or None.
    :param tolerance: ``Tolerance`` by which it is judged.
    :param is_spatial: whether MuJoCo moves object and robot, and not the plant.
    :param slope: of the floor (angle, direction of descent in the world) [rad]; in MuJoCo only.
    """

    scenario: Scenario
    variety: str = ''
    floor: Optional[Floor] = None
    intervention: Optional[Intervention] = None
    tolerance: Tolerance = Tolerance()
    is_spatial: bool = False
    slope: tuple[float, float] = (0.0, 0.0)


def jobs(part: str, count: int, kinds: Sequence[str] = ()) -> list[Job]:
    """
    List the tasks of a part; the first ones do not depend on how many there are.

    :param part: one of ``PARTS``.
    :param count: number of tasks.
    :param kinds: of the ``KINDS`` of this part; empty for all of them.
    :return: keyword arguments of ``draw``.
    """
    kinds = kinds or KINDS[part]
    if part in BASE_PARTS:
        return varied_jobs(part, count, kinds, len(BAD_BASES))
    if part in EYES_PARTS:
        return varied_jobs(part, count, kinds, len(EYES))
    return [{'part': part, 'kind': kinds[index % len(kinds)], 'seed': index // len(kinds)}
            for index in range(count)]


def odometry_jobs(tasks: Sequence[Job]) -> list[Job]:
    """
    List what tasks with a lidar are compared with: each of them by odometry alone.

    :param tasks: of ``jobs``, of ``LIDAR_PARTS``.
    """
    return [{**job, 'base': BY_ODOMETRY} for job in tasks]


def free_jobs(tasks: Sequence[Job]) -> list[Job]:
    """
    List what tasks of bins at walls are compared with: each of them done with any heading.

    :param tasks: of ``jobs``, of ``WALLS``.
    """
    return [{**job, 'base': ANY_HEADING} for job in tasks if job['kind'].startswith('bin,')]


def draw(part: str, kind: str, seed: int, base: str = LEARNED, maps: str = '') -> Case:
    """
    Draw a task.

    :param part: one of ``PARTS``.
    :param kind: one of the ``KINDS`` of this part.
    :param seed: of all draws.
    :param base: what the task is compared with: one of ``TREATMENTS`` of a base, of ``BASE_PARTS``
        only; ``ALWAYS_SEEN``, of ``EYES_PARTS`` only; ``BY_ODOMETRY``, of ``LIDAR_PARTS`` only;
        ``ANY_HEADING``, of ``WALLS`` only.
    :param maps: folder of maps, of ``PUBLIC_MAPS`` only.
    :return: ``Case``.
    """
    if part in LIDAR_PARTS:
        case = _draw(part, kind, seed, maps)
        return case._replace(variety=BY_ODOMETRY) if base == BY_ODOMETRY else (
            _by_lidar(case)._replace(variety=BY_LIDAR))
    if part == WALLS:
        case = _by_lidar(_at_walls(kind, seed))
        return with_tolerance(case, FREE_TOLERANCE) if base == ANY_HEADING else case
    if part in (OPEN, IN_MAPS, FLATS, DISTURBED):
        return _draw(part, kind, seed)
    rng = _rng(part, kind, seed)
    if part == STRICT:
        # Every task comes once with each tolerance.
        number, index = divmod(seed, len(STRICT_TOLERANCES))
        case = _strict(_draw(OPEN, kind, number), STRICT_TOLERANCES[index])
    elif part in BASE_PARTS:
        # Every task comes once with each base.
        number, index = divmod(seed, STRIDE)
        case = _draw(OPEN, kind, number)
        case = _spatial(case, rng) if part == SPATIAL_BASES else case
        case = _with_base(case, list(BAD_BASES)[index], base, rng)
    elif part in EYES_PARTS:
        number, index = divmod(seed, STRIDE)
        case = _draw(OPEN, kind, number)
        case = _spatial(case, rng) if part == SPATIAL_EYES else case
        case = _with_eyes(case, list(EYES)[index], base, rng)
    else:
        case = VARIATIONS[part](_draw(OPEN, kind, seed), rng)
    return case._replace(scenario=dataclasses.replace(
        case.scenario, description=f'{part}, {kind}, seed {seed}'))


def _draw(part: str, kind: str, seed: int, maps: str = '') -> Case:
    """Draw a task on open floor, in a map, or disturbed."""
    if part == PUBLIC_MAPS:
        return _in_public_map(kind, seed, maps)
    rng = _rng(part, kind, seed)
    bodies = draw_bodies(kind, seed, rng)
    true, robot = bodies.true_object, bodies.robot
    dropouts: tuple[tuple[float, float], ...] = ()
    floor, variety, intervention = None, '', None
    if part in (IN_MAPS, FLATS, FAR_ROBOTS):
        variety = MAPS[seed % len(MAPS)] if part == IN_MAPS else FLAT
        is_far = part == FAR_ROBOTS
        floor, start, goal = _in_map(variety, true, robot, rng, is_near=is_far)
        within = FAR_ROBOT_WITHIN if is_far else ROBOT_WITHIN
    else:
        start, goal, within = Pose(0.0, 0.0, 0.0), _goal(rng), ROBOT_WITHIN
    robot_start = _robot_start(true, robot, start, floor, rng, within=within)
    if part == DISTURBED:
        disturbance = OPEN_DISTURBANCES[seed % len(OPEN_DISTURBANCES)]
        variety = disturbance.value
        intervention = Intervention(disturbance, rng.uniform(0.0, LATEST),
                                    rng.uniform(-math.pi, math.pi))
        begin = rng.uniform(0.0, LATEST)
        dropouts = ((begin, begin + rng.uniform(0.0, MAX_DROPOUT)),)
    scenario = make_scenario(f'{part}, {kind}, seed {seed}', bodies,
                             TaskPoses(start, goal, robot_start), seed,
                             None if floor is None else floor.map)
    sensors = dataclasses.replace(SENSORS, pose_dropouts=dropouts)
    return Case(dataclasses.replace(scenario, sensors=sensors), variety, floor, intervention)


def _in_public_map(kind: str, seed: int, maps: str) -> Case:
    """Draw a task in a map of others; consecutive tasks are in different ones."""
    kinds = KINDS[PUBLIC_MAPS]
    rng = _rng(PUBLIC_MAPS, kind, seed)
    bodies = draw_bodies(kind, seed, rng)
    task = draw_public_task(maps, len(kinds) * seed + kinds.index(kind), bodies.true_object,
                            bodies.robot, rng)
    poses = TaskPoses(task.start, task.goal, task.robot_start)
    return Case(make_scenario(f'{task.name}, {kind}, seed {seed}', bodies, poses, seed,
                              task.floor_map))


def _at_walls(kind: str, seed: int) -> Case:
    """Draw a task from walls, to walls or along them."""
    rng = _rng(WALLS, kind, seed)
    bodies = draw_bodies(kind, seed, rng)
    nook = POSSIBLE[seed % len(POSSIBLE)]
    task = draw_nook_task(nook, bodies.true_object, bodies.robot, rng,
                          is_square=bool(rng.integers(2)), resolution=float(rng.choice(CELLS)))
    poses = TaskPoses(task.start, task.goal, task.robot_start)
    return Case(make_scenario(f'{WALLS}, {kind}, seed {seed}', bodies, poses, seed,
                              drawn_map(task.occupancy_map)), nook.value)


def _rng(part: str, kind: str, seed: int) -> np.random.Generator:
    return np.random.default_rng((PARTS.index(part), KINDS[part].index(kind), seed))


def _goal(rng: np.random.Generator) -> Pose:
    far = rng.uniform(NEAREST, FARTHEST)
    bearing, heading = rng.uniform(-math.pi, math.pi, 2)
    return Pose(far * math.cos(bearing), far * math.sin(bearing), heading)


def _by_lidar(case: Case) -> Case:
    """Give the robot a lidar, by which it finds its place in the map."""
    scenario = case.scenario
    return case._replace(scenario=with_sensors(scenario, dataclasses.replace(
        scenario.sensors, lidar=LidarSensorSettings(rate=10.0))))


def _in_map(name: str, obj: PushedObject, robot: RoundRobot, rng: np.random.Generator, *,
            is_near: bool = False) -> tuple[Floor, Pose, Pose]:
    """
    Place object and goal where the robot can drive all round, with a path between them.

    :param is_near: whether the goal is near in a flat, else far.
    """
    aside = (inner_reach(obj) if name == FLAT else reach(obj)) + CLEARANCE
    around = reach(obj) + CLEARANCE + 2.0 * robot.radius + CLEARANCE
    while True:
        floor = draw_floor(name, rng)
        find = places_in_flat if name == FLAT else places
        region, points = find(floor, aside)
        wide = np.flatnonzero(find(floor, around)[0] * region)
        if not wide.size:
            continue
        first, last = rng.choice(wide, 2)
        if is_near:
            away = np.hypot(*(points[wide] - points[first]).T)
            last = rng.choice(wide[away < NEAR_IN_FLAT])
        start, goal = (Pose(float(points[index, 0]), float(points[index, 1]),
                            rng.uniform(-math.pi, math.pi)) for index in (first, last))
        is_valid = is_near or _is_valid_goal(name, floor, start, goal)
        if region[first] == region[last] and is_valid:
            return floor, start, goal


def _is_valid_goal(name: str, floor: Floor, start: Pose, goal: Pose) -> bool:
    """Tell whether the goal is in the other of two rooms, or far enough in the only one."""
    if name == FLAT:
        return distance(start, goal) > FAR_IN_FLAT
    if name == 'cluttered room':
        return NEAREST < distance(start, goal) < FARTHEST
    middle = 0.5 * floor.map.resolution * floor.size[0]
    return (start.x - middle) * (goal.x - middle) < 0.0


def _robot_start(obj: PushedObject, robot: RoundRobot, start: Pose, floor: Optional[Floor],
                 rng: np.random.Generator, *, within: float) -> Pose:
    """Place the robot within a distance [m] of the object, clear of it and of obstacles."""
    occupancy_map = None if floor is None else floor.map.occupancy_map
    while True:
        # The root spreads the places evenly over the disc.
        away = within * math.sqrt(rng.uniform())
        bearing, heading = rng.uniform(-math.pi, math.pi, 2)
        pose = Pose(start.x + away * math.cos(bearing), start.y + away * math.sin(bearing),
                    heading)
        clear = find_contact(obj, start, pose[:2], robot.radius)[2] >= CLEARANCE
        if clear and (occupancy_map is None
                      or occupancy_map.robot_is_free(robot, [pose], 2.0 * CLEARANCE)):
            return pose


def _with_contact_friction(case: Case, friction: float) -> Case:
    return case._replace(scenario=dataclasses.replace(case.scenario, true_object=(
        dataclasses.replace(case.scenario.true_object, contact_friction_coefficient=friction))))


def _with_sensors(case: Case, **errors: Any) -> Case:
    return case._replace(scenario=dataclasses.replace(
        case.scenario, sensors=dataclasses.replace(case.scenario.sensors, **errors)))


def _with_supervision(case: Case, **settings: Any) -> Case:
    task = case.scenario.task or Task()
    return case._replace(scenario=dataclasses.replace(case.scenario, task=dataclasses.replace(
        task, supervision=dataclasses.replace(task.supervision, **settings))))


def with_tolerance(case: Case, tolerance: Tolerance) -> Case:
    """
    Let a task be done, and judged, within another tolerance.

    :param tolerance: ``Tolerance``.
    """
    return _with_supervision(case, position_tolerance=tolerance.position,
                             heading_tolerance=tolerance.heading)._replace(tolerance=tolerance)


def _slippery(case: Case, rng: np.random.Generator) -> Case:
    return _with_contact_friction(case, float(rng.uniform(*SLIPPERY_FRICTION)))


def _creeping(case: Case, _: np.random.Generator) -> Case:
    return case._replace(scenario=dataclasses.replace(
        case.scenario, simulation=dataclasses.replace(case.scenario.simulation,
                                                      contact_creep=CREEP)))


def _frictionless(case: Case, _: np.random.Generator) -> Case:
    return _with_contact_friction(case, 0.0)


def _wheels(case: Case, rng: np.random.Generator) -> Case:
    scale = YAW_SCALE if rng.uniform() < 0.5 else -YAW_SCALE
    return _with_sensors(case, odometry_yaw_scale=scale)._replace(
        variety=f'{100.0 * scale:+g} %')


def _tag(case: Case, _: np.random.Generator) -> Case:
    seen = _with_supervision(_with_sensors(case, **TAG_SENSORS), **TAG_SUPERVISION)
    seen = with_tolerance(seen, TAG_TOLERANCE)
    return seen._replace(scenario=dataclasses.replace(
        seen.scenario, control=dataclasses.replace(seen.scenario.control, **TAG_CONTROL)))


def _spatial(case: Case, _: np.random.Generator) -> Case:
    """Let MuJoCo move object and robot, with the heights that they have in space."""
    scenario = case.scenario
    return case._replace(is_spatial=True, scenario=dataclasses.replace(
        scenario, true_object=dataclasses.replace(scenario.true_object, **HEIGHTS)))


def _slopes(case: Case, rng: np.random.Generator) -> Case:
    """Tilt the floor."""
    angle, direction = rng.uniform((0.0, -math.pi), (MAX_SLOPE, math.pi)).tolist()
    return _spatial(case, rng)._replace(slope=(angle, direction))


def _with_base(case: Case, variety: str, base: str, rng: np.random.Generator) -> Case:
    """Give the robot a base that does not do what it is told, unless a good one is asked for."""
    if base == GOOD:
        return case._replace(variety=GOOD)
    scenario, bad = case.scenario, bad_base(variety, rng)
    true_fields: dict[str, Any] = dict(bad.robot)
    true_object = dataclasses.replace(
        scenario.true_object, mass=bad.mass_ratio * scenario.true_object.mass)
    case = _with_sensors(case, **bad.sensors)
    return case._replace(variety=variety, scenario=dataclasses.replace(
        case.scenario,
        robot=dataclasses.replace(scenario.robot, identify_base=base != NOT_LEARNED),
        true_object=true_object,
        true_robot=dataclasses.replace(scenario.true_robot, **true_fields),
        simulation=dataclasses.replace(scenario.simulation, drive=bad.drive)))


def _with_eyes(case: Case, variety: str, base: str, rng: np.random.Generator) -> Case:
    """Let the robot see with other eyes, unless the object is to be seen always."""
    if base == ALWAYS_SEEN:
        return case._replace(variety=ALWAYS_SEEN)
    eyes = EYES[variety]
    moment, direction = rng.uniform((0.0, -math.pi), (LATEST, math.pi)).tolist()
    return case._replace(
        variety=variety, scenario=eyes_scenario(case.scenario, eyes),
        tolerance=Tolerance(eyes.position_tolerance, eyes.heading_tolerance),
        intervention=Intervention(Disturbance.CARRIED_AWAY, moment, direction)
        if eyes.is_moved else None)


def _informed(case: Case, _: np.random.Generator) -> Case:
    """Let the robot know the true object and where it is; poses come as late as before."""
    sensors = SensorSettings(
        pose_rate=SENSORS.pose_rate, pose_latency=SENSORS.pose_latency,
        odometry_rate=SENSORS.odometry_rate, odometry_reference='absolute',
        odometry_position_noise=INFORMED_NOISE, odometry_heading_noise=INFORMED_NOISE)
    return _with_supervision(case._replace(scenario=dataclasses.replace(
        case.scenario, object=case.scenario.true_object, sensors=sensors)),
        odometry_reference='absolute')


def _strict(case: Case, tolerance: Tolerance) -> Case:
    return with_tolerance(case, tolerance)._replace(variety=str(tolerance))


VARIATIONS: dict[str, Callable[[Case, np.random.Generator], Case]] = {
    SLIPPERY: _slippery, CREEPING: _creeping, FRICTIONLESS: _frictionless, WHEELS: _wheels,
    TAG: _tag, INFORMED: _informed, SPATIAL: _spatial, SLOPES: _slopes}
