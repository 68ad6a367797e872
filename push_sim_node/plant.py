"""The true object and the robot that pushes it."""

import math

import numpy as np
from push_model.geometry import Pose
from push_model.signals import STOP, Twist
from push_sim_node.kernel import layout as at
from push_sim_node.kernel.actuation import limit_command
from push_sim_node.kernel.compiled import IS_COMPILED, sequence
from push_sim_node.kernel.contact_law import nearest, surface_velocity
from push_sim_node.kernel.encoding import (
    body_numbers, drive_numbers, NO_OUTLINE, object_pose_of, object_twist_of, placed, start_state,
    support_rows,
)
from push_sim_node.kernel.floor import floor_rows, PATCH_SIZE
from push_sim_node.kernel.step import advance
from push_sim_node.truth import Energy, Truth


class Plant:
    """
    Round robot, point or fence against a rigid object on frictional supports.

    The robot is velocity-controlled: nothing that it touches slows it down. It starts at rest; a
    robot placed up to 5 mm into the object is moved back along the normal until it touches.

    :param obj: the true ``PushedObject``.
    :param robot: the true ``RoundRobot``.
    :param object_pose: ``Pose`` of the object frame in the world.
    :param robot_pose: ``Pose`` of the robot in the world.
    :param step: longest step [s].
    :param smoothing: speed below which support friction turns viscous [m/s].
    :param floor: ``FloorPatch`` sequence.
    :raises ValueError: where robot and object overlap by more than 5 mm.
    """

    def __init__(self, obj, robot, object_pose, robot_pose, step=2e-3, smoothing=1e-5, floor=()):
        self.obj, self.robot, self.step = obj, robot, step
        object_pose = Pose(*object_pose)
        robot_pose = placed(obj, robot, object_pose, Pose(*robot_pose))
        self._capacities = obj.capacities
        self._body = sequence(body_numbers(obj, robot, smoothing))
        self._outline = sequence(obj.outline or NO_OUTLINE)
        self._floor = sequence(np.reshape(floor_rows(floor), (-1, PATCH_SIZE)))
        self._drive = sequence(drive_numbers(robot))
        self._forces = sequence([0.0] * (2 * len(obj.supports)))
        self._state = sequence(start_state(obj, object_pose, robot_pose))
        self._command = STOP
        self._target = sequence(STOP)
        self.set_friction_factors([1.0] * len(obj.supports))
        self._compile()

    def set_friction_factors(self, factors):
        """
        Multiply the friction of the supports.

        :param factors: one factor for each support, of at least 0.
        """
        self._supports = sequence(support_rows(self.obj, self._capacities, factors))
        self._forget_acceleration()

    def set_object_pose(self, pose):
        """
        Put the object elsewhere, at rest, as a hand would; the robot goes on.

        :param pose: ``Pose`` of the object frame in the world.
        :raises ValueError: where it is not finite or the robot is in the way.
        """
        pose = Pose(*pose)
        robot_pose = self.robot_pose
        if placed(self.obj, self.robot, pose, robot_pose) != robot_pose:
            raise ValueError(f'pose: got {tuple(pose)}, expected one beside the robot')
        state = start_state(self.obj, pose, robot_pose)
        for i in range(at.X, at.P_X):
            self._state[i] = state[i]

    def advance(self, duration, command=STOP):
        """
        Let time pass while one command stands.

        :param duration: how long [s], above 0.
        :param command: ``Twist`` for the robot, its own axes; limits of the drive apply.
        :raises ValueError: where the command is not finite or not possible for the drive.
        """
        if not (math.isfinite(duration) and duration > 0.0):
            raise ValueError(f'duration: got {duration!r}, expected a finite time above 0 [s]')
        if command != self._command:
            self._target = sequence(limit_command(self.robot, command))
            self._command = command
            self._forget_acceleration()
        advance(self._state, self._body, self._supports, self._outline, self._floor,
                self._forces, self._target, self._drive, duration, self.step)

    @property
    def object_pose(self):
        """Pose of the object frame in the world; the angle is not wrapped."""
        return object_pose_of(self._state, self.obj.center_of_mass)

    @property
    def object_twist(self):
        """Velocity of the object frame's origin, world axes, and yaw rate."""
        return object_twist_of(self._state, self.obj.center_of_mass)

    @property
    def robot_pose(self):
        """Pose of the robot in the world; the angle is not wrapped."""
        return Pose(*self._numbers(at.P_X, at.PHI))

    @property
    def robot_twist(self):
        """Velocity of the robot, own axes."""
        return Twist(*self._numbers(at.U_X, at.U_OMEGA))

    @property
    def mode(self):
        """Contact mode over the last step, one of ``layout.MODES``."""
        return at.MODES[int(self._number(at.MODE))]

    @property
    def steps(self):
        """Number of steps since the start."""
        return int(self._number(at.STEPS))

    @property
    def unsolved_steps(self):
        """Number of steps whose velocities are off their equations by more than 0.1 mm/s."""
        return int(self._number(at.UNSOLVED))

    @property
    def energy(self):
        """``Energy`` since the start."""
        v_x, v_y, omega = self._numbers(at.V_X, at.OMEGA)
        kinetic = 0.5 * (self.obj.mass * (v_x * v_x + v_y * v_y)
                         + self.obj.inertia * omega * omega)
        work, *losses = (self._number(i) for i in (at.WORK, at.SUPPORT_LOSS, at.CONTACT_LOSS,
                                                   at.IMPACT_LOSS))
        return Energy(work, kinetic, *losses)

    def truth(self, time):
        """
        Sample everything at once.

        :param time: simulated time that the sample carries [s].
        :return: ``Truth``.
        """
        robot, twist = self.robot_pose, self.robot_twist
        pose = self.object_pose
        n_x, n_y, c_x, c_y, gap = nearest(self._outline, self.obj.radius, self.robot.radius,
                                          *pose, *robot)
        mode = self.mode
        forces = tuple((float(x), float(y))
                       for x, y in zip(self._forces[::2], self._forces[1::2]))
        angle = math.nan
        if mode != 'separate':
            v_x, v_y = robot.rotate(twist)
            normal, tangential = surface_velocity(
                self.robot.radius, n_x, n_y, c_x - robot.x, c_y - robot.y, v_x, v_y, twist.omega)
            if normal != 0.0 or tangential != 0.0:
                angle = math.atan2(tangential, normal)
        return Truth(time, pose, self.object_twist, robot, twist, mode, (c_x, c_y),
                     math.atan2(n_y, n_x), gap, angle, self._number(at.FORCE_N),
                     self._number(at.FORCE_T), forces, self.energy)

    def _compile(self):
        # Seconds where no machine code is kept on disk: better here than while time runs.
        if not IS_COMPILED or advance.signatures:
            return
        self.truth(0.0)
        advance(sequence(self._state), self._body, sequence(self._supports), self._outline,
                self._floor, sequence(self._forces), self._target, self._drive, self.step,
                self.step)

    def _forget_acceleration(self):
        for i in (at.A_X, at.A_Y, at.A_OMEGA):
            self._state[i] = 0.0

    def _number(self, index):
        return float(self._state[index])

    def _numbers(self, first, last):
        return tuple(map(float, self._state[first:last + 1]))
