"""
Path follower: tracking laws for both drives, and the commands along a whole path.

The laws keep the robot on a section of its path by feedback of its pose. With e the lateral
offset to the left, d the heading error and kappa the curvature of the path, a differential drive
steers by

    omega = v (kappa - e / R^2 - 2 sin(d) / R)

which returns it to the path within a distance R, critically damped for small errors.

A path may end at a speed: the robot then passes its end and drives on, while whatever comes next
takes over.
"""

import math

from push_model.geometry import distance, Pose, wrap_angle
from push_model.parameters import RoundRobot
from push_model.signals import STOP, Twist
from push_navigation.path import (
    differential_path, holonomic_path, Path, PathSegment, Waypoint,
)
from push_navigation.settings import DriveSettings
from push_navigation.speed_profile import (
    FADE_TIME, MotionSection, split_at_stops, stopping_speed,
)

# R, distance on which a differential drive returns to its path [m]. Chosen: about the radius of a
# small robot; shorter ones respond to noise of its pose.
RETURN_DISTANCE = 0.15
# Heading error beyond which a differential drive first rotates in place [rad]. Chosen: where the
# linear law is no longer a good one.
MAX_HEADING_ERROR = 0.6
# Speed at which a holonomic base returns to its path, at most [m/s]. Chosen: slow against its
# speed along the path, so that it does not cut corners.
MAX_LATERAL_SPEED = 0.1
# At the goal within these. Chosen: a third of what a push asks of the robot's start.
POSITION_TOLERANCE = 0.003
HEADING_TOLERANCE = math.radians(0.6)
# A section is done within these of its end: a third of the tolerances at the goal.
SECTION_POSITION_TOLERANCE = 0.001
SECTION_HEADING_TOLERANCE = math.radians(0.2)
# It passes the end of a path rightly within these, across. Chosen: what a push allows its contact
# place and its direction to be off, with a margin of two over what is measured in the tests.
PASSING_POSITION_TOLERANCE = 0.01
PASSING_HEADING_TOLERANCE = math.radians(2.5)
# The predicted pose, a lag ahead, is at most so far behind the robot that passes the end [m].
# Chosen: above what feedback of a disturbed pose makes of it, far below a detour.
PASSING_RANGE = 0.05
# At rest for this long beside the goal, the robot drives there directly [s]. Chosen: several
# lags of a drive and periods of localization.
REST_TIMEOUT = 0.4
# Time constant of the filter that tells a stop from passing by [s]. Chosen: the usual lag.
DWELL = 0.1


def limit_command(previous: Twist, requested: Twist, limits: DriveSettings, dt: float) -> Twist:
    """
    Bring a command within the limits, the change from the previous one included.

    :param previous: ``Twist`` that was commanded.
    :param limits: ``DriveSettings`` within the limits of the robot.
    :param dt: time between the two [s].
    """
    x, y = requested.v_x - previous.v_x, requested.v_y - previous.v_y
    change = math.hypot(x, y)
    ratio = min(1.0, limits.acceleration * dt / change) if change else 0.0
    x, y = previous.v_x + ratio * x, previous.v_y + ratio * y
    excess = max(1.0, math.hypot(x, y) / limits.speed)
    step = limits.yaw_acceleration * dt
    omega = previous.omega + min(step, max(-step, requested.omega - previous.omega))
    return Twist(x / excess, y / excess, min(limits.yaw_rate, max(-limits.yaw_rate, omega)))


def keep_curvature(previous: Twist, requested: Twist, limits: DriveSettings, dt: float) -> Twist:
    """
    Speed up no faster than the yaw rate can follow, so that the curvature is kept.

    :param previous: ``Twist`` that was commanded.
    :param requested: ``Twist`` of a differential drive.
    :param limits: ``DriveSettings`` within the limits of the robot.
    :param dt: time between the two [s].
    """
    reached = (math.copysign(1.0, requested.omega) * previous.omega
               + limits.yaw_acceleration * dt)
    rises = requested.v_x * previous.v_x >= 0.0 and reached < abs(requested.omega)
    if requested.omega == 0.0 or not rises:
        return requested
    speed = max(abs(previous.v_x), abs(requested.v_x) * max(0.0, reached / abs(requested.omega)))
    return requested._replace(v_x=math.copysign(min(abs(requested.v_x), speed), requested.v_x))


def turn_in_place(remaining: float, limits: DriveSettings) -> float:
    """
    Yaw rate of a rotation in place [rad/s].

    :param remaining: remaining angle [rad].
    :param limits: ``DriveSettings`` within the limits of the robot.
    """
    rate = min(limits.yaw_rate, stopping_speed(abs(remaining), limits.yaw_acceleration))
    return math.copysign(rate, remaining)


def track_differential(section: MotionSection, pose: Pose, s: float, lateral: float,
                       limits: DriveSettings) -> Twist:
    """
    Command of a differential drive: curvature by lateral offset and heading error.

    :param s: arc length that it has come to [m].
    :param lateral: its offset to the left of the path [m].
    :param limits: ``DriveSettings`` within the limits of the robot.
    """
    speed = section.speed(s)
    direction, curvature, offset = section.smooth_motion(s)
    reversal = math.pi if section.is_backwards else 0.0
    error = wrap_angle(pose.theta + reversal - direction)
    if abs(error) > MAX_HEADING_ERROR:
        return Twist(0.0, 0.0, turn_in_place(-error, limits))
    lateral = min(RETURN_DISTANCE, max(-RETURN_DISTANCE, lateral - offset))
    omega = max(0.0, speed) * (curvature - lateral / RETURN_DISTANCE ** 2
                               - 2.0 * math.sin(error) / RETURN_DISTANCE)
    # Slower where the yaw rate is limited, so that the curvature is kept.
    ratio = min(1.0, limits.yaw_rate / abs(omega)) if omega else 1.0
    return Twist(ratio * (-speed if section.is_backwards else speed), 0.0, ratio * omega)


def track_holonomic(section: MotionSection, pose: Pose, s: float, lateral: float,
                    limits: DriveSettings) -> Twist:
    """
    Command of a holonomic base: along the path, sideways back to it, and to its heading there.

    :param s: arc length that it has come to [m].
    :param lateral: its offset to the left of the path [m].
    :param limits: ``DriveSettings`` within the limits of the robot.
    """
    speed = section.speed(s)
    direction, _, offset = section.smooth_motion(s)
    heading, heading_rate = section.heading(s)
    across = min(MAX_LATERAL_SPEED, max(-MAX_LATERAL_SPEED, (lateral - offset) / FADE_TIME))
    x, y = Pose(0.0, 0.0, direction - pose.theta).rotate((speed, -across))
    return Twist(x, y, speed * heading_rate
                 + turn_in_place(wrap_angle(heading - pose.theta), limits))


class PathFollower:
    """
    Commands along a path, one after the other.

    A robot that shall stop at the end and is not at the last pose when it stops drives there
    directly. One that shall pass the end has ``finished`` when it does so within
    ``PASSING_POSITION_TOLERANCE`` and ``PASSING_HEADING_TOLERANCE``; whoever follows may take
    over from the command that it has then, and until that comes it drives straight on. If it
    passes farther off, it has ``missed`` the end, and stops.

    :param robot: the ``RoundRobot``.
    :param settings: ``DriveSettings``.
    :param path: the ``Path``.
    :param end_speed: speed at which the robot passes the end, 0 where it shall stop there [m/s].
    :param handover_distance: distance before the end at which it counts as passed [m].
    :param motion: ``Twist`` of the robot at the beginning, in its own axes.
    :raises ValueError: where a speed or distance is not finite, or is negative.
    """

    def __init__(self, robot: RoundRobot, settings: DriveSettings, path: Path, *,
                 end_speed: float = 0.0, handover_distance: float = 0.0,
                 motion: Twist = STOP) -> None:
        for name, value in (('end_speed', end_speed), ('handover_distance', handover_distance)):
            if not (math.isfinite(value) and value >= 0.0):
                raise ValueError(f'{name}: got {value!r}, expected a finite number of at least 0')
        self._robot = robot
        self._settings = settings
        self._limits = settings.limited_to(robot)
        self._goal = path.poses[-1]
        # The path, with the speed at which it is left, that the sections are of.
        self._path, self._end_speed = path, end_speed
        self._sections = split_at_stops(path, self._limits, end_speed)
        # A rotation in place at the end is a stop at any rate.
        self._passes_end = (end_speed > 0.0 and bool(self._sections)
                            and isinstance(self._sections[-1], MotionSection))
        self._handover_distance = handover_distance
        self._progress = _SectionProgress()
        self._rest_time = 0.0
        self._command = motion
        # Motion of the robot as its lag lets it follow the commands.
        self._motion: tuple[float, float, float] = motion
        self.finished = False
        self.missed = False

    def limit_to(self, robot: RoundRobot) -> bool:
        """
        Keep to other limits from now on.

        :param robot: the ``RoundRobot`` as known by now.
        :return: whether they differ from those until now.
        """
        limits = self._settings.limited_to(robot)
        if limits == self._limits:
            return False
        self._limits = limits
        # Limits do not change where the robot stops.
        sections = split_at_stops(self._path, limits, self._end_speed)
        self._sections = sections[len(sections) - len(self._sections):]
        return True

    @property
    def remaining_distance(self) -> float:
        """Distance left along the path [m]."""
        lengths = [section.length for section in self._sections
                   if isinstance(section, MotionSection)]
        is_moving = bool(self._sections) and isinstance(self._sections[0], MotionSection)
        return max(0.0, sum(lengths) - (self._progress.distance if is_moving else 0.0))

    def step(self, pose: Pose, dt: float, predicted: Pose | None = None) -> Twist:
        """
        Compute the next command.

        :param pose: ``Pose`` of the robot in the world.
        :param dt: time since the last step [s].
        :param predicted: ``Pose`` from which on this command takes effect; None for one lag ahead.
        :raises ValueError: where the pose or the time is not finite.
        """
        pose = Pose(*pose)
        if not pose.is_finite():
            raise ValueError(f'pose: got {tuple(pose)}, expected finite numbers')
        if not (math.isfinite(dt) and dt >= 0.0):
            raise ValueError(f'dt: got {dt!r}, expected a finite time of at least 0 [s]')
        # The lag is followed with ``predicted``, too: that may be missing from the next step on.
        lagged = self._predict(pose, dt)
        predicted = lagged if predicted is None else predicted
        if self._passes_end:
            self._check_passing(pose)
            stops = self.missed
        else:
            stops = self._check_arrival(pose, predicted, dt)
        requested = STOP if stops else self._track(predicted, dt)
        if self._robot.drive == 'differential':
            requested = keep_curvature(self._command, requested, self._limits, dt)
        self._command = limit_command(self._command, requested, self._limits, dt)
        return self._command

    def _predict(self, pose: Pose, dt: float) -> Pose:
        """Predict the pose one lag ahead: from there the drive follows as one without lag."""
        lag = self._robot.time_constant
        ratio = -math.expm1(-dt / lag) if lag else 1.0
        (v_x, v_y, omega), command = self._motion, self._command
        v_x += ratio * (command.v_x - v_x)
        v_y += ratio * (command.v_y - v_y)
        omega += ratio * (command.omega - omega)
        self._motion = v_x, v_y, omega
        rotation = omega * lag
        x, y = Pose(0.0, 0.0, pose.theta + 0.5 * rotation).rotate((v_x, v_y))
        return Pose(pose.x + lag * x, pose.y + lag * y, pose.theta + rotation)

    def _check_arrival(self, pose: Pose, predicted: Pose, dt: float) -> bool:
        """Tell whether no section is left; a robot at rest beside the goal gets a new one."""
        resting = self._command == STOP and not self._sections
        self._rest_time = self._rest_time + dt if resting else 0.0
        self.finished = resting and self._is_at_goal(pose) and self._is_at_goal(predicted)
        if self._rest_time > REST_TIMEOUT and not self.finished:
            self._path, self._end_speed = self._direct_path(pose), 0.0
            self._sections = split_at_stops(self._path, self._limits)
        return not self._sections

    def _check_passing(self, pose: Pose) -> None:
        """Find out whether the robot passes the end, and whether it does so on the path."""
        section = self._sections[-1]
        if (self.finished or self.missed or len(self._sections) > 1
                or not isinstance(section, MotionSection)):
            return
        if self._progress.distance < section.length - self._handover_distance - PASSING_RANGE:
            return
        direction = section.direction(section.length)
        along, lateral = Pose(0.0, 0.0, -direction).rotate((pose.x - self._goal.x,
                                                            pose.y - self._goal.y))
        if along >= -self._handover_distance:
            self.finished = (
                abs(lateral) <= PASSING_POSITION_TOLERANCE
                and abs(wrap_angle(pose.theta - self._goal.theta)) <= PASSING_HEADING_TOLERANCE)
            self.missed = not self.finished

    def _is_at_goal(self, pose: Pose) -> bool:
        return (distance(pose, self._goal) <= POSITION_TOLERANCE
                and abs(wrap_angle(pose.theta - self._goal.theta)) <= HEADING_TOLERANCE)

    def _direct_path(self, pose: Pose) -> Path:
        if distance(pose, self._goal) <= 0.5 * POSITION_TOLERANCE:
            return Path((pose, pose._replace(theta=self._goal.theta)))
        waypoints = [Waypoint(self._goal.x, self._goal.y)]
        if self._robot.drive == 'holonomic':
            return holonomic_path(pose, self._goal, waypoints)
        bearing = math.atan2(self._goal.y - pose.y, self._goal.x - pose.x)
        return differential_path(pose, self._goal, waypoints,
                                 [math.cos(bearing - pose.theta) < 0.0])

    def _track(self, predicted: Pose, dt: float) -> Twist:
        """Command on the first section that is not done."""
        while self._sections:
            section = self._sections[0]
            if isinstance(section, MotionSection):
                command = self._track_section(section, predicted, dt)
            else:
                command = self._track_rotation(section, predicted, dt)
            if command is not None:
                return command
            self._sections.pop(0)
            self._progress = _SectionProgress()
        return STOP

    def _track_rotation(self, segment: PathSegment, predicted: Pose, dt: float) -> Twist | None:
        remaining = wrap_angle(segment.end.theta - predicted.theta)
        settled = self._progress.settle(remaining, SECTION_HEADING_TOLERANCE, dt)
        # A section that follows corrects the heading by itself.
        is_followed = len(self._sections) > 1 and abs(remaining) < SECTION_HEADING_TOLERANCE
        if settled or is_followed:
            return None
        return Twist(0.0, 0.0, turn_in_place(remaining, self._limits))

    def _track_section(self, section: MotionSection, predicted: Pose, dt: float) -> Twist | None:
        s, lateral = section.locate(predicted)
        self._progress.distance = s
        remaining = section.length - s
        if self._robot.drive == 'holonomic':
            error, track = complex(remaining, lateral), track_holonomic
        else:
            error, track = remaining, track_differential
        if self._passes_end and len(self._sections) == 1:
            return track(section, predicted, s, lateral, self._limits)
        if self._progress.settle(error, SECTION_POSITION_TOLERANCE, dt):
            return None
        return track(section, predicted, s, lateral, self._limits)


class _SectionProgress:
    """Progress of the robot on a section, and whether it has settled at its end."""

    def __init__(self) -> None:
        self.distance = 0.0
        self._filtered: complex | None = None

    def settle(self, remaining: complex, tolerance: float, dt: float) -> bool:
        """
        Tell whether the remainder has been small for a while, so that the robot does not pass by.

        :param remaining: remaining distance or angle; complex with the lateral offset.
        :param tolerance: same unit.
        :param dt: time since the last call [s].
        """
        late = remaining if self._filtered is None else self._filtered
        self._filtered = late - math.expm1(-dt / DWELL) * (remaining - late)
        return abs(self._filtered) < tolerance and abs(remaining) < 2.0 * tolerance
