"""
Scenes of MuJoCo, written part by part: a floor, walls, an object on small feet, and its pusher.

Only the pairs of shapes that a part names touch. What only cameras see is in ``appearance``.
"""

import dataclasses
import math
from typing import NamedTuple

import numpy as np
from push_dynamics.walls import Wall
from push_model.geometry import Coordinates, FloatArray, Pose
from push_model.parameters import GRAVITY, PushedObject, RoundRobot

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
# Thickness of a wall that acts from both sides [m]; chosen: its faces are where its line is.
THIN_WALL = 0.002
# Groups of shapes: what lidars may see beside walls, and what touches and no camera sees.
BODY_GROUP, HIDDEN_GROUP = 2, 3
# Time that the object gets to sink to its rest on the soft floor [s]; chosen: many time constants.
SETTLING_TIME = 0.5
SolverParameters = tuple[float, float]


class Contact(NamedTuple):
    """
    How a contact yields.

    :param solref: (time constant [s], damping ratio) of the normal force.
    :param friction_solref: the same for friction; (0, 0): that of the normal force.
    :param impedance: (at first touch, 1 mm deep).
    :param margin: distance at which it becomes active [m].
    """

    solref: SolverParameters
    friction_solref: SolverParameters
    impedance: SolverParameters
    margin: float = 0.0


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
        the object follows its height, one far above keeps its own, and rubs upwards too. MuJoCo
        softens a contact by the inverse masses of its bodies, averaged over directions. So a light
        bumper sinks into the object, unless ``bumper_impedance`` is close to 1.
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

    @property
    def foot_contact(self) -> Contact:
        """Contact of a foot and the floor."""
        return Contact(self.floor, self.floor_friction, self.floor_impedance, self.margin)

    @property
    def outline_contact(self) -> Contact:
        """Contact of the outline and what it meets: robot or wall."""
        return Contact(self.bumper, (0.0, 0.0), self.bumper_impedance, self.margin)


class Room(NamedTuple):
    """
    Walls.

    :param walls: ``Wall`` sequence, each solid behind the side on which the object starts.
    :param friction: coefficient between them and the object.
    """

    walls: tuple[Wall, ...] = ()
    friction: float = 0.3


DEFAULT = Engine()
# The same with a bumper that keeps its height, and with a round cone besides: on the default
# pyramid friction depends on the direction in the world.
HEAVY_BUMPER = dataclasses.replace(DEFAULT, bumper_mass=BASE_MASS)
ELLIPTIC = dataclasses.replace(HEAVY_BUMPER, cone='elliptic')
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


def planar_pose(coordinates: FloatArray) -> Pose:
    """
    Take the pose on the floor from the coordinates of a free body.

    :param coordinates: position and quaternion, shape (7,) [m, -].
    """
    x, y, _, w, _, _, z = coordinates.tolist()
    return Pose(x, y, 2.0 * math.atan2(z, w))


class Shape(NamedTuple):
    """
    XML of a shape.

    :param geom: attributes of the shape.
    :param assets: meshes that it is made of.
    """

    geom: str
    assets: str = ''


def prism(obj: PushedObject, name: str, low: float, high: float) -> Shape:
    """
    Write the body above the outline, between two heights.

    It is a box for a rectangle along the axes, a cylinder for a disc, else a mesh.

    :param name: of the mesh.
    :param low: lower end [m].
    :param high: upper end [m].
    """
    half, middle = (high - low) / 2, (high + low) / 2
    if obj.radius:
        return Shape(f'type="cylinder" size="{xml(obj.radius, half)}" pos="{xml(0, 0, middle)}"')
    corner, opposite = np.min(obj.outline, axis=0), np.max(obj.outline, axis=0)
    if len(obj.outline) == 4 and np.isin(obj.outline, [corner, opposite]).all():
        size, center = (opposite - corner) / 2, (opposite + corner) / 2
        return Shape(f'type="box" size="{xml(*size, half)}" pos="{xml(*center, middle)}"')
    vertices = [coordinate for z in (low, high) for vertex in obj.outline
                for coordinate in (*vertex, z)]
    return Shape(f'type="mesh" mesh="{name}"', f'<mesh name="{name}" vertex="{xml(*vertices)}"/>')


def pair(one: str, other: str, mu: float, contact: Contact) -> str:
    """Write a pair of shapes that may touch."""
    return (f'<pair geom1="{one}" geom2="{other}" condim="3" friction="{xml(mu, mu, 0, 0, 0)}"'
            f' solref="{xml(*contact.solref)}" solreffriction="{xml(*contact.friction_solref)}"'
            f' solimp="{xml(*contact.impedance, 1e-3, 0.5, 2)}" margin="{contact.margin}"/>')


def wall_geom(name: str, wall: Wall, origin: Coordinates | None) -> str:
    """
    Write a wall: a block with one face on the segment, behind it, or a thin one along it.

    :param origin: (x, y) of the object, which tells the side [m]; None: it acts from both.
    """
    length = math.hypot(wall.end_x - wall.start_x, wall.end_y - wall.start_y)
    angle = math.atan2(wall.end_y - wall.start_y, wall.end_x - wall.start_x)
    frame = Pose(wall.start_x, wall.start_y, angle)
    half, side = THIN_WALL / 2, 0.0
    if origin is not None:
        half = WALL_THICKNESS / 2
        side = math.copysign(half, frame.inverse().transform(origin[:2])[1])
    x, y = frame.transform((length / 2, -side))
    return (f'<geom name="{name}" type="box" pos="{xml(x, y, WALL_HEIGHT / 2)}" '
            f'euler="{xml(0, 0, math.degrees(angle))}" '
            f'size="{xml(length / 2, half, WALL_HEIGHT / 2)}"/>')


class Part(NamedTuple):
    """
    XML of a part of a scene.

    :param bodies: bodies, or shapes that stand still.
    :param pairs: of shapes that may touch.
    :param actuators: motors.
    :param assets: meshes, textures and materials.
    """

    bodies: str
    pairs: str = ''
    actuators: str = ''
    assets: str = ''


def object_part(obj: PushedObject, engine: Engine, looks: str = '') -> Part:
    """
    Write the object, a free body on its feet; its outline is the shape 'outline'.

    :param looks: shapes of it that only cameras and lidars see.
    """
    outline = prism(obj, 'outline', obj.contact_height - HALF_HEIGHT,
                    obj.contact_height + HALF_HEIGHT)
    feet = ''.join(f'<geom name="foot{i}" type="sphere" size="{FOOT_RADIUS}" '
                   f'pos="{xml(foot.x, foot.y, FOOT_RADIUS)}"/>'
                   for i, foot in enumerate(obj.supports))
    pairs = ''.join(pair('floor', f'foot{i}', foot.friction_coefficient, engine.foot_contact)
                    for i, foot in enumerate(obj.supports))
    inertia = xml(obj.inertia, obj.inertia, obj.inertia)
    center = xml(*obj.center_of_mass, obj.center_of_mass_height)
    return Part(f"""
    <body name="object">
      <freejoint/>
      <inertial pos="{center}" mass="{obj.mass}" diaginertia="{inertia}"/>
      <geom name="outline" {outline.geom} group="{HIDDEN_GROUP}"/>{feet}{looks}
    </body>""", pairs, assets=outline.assets)


def pusher_part(obj: PushedObject, robot: RoundRobot, engine: Engine) -> Part:
    """Write the robot as a cylinder that goes where it is sent, with a skin that may rise."""
    cylinder = xml(robot.radius - engine.margin, ROBOT_HALF_HEIGHT)
    bumper_inertia = xml(*3 * [engine.bumper_mass])
    return Part(f"""
    <body name="robot" gravcomp="1">
      <inertial pos="0 0 0" mass="{BASE_MASS}" diaginertia="{xml(*3 * [BASE_MASS])}"/>
      <joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 1 0"/>
      <joint type="hinge" axis="0 0 1"/>
      <body gravcomp="1">
        <inertial pos="0 0 0" mass="{engine.bumper_mass}" diaginertia="{bumper_inertia}"/>
        <joint type="slide" axis="0 0 1" damping="{engine.bumper_mass}"/>
        <geom name="robot" type="cylinder" size="{cylinder}"/>
      </body>
    </body>""", pair('robot', 'outline', obj.contact_friction_coefficient,
                     engine.outline_contact))


def walls_part(room: Room, engine: Engine, origin: Coordinates | None) -> Part:
    """
    Write walls that stop the object.

    :param origin: as of ``wall_geom``.
    """
    return Part(
        ''.join(wall_geom(f'wall{i}', wall, origin) for i, wall in enumerate(room.walls)),
        ''.join(pair(f'wall{i}', 'outline', room.friction, engine.outline_contact)
                for i in range(len(room.walls))))


def scene_xml(engine: Engine, *parts: Part, floor: str = '') -> str:
    """
    Write a scene of a floor and parts; the joints follow the order of the parts.

    :param floor: attributes of how the floor looks.
    """
    return f"""
<mujoco>
  <option timestep="{engine.step}" cone="{engine.cone}" impratio="{engine.impratio}"
          tolerance="{engine.tolerance}" iterations="{engine.iterations}"
          gravity="{xml(*engine.gravity)}"/>
  <statistic extent="1"/>
  <visual>
    <headlight ambient="0.5 0.5 0.5" diffuse="0.3 0.3 0.3" specular="0 0 0"/>
    <map znear="0.01" zfar="60"/>
  </visual>
  <asset>{''.join(part.assets for part in parts)}</asset>
  <default><geom contype="0" conaffinity="0"/></default>
  <worldbody>
    <geom name="floor" type="plane" size="9 9 1"{floor}/>{''.join(part.bodies for part in parts)}
  </worldbody>
  <contact>{''.join(part.pairs for part in parts)}</contact>
  <actuator>{''.join(part.actuators for part in parts)}</actuator>
</mujoco>"""
