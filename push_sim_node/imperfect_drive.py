"""
From command to motion of a base that is not ideal, the same for every plant.

A command passes, in this order, the dead time, what scales or smooths commands on the way, the
step of speeds, the least speed of wheels that turn, the wheels themselves, lag and acceleration
limits, a least speed behind them, the play of the wheels, and the floor, on which wheels may slip
and the robot may yaw on its tyres. Odometry counts what turns ahead of the play.
"""

from collections import deque
import math

from push_dynamics import actuation
from push_dynamics.compiled import interpreted
from push_dynamics.encoding import drive_values
from push_model.geometry import Pose
from push_model.parameters import RoundRobot
from push_model.signals import STOP, Twist
from push_model.wheels import twist_of_wheels, wheel_speeds
from push_sim_node.drive_imperfections import DriveImperfections

# Rounding of times [s]; chosen: far below any step.
TIME_ROUNDING = 1e-9
# Time over which the force is averaged by which wheels creep [s]; chosen: above the steps of the
# plants, so that force and creep cannot excite each other, and below that of any motion.
CREEP_TIME = 0.05
# Time constant with which a robot yaws on its tyres [s]; chosen likewise.
YAW_TIME = 0.05
# Single calls are not worth compiling them.
track_command = interpreted(actuation.track_command)
chord_velocity = interpreted(actuation.chord_velocity)


def is_ideal(robot: RoundRobot, imperfections: DriveImperfections) -> bool:
    """Tell whether a base follows its commands with lag and limits alone."""
    stated = robot.dead_time, robot.min_speed, robot.min_yaw_rate, robot.speed_step
    return (not any(stated) and math.isinf(robot.max_push_force)
            and imperfections == DriveImperfections())


class ImperfectDrive:
    """
    Moves a base, step by step.

    ``odometry_pose``: ``Pose`` by what the wheels turned, its angle not wrapped.
    ``odometry_twist``: ``Twist`` by what they turn.
    """

    def __init__(self, robot: RoundRobot, imperfections: DriveImperfections, pose: Pose,
                 object_mass: float) -> None:
        """
        Start at rest.

        :param pose: of the robot.
        :param object_mass: mass of what it pushes [kg].
        """
        self._robot = robot
        self._faults = imperfections
        self._drive = drive_values(robot)
        self._smoother = (0.0, imperfections.smoother_acceleration,
                          imperfections.smoother_yaw_acceleration)
        self.set_object_mass(object_mass)
        self._time = 0.0
        # Commands under way, with the times from which on they act [s].
        self._pending: deque[tuple[float, Twist]] = deque()
        self._arrived = self._smoothed = self._velocity = STOP
        # Which wheels, or translation and rotation, turn by their commands; speed by which the
        # wheels spin, in translation and rotation [m/s]; force that the wheels creep by [N]; angle
        # by which the robot has yawed on its tyres [rad], and its rate [rad/s].
        self._turns = [False, False]
        self._spin = self._yaw_spin = 0.0
        # Speed by which the load slows the motors down [m/s].
        self._stall = 0.0
        self._force = 0.0
        self._deflection = self._yaw_rate = 0.0
        # Way of each wheel, or axis, from the backward end of its play [m].
        self._in_play = [imperfections.play] * 3
        self.odometry_pose = pose
        self.odometry_twist = STOP

    def set_object_mass(self, mass: float) -> None:
        """
        Let the base push another object.

        :param mass: of it [kg].
        """
        self._mass = self._faults.robot_mass + mass

    def command(self, twist: Twist) -> None:
        """
        Send a command, which acts after the dead time.

        :param twist: ``Twist`` within the limits of the drive.
        """
        self._pending.append((self._time + self._robot.dead_time, twist))

    def step(self, dt: float, force: tuple[float, float], moment: float = 0.0) -> Twist:
        """
        Let the base move.

        :param dt: duration, that of a step of the plant [s].
        :param force: of the object on the robot (x, y) in the last step, own axes [N].
        :param moment: of that force about the centre of the robot [N m].
        :return: mean ``Twist`` of the robot in this step.
        """
        self._time += dt
        followed = track_command(*self._velocity, self._asked_of_drive(dt), self._drive, dt)
        self._velocity = Twist(*followed[:3])
        mean = self._stalled(self._moving_part(Twist(*followed[3:])), force, dt)
        v_x, v_y = chord_velocity(self.odometry_pose.theta, *mean, dt)
        pose = self.odometry_pose
        self.odometry_pose = Pose(pose.x + v_x * dt, pose.y + v_y * dt,
                                  pose.theta + mean.omega * dt)
        self.odometry_twist = mean
        moved = self._on_floor(self._after_play(mean, dt), force, moment, dt)
        return self._on_tyres(moved, moment, dt)

    def _asked_of_drive(self, dt: float) -> Twist:
        """Return what the motors are asked for: the command as it arrives."""
        while (self._pending
               and self._pending[0][0] <= self._time - dt + TIME_ROUNDING):
            self._arrived = self._pending.popleft()[1]
        asked = self._scaled(self._arrived)
        if math.isfinite(min(self._smoother[1:])):
            asked = Twist(*track_command(*self._smoothed, asked, self._smoother, dt)[:3])
            self._smoothed = asked
        return self._by_wheels(asked)

    def _scaled(self, twist: Twist) -> Twist:
        """Scale a command by what acts now."""
        faults, time = self._faults, self._time
        factor = 1.0 - faults.sag * min(1.0, time / faults.sag_time)
        for interval in faults.speed_factors:
            if interval.start <= time < interval.end:
                factor *= interval.factor
        return twist if factor == 1.0 else Twist(*(factor * value for value in twist))

    def _by_wheels(self, twist: Twist) -> Twist:
        """Let wheels round and stick."""
        robot = self._robot
        if robot.drive == 'differential':
            left, right = wheel_speeds(twist, robot.wheel_track)
            turning = (self._turning(0, left, robot.min_speed, robot.speed_step),
                       self._turning(1, right, robot.min_speed, robot.speed_step))
            factor = self._faults.left_wheel_factor
            if turning == (left, right) and factor == 1.0:
                return twist
            return twist_of_wheels(factor * turning[0], turning[1], robot.wheel_track)
        speed = math.hypot(twist.v_x, twist.v_y)
        moving = self._turning(0, speed, robot.min_speed, robot.speed_step)
        ratio = moving / speed if speed > 0.0 else 0.0
        return Twist(ratio * twist.v_x, ratio * twist.v_y,
                     self._turning(1, twist.omega, robot.min_yaw_rate,
                                   robot.speed_step / (0.5 * robot.wheel_track)))

    def _turning(self, index: int, speed: float, least: float, step: float) -> float:
        """Return the speed with which a wheel is driven."""
        if step > 0.0:
            speed = step * round(speed / step)
        threshold = least if self._turns[index] else least * self._faults.start_ratio
        self._turns[index] = abs(speed) >= threshold and speed != 0.0
        return speed if self._turns[index] else 0.0

    def _moving_part(self, twist: Twist) -> Twist:
        """Let rest what is slower behind the lag than it can be."""
        faults, robot = self._faults, self._robot
        if not (faults.output_min_speed or faults.output_min_yaw_rate):
            return twist
        if robot.drive == 'differential':
            left, right = (speed if abs(speed) >= faults.output_min_speed else 0.0
                           for speed in wheel_speeds(twist, robot.wheel_track))
            return twist_of_wheels(left, right, robot.wheel_track)
        is_moving = math.hypot(twist.v_x, twist.v_y) >= faults.output_min_speed
        omega = twist.omega if abs(twist.omega) >= faults.output_min_yaw_rate else 0.0
        return Twist(twist.v_x, twist.v_y, omega) if is_moving else Twist(0.0, 0.0, omega)

    def _stalled(self, twist: Twist, force: tuple[float, float], dt: float) -> Twist:
        """Let the wheels turn no faster than the load allows."""
        if math.isinf(self._faults.stall_force):
            return twist
        speed = math.hypot(twist.v_x, twist.v_y)
        resistance = -(force[0] * twist.v_x + force[1] * twist.v_y) / speed if speed else 0.0
        self._stall = self._slowed(self._stall, speed, resistance - self._faults.stall_force, dt)
        ratio = 1.0 - self._stall / speed if speed else 1.0
        return Twist(ratio * twist.v_x, ratio * twist.v_y, twist.omega)

    def _after_play(self, twist: Twist, dt: float) -> Twist:
        """Let wheels, or axes, go through their play where they reverse."""
        if self._faults.play == 0.0:
            return twist
        track = self._robot.wheel_track
        if self._robot.drive == 'differential':
            left, right = wheel_speeds(twist, track)
            return twist_of_wheels(self._taken_up(0, left, dt), self._taken_up(1, right, dt),
                                   track)
        return Twist(self._taken_up(0, twist.v_x, dt), self._taken_up(1, twist.v_y, dt),
                     self._taken_up(2, 0.5 * track * twist.omega, dt) / (0.5 * track))

    def _taken_up(self, index: int, speed: float, dt: float) -> float:
        """Return the speed that is passed on, after what the play takes up."""
        reached = self._in_play[index] + speed * dt
        self._in_play[index] = min(self._faults.play, max(0.0, reached))
        return (reached - self._in_play[index]) / dt

    def _on_floor(self, twist: Twist, force: tuple[float, float], moment: float,
                  dt: float) -> Twist:
        """Let the wheels slip by the force that the robot pushes with."""
        speed, arm = math.hypot(twist.v_x, twist.v_y), 0.5 * self._robot.wheel_track
        resistance = -(force[0] * twist.v_x + force[1] * twist.v_y) / speed if speed else 0.0
        limit = self._robot.max_push_force
        self._spin = self._slowed(self._spin, speed, resistance - limit, dt)
        self._yaw_spin = self._slowed(
            self._yaw_spin, arm * abs(twist.omega),
            -math.copysign(1.0, twist.omega) * moment / arm - limit, dt)
        if speed > 0.0:
            self._force += min(1.0, dt / CREEP_TIME) * (max(0.0, resistance) - self._force)
        creep = self._faults.wheel_creep * self._force
        slip = min(1.0, self._spin / speed + creep) if speed > 0.0 else 0.0
        yaw_slip = self._yaw_spin / (arm * abs(twist.omega)) if twist.omega else 0.0
        if slip == yaw_slip == 0.0:
            return twist
        return Twist((1.0 - slip) * twist.v_x, (1.0 - slip) * twist.v_y,
                     (1.0 - yaw_slip) * twist.omega)

    def _slowed(self, lost: float, speed: float, excess: float, dt: float) -> float:
        """
        Return the speed that wheels lose, at most their own.

        Beyond its greatest force the robot slows down with the object, as one mass.

        :param lost: what they have lost until now [m/s].
        :param excess: resistance beyond that force [N].
        """
        return min(speed, max(0.0, lost + dt * excess / self._mass))

    def _on_tyres(self, twist: Twist, moment: float, dt: float) -> Twist:
        """Let the robot yaw by the moment of the contact, as by a spring."""
        if math.isinf(self._faults.yaw_stiffness):
            return twist
        # A spring with inertia, critically damped: without inertia it would yaw so fast that
        # friction at the contact changes its side at every step.
        missing = moment / self._faults.yaw_stiffness - self._deflection
        self._yaw_rate += dt / YAW_TIME * (missing / YAW_TIME - 2.0 * self._yaw_rate)
        self._deflection += dt * self._yaw_rate
        return twist._replace(omega=twist.omega + self._yaw_rate)
