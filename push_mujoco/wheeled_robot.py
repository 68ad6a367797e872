"""
A robot on two driven wheels and a caster in MuJoCo: odometry, pushing force, push and lidar.

In the package's model the robot goes where it is sent, whatever it pushes; here it does not. A
push at height h lifts the front, where the caster stands at c, and loads the wheels. With the mass
m centred at x, and friction mu of the wheels, moments about the caster give the largest force

    F = mu N,    N = m g (1 - x / c) / (1 - mu h / c)

as long as the caster stands, F h < m g x.
"""

import dataclasses
import math
from typing import Any

import mujoco
import numpy as np
from push_dynamics.walls import Wall
from push_model.geometry import FloatArray, Pose
from push_model.parameters import GRAVITY, PushedObject
from push_mujoco.scene import (
    Contact, object_part, pair, Part, planar_pose, Room, scene_xml, SETTLING_TIME, TUNED,
    walls_part, xml,
)

# MuJoCo defines these in an extension module without type stubs.
_mujoco: Any = mujoco
# Settings, chosen: an object's contacts are as stiff as those of the comparison, and the robot's
# come to rest at a wall with little creep.
ENGINE = dataclasses.replace(TUNED, step=1e-3, margin=0.0)
CONTACT = Contact(solref=(0.02, 1.0), friction_solref=(0.0, 0.0), impedance=(0.95, 0.95))
# Damping by which a motor holds its speed [N m s], and inertia of its rotor behind the gears
# [kg m^2]; chosen: it lags by some 10 ms, and explicit steps are stable.
MOTOR_GAIN, ROTOR_INERTIA = 0.5, 2e-3
# Half the height of the bumper [m]; chosen: low, as a push has one height.
BUMPER_HALF_HEIGHT = 0.002
# Where the wall of the pushing test stands [m], the speed of the wheels [m/s], and how long they
# turn before and while the force is measured [s]; chosen: the impact is over.
WALL_X, PUSHING_SPEED, PUSHING_TIME = 0.175, 0.1, 0.5


@dataclasses.dataclass(frozen=True)
class WheeledRobot:
    """
    Masses and measures of a robot on two wheels and a caster, its origin below the axle's middle.

    :param body_mass: of all but the wheels [kg].
    :param body_inertia: about the centre of that mass and the axes (x, y, z) [kg m^2].
    :param body_center: centre of that mass (x, y, z) [m].
    :param bumper_radius: of the bumper, a ring about the origin [m].
    :param bumper_height: above the floor [m].
    :param wheel_mass: of one wheel [kg].
    :param wheel_radius: [m].
    :param wheel_width: [m].
    :param track: distance between the wheels [m].
    :param wheel_friction: coefficient between wheels and floor.
    :param motor_torque: largest torque on one wheel [N m].
    :param max_acceleration: of a wheel's rim while its speed follows a command [m/s^2].
    :param caster_x: where the caster stands [m].
    :param caster_radius: [m].
    :param caster_friction: coefficient between caster and floor.
    :param lidar: position of the lidar (x, y, z) [m].
    """

    body_mass: float
    body_inertia: tuple[float, float, float]
    body_center: tuple[float, float, float]
    bumper_radius: float
    bumper_height: float
    wheel_mass: float
    wheel_radius: float
    wheel_width: float
    track: float
    wheel_friction: float
    motor_torque: float
    max_acceleration: float
    caster_x: float
    caster_radius: float
    caster_friction: float
    lidar: tuple[float, float, float]

    @property
    def mass(self) -> float:
        """Mass of the whole robot [kg]."""
        return self.body_mass + 2.0 * self.wheel_mass

    @property
    def center_x(self) -> float:
        """How far the centre of mass is ahead of the axle [m]."""
        return self.body_mass * self.body_center[0] / self.mass

    @property
    def lifting_force(self) -> float:
        """Force of a push that lifts the caster, unless the wheels spin before [N]."""
        return self.mass * GRAVITY * self.center_x / self.bumper_height

    @property
    def traction(self) -> float:
        """Force of a push at which the wheels spin, if the caster stands then [N]."""
        mu, caster = self.wheel_friction, self.caster_x
        load = self.mass * GRAVITY * (1.0 - self.center_x / caster)
        return mu * load / (1.0 - mu * self.bumper_height / caster)


# Wheels, caster, track and lidar as in the makers' public URDF (iRobotEducation/create3_sim,
# turtlebot/turtlebot4), the sum of masses as in their data sheet (3.9 kg). Chosen: what stands on
# the base is centred above the axle, 0.15 m high; inertias; motors; bumper; wheel friction.
TURTLEBOT_4 = WheeledRobot(
    body_mass=3.5, body_inertia=(0.035, 0.035, 0.045), body_center=(0.0173, 0.0, 0.098),
    bumper_radius=0.171, bumper_height=0.05, wheel_mass=0.2, wheel_radius=0.03575,
    wheel_width=0.015, track=0.233, wheel_friction=0.6, motor_torque=1.0,
    max_acceleration=0.9, caster_x=0.125, caster_radius=0.01, caster_friction=0.1,
    lidar=(-0.04, 0.0, 0.193))


def wheel_body(robot: WheeledRobot, name: str, y: float) -> str:
    """Write a driven wheel, which touches the floor at one point."""
    radius, width = robot.wheel_radius, robot.wheel_width
    across = robot.wheel_mass * (3.0 * radius**2 + width**2) / 12.0
    inertia = xml(across, robot.wheel_mass * radius**2 / 2.0, across)
    return (f'<body name="{name}" pos="{xml(0, y, radius)}"><joint name="{name}" axis="0 1 0" '
            f'armature="{ROTOR_INERTIA}"/>'
            f'<inertial pos="0 0 0" mass="{robot.wheel_mass}" diaginertia="{inertia}"/>'
            f'<geom name="{name}" type="ellipsoid" size="{xml(radius, width / 2, radius)}"/>'
            '</body>')


def robot_part(robot: WheeledRobot, walls: int) -> Part:
    """
    Write the robot.

    :param walls: number of the walls that it may touch.
    """
    wheels = (wheel_body(robot, 'left', robot.track / 2)
              + wheel_body(robot, 'right', -robot.track / 2))
    motors = ''.join(f'<velocity joint="{name}" kv="{MOTOR_GAIN}" '
                     f'forcerange="{xml(-robot.motor_torque, robot.motor_torque)}"/>'
                     for name in ('left', 'right'))
    pairs = [pair('floor', 'left', robot.wheel_friction, CONTACT),
             pair('floor', 'right', robot.wheel_friction, CONTACT),
             pair('floor', 'caster', robot.caster_friction, CONTACT),
             *(pair(f'wall{i}', 'bumper', 0.0, CONTACT) for i in range(walls))]
    return Part(f"""
    <body name="robot">
      <freejoint/>
      <inertial pos="{xml(*robot.body_center)}" mass="{robot.body_mass}"
                diaginertia="{xml(*robot.body_inertia)}"/>
      <geom name="bumper" type="cylinder" pos="{xml(0, 0, robot.bumper_height)}"
            size="{xml(robot.bumper_radius, BUMPER_HALF_HEIGHT)}"/>
      <geom name="caster" type="sphere" size="{robot.caster_radius}"
            pos="{xml(robot.caster_x, 0, robot.caster_radius)}"/>
      <site name="lidar" pos="{xml(*robot.lidar)}"/>{wheels}
    </body>""", ''.join(pairs), motors)


def wheeled_scene(robot: WheeledRobot, room: Room, obj: PushedObject | None) -> str:
    """Write the robot in a room, with an object; walls are solid where the origin is not."""
    wheeled = robot_part(robot, len(room.walls))
    walls = walls_part(room, ENGINE, (0.0, 0.0))
    if obj is None:
        return scene_xml(ENGINE, wheeled, Part(walls.bodies, ''))
    touch = Part('', pair('bumper', 'outline', obj.contact_friction_coefficient,
                          ENGINE.outline_contact))
    return scene_xml(ENGINE, wheeled, walls, object_part(obj, ENGINE), touch)


class WheeledPlant:
    """
    The robot in MuJoCo, at first at the origin, and an object that it pushes.

    :param robot: ``WheeledRobot``.
    :param room: walls that stop robot and object; none passes through the origin.
    :param obj: the ``PushedObject``, touched at the height of the bumper; None for none.
    :param object_pose: ``Pose`` of the object's frame at first.
    """

    def __init__(self, robot: WheeledRobot, room: Room = Room(), obj: PushedObject | None = None,
                 object_pose: Pose = Pose(1.0, 0.0, 0.0)) -> None:
        self.robot = robot
        self.model = _mujoco.MjModel.from_xml_string(wheeled_scene(robot, room, obj))
        self.data = _mujoco.MjData(self.model)
        if obj is not None:
            x, y, theta = object_pose
            self.data.qpos[9:11] = x, y
            self.data.qpos[12:16] = math.cos(theta / 2), 0.0, 0.0, math.sin(theta / 2)
            # It sinks to its rest on the soft floor.
            self.advance(SETTLING_TIME, 0.0, 0.0)
        _mujoco.mj_forward(self.model, self.data)

    def advance(self, duration: float, speed: float, yaw_rate: float) -> None:
        """
        Advance time while the speeds of the wheels follow a command.

        :param duration: how long [s].
        :param speed: of the robot ahead, if no wheel slips [m/s].
        :param yaw_rate: likewise [rad/s].
        """
        difference = yaw_rate * self.robot.track / 2.0
        radius = self.robot.wheel_radius
        command = np.array([speed - difference, speed + difference]) / radius
        change = self.robot.max_acceleration * ENGINE.step / radius
        for _ in range(round(duration / ENGINE.step)):
            self.data.ctrl += np.clip(command - self.data.ctrl, -change, change)
            _mujoco.mj_step(self.model, self.data)

    @property
    def pose(self) -> Pose:
        """Pose of the robot in the world; the angle within +-pi."""
        return planar_pose(self.data.qpos[:7])

    @property
    def object_pose(self) -> Pose:
        """Pose of the object's frame in the world; the angle within +-pi."""
        return planar_pose(self.data.qpos[9:16])

    @property
    def wheel_angles(self) -> tuple[float, float]:
        """Angles by which the wheels (left, right) have turned [rad]."""
        left, right = self.data.qpos[7:9].tolist()
        return left, right

    @property
    def force_on_walls(self) -> float:
        """Sum of the normal forces between bumper and walls in the last step [N]."""
        bumper = self.model.geom('bumper').id
        forces = np.zeros((self.data.ncon, 6))
        for i in range(self.data.ncon):
            _mujoco.mj_contactForce(self.model, self.data, i, forces[i])
        touches = (np.array(self.data.contact.geom).reshape(-1, 2) == bumper).any(axis=1)
        return float(forces[touches, 0].sum())

    def scan(self, beams: int, max_range: float = 12.0) -> FloatArray:
        """
        Measure how far it is to the walls, all round in the plane of the lidar.

        :param beams: their number, the first ahead, counter-clockwise.
        :param max_range: largest range that is measured [m].
        :return: shape (beams,) [m]; infinite where there is nothing.
        """
        angles = np.linspace(0.0, 2.0 * math.pi, beams, endpoint=False)
        rays = np.stack((np.cos(angles), np.sin(angles), np.zeros(beams)), axis=1)
        lidar = self.data.site('lidar')
        rays = rays @ lidar.xmat.reshape(3, 3).T
        geoms, ranges = np.zeros(beams, dtype=np.int32), np.zeros(beams)
        _mujoco.mj_multiRay(self.model, self.data, lidar.xpos, rays.ravel(), None, True,
                            self.model.body('robot').id, geoms, ranges, None, beams, max_range)
        return np.where((ranges >= 0.0) & (ranges <= max_range), ranges, math.inf)


def pushing_force(robot: WheeledRobot) -> float:
    """Drive against a wall until the wheels spin; return the mean force on it [N]."""
    plant = WheeledPlant(robot, Room((Wall(WALL_X, -1.0, WALL_X, 1.0),)))
    plant.advance(PUSHING_TIME, PUSHING_SPEED, 0.0)
    forces = []
    for _ in range(round(PUSHING_TIME / ENGINE.step)):
        plant.advance(ENGINE.step, PUSHING_SPEED, 0.0)
        forces.append(plant.force_on_walls)
    return float(np.mean(forces))
