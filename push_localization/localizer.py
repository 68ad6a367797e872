"""
The place of the robot, scan by scan.

State are the pose of the robot (x, y, heading), the scale error e of its odometry and the drift d
of the heading per distance. A step (dx, dy, dt) of odometry of length l, in the robot's axes,
predicts

    p <- p + (1 + e) R (dx, dy),    heading <- heading + dt + d l,

and a scan corrects the pose by a match to the walls of the map (``matching``), whose covariance
counts as of errors that last (``fusion``). At the start a grid is searched; a robot whose scans do
not fit for a while is lost, and looked for elsewhere.
"""

from collections import deque
from collections.abc import Sequence
import math

import numpy as np
from push_localization.fusion import fused_covariance, lasting_correction
from push_localization.matching import Match, placed, Prior, ScanMatcher
from push_localization.object_beams import sees_object
from push_localization.scan_points import (
    LidarMount, MotionBuffer, scan_points, ScanPoints, UnexplainedPoints,
)
from push_localization.search import likelihood, search, SearchRange, start_range
from push_localization.settings import PlaceSettings
from push_localization.wall_field import WallField
from push_model.geometry import FloatArray, Pose
from push_model.parameters import PushedObject
from push_model.signals import (
    LidarScan, ObjectPose, Odometry, PlaceStatus, PoseCovariance, RobotPlace,
)

# Standard deviations of scale and drift [rad/m], and random walks per root of the distance, of the
# position, of the heading, per rotation, and of scale and drift; chosen: as odometry of wheels.
SCALE_STD, DRIFT_STD = 0.02, 0.02
WALK, HEADING_WALK, TURN_WALK, ERROR_WALK = 0.003, 0.01, 0.02, 0.002
# Beams of walls below which a scan tells nothing; chosen: a pole or two are no place.
MIN_BEAMS = 40
# Fit below which scans do not fit, how many in a row mean that the robot is lost, and how often it
# is looked for then [s]; measured: fits are 0.92 in the median while tracking, 0.63 at least with
# ten unmapped things about, and 0.16 when lost.
MIN_FIT, MAX_MISFITS, SEARCH_PERIOD = 0.55, 10, 1.0
# Range in which a lost robot is looked for, standard deviations of what is found, and by how much
# it must fit, and fit better than the present place; measured: right places fit by 0.96 and more,
# wrong ones by up to 0.69.
LOST_RANGE = SearchRange(1.0, math.radians(50.0))
REGAINED_STDS = 0.1, 0.1, math.radians(5.0)
MIN_LIKELIHOOD, MIN_GAIN = 0.7, 0.2
# Distance from walls beyond which a beam ends at something else [m]; chosen: three times what
# walls, ranges and the place of the robot err by.
UNEXPLAINED_DISTANCE = 0.2
# Scans over which the fit is averaged; chosen: five seconds, in which a robot turns.
FIT_COUNT = 50
# Standard deviations of a lost robot, before which no place is likelier [m], [rad].
LOST_STDS = 1.0, 1.0, 1.0
# Age of the state after which it is moved on without a scan, and how far behind it then stays [s];
# chosen: scans are late by less.
MAX_AGE, LATENCY = 2.0, 0.5


class LidarLocalizer:
    """Finds the place of the robot in a map by scans of its lidar."""

    def __init__(self, settings: PlaceSettings, obj: PushedObject) -> None:
        """
        Wait for odometry, a map and scans.

        :param settings: ``PlaceSettings``.
        :param obj: the ``PushedObject``, which scans see and the map does not have.
        """
        self._settings = settings
        self._object = obj
        self._standing: tuple[tuple[PushedObject, Pose], ...] = ()
        self._matcher: ScanMatcher | None = None
        self.reset()

    def reset(self) -> None:
        """Forget all measurements; the map stays."""
        self._motion = MotionBuffer()
        self._scan: LidarScan | None = None
        self._mount = LidarMount(self._settings.mount_pose)
        # State (x, y, heading, scale, drift), its covariance and its time.
        self._state: FloatArray = np.zeros(5)
        self._covariance: FloatArray = np.zeros((5, 5))
        self._time = -math.inf
        self._has_started = False
        self._misfits = 0
        self._unexplained: UnexplainedPoints | None = None
        self._fits: deque[float] = deque(maxlen=FIT_COUNT)
        self._searched_at = -math.inf
        # Where the object is to the robot at the time of the state, by odometry since a sensor on
        # the robot measured it, and the time of that [s].
        self._relative: Pose | None = None
        self._measured_at = -math.inf

    @property
    def unexplained(self) -> UnexplainedPoints | None:
        """``UnexplainedPoints`` of the newest scan that was matched; None before the first."""
        return self._unexplained

    @property
    def mean_fit(self) -> float | None:
        """Mean part of the beams that end at walls, over some seconds; None before that."""
        return sum(self._fits) / FIT_COUNT if len(self._fits) == FIT_COUNT else None

    @property
    def is_lost(self) -> bool:
        """Tell whether scans have not fitted for a while."""
        return self._misfits >= MAX_MISFITS

    def set_field(self, field: WallField | None) -> None:
        """
        Set the walls, None for no map.

        :param field: ``WallField``.
        """
        self._matcher = None if field is None else ScanMatcher(field, self._settings)

    def move_field(self, origin: Pose) -> None:
        """
        Let the same walls lie elsewhere, and the robot with them: it is where it was in the map.

        :param origin: ``Pose`` in the world of the outer corner of the first cell.
        """
        if self._matcher is None:
            return
        field = self._matcher.field
        correction = origin @ field.origin.inverse()
        self.set_field(field.moved(origin))
        if not self._has_started:
            return
        x, y = correction.transform(self._state[:2])
        self._state[:3] = x, y, self._state[2] + correction.theta
        rotation = np.eye(5)
        c, s = math.cos(correction.theta), math.sin(correction.theta)
        rotation[:2, :2] = (c, -s), (s, c)
        self._covariance = rotation @ self._covariance @ rotation.T

    def set_object(self, obj: PushedObject) -> None:
        """
        Push another object.

        :param obj: the ``PushedObject``.
        """
        self._object = obj

    def set_standing(self, standing: Sequence[tuple[PushedObject, Pose]]) -> None:
        """
        Leave out what sees objects that stand, too.

        :param standing: ``PushedObject`` and ``Pose`` in the world of each.
        """
        self._standing = tuple(standing)

    def add_odometry(self, odometry: Odometry) -> None:
        """
        Take in odometry.

        :param odometry: finite ``Odometry``; one that is not newer than the last is ignored.
        """
        if self._time == -math.inf:
            self._begin_at(odometry)
        self._motion.append(odometry)
        if odometry.time - self._time > MAX_AGE:
            self._predict(odometry.time - LATENCY)

    def _begin_at(self, odometry: Odometry) -> None:
        """Begin where odometry has the robot, as well as the settings know it."""
        settings = self._settings
        self._time = odometry.time
        self._state[:3] = odometry.pose
        self._covariance = np.diag(np.square((
            settings.start_position, settings.start_position, settings.start_heading,
            SCALE_STD, DRIFT_STD)))

    def add_scan(self, scan: LidarScan, mount: LidarMount | None = None) -> None:
        """
        Take in a scan, which is matched once there is odometry up to its end.

        :param scan: ``LidarScan``; ignored while another one waits: were that dropped, scans that
            are stamped ahead of odometry would never be matched.
        :param mount: ``LidarMount``; None for that of the settings.
        """
        if self._scan is None:
            self._scan = scan
        if mount is not None:
            self._mount = mount

    def locate(self, measured: ObjectPose | None) -> RobotPlace | None:
        """
        Match the scan that waits.

        :param measured: the newest ``ObjectPose``, whose beams are left out; None without any. One
            of a sensor on the robot is carried on by odometry.
        :return: ``RobotPlace`` at the middle of the scan; None where there is no scan, or it tells
            nothing.
        """
        self._note_relative(measured)
        scan, matcher = self._scan, self._matcher
        if scan is None or self._motion.newest < scan.end:
            return None
        self._scan = None
        if matcher is None or scan.time < self._motion.oldest or scan.middle <= self._time:
            return None
        points = scan_points(scan, self._mount, self._motion, self._settings.beams)
        self._predict(scan.middle)
        if measured is not None and self._settings.sees_object:
            points = self._without_object(points, measured)
        if self._standing and self._settings.sees_object:
            points = self._without_standing(points)
        if len(points.points) < MIN_BEAMS:
            return None
        return self._match(matcher, points)

    def _note_relative(self, measured: ObjectPose | None) -> None:
        """Note where a sensor on the robot has seen the object, once for each pose."""
        if measured is None or measured.relative is None or self._time == -math.inf:
            self._relative = None
        elif self._relative is None or measured.time != self._measured_at:
            step = self._motion.step(measured.time, self._time)
            self._relative, self._measured_at = step.inverse() @ measured.relative, measured.time

    def _without_object(self, points: ScanPoints, measured: ObjectPose) -> ScanPoints:
        """Leave out what sees the object, as the robot is predicted to stand to it."""
        pose = self._relative
        if pose is None:
            pose = Pose(*self._state[:3].tolist()).inverse() @ measured.pose
        return points.selected(
            ~sees_object(points, self._object, pose, self._settings.object_margin))

    def _without_standing(self, points: ScanPoints) -> ScanPoints:
        """Leave out what sees objects that stand."""
        to_robot = Pose(*self._state[:3].tolist()).inverse()
        for obj, pose in self._standing:
            points = points.selected(
                ~sees_object(points, obj, to_robot @ pose, self._settings.object_margin))
        return points

    def _predict(self, time: float) -> None:
        """Move the state on by odometry."""
        step = self._motion.step(self._time, time)
        self._time = time
        if self._relative is not None:
            self._relative = step.inverse() @ self._relative
        self._motion.drop_before(time - LATENCY)
        length = math.hypot(step.x, step.y)
        x, y, heading, scale, drift = self._state.tolist()
        d_x, d_y = Pose(0.0, 0.0, heading).rotate((step.x, step.y))
        self._state[:3] = (x + (1.0 + scale) * d_x, y + (1.0 + scale) * d_y,
                           heading + step.theta + drift * length)
        jacobian = np.eye(5)
        jacobian[0, 2:4] = -(1.0 + scale) * d_y, d_x
        jacobian[1, 2:4] = (1.0 + scale) * d_x, d_y
        jacobian[2, 4] = length
        walk, error_walk = WALK ** 2 * length, ERROR_WALK ** 2 * length
        turn = HEADING_WALK ** 2 * length + TURN_WALK ** 2 * abs(step.theta)
        self._covariance = (jacobian @ self._covariance @ jacobian.T
                            + np.diag((walk, walk, turn, error_walk, error_walk)))

    def _match(self, matcher: ScanMatcher, points: ScanPoints) -> RobotPlace:
        """Correct the state by a scan; look elsewhere where the robot is lost."""
        prior = Prior(self._state[:3].copy(), _positive(self._covariance[:3, :3]))
        start = None
        if not self._has_started:
            start = search(matcher.field, points, prior, start_range(prior.covariance))
            self._has_started = True
        match = matcher.match(points, prior, start)
        self._fits.append(match.fit)
        self._misfits = self._misfits + 1 if match.fit < MIN_FIT else 0
        status = PlaceStatus.LOST if self.is_lost else PlaceStatus.TRACKED
        elsewhere = self._look_elsewhere(matcher, points, match) if self.is_lost else None
        if elsewhere is not None:
            status, self._misfits = PlaceStatus.REGAINED, 0
            self._place(elsewhere)
        else:
            self._fuse(prior, match)
        ends = matcher.field.sample(placed(points.points, self._state[:3])).distances
        self._unexplained = UnexplainedPoints(
            points.time, points.points[ends > UNEXPLAINED_DISTANCE])
        return RobotPlace(self._time, Pose(*self._state[:3].tolist()),
                          PoseCovariance.from_matrix(self._covariance[:3, :3]), status)

    def _fuse(self, prior: Prior, match: Match) -> None:
        """Correct the state, scale and drift with it."""
        covariance = fused_covariance(prior.covariance, match.information)
        gain = self._covariance[:, :3] @ np.linalg.inv(prior.covariance)
        correction = match.pose - prior.pose
        self._state += gain @ lasting_correction(prior.covariance, match.information, correction)
        self._covariance = self._covariance + gain @ (covariance - prior.covariance) @ gain.T

    def _place(self, match: Match) -> None:
        """Put the robot where it was found; nothing that is known of odometry changes."""
        self._state[:3] = match.pose
        covariance = np.zeros((5, 5))
        covariance[3:, 3:] = self._covariance[3:, 3:]
        covariance[:3, :3] = fused_covariance(np.diag(np.square(REGAINED_STDS)), match.information)
        self._covariance = covariance

    def _look_elsewhere(self, matcher: ScanMatcher, points: ScanPoints,
                        present: Match) -> Match | None:
        """Look for a place that fits much better than the present one; None where none does."""
        if self._time - self._searched_at < SEARCH_PERIOD:
            return None
        self._searched_at = self._time
        prior = Prior(present.pose, np.diag(np.square(LOST_STDS)))
        node = search(matcher.field, points, prior, LOST_RANGE)
        match = matcher.match(points, Prior(node, np.diag(np.square(REGAINED_STDS))))
        here = likelihood(matcher.field, placed(points.points, present.pose))
        there = likelihood(matcher.field, placed(points.points, match.pose))
        return match if there > max(MIN_LIKELIHOOD, here + MIN_GAIN) else None


def _positive(covariance: FloatArray) -> FloatArray:
    """Return a copy that is symmetric, and positive also after many small steps."""
    return 0.5 * (covariance + covariance.T) + 1e-12 * np.eye(len(covariance))
