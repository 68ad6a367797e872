"""Tasks of a TurtleBot 4 in MuJoCo, by its own camera or by another one in the room."""

import dataclasses
import math
from typing import get_args, Literal, NamedTuple

import numpy as np
from push_control.supervision_settings import SupervisionSettings
from push_control.task.supervisor import Supervisor
from push_model.files.parameter_files import named_file, read_object, read_robot
from push_model.geometry import distance, wrap_angle
from push_model.parameters import PushedObject
from push_mujoco.appearance import looks_of
from push_mujoco.camera import SimulatedCamera
from push_mujoco.engine_plant import engine_plant
from push_mujoco.simulated_robot import read_simulated_robot
from push_mujoco.tags import tag_eye, tag_pictures
from push_scenario.definition.expected_poses import with_sensors
from push_scenario.definition.loader import with_map
from push_scenario.definition.placement import Placement
from push_scenario.definition.scenario import GoalBounds, Scenario, Start
from push_scenario.definition.task import Task
from push_scenario.simulation.loop import simulate
from push_scenario.simulation.result import Outcome
from push_sim_node.camera import CameraSettings
from push_sim_node.lidar import LidarSensorSettings
from push_sim_node.sensors import SensorSettings
from push_sim_node.settings import SimulationSettings
from push_tags.tag_layout import read_tag_layout

ROBOT = 'turtlebot4'
# Mass of a carton that the wheels push [kg]; chosen: 7 to 13 N, of the 20 N that they have. From
# 12 N on they lift the caster (``python -m benchmarks.plant.pushing_force``).
CARTON_MASS = 3.0
# Two rooms and a door of 1.4 m, and where object, robot and goal are in it: least and greatest x
# and y [m]; chosen: the object starts in one room, and its goal is in the other.
MAP = 'two_rooms'
OBJECT_AREA, ROBOT_AREA = ((-1.1, -0.6), (-0.5, 0.9)), ((-2.1, -1.7), (-1.3, 1.3))
GOAL_AREA = (0.6, 1.1), (-0.5, 0.9)
# Rate of the lidar by which the robot with a camera knows its place in rooms [Hz]; as that of a
# TurtleBot 4.
SCAN_RATE = 8.0
# Simulated time for a task [s]; chosen.
TIME_LIMITS: dict['Place', float] = {'floor': 180.0, 'door': 300.0}
# Where goals are [m, rad], and how far the robot is from the object at first [m]; chosen: a room.
GOAL_REACH, GOAL_TURN = (0.3, 0.8), math.pi / 2
ROBOT_DISTANCE = 0.7, 1.2
# Friction of each foot over what is stated: drawn between these; chosen as in benchmarks.tasks.
FRICTION_RATIOS = 0.7, 1.3
# Lens in the room: 1.6 m above the floor, 1.8 m beside its middle.
ROOM_LENS = SimulatedCamera(place='room', x=0.3, y=-1.8, z=1.6, heading=math.pi / 2, pitch=0.75)
# From an image to its pose [s], images per second [Hz]; chosen: as a driver and a detector have.
LATENCY, RATE = 0.1, 5.0
# Nearest distance from the lens on the robot to a face of which the tag is in view [m]: its lower
# edge is 0.13 m below the lens, and the view ends 28 degrees below the horizon.
NEAREST = 0.27
# Noise of poses that the controller expects: growth with the distance [m/m, rad/m], measured by
# ``tag_errors``.
NOISE_PER_DISTANCE, HEADING_NOISE_PER_DISTANCE = 0.004, 0.009


# Open floor, or from one room through a door into another one.
Place = Literal['floor', 'door']


class Kind(NamedTuple):
    """
    Kind of a task.

    :param object: name of the object, and of its tags.
    :param place: open floor, or two rooms and a door.
    """

    object: str
    place: Place


KINDS = tuple(Kind(name, place) for place in get_args(Place) for name in ('box_04', 'carton'))


class Tolerance(NamedTuple):
    """Errors at which a task is done: distance [m] and angle [rad]."""

    position: float
    heading: float


# A camera on the robot, whose place is known by ticks of its wheels and a gyro, or to a millimetre
# as by motion capture; and a camera in the room.
View = Literal['robot', 'located_robot', 'room']
VIEWS: tuple[View, ...] = get_args(View)
TOLERANCES = {'robot': Tolerance(0.02, math.radians(2.0)),
              'located_robot': Tolerance(0.02, math.radians(2.0)),
              'room': Tolerance(0.01, math.radians(1.0))}

# Part of the tolerance that the robot is asked for; chosen: half of it where its odometry drifts,
# as it does not know how far what it calls done is off by that drift.
ASKED_RATIOS = {'robot': 0.5, 'located_robot': 1.0, 'room': 1.0}


class Ending(NamedTuple):
    """
    End of a task.

    :param view: one of ``VIEWS``.
    :param seed: of the case.
    :param outcome: ``Outcome``.
    :param reason: why it is not done; empty where it is.
    :param time: simulated [s].
    :param position_error: true distance to the goal [m].
    :param heading_error: true angle to it [rad].
    """

    view: View
    seed: int
    outcome: Outcome
    reason: str
    time: float
    position_error: float
    heading_error: float

    @property
    def is_within(self) -> bool:
        """Tell whether the object truly is within the tolerance."""
        tolerance = TOLERANCES[self.view]
        return (self.position_error <= tolerance.position
                and self.heading_error <= tolerance.heading)


def camera_of(view: View) -> SimulatedCamera:
    """
    Return the camera on the robot, or in the room.

    :param view: one of ``VIEWS``.
    """
    return ROOM_LENS if view == 'room' else read_simulated_robot(ROBOT).camera


def kind_of(seed: int) -> Kind:
    """
    Return the kind of a task: each follows the one before.

    :param seed: of the case.
    """
    return KINDS[seed % len(KINDS)]


def draw_scenario(view: View, seed: int) -> Scenario:
    """
    Draw a task.

    :param view: one of ``VIEWS``.
    :param seed: of the kind, the draw, and of all errors.
    """
    rng, kind = np.random.default_rng(seed), kind_of(seed)
    obj = _read_object(kind.object)
    ratios = rng.uniform(*FRICTION_RATIOS, len(obj.supports))
    supports = tuple(dataclasses.replace(
        support, friction_coefficient=support.friction_coefficient * float(ratio))
        for support, ratio in zip(obj.supports, ratios))
    start, goal = (_draw_on_floor if kind.place == 'floor' else _draw_in_rooms)(rng)
    robot, tolerance, asked = read_robot('create3'), TOLERANCES[view], ASKED_RATIOS[view]
    task = Task(
        supervision=SupervisionSettings(position_tolerance=asked * tolerance.position,
                                        heading_tolerance=asked * tolerance.heading))
    scenario = Scenario(
        name=f'{view}_{seed}', description='', object=obj,
        true_object=dataclasses.replace(obj, supports=supports), robot=robot, true_robot=robot,
        start=start, goal=goal, simulation=SimulationSettings(seed=seed), task=task,
        time_limit=TIME_LIMITS[kind.place], bounds=GoalBounds(*tolerance))
    if kind.place == 'door':
        scenario = with_map(scenario, named_file('maps', MAP))
    return with_sensors(scenario, sensors_of(view, kind.place))


def _read_object(name: str) -> PushedObject:
    """Read an object; a carton is as light as the robot can push it."""
    obj = read_object(name)
    if name != 'carton':
        return obj
    return dataclasses.replace(obj, mass=CARTON_MASS, inertia=obj.inertia * CARTON_MASS / obj.mass)


def _draw_on_floor(rng: np.random.Generator) -> tuple[Start, Placement]:
    """Draw start and goal on open floor, the object in the middle."""
    reach, bearing = rng.uniform(*GOAL_REACH), rng.uniform(-math.pi, math.pi)
    away, side = rng.uniform(*ROBOT_DISTANCE), rng.uniform(-math.pi, math.pi)
    robot = Placement(away * math.cos(side), away * math.sin(side),
                      float(rng.uniform(-math.pi, math.pi)))
    return Start(robot=robot), Placement(
        float(reach * math.cos(bearing)), float(reach * math.sin(bearing)),
        float(rng.uniform(-GOAL_TURN, GOAL_TURN)))


def _draw_in_rooms(rng: np.random.Generator) -> tuple[Start, Placement]:
    """Draw start and goal on both sides of the door."""
    obj, robot, goal = (
        Placement(float(rng.uniform(*x_range)), float(rng.uniform(*y_range)),
                  float(rng.uniform(-turn, turn)))
        for (x_range, y_range), turn in ((OBJECT_AREA, math.pi), (ROBOT_AREA, math.pi),
                                         (GOAL_AREA, math.pi)))
    return Start(object=obj, robot=robot), goal


def sensors_of(view: View, place: Place) -> SensorSettings:
    """
    Return what the controller expects of a camera; its pixels decide what it gets.

    :param view: one of ``VIEWS``.
    :param place: in rooms a robot whose place is not known has a lidar.
    """
    camera = camera_of(view)
    is_fixed = camera.place == 'room'
    camera_settings = CameraSettings(
        place=camera.place, reference='world' if is_fixed else 'robot', mount_x=camera.x,
        mount_y=camera.y, mount_heading=camera.heading, half_angle=camera.view_angle / 2,
        nearest=0.0 if is_fixed else NEAREST, noise_per_distance=NOISE_PER_DISTANCE,
        heading_noise_per_distance=HEADING_NOISE_PER_DISTANCE)
    has_lidar = view == 'robot' and place == 'door'
    # The wheels slip, and their ticks are all that there is of the way that the robot goes.
    return SensorSettings(pose_rate=RATE, pose_latency=LATENCY, pose_noise=0.001,
                          pose_heading_noise=0.003, camera=camera_settings,
                          lidar=LidarSensorSettings(rate=SCAN_RATE if has_lidar else 0.0),
                          odometry_reference='absolute' if view == 'located_robot' else 'drifting')


def run_task(view: View, seed: int) -> Ending:
    """
    Run a task from pixels to wheels.

    :param view: one of ``VIEWS``.
    :param seed: of the case.
    """
    scenario, layout = draw_scenario(view, seed), read_tag_layout(kind_of(seed).object)
    poses = [scenario.start.object.pose]

    def look(simulation, _: Supervisor) -> None:
        poses[0] = simulation.plant.object_pose

    result = simulate(scenario, intervene=look, plant_type=engine_plant(
        read_simulated_robot(ROBOT), looks_of(tag_pictures(layout)),
        tag_eye(camera_of(view), layout)))
    goal = scenario.goal.pose
    return Ending(view, seed, result.outcome, result.reason, result.duration,
                  distance(poses[0], goal), abs(wrap_angle(poses[0].theta - goal.theta)))
