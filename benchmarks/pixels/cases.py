"""Tasks of a TurtleBot 4 in MuJoCo, by its own camera or by another one in the room."""

import dataclasses
import math
from typing import get_args, Literal, NamedTuple

import numpy as np
from push_control.supervision_settings import SupervisionSettings
from push_control.task.supervisor import Supervisor
from push_model.files.parameter_files import read_object, read_robot
from push_model.geometry import distance, wrap_angle
from push_mujoco.appearance import looks_of
from push_mujoco.camera import SimulatedCamera
from push_mujoco.engine_plant import engine_plant
from push_mujoco.simulated_robot import read_simulated_robot
from push_mujoco.tags import tag_eye, tag_pictures
from push_scenario.definition.expected_poses import with_sensors
from push_scenario.definition.placement import Placement
from push_scenario.definition.scenario import GoalBounds, Scenario, Start
from push_scenario.definition.task import Task
from push_scenario.simulation.loop import simulate
from push_scenario.simulation.result import Outcome
from push_sim_node.camera import CameraSettings
from push_sim_node.sensors import SensorSettings
from push_sim_node.settings import SimulationSettings
from push_tags.tag_layout import read_tag_layout

OBJECT, ROBOT = 'box_04', 'turtlebot4'
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


def draw_scenario(view: View, seed: int) -> Scenario:
    """
    Draw a task.

    :param view: one of ``VIEWS``.
    :param seed: of the draw, and of all errors.
    """
    rng = np.random.default_rng(seed)
    obj = read_object(OBJECT)
    ratios = rng.uniform(*FRICTION_RATIOS, len(obj.supports))
    supports = tuple(dataclasses.replace(
        support, friction_coefficient=support.friction_coefficient * float(ratio))
        for support, ratio in zip(obj.supports, ratios))
    reach, bearing = rng.uniform(*GOAL_REACH), rng.uniform(-math.pi, math.pi)
    away, side = rng.uniform(*ROBOT_DISTANCE), rng.uniform(-math.pi, math.pi)
    robot, tolerance = read_robot('create3'), TOLERANCES[view]
    scenario = Scenario(
        name=f'{view}_{seed}', description='', object=obj,
        true_object=dataclasses.replace(obj, supports=supports), robot=robot, true_robot=robot,
        start=Start(robot=Placement(away * math.cos(side), away * math.sin(side),
                                    float(rng.uniform(-math.pi, math.pi)))),
        goal=Placement(float(reach * math.cos(bearing)), float(reach * math.sin(bearing)),
                       float(rng.uniform(-GOAL_TURN, GOAL_TURN))),
        simulation=SimulationSettings(seed=seed), task=Task(), time_limit=180.0,
        bounds=GoalBounds(*tolerance))
    asked = ASKED_RATIOS[view]
    supervision = SupervisionSettings(position_tolerance=asked * tolerance.position,
                                      heading_tolerance=asked * tolerance.heading)
    return with_sensors(dataclasses.replace(scenario, task=Task(supervision=supervision)),
                        sensors_of(view))


def sensors_of(view: View) -> SensorSettings:
    """
    Return what the controller expects of a camera; its pixels decide what it gets.

    :param view: one of ``VIEWS``.
    """
    camera = camera_of(view)
    is_fixed = camera.place == 'room'
    camera_settings = CameraSettings(
        place=camera.place, reference='world' if is_fixed else 'robot', mount_x=camera.x,
        mount_y=camera.y, mount_heading=camera.heading, half_angle=camera.view_angle / 2,
        nearest=0.0 if is_fixed else NEAREST, noise_per_distance=NOISE_PER_DISTANCE,
        heading_noise_per_distance=HEADING_NOISE_PER_DISTANCE)
    # The wheels slip, and their ticks are all that there is of the way that the robot goes.
    return SensorSettings(pose_rate=RATE, pose_latency=LATENCY, pose_noise=0.001,
                          pose_heading_noise=0.003, camera=camera_settings,
                          odometry_reference='absolute' if view == 'located_robot' else 'drifting')


def run_task(view: View, seed: int) -> Ending:
    """
    Run a task from pixels to wheels.

    :param view: one of ``VIEWS``.
    :param seed: of the case.
    """
    scenario, layout = draw_scenario(view, seed), read_tag_layout(OBJECT)
    poses = [scenario.start.object.pose]

    def look(simulation, _: Supervisor) -> None:
        poses[0] = simulation.plant.object_pose

    result = simulate(scenario, intervene=look, plant_type=engine_plant(
        read_simulated_robot(ROBOT), looks_of(tag_pictures(layout)),
        tag_eye(camera_of(view), layout)))
    goal = scenario.goal.pose
    return Ending(view, seed, result.outcome, result.reason, result.duration,
                  distance(poses[0], goal), abs(wrap_angle(poses[0].theta - goal.theta)))
