"""
The planar push in MuJoCo: an object on small feet, and a velocity-controlled cylinder.

Contact and mass centre are at the heights of the object, at floor height where it has none: there
no load shifts from foot to foot.
"""

import dataclasses
import math
from typing import Any, NamedTuple

import mujoco
import numpy as np
from push_dynamics.actuation import chord_velocity, limit_command, track_command
from push_dynamics.walls import Wall
from push_model.geometry import Coordinates, Pose
from push_model.parameters import GRAVITY, PushedObject, RoundRobot
from push_model.signals import Twist

# MuJoCo defines these in an extension module without type stubs.
_mujoco: Any = mujoco
# Shapes [m], chosen: radius of the spheres that stand for point supports; half the height of the
# outline, low as the contact has one height; half the height of the robot, well above any contact.
FOOT_RADIUS = 0.005
HALF_HEIGHT = 0.002
ROBOT_HALF_HEIGHT = 0.4
# Mass [kg] and inertia [kg m^2] of the robot's base, which no push may slow down; chosen: far
# above those of any object.
BASE_MASS = 1e6
# Thickness and height of a wall [m]; chosen: nothing passes it.
WALL_THICKNESS, WALL_HEIGHT = 0.1, 0.4
# Time that the object gets to sink to its rest on the soft floor [s]; chosen: many time constants.
SETTLING_TIME = 0.5
SolverParameters = tuple[float, float]


@dataclasses.dataclass(frozen=True)
class Engine:
    """
    Settings of MuJoCo.

    :param step: time step [s].
    :param impratio: ratio of friction to normal impedance.
    :param floor: (time constant [s], damping ratio) of the feet's normal contact.
    :param floor_friction: the same for their friction; (0, 0): that of the normal contact.
    :param bumper: the same for the contact of robot and object.
    :param margin: distance at which a contact becomes active [m]; the robot is drawn smaller by
        it, so that it pushes where it should.
    :param floor_impedance: of the feet, (at first touch, 1 mm deep).
    :param bumper_impedance: of the contact of robot and object.
    :param cone: 'elliptic' or 'pyramidal'.
    :param bumper_mass: mass, inertia and damping of the robot's bumper [kg]: one far below that of
        the object follows its height, one far above keeps its own, and rubs upwards too.
    :param tolerance: of the solver.
    :param iterations: limit on the iterations of the solver.
    :param gravity: in the axes of the floor, which slopes where it is not vertical [m/s^2].
    """

    step: float = 1e-3
    impratio: float = 1.0
    floor: SolverParameters = (0.02, 1.0)
    floor_friction: SolverParameters = (0.0, 0.0)
    bumper: SolverParameters = (0.02, 1.0)
    margin: float = 0.0
    floor_impedance: SolverParameters = (0.9, 0.95)
    bumper_impedance: SolverParameters = (0.9, 0.95)
    cone: str = 'pyramidal'
    bumper_mass: float = 1e-3
    tolerance: float = 1e-8
    iterations: int = 100
    gravity: tuple[float, float, float] = (0.0, 0.0, -GRAVITY)


class Room(NamedTuple):
    """
    Walls.

    :param walls: ``Wall`` sequence, each solid behind the side on which the object starts.
    :param friction: coefficient between them and the object.
    """

    walls: tuple[Wall, ...] = ()
    friction: float = 0.3


DEFAULT = Engine()
# Stiff contacts and an exact cone.
HARD = Engine(step=5e-4, impratio=10.0, floor=(0.002, 1.0), bumper=(0.002, 1.0),
              floor_impedance=(0.999, 0.999), bumper_impedance=(0.999, 0.999), cone='elliptic',
              tolerance=1e-10)
# Chosen for a small difference from the plant on ``comparison.PUSHES``, see
# docs/reports/mujoco.md.
TUNED = Engine(step=2.5e-4, impratio=10.0, floor=(0.02, 1.0), floor_friction=(0.1, 1.0),
               bumper=(0.004, 1.0), margin=0.001, floor_impedance=(0.3, 0.3),
               bumper_impedance=(0.9999, 0.9999), cone='elliptic', tolerance=1e-10)


def xml(*values: float) -> str:
    """Write numbers as an XML attribute."""
    return ' '.join(f'{value:.12g}' for value in values)


def outline_geom(obj: PushedObject) -> str:
    """Write the outline: a box for a rectangle about the frame's axes, a cylinder for a disc."""
    if obj.radius:
        return (f'type="cylinder" size="{xml(obj.radius, HALF_HEIGHT)}" '
                f'pos="{xml(0, 0, obj.contact_height)}"')
    low, high = np.min(obj.outline, axis=0), np.max(obj.outline, axis=0)
    if len(obj.outline) != 4 or not np.isin(obj.outline, [low, high]).all():
        raise ValueError(f'outline: got {obj.outline}, expected a rectangle along the axes')
    size, middle = (high - low) / 2, (high + low) / 2
    return f'type="box" size="{xml(*size, HALF_HEIGHT)}" pos="{xml(*middle, obj.contact_height)}"'


def pair(one: str, other: str, mu: float, margin: float, *, solref: SolverParameters,
         friction_solref: SolverParameters, impedance: SolverParameters) -> str:
    """Write a pair of shapes that may touch."""
    return (f'<pair geom1="{one}" geom2="{other}" condim="3" friction="{xml(mu, mu, 0, 0, 0)}"'
            f' solref="{xml(*solref)}" solreffriction="{xml(*friction_solref)}"'
            f' solimp="{xml(*impedance, 1e-3, 0.5, 2)}" margin="{margin}"/>')


def wall_geom(name: str, wall: Wall, origin: Coordinates) -> str:
    """
    Write a wall: a block with one face on the segment, behind it.

    :param origin: (x, y) of the object, which tells the side [m].
    """
    length = math.hypot(wall.end_x - wall.start_x, wall.end_y - wall.start_y)
    angle = math.atan2(wall.end_y - wall.start_y, wall.end_x - wall.start_x)
    frame = Pose(wall.start_x, wall.start_y, angle)
    side = math.copysign(WALL_THICKNESS / 2, frame.inverse().transform(origin[:2])[1])
    x, y = frame.transform((length / 2, -side))
    return (f'<geom name="{name}" type="box" pos="{xml(x, y, WALL_HEIGHT / 2)}" '
            f'euler="{xml(0, 0, math.degrees(angle))}" '
            f'size="{xml(length / 2, WALL_THICKNESS / 2, WALL_HEIGHT)}"/>')


def scene_xml(obj: PushedObject, robot: RoundRobot, engine: Engine, room: Room = Room(),
              origin: Coordinates = (0.0, 0.0)) -> str:
    """
    Write the scene; only the pairs named in it touch.

    :param origin: (x, y) of the object at first [m].
    """
    walls = ''.join(wall_geom(f'wall{i}', wall, origin) for i, wall in enumerate(room.walls))
    feet = ''.join(f'<geom name="foot{i}" type="sphere" size="{FOOT_RADIUS}" '
                   f'pos="{xml(foot.x, foot.y, FOOT_RADIUS)}"/>'
                   for i, foot in enumerate(obj.supports))
    pairs = ''.join(
        pair('floor', f'foot{i}', foot.friction_coefficient, engine.margin, solref=engine.floor,
             friction_solref=engine.floor_friction, impedance=engine.floor_impedance)
        for i, foot in enumerate(obj.supports))
    pairs += pair('robot', 'outline', obj.contact_friction_coefficient, engine.margin,
                  solref=engine.bumper, friction_solref=(0.0, 0.0),
                  impedance=engine.bumper_impedance)
    pairs += ''.join(
        pair(f'wall{i}', 'outline', room.friction, engine.margin, solref=engine.bumper,
             friction_solref=(0.0, 0.0), impedance=engine.bumper_impedance)
        for i in range(len(room.walls)))
    cylinder = xml(robot.radius - engine.margin, ROBOT_HALF_HEIGHT)
    inertia = xml(obj.inertia, obj.inertia, obj.inertia)
    center = xml(*obj.center_of_mass, obj.center_of_mass_height)
    bumper_inertia = xml(*3 * [engine.bumper_mass])
    return f"""
<mujoco>
  <option timestep="{engine.step}" cone="{engine.cone}" impratio="{engine.impratio}"
          tolerance="{engine.tolerance}" iterations="{engine.iterations}"
          gravity="{xml(*engine.gravity)}"/>
  <default><geom contype="0" conaffinity="0"/></default>
  <worldbody>
    <geom name="floor" type="plane" size="9 9 1"/>{walls}
    <body name="object">
      <freejoint/>
      <inertial pos="{center}" mass="{obj.mass}" diaginertia="{inertia}"/>
      <geom name="outline" {outline_geom(obj)}/>{feet}
    </body>
    <body name="robot" gravcomp="1">
      <inertial pos="0 0 0" mass="{BASE_MASS}" diaginertia="{xml(*3 * [BASE_MASS])}"/>
      <joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 1 0"/>
      <joint type="hinge" axis="0 0 1"/>
      <body gravcomp="1">
        <inertial pos="0 0 0" mass="{engine.bumper_mass}" diaginertia="{bumper_inertia}"/>
        <joint type="slide" axis="0 0 1" damping="{engine.bumper_mass}"/>
        <geom name="robot" type="cylinder" size="{cylinder}"/>
      </body>
    </body>
  </worldbody>
  <contact>{pairs}</contact>
</mujoco>"""


class MujocoPlant:
    """
    The plant in MuJoCo, with the interface of ``push_sim_node.plant.Plant``.

    :param obj: the ``PushedObject``; its outline a disc or a rectangle along the axes, its load
        shares those that equal feet would take.
    :param robot: the ``RoundRobot``; its drive is the plant's.
    :param object_pose: ``Pose`` of the object frame.
    :param robot_pose: ``Pose`` of the robot.
    :param engine: ``Engine``.
    :param steps_per_command: steps between two settings of the robot's velocity.
    :param room: walls that stop the object; the robot passes them.
    """

    def __init__(self, obj: PushedObject, robot: RoundRobot, object_pose: Pose, robot_pose: Pose,
                 engine: Engine = DEFAULT, *, steps_per_command: int = 1,
                 room: Room = Room()) -> None:
        self.engine = engine
        self.robot = robot
        self.steps_per_command = steps_per_command
        self.model = _mujoco.MjModel.from_xml_string(
            scene_xml(obj, robot, engine, room, object_pose))
        self.data = _mujoco.MjData(self.model)
        self.drive = (robot.time_constant, robot.max_acceleration, robot.max_yaw_acceleration)
        self._settle()
        self.set_object_pose(object_pose)
        self.data.qpos[7:10] = robot_pose
        self.twist = Twist()

    def _settle(self) -> None:
        """Let the object sink to its rest on the soft floor, far from the robot."""
        self.data.qpos[7:10] = 5.0, 5.0, 0.0
        _mujoco.mj_step(self.model, self.data, int(round(SETTLING_TIME / self.engine.step)))
        self.data.qvel[:] = 0.0
        self.data.qpos[:2] = 0.0

    def set_object_pose(self, pose: Pose) -> None:
        """
        Put the object elsewhere, at rest.

        :param pose: ``Pose`` of the object frame in the world.
        """
        self.data.qpos[0:2] = pose[:2]
        self.data.qpos[3:7] = math.cos(pose[2] / 2), 0.0, 0.0, math.sin(pose[2] / 2)
        self.data.qvel[0:6] = 0.0

    def advance(self, duration: float, command: Twist) -> None:
        """
        Advance time under a constant command.

        :param duration: how long [s].
        :param command: ``Twist`` for the robot, in its own axes.
        """
        command = limit_command(self.robot, command)
        count = int(round(duration / self.engine.step))
        data, h = self.data, self.engine.step
        while count > 0:
            steps = min(self.steps_per_command, count)
            v_x, v_y, omega, m_x, m_y, m_omega = track_command(
                self.twist.v_x, self.twist.v_y, self.twist.omega, command, self.drive, steps * h)
            self.twist = Twist(v_x, v_y, omega)
            u_x, u_y = chord_velocity(data.qpos[9], m_x, m_y, m_omega, steps * h)
            data.qvel[6:9] = u_x, u_y, m_omega
            _mujoco.mj_step(self.model, data, steps)
            count -= steps

    @property
    def object_pose(self) -> Pose:
        """Pose of the object frame in the world; the angle within +-pi."""
        x, y, _, w, _, _, z = self.data.qpos[:7].tolist()
        return Pose(x, y, 2.0 * math.atan2(z, w))

    @property
    def object_twist(self) -> Twist:
        """Velocity of the object frame's origin, world axes, and yaw rate."""
        v_x, v_y, _, _, _, omega = self.data.qvel[:6].tolist()
        return Twist(v_x, v_y, omega)

    @property
    def robot_pose(self) -> Pose:
        """Pose of the robot in the world."""
        x, y, theta = self.data.qpos[7:10].tolist()
        return Pose(x, y, theta)

    @property
    def force_on_robot(self) -> tuple[float, float]:
        """Force of the object on the robot (x, y) in the last step, world axes [N]."""
        # Of all constraints only the contact with the object acts on the joints of the robot.
        x, y = self.data.qfrc_constraint[6:8].tolist()
        return x, y

    @property
    def moment_on_robot(self) -> float:
        """Moment of the object on the robot about its axis in the last step [N m]."""
        return float(self.data.qfrc_constraint[8])
