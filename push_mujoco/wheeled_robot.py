"""
A robot on two driven wheels and a caster, or on a holonomic base, in MuJoCo.

In the package's own plant the robot goes where it is sent, whatever it pushes; here motors and
friction on the floor decide.
"""

import dataclasses
import math
from typing import Any, NamedTuple

import mujoco
import numpy as np
from push_dynamics.walls import Wall
from push_model.geometry import Pose
from push_model.parameters import PushedObject
from push_model.signals import Twist
from push_model.wheels import wheel_speeds
from push_mujoco.scene import (
    BODY_GROUP, Contact, HIDDEN_GROUP, object_part, pair, Part, planar_pose, prism, Room,
    scene_xml, SETTLING_TIME, TUNED, walls_part, xml,
)
from push_mujoco.simulated_robot import SimulatedRobot

# MuJoCo defines these in an extension module without type stubs.
_mujoco: Any = mujoco
# Settings, chosen: an object's contacts are as stiff as those of the comparison, and the robot's
# come to rest at a wall with little creep.
ENGINE = dataclasses.replace(TUNED, step=1e-3, margin=0.0)
CONTACT = Contact(solref=(0.02, 1.0), friction_solref=(0.0, 0.0), impedance=(0.95, 0.95))
# The bumper on the object; chosen: on its springs it gives way by a millimetre at 10 N for an
# effective mass of some 2 kg, by less for heavier ones. Were it stiff, each touch would be an
# impact, and the wheels would slip at each.
BUMPER_CONTACT = Contact(solref=(0.05, 1.0), friction_solref=(0.0, 0.0), impedance=(0.9, 0.9))
# Damping by which a motor holds its speed [N m s], and inertia of its rotor behind the gears
# [kg m^2]; chosen: it lags by some 10 ms, and explicit steps are stable.
MOTOR_GAIN, ROTOR_INERTIA = 0.5, 2e-3
# Time in which motors of a holonomic base have its speed [s], chosen likewise.
SERVO_TIME = 0.02
# Rate at which the motors make up for speed that a load takes [1/s]; chosen: within half a second.
INTEGRAL_RATE = 10.0
# Half the height of the bumper [m]; chosen: low, as a push on a wall has one height. What meets
# the object is as high as that, which has one height itself [m].
BUMPER_HALF_HEIGHT, SKIRT_HALF_HEIGHT = 0.002, 0.2
# Where the wall of the pushing test stands [m], the speed of the wheels [m/s], and how long they
# turn before and while the force is measured [s]; chosen: the impact is over.
WALL_X, PUSHING_SPEED, PUSHING_TIME = 0.175, 0.1, 0.5
# Height of an object of which none is stated [m]; chosen: lidars of such robots see it.
OBJECT_HEIGHT = 0.3
# Colours (red, green, blue, opacity), chosen; the object is cardboard.
ROBOT_COLOR, OBJECT_COLOR = '0.16 0.17 0.2 1', '0.72 0.58 0.42 1'


def wheel_body(robot: SimulatedRobot, name: str, y: float) -> str:
    """Write a driven wheel, which touches the floor at one point."""
    radius, width = robot.wheel_radius, robot.wheel_width
    across = robot.wheel_mass * (3.0 * radius**2 + width**2) / 12.0
    inertia = xml(across, robot.wheel_mass * radius**2 / 2.0, across)
    return (f'<body name="{name}" pos="{xml(0, y, radius)}"><joint name="{name}" axis="0 1 0" '
            f'armature="{ROTOR_INERTIA}"/>'
            f'<inertial pos="0 0 0" mass="{robot.wheel_mass}" diaginertia="{inertia}"/>'
            f'<geom name="{name}" type="ellipsoid" size="{xml(radius, width / 2, radius)}"/>'
            '</body>')


def standing_base(robot: SimulatedRobot) -> Part:
    """Write what a differential drive stands on: two driven wheels, a caster, an edge behind."""
    wheels = (wheel_body(robot, 'left', robot.track / 2)
              + wheel_body(robot, 'right', -robot.track / 2))
    motors = ''.join(f'<velocity joint="{name}" kv="{MOTOR_GAIN}" '
                     f'forcerange="{xml(-robot.motor_torque, robot.motor_torque)}"/>'
                     for name in ('left', 'right'))
    spheres = ''.join(f'<geom name="{name}" type="sphere" size="{robot.caster_radius}" '
                      f'pos="{xml(x, 0, robot.caster_radius + clearance)}"/>'
                      for name, x, clearance in (('caster', robot.caster_x, 0.0),
                                                 ('rear', robot.rear_x, robot.rear_clearance)))
    pairs = [pair('floor', 'left', robot.wheel_friction, CONTACT),
             pair('floor', 'right', robot.wheel_friction, CONTACT),
             pair('floor', 'caster', robot.caster_friction, CONTACT),
             pair('floor', 'rear', robot.caster_friction, CONTACT)]
    return Part('<freejoint name="robot"/>' + spheres + wheels, ''.join(pairs), motors)


def sliding_base(robot: SimulatedRobot) -> Part:
    """Write a holonomic base: motors along both axes of the floor and about the vertical."""
    force = robot.traction
    joints = ''.join(f'<joint name="robot_{name}" type="{kind}" axis="{axis}"/>'
                     for name, kind, axis in (('x', 'slide', '1 0 0'), ('y', 'slide', '0 1 0'),
                                              ('yaw', 'hinge', '0 0 1')))
    limits = ('x', robot.mass, force), ('y', robot.mass, force), (
        'yaw', robot.body_inertia[2], force * robot.bumper_radius)
    motors = ''.join(f'<velocity joint="robot_{name}" kv="{inertia / SERVO_TIME:.12g}" '
                     f'forcerange="{xml(-limit, limit)}"/>' for name, inertia, limit in limits)
    return Part(joints, actuators=motors)


def robot_part(robot: SimulatedRobot, walls: int) -> Part:
    """
    Write the robot; what meets the object is its shape 'skirt'.

    :param walls: number of the walls that it may touch.
    """
    base = standing_base(robot) if robot.drive == 'differential' else sliding_base(robot)
    pairs = ''.join(pair(f'wall{i}', 'bumper', 0.0, CONTACT) for i in range(walls))
    half = 0.5 * robot.body_height
    return Part(f"""
    <body name="robot">
      <inertial pos="{xml(*robot.body_center)}" mass="{robot.body_mass}"
                diaginertia="{xml(*robot.body_inertia)}"/>
      <geom name="bumper" type="cylinder" pos="{xml(0, 0, robot.bumper_height)}"
            size="{xml(robot.bumper_radius, BUMPER_HALF_HEIGHT)}" group="{HIDDEN_GROUP}"/>
      <geom name="skirt" type="cylinder" size="{xml(robot.bumper_radius, SKIRT_HALF_HEIGHT)}"
            group="{HIDDEN_GROUP}"/>
      <geom type="cylinder" pos="{xml(0, 0, 0.05)}" size="{xml(robot.bumper_radius, 0.04)}"
            rgba="{ROBOT_COLOR}"/>
      <geom type="cylinder" pos="{xml(0, 0, half)}" size="{xml(0.6 * robot.bumper_radius, half)}"
            rgba="{ROBOT_COLOR}"/>
      {base.bodies}
    </body>""", pairs + base.pairs, base.actuators)


class Looks(NamedTuple):
    """
    What cameras and lidars see besides the robot.

    :param height: of the body of the object [m].
    :param object: what is on it, as of ``appearance.tags_part``.
    :param room: lights and floor, as of ``appearance.room_looks``.
    :param floor: attributes of the floor.
    :param files: contents of the files that they name.
    """

    height: float = OBJECT_HEIGHT
    object: Part = Part('')
    room: Part = Part('')
    floor: str = ''
    files: dict[str, bytes] | None = None


def wheeled_scene(robot: SimulatedRobot, room: Room, obj: PushedObject | None,
                  looks: Looks = Looks()) -> str:
    """Write the robot in a room, with an object; walls act from both sides."""
    parts = [robot_part(robot, len(room.walls)), looks.room, Part('', assets=looks.object.assets)]
    walls = walls_part(room, ENGINE, None)
    if obj is None:
        return scene_xml(ENGINE, *parts, Part(walls.bodies), floor=looks.floor)
    touch = Part('', pair('skirt', 'outline', obj.contact_friction_coefficient, BUMPER_CONTACT))
    body = prism(obj, 'body', 0.0, looks.height)
    shapes = (f'<geom name="body" {body.geom} group="{BODY_GROUP}" rgba="{OBJECT_COLOR}"/>'
              + looks.object.bodies)
    return scene_xml(ENGINE, *parts, walls, Part('', assets=body.assets),
                     object_part(obj, ENGINE, shapes), touch, floor=looks.floor)


class WheeledPlant:
    """
    The robot in MuJoCo, and an object that it pushes.

    ``robot``: the ``SimulatedRobot``. ``model`` and ``data``: those of MuJoCo.

    :param robot: ``SimulatedRobot``.
    :param room: walls that stop robot and object.
    :param obj: the ``PushedObject``; None for none.
    :param object_pose: ``Pose`` of the object's frame at first.
    :param robot_pose: ``Pose`` of the robot at first.
    :param looks: ``Looks``.
    """

    def __init__(self, robot: SimulatedRobot, room: Room = Room(),
                 obj: PushedObject | None = None, object_pose: Pose = Pose(1.0, 0.0, 0.0),
                 robot_pose: Pose = Pose(0.0, 0.0, 0.0), looks: Looks = Looks()) -> None:
        self.robot = robot
        self.model = _mujoco.MjModel.from_xml_string(wheeled_scene(robot, room, obj, looks),
                                                     looks.files)
        self.data = _mujoco.MjData(self.model)
        self._is_standing = robot.drive == 'differential'
        motors = self.model.actuator_trnid[:, 0]
        self._motor_dofs = self.model.jnt_dofadr[motors]
        # What motors add to the speeds that they are asked for, and at most [rad/s or m/s].
        self._added = np.zeros(len(motors))
        self._most_added = self.model.actuator_forcerange[:, 1] / self.model.actuator_gainprm[:, 0]
        self._robot_qpos = int(self.model.body('robot').jntadr[0])
        self._robot_qpos = int(self.model.jnt_qposadr[self._robot_qpos])
        self._robot_dof = int(self.model.body('robot').dofadr[0])
        self._set_robot_pose(robot_pose)
        if obj is not None:
            body = self.model.body('object')
            self._object_qpos = int(self.model.jnt_qposadr[body.jntadr[0]])
            self._object_dof = int(body.dofadr[0])
            self._settle(object_pose)
        _mujoco.mj_forward(self.model, self.data)

    def _set_robot_pose(self, pose: Pose) -> None:
        first = self._robot_qpos
        if self._is_standing:
            _place_free_body(self.data, first, pose)
        else:
            self.data.qpos[first:first + 3] = pose

    def _settle(self, pose: Pose) -> None:
        """Let the object sink to its rest on the soft floor."""
        self.set_object_pose(pose)
        for _ in range(round(SETTLING_TIME / ENGINE.step)):
            _mujoco.mj_step(self.model, self.data)
        # What has come to rest may have crept.
        self.set_object_pose(pose)

    def set_object_pose(self, pose: Pose) -> None:
        """
        Put the object elsewhere, at rest.

        :param pose: ``Pose`` of the object's frame in the world.
        """
        self.place_object(self.data, pose)
        self.data.qvel[self._object_dof:self._object_dof + 6] = 0.0

    def show_object(self, pose: Pose) -> None:
        """
        Put the object elsewhere, for images alone: no time passes.

        :param pose: ``Pose`` of the object's frame in the world.
        """
        self.set_object_pose(pose)
        _mujoco.mj_kinematics(self.model, self.data)

    def place_object(self, data: Any, pose: Pose) -> None:
        """
        Place the object in a state of the scene.

        :param data: of MuJoCo, is written.
        :param pose: ``Pose`` of the object's frame in the world.
        """
        _place_free_body(data, self._object_qpos, pose)

    def pair_index(self, one: str, other: str) -> int:
        """Look up the number of a pair of shapes that may touch."""
        pairs = zip(self.model.pair_geom1.tolist(), self.model.pair_geom2.tolist())
        shapes = {self.model.geom(one).id, self.model.geom(other).id}
        return next(index for index, touching in enumerate(pairs) if set(touching) == shapes)

    def drive(self, twist: Twist, step: float = ENGINE.step) -> None:
        """
        Let one step pass in which the motors hold the speeds of a twist.

        :param twist: of the robot, own axes, if nothing slips.
        :param step: [s].
        """
        if self._is_standing:
            left, right = wheel_speeds(twist, self.robot.track)
            speeds = np.array([left, right]) / self.robot.wheel_radius
        else:
            x, y = Pose(0.0, 0.0, self.pose.theta).rotate(twist[:2])
            speeds = np.array([x, y, twist.omega])
        errors = speeds - self.data.qvel[self._motor_dofs]
        self._added = np.clip(self._added + INTEGRAL_RATE * step * errors, -self._most_added,
                              self._most_added)
        self.data.ctrl[:] = speeds + self._added
        self.model.opt.timestep = step
        _mujoco.mj_step(self.model, self.data)

    def advance(self, duration: float, speed: float, yaw_rate: float) -> None:
        """
        Advance time while the speeds of the wheels follow a command.

        :param duration: how long [s].
        :param speed: of the robot ahead, if no wheel slips [m/s].
        :param yaw_rate: likewise [rad/s].
        """
        radius = self.robot.wheel_radius
        command = np.array(wheel_speeds(Twist(speed, 0.0, yaw_rate), self.robot.track)) / radius
        change = self.robot.max_acceleration * ENGINE.step / radius
        for _ in range(round(duration / ENGINE.step)):
            self.data.ctrl += np.clip(command - self.data.ctrl, -change, change)
            _mujoco.mj_step(self.model, self.data)

    @property
    def pose(self) -> Pose:
        """Pose of the robot in the world; the angle of a standing one within +-pi."""
        first = self._robot_qpos
        if self._is_standing:
            return planar_pose(self.data.qpos[first:first + 7])
        return Pose(*self.data.qpos[first:first + 3].tolist())

    @property
    def twist(self) -> Twist:
        """Velocity of the robot, own axes."""
        first, last = self._robot_dof, 5 if self._is_standing else 2
        v_x, v_y = self.data.qvel[first:first + 2].tolist()
        v_x, v_y = Pose(0.0, 0.0, -self.pose.theta).rotate((v_x, v_y))
        return Twist(float(v_x), float(v_y), float(self.data.qvel[first + last]))

    @property
    def object_pose(self) -> Pose:
        """Pose of the object's frame in the world; the angle within +-pi."""
        return planar_pose(self.data.qpos[self._object_qpos:self._object_qpos + 7])

    @property
    def object_twist(self) -> Twist:
        """Velocity of the object frame's origin, world axes, and yaw rate."""
        first = self._object_dof
        v_x, v_y, _, _, _, omega = self.data.qvel[first:first + 6].tolist()
        return Twist(v_x, v_y, omega)

    @property
    def wheel_angles(self) -> tuple[float, float]:
        """Angles by which the wheels (left, right) of a differential drive have turned [rad]."""
        left, right = (float(self.data.joint(name).qpos[0]) for name in ('left', 'right'))
        return left, right

    def normal_force(self, *shapes: str) -> float:
        """
        Sum the normal forces on shapes in the last step [N].

        :param shapes: their names, as 'bumper', which meets walls, and 'skirt', the object.
        """
        geoms = [self.model.geom(shape).id for shape in shapes]
        touched = np.isin(np.array(self.data.contact.geom).reshape(-1, 2), geoms).any(axis=1)
        total, force = 0.0, np.zeros(6)
        for index in np.flatnonzero(touched):
            _mujoco.mj_contactForce(self.model, self.data, int(index), force)
            total += float(force[0])
        return total


def _place_free_body(data: Any, first: int, pose: Pose) -> None:
    """Put a free body elsewhere on the floor: its coordinates begin at a number."""
    x, y, theta = pose
    data.qpos[first:first + 2] = x, y
    data.qpos[first + 3:first + 7] = math.cos(theta / 2), 0.0, 0.0, math.sin(theta / 2)


def pushing_force(robot: SimulatedRobot) -> float:
    """Drive against a wall until the wheels spin; return the mean force on it [N]."""
    plant = WheeledPlant(robot, Room((Wall(WALL_X, -1.0, WALL_X, 1.0),)))
    plant.advance(PUSHING_TIME, PUSHING_SPEED, 0.0)
    forces: list[float] = []
    for _ in range(round(PUSHING_TIME / ENGINE.step)):
        plant.advance(ENGINE.step, PUSHING_SPEED, 0.0)
        forces.append(plant.normal_force('bumper'))
    return float(np.mean(forces))
