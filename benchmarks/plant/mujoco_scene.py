"""
The same push in MuJoCo: an object on small feet, and a velocity-controlled cylinder.

Everything that acts between the bodies acts at floor height, the mass centre too: there the plane
model and a spatial engine must agree, as no load moves from foot to foot.
"""

import dataclasses
import math

import mujoco
import numpy as np
from push_model.geometry import Pose
from push_sim_node.kernel.actuation import chord_velocity, limit_command, track_command

FOOT = 0.005
HALF_HEIGHT = 0.002
IMMOVABLE = 1e6
SKIN = 1e-3
TALL = 0.2


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
    :param floor_impedance: of the feet (at first touch, 1 mm deep).
    :param bumper_impedance: of the contact of robot and object.
    :param cone: 'elliptic' or 'pyramidal'.
    :param tolerance: of the solver.
    :param iterations: most iterations of the solver.
    """

    step: float = 1e-3
    impratio: float = 1.0
    floor: tuple = (0.02, 1.0)
    floor_friction: tuple = (0.0, 0.0)
    bumper: tuple = (0.02, 1.0)
    margin: float = 0.0
    floor_impedance: tuple = (0.9, 0.95)
    bumper_impedance: tuple = (0.9, 0.95)
    cone: str = 'pyramidal'
    tolerance: float = 1e-8
    iterations: int = 100


EXACT = {'cone': 'elliptic', 'tolerance': 1e-10}
DEFAULT = Engine()
HARD = Engine(step=5e-4, impratio=10.0, floor=(0.002, 1.0), bumper=(0.002, 1.0),
              floor_impedance=(0.999, 0.999), bumper_impedance=(0.999, 0.999), **EXACT)
TUNED = Engine(step=2.5e-4, impratio=10.0, floor=(0.02, 1.0), floor_friction=(0.1, 1.0),
               bumper=(0.004, 1.0), margin=0.001, floor_impedance=(0.3, 0.3),
               bumper_impedance=(0.9999, 0.9999), **EXACT)


def words(*numbers):
    """Write numbers as an XML attribute."""
    return ' '.join(f'{number:.12g}' for number in numbers)


def outline_geom(obj):
    """Write the outline: a box for a rectangle about the frame's axes, a cylinder for a disc."""
    if obj.radius:
        return f'type="cylinder" size="{words(obj.radius, HALF_HEIGHT)}"'
    low, high = np.min(obj.outline, axis=0), np.max(obj.outline, axis=0)
    if len(obj.outline) != 4 or not np.isin(obj.outline, [low, high]).all():
        raise ValueError(f'outline: got {obj.outline}, expected a rectangle along the axes')
    size, middle = (high - low) / 2, (high + low) / 2
    return f'type="box" size="{words(*size, HALF_HEIGHT)}" pos="{words(*middle, 0)}"'


def pair(one, other, mu, solref, friction_solref, impedance, margin):
    """Write a pair of shapes that touch."""
    return (f'<pair geom1="{one}" geom2="{other}" condim="3" friction="{words(mu, mu, 0, 0, 0)}"'
            f' solref="{words(*solref)}" solreffriction="{words(*friction_solref)}"'
            f' solimp="{words(*impedance, 1e-3, 0.5, 2)}" margin="{margin}"/>')


def scene_xml(obj, robot, engine):
    """Write the scene; only the pairs named in it touch."""
    feet = ''.join(f'<geom name="foot{i}" type="sphere" size="{FOOT}" '
                   f'pos="{words(foot.x, foot.y, FOOT)}"/>'
                   for i, foot in enumerate(obj.supports))

    pairs = ''.join(
        pair('floor', f'foot{i}', foot.friction_coefficient, engine.floor,
             engine.floor_friction, engine.floor_impedance, engine.margin)
        for i, foot in enumerate(obj.supports))
    pairs += pair('robot', 'outline', obj.contact_friction_coefficient, engine.bumper,
                  (0.0, 0.0), engine.bumper_impedance, engine.margin)
    inertia = words(obj.inertia, obj.inertia, obj.inertia)
    return f"""
<mujoco>
  <option timestep="{engine.step}" cone="{engine.cone}" impratio="{engine.impratio}"
          tolerance="{engine.tolerance}" iterations="{engine.iterations}" gravity="0 0 -9.81"/>
  <default><geom contype="0" conaffinity="0"/></default>
  <worldbody>
    <geom name="floor" type="plane" size="9 9 1"/>
    <body name="object">
      <freejoint/>
      <inertial pos="{words(*obj.center_of_mass, 0)}" mass="{obj.mass}" diaginertia="{inertia}"/>
      <geom name="outline" {outline_geom(obj)}/>{feet}
    </body>
    <body name="robot">
      <inertial pos="0 0 0" mass="{IMMOVABLE}" diaginertia="{words(*3 * [IMMOVABLE])}"/>
      <joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 1 0"/>
      <joint type="hinge" axis="0 0 1"/>
      <body gravcomp="1">
        <inertial pos="0 0 0" mass="{SKIN}" diaginertia="{words(*3 * [SKIN])}"/>
        <joint type="slide" axis="0 0 1" damping="{SKIN}"/>
        <geom name="robot" type="cylinder" size="{words(robot.radius - engine.margin, TALL)}"/>
      </body>
    </body>
  </worldbody>
  <contact>{pairs}</contact>
</mujoco>"""


class Rival:
    """
    The plant's interface, by MuJoCo.

    :param obj: the ``PushedObject``; its outline a disc or a rectangle along the axes, its load
        shares those that equal feet would take.
    :param robot: the ``RoundRobot``; its drive is the plant's.
    :param object_pose: ``Pose`` of the object frame.
    :param robot_pose: ``Pose`` of the robot.
    :param engine: ``Engine``.
    """

    def __init__(self, obj, robot, object_pose, robot_pose, engine=DEFAULT):
        self.engine, self.robot = engine, robot
        self.model = mujoco.MjModel.from_xml_string(scene_xml(obj, robot, engine))
        self.data = mujoco.MjData(self.model)
        self.drive = (robot.time_constant, robot.max_acceleration, robot.max_yaw_acceleration)
        self._settle()
        place = self.data.qpos
        place[0:2] = object_pose[:2]
        place[3:7] = math.cos(object_pose[2] / 2), 0.0, 0.0, math.sin(object_pose[2] / 2)
        place[7:10] = robot_pose
        self.twist, self.turns, self._last = (0.0, 0.0, 0.0), 0.0, object_pose[2]

    def _settle(self):
        """Let the object sink to its rest on the soft floor, far from the robot."""
        self.data.qpos[7:10] = 5.0, 5.0, 0.0
        mujoco.mj_step(self.model, self.data, int(round(0.5 / self.engine.step)))
        self.data.qvel[:] = 0.0
        self.data.qpos[:2] = 0.0

    def advance(self, duration, command, together=1):
        """
        Let time pass while one command stands.

        :param duration: how long [s].
        :param command: ``Twist`` for the robot, its own axes.
        :param together: steps between two settings of the robot's velocity.
        """
        command = limit_command(self.robot, command)
        count = int(round(duration / self.engine.step))
        data, h = self.data, self.engine.step
        while count > 0:
            steps = min(together, count)
            *self.twist, m_x, m_y, m_omega = track_command(*self.twist, command, self.drive,
                                                           steps * h)
            u_x, u_y = chord_velocity(data.qpos[9], m_x, m_y, m_omega, steps * h)
            data.qvel[6:9] = u_x, u_y, m_omega
            mujoco.mj_step(self.model, data, steps)
            count -= steps

    @property
    def object_pose(self):
        """Pose of the object frame in the world; the angle within +-pi."""
        w, _, _, z = self.data.qpos[3:7]
        return Pose(*self.data.qpos[:2], 2.0 * math.atan2(z, w))

    @property
    def robot_pose(self):
        """Pose of the robot in the world."""
        return Pose(*self.data.qpos[7:10])
