"""Feedback that keeps the robot on its way, by where it sees itself."""

import math

from push_drive.laws import driven, held, limited_change, turning
from push_drive.run import Run, stretches
from push_drive.way import driven_way, turned_way, Way
from push_model.geometry import distance, Pose, wrap_angle
from push_model.signals import STOP, Twist

POSITION_TOLERANCE = 0.003
HEADING_TOLERANCE = math.radians(0.6)
PATIENCE, DWELL = 0.4, 0.1
CLOSE, ALIGNED = 0.001, math.radians(0.2)


class WayFollower:
    """
    Commands along a way, one after the other.

    The robot starts at rest. Where it has come to the end and is not at the last pose, it goes
    there directly.

    :param robot: the ``RoundRobot``.
    :param settings: ``DriveSettings``.
    :param way: the ``Way``.
    """

    def __init__(self, robot, settings, way):
        self._robot, self._limits = robot, settings.capped(robot)
        self._goal = way.poses[-1]
        self._stretches = stretches(way, self._limits)
        self._along, self._late, self._stood = 0.0, None, 0.0
        self._command, self._motion = STOP, STOP
        self.finished = False

    @property
    def remaining(self):
        """Way left [m]."""
        runs = [stretch.length for stretch in self._stretches if isinstance(stretch, Run)]
        first = isinstance(self._stretches[0], Run) if self._stretches else False
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
        self._command = limited_change(self._command, wanted, self._limits, dt)
        return self._command

    def _ahead(self, pose, dt):
        # Where a drive with a lag of one time constant is, for commands that begin now, as good
        # as one without.
        lag = self._robot.time_constant
        share = -math.expm1(-dt / lag) if lag else 1.0
        self._motion = Twist(*(moving + share * (commanded - moving)
                               for moving, commanded in zip(self._motion, self._command)))
        turn = self._motion.omega * lag
        x, y = pose._replace(theta=pose.theta + 0.5 * turn).rotate(self._motion)
        return Pose(pose.x + lag * x, pose.y + lag * y, pose.theta + turn)

    def _arrived(self, pose, ahead, dt):
        resting = self._command == STOP and not self._stretches
        self._stood = self._stood + dt if resting else 0.0
        self.finished = resting and self._is_there(pose) and self._is_there(ahead)
        if self._stood > PATIENCE and not self.finished:
            self._stretches = stretches(self._directly(pose), self._limits)
        return not self._stretches

    def _is_there(self, pose):
        return (distance(pose, self._goal) <= POSITION_TOLERANCE
                and abs(wrap_angle(pose.theta - self._goal.theta)) <= HEADING_TOLERANCE)

    def _directly(self, pose):
        if distance(pose, self._goal) <= 0.5 * POSITION_TOLERANCE:
            return Way((pose, pose._replace(theta=self._goal.theta)))
        track = [(self._goal.x, self._goal.y, 0.0)]
        if self._robot.drive == 'holonomic':
            return turned_way(pose, self._goal, track)
        toward = math.atan2(self._goal.y - pose.y, self._goal.x - pose.x)
        return driven_way(pose, self._goal, track, [math.cos(toward - pose.theta) < 0.0])

    def _wanted(self, ahead, dt):
        while self._stretches:
            stretch = self._stretches[0]
            law = self._along_run if isinstance(stretch, Run) else self._turned
            wanted = law(stretch, ahead, dt)
            if wanted is not None:
                return wanted
            self._stretches.pop(0)
            self._along, self._late = 0.0, None
        return STOP

    def _turned(self, leg, ahead, dt):
        left = wrap_angle(leg.end.theta - ahead.theta)
        # A run that follows puts the heading right by itself.
        if self._settled(left, ALIGNED, dt) or len(self._stretches) > 1 and abs(left) < ALIGNED:
            return None
        return Twist(0.0, 0.0, turning(left, self._limits))

    def _along_run(self, run, ahead, dt):
        self._along, aside = run.locate(ahead)
        left = run.length - self._along
        holonomic = self._robot.drive == 'holonomic'
        if self._settled(complex(left, aside) if holonomic else left, CLOSE, dt):
            return None
        return (held if holonomic else driven)(run, ahead, self._along, aside, self._limits)

    def _settled(self, left, tolerance, dt):
        # Not while it only passes by: what is left must have been little for a while.
        late = left if self._late is None else self._late
        self._late = late - math.expm1(-dt / DWELL) * (left - late)
        return abs(self._late) < tolerance and abs(left) < 2.0 * tolerance
