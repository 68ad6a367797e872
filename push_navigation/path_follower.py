"""Feedback that keeps the robot on its way, by where it sees itself."""

import math

from push_model.geometry import distance, Pose, wrap_angle
from push_model.signals import STOP, Twist
from push_navigation.motion_section import FADE_TIME, MotionSection, split_at_stops, stopping_speed
from push_navigation.path import differential_path, holonomic_path, Path

# Way on which a differential drive comes back to its line.
RETURN = 0.15
ASTRAY = 0.6
SIDEWAYS = 0.1


def limit_command(before, wanted, limits, dt):
    """
    Bring a command within the limits, the change from the one before included.

    :param before: ``Twist`` that was commanded.
    :param wanted: ``Twist`` that is wanted.
    :param limits: ``DriveSettings`` within the limits of the robot.
    :param dt: time between the two [s].
    :return: ``Twist``.
    """
    x, y = wanted.v_x - before.v_x, wanted.v_y - before.v_y
    change = math.hypot(x, y)
    share = min(1.0, limits.acceleration * dt / change) if change else 0.0
    x, y = before.v_x + share * x, before.v_y + share * y
    excess = max(1.0, math.hypot(x, y) / limits.speed)
    step = limits.yaw_acceleration * dt
    omega = before.omega + min(step, max(-step, wanted.omega - before.omega))
    return Twist(x / excess, y / excess, min(limits.yaw_rate, max(-limits.yaw_rate, omega)))


def turn_in_place(left, limits):
    """
    Yaw rate of a turn on the spot [rad/s].

    :param left: angle left [rad].
    :param limits: ``DriveSettings`` within the limits of the robot.
    """
    rate = min(limits.yaw_rate, stopping_speed(abs(left), limits.yaw_acceleration))
    return math.copysign(rate, left)


def track_differential(run, pose, way, aside, limits):
    """
    Command of a differential drive: curvature by how far it is off, sideways and in heading.

    :param run: the ``MotionSection``.
    :param pose: ``Pose`` of the robot.
    :param way: how far it has come [m].
    :param aside: how far it is to the left of the run [m].
    :param limits: ``DriveSettings`` within the limits of the robot.
    :return: ``Twist``.
    """
    speed = run.speed(way)
    direction, curvature = run.smooth_direction(way, speed)
    off = wrap_angle(pose.theta + math.pi * run.is_backwards - direction)
    if abs(off) > ASTRAY:
        return Twist(0.0, 0.0, turn_in_place(-off, limits))
    aside = min(RETURN, max(-RETURN, aside))
    omega = max(0.0, speed) * (curvature - aside / RETURN ** 2 - 2.0 * math.sin(off) / RETURN)
    share = min(1.0, limits.yaw_rate / abs(omega)) if omega else 1.0
    return Twist(share * (-speed if run.is_backwards else speed), 0.0, share * omega)


def track_holonomic(run, pose, way, aside, limits):
    """
    Command of a holonomic base: along the run, back to it sideways, and turned as it should be.

    :param run: the ``MotionSection``.
    :param pose: ``Pose`` of the robot.
    :param way: how far it has come [m].
    :param aside: how far it is to the left of the run [m].
    :param limits: ``DriveSettings`` within the limits of the robot.
    :return: ``Twist``.
    """
    speed = run.speed(way)
    direction, _ = run.smooth_direction(way, speed)
    heading, turned = run.heading(way)
    across = min(SIDEWAYS, max(-SIDEWAYS, aside / FADE_TIME))
    x, y = Pose(0.0, 0.0, direction - pose.theta).rotate((speed, -across))
    return Twist(x, y, speed * turned + turn_in_place(wrap_angle(heading - pose.theta), limits))


POSITION_TOLERANCE = 0.003
HEADING_TOLERANCE = math.radians(0.6)
PATIENCE, DWELL = 0.4, 0.1
CLOSE, ALIGNED = 0.001, math.radians(0.2)


class PathFollower:
    """
    Commands along a way, one after the other.

    The robot starts at rest. Where it has come to the end and is not at the last pose, it goes
    there directly.

    :param robot: the ``RoundRobot``.
    :param settings: ``DriveSettings``.
    :param way: the ``Path``.
    """

    def __init__(self, robot, settings, way):
        self._robot, self._limits = robot, settings.limited_to(robot)
        self._goal = way.poses[-1]
        self._stretches = split_at_stops(way, self._limits)
        self._along, self._late, self._stood = 0.0, None, 0.0
        self._command, self._motion = STOP, STOP
        self.finished = False

    @property
    def remaining_distance(self):
        """Way left [m]."""
        runs = [stretch.length for stretch in self._stretches if isinstance(stretch, MotionSection)]
        first = isinstance(self._stretches[0], MotionSection) if self._stretches else False
        return max(0.0, sum(runs) - (self._along if first else 0.0))

    def step(self, pose, dt):
        """
        Compute the next command.

        :param pose: ``Pose`` of the robot in the world.
        :param dt: time since the last step [s].
        :return: ``Twist``.
        :raises ValueError: where the pose or the time is not finite.
        """
        if not Pose(*pose).is_finite():
            raise ValueError(f'pose: got {tuple(pose)}, expected finite numbers')
        if not (math.isfinite(dt) and dt >= 0.0):
            raise ValueError(f'dt: got {dt!r}, expected a finite time of at least 0 [s]')
        pose = Pose(*pose)
        ahead = self._ahead(pose, dt)
        wanted = STOP if self._arrived(pose, ahead, dt) else self._wanted(ahead, dt)
        self._command = limit_command(self._command, wanted, self._limits, dt)
        return self._command

    def _ahead(self, pose, dt):
        # Where a drive with a lag of one time constant is, for commands that begin now, as good
        # as one without.
        lag = self._robot.time_constant
        share = -math.expm1(-dt / lag) if lag else 1.0
        self._motion = Twist(*(moving + share * (commanded - moving)
                               for moving, commanded in zip(self._motion, self._command)))
        heading_change = self._motion.omega * lag
        x, y = pose._replace(theta=pose.theta + 0.5 * heading_change).rotate(self._motion)
        return Pose(pose.x + lag * x, pose.y + lag * y, pose.theta + heading_change)

    def _arrived(self, pose, ahead, dt):
        resting = self._command == STOP and not self._stretches
        self._stood = self._stood + dt if resting else 0.0
        self.finished = resting and self._is_there(pose) and self._is_there(ahead)
        if self._stood > PATIENCE and not self.finished:
            self._stretches = split_at_stops(self._directly(pose), self._limits)
        return not self._stretches

    def _is_there(self, pose):
        return (distance(pose, self._goal) <= POSITION_TOLERANCE
                and abs(wrap_angle(pose.theta - self._goal.theta)) <= HEADING_TOLERANCE)

    def _directly(self, pose):
        if distance(pose, self._goal) <= 0.5 * POSITION_TOLERANCE:
            return Path((pose, pose._replace(theta=self._goal.theta)))
        waypoints = [(self._goal.x, self._goal.y, 0.0)]
        if self._robot.drive == 'holonomic':
            return holonomic_path(pose, self._goal, waypoints)
        toward = math.atan2(self._goal.y - pose.y, self._goal.x - pose.x)
        return differential_path(pose, self._goal, waypoints, [math.cos(toward - pose.theta) < 0.0])

    def _wanted(self, ahead, dt):
        while self._stretches:
            stretch = self._stretches[0]
            law = self._along_run if isinstance(stretch, MotionSection) else self._turned
            wanted = law(stretch, ahead, dt)
            if wanted is not None:
                return wanted
            self._stretches.pop(0)
            self._along, self._late = 0.0, None
        return STOP

    def _turned(self, segment, ahead, dt):
        left = wrap_angle(segment.end.theta - ahead.theta)
        # A run that follows puts the heading right by itself.
        if self._settled(left, ALIGNED, dt) or len(self._stretches) > 1 and abs(left) < ALIGNED:
            return None
        return Twist(0.0, 0.0, turn_in_place(left, self._limits))

    def _along_run(self, run, ahead, dt):
        self._along, aside = run.locate(ahead)
        left = run.length - self._along
        holonomic = self._robot.drive == 'holonomic'
        if self._settled(complex(left, aside) if holonomic else left, CLOSE, dt):
            return None
        return (track_holonomic if holonomic else track_differential)(run, ahead, self._along, aside, self._limits)

    def _settled(self, left, tolerance, dt):
        # Not while it only passes by: what is left must have been little for a while.
        late = left if self._late is None else self._late
        self._late = late - math.expm1(-dt / DWELL) * (left - late)
        return abs(self._late) < tolerance and abs(left) < 2.0 * tolerance
