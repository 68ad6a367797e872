"""What has been measured lately: newest odometry and object pose, and whether odometry stops."""

import enum
from typing import NamedTuple

from push_control.supervision_settings import SupervisionSettings
from push_model.observation import Observation
from push_model.odometry_history import OdometryHistory
from push_model.signals import ObjectPose, Odometry
from push_safety.tolerances import MAX_STAMP_OFFSET

NANOSECOND = 1e-9
# Odometry is lost, and not only late, after this many time-outs; chosen: 1 s by default.
LOST_RATIO = 4.0
# Time with odometry after which another gap is reported again [s]; chosen: gaps under load follow
# each other more closely.
RECOVERY_TIME = 5.0
# Time on a steady clock without odometry after which it is missing although simulated time stands
# still [s]; chosen: longer than a step of a slow simulator.
STANDSTILL_TIMEOUT = 1.0


class _BumperMemory:
    """Keeps a touch of the bumper until the next odometry, however short it was."""

    def __init__(self) -> None:
        # None before the first news of it.
        self._is_pressed: bool | None = None
        self._was_pressed = False

    def add(self, is_pressed: bool) -> None:
        self._is_pressed = is_pressed
        self._was_pressed |= is_pressed

    def pop(self) -> bool | None:
        """Tell whether it was pressed since the last call; None where nothing is known."""
        was_pressed, self._was_pressed = self._was_pressed, self._is_pressed is True
        return was_pressed or self._is_pressed


class LatestMeasurements:
    """
    Newest measurement of each kind.

    ``time``: newest time of all [s], 0 before the first.
    """

    def __init__(self) -> None:
        """Start without measurements."""
        self.odometry: Odometry | None = None
        self.object_pose: ObjectPose | None = None
        self.time = 0.0
        self._bumper = _BumperMemory()
        self._is_bumper_pressed: bool | None = None
        self._history = OdometryHistory()
        # A relative pose that waits for odometry of its time.
        self._unplaced: ObjectPose | None = None

    def add(self, measured: Odometry | ObjectPose) -> float:
        """
        Take in a measurement; one that is older than the last of its kind is ignored.

        A pose relative to the robot is placed in the world by odometry of its time, for which it
        waits; one from before the first odometry is ignored.

        :param measured: ``Odometry`` or ``ObjectPose``.
        :return: time since the newest measurement before [s], at least 0.
        """
        before = self.time
        if isinstance(measured, Odometry):
            self._add_odometry(measured)
        elif measured.relative is None:
            self._add_pose(measured)
        else:
            self._unplaced = measured
        self._place_relative()
        return self.time - before

    def on_time_ahead(self, duration: float) -> None:
        """
        Note that clocks were set ahead: what was measured is no older for that.

        :param duration: by how much [s].
        """
        self.time += duration
        if self.object_pose is not None:
            self.object_pose = self.object_pose._replace(time=self.object_pose.time + duration)

    def add_bumper(self, is_pressed: bool) -> None:
        """Note whether the bumper is pressed, which counts with the next odometry."""
        self._bumper.add(is_pressed)

    def forget_object(self) -> None:
        """Forget where the object is: it is another one from now on."""
        self.object_pose = self._unplaced = None

    def _add_odometry(self, odometry: Odometry) -> None:
        if self.odometry is None:
            self._forget_later_pose(odometry.time)
        if self.odometry is None or odometry.time >= self.odometry.time:
            self.odometry = odometry
            self._is_bumper_pressed = self._bumper.pop()
        self._history.append(odometry)
        self.time = max(self.time, odometry.time)

    def _add_pose(self, object_pose: ObjectPose) -> None:
        if self.object_pose is None or object_pose.time >= self.object_pose.time:
            self.object_pose = object_pose
        self.time = max(self.time, object_pose.time)

    def _place_relative(self) -> None:
        """Place the relative pose that waits, once there is odometry of its time."""
        relative, odometry = self._unplaced, self.odometry
        if relative is None or odometry is None or odometry.time < relative.time:
            return
        self._unplaced = None
        placed = self._history.place(relative)
        if placed is not None:
            self._add_pose(placed)

    def _forget_later_pose(self, time: float) -> None:
        """Forget an object pose of another clock, to which nothing could be compared before."""
        if self.object_pose is not None and self.object_pose.time > time + MAX_STAMP_OFFSET:
            self.object_pose = None
            self.time = time

    @property
    def missing(self) -> list[str]:
        """Topics on which nothing has come yet that can be used."""
        return [name for name, measured in (('odom', self.odometry),
                                            ('object_pose', self.object_pose)) if measured is None]

    @property
    def observation(self) -> Observation | None:
        """``Observation`` of the newest measurements; None before the first odometry."""
        if self.odometry is None:
            return None
        return Observation(self.time, self.odometry, self.object_pose,
                           is_bumper_pressed=self._is_bumper_pressed)


class CovarianceCheck:
    """Notices odometry that should be absolute and does not state how certain it is."""

    def __init__(self, settings: SupervisionSettings) -> None:
        """Start before the first odometry."""
        self._is_expected = settings.odometry_reference == 'absolute'
        self._was_missing = False

    def update(self, odometry: Odometry) -> str:
        """
        Check odometry.

        :return: one sentence where its covariance is missing and was there, or is so at first;
            else empty.
        """
        is_missing = self._is_expected and odometry.covariance is None
        is_new, self._was_missing = is_missing and not self._was_missing, is_missing
        if not is_new:
            return ''
        return ('odom.pose.covariance: got none, expected variances of x, y and yaw above 0, as '
                'supervision.odometry_reference is absolute; odometry counts as drifting')


class OdometryState(enum.IntEnum):
    """Tell whether odometry comes; the robot stands unless it does."""

    PRESENT = 0
    MISSING = 1
    LOST = 2


class _Arrival(NamedTuple):
    """Arrival of odometry: its stamp and the clock of the node [ns], and a steady clock [s]."""

    stamp: int
    clock: int
    now: float


class ClockCheck(NamedTuple):
    """
    Result of a look at the clock.

    :param age: of the last odometry [s], 0 before the first.
    :param is_news: whether that is worth a report.
    """

    state: OdometryState
    age: float
    is_news: bool


class OdometryWatchdog:
    """
    Notices that odometry has stopped, or repeats its stamp, by a steady clock.

    Simulated time may be slower, or stand still: there the clock of the node counts, and the
    steady one only after a while.

    A machine under load lets odometry come late now and then: the robot stops each time, but that
    is reported once, and not again until odometry has come for a while. That it is lost is
    reported each time.
    """

    def __init__(self, timeout: float, *, is_simulated: bool) -> None:
        """
        Start before the first odometry, which may take its time.

        :param timeout: age of the last odometry beyond which it is missing [s].
        :param is_simulated: whether the clock of the node is simulated.
        """
        self._timeout = timeout
        self._is_simulated = is_simulated
        self.reset()

    def reset(self) -> None:
        """Wait for the next odometry."""
        self._received: _Arrival | None = None
        self._state = self._reported = OdometryState.PRESENT
        self._missing_at = 0.0

    def feed(self, stamp: int, clock: int, now: float) -> None:
        """
        Note that odometry has come; one that is not newer than the last tells nothing.

        :param stamp: of the message [ns], which may be of another clock, or ahead of simulated
            time.
        :param clock: time on the clock of the node [ns].
        :param now: time on a steady clock [s].
        """
        if self._received is None or stamp > self._received.stamp:
            self._received = _Arrival(stamp, max(clock, stamp), now)

    def has_gap(self, now: float) -> bool:
        """
        Tell whether odometry has been lost by the steady clock: none came, or this process slept.

        :param now: time on a steady clock [s].
        """
        return (self._received is not None
                and now - self._received.now > LOST_RATIO * self._timeout)

    def is_missing(self, clock: int, now: float) -> bool:
        """
        Tell whether odometry is missing, so that the robot was stopped or is about to be.

        :param clock: time on the clock of the node [ns].
        :param now: time on a steady clock [s].
        """
        return self._age(clock, now) > self._timeout

    def _age(self, clock: int, now: float) -> float:
        """Age of the last odometry [s], 0 before the first."""
        if self._received is None:
            return 0.0
        age = now - self._received.now
        if self._is_simulated and age < STANDSTILL_TIMEOUT:
            return (clock - self._received.clock) * NANOSECOND
        return age

    def check(self, clock: int, now: float) -> ClockCheck:
        """
        Find out how long odometry has been missing.

        :param clock: time on the clock of the node [ns].
        :param now: time on a steady clock [s].
        """
        age = self._age(clock, now)
        state = OdometryState.PRESENT
        if age > self._timeout:
            self._missing_at = now
            state = OdometryState.MISSING
        if age > LOST_RATIO * self._timeout:
            state = OdometryState.LOST
        is_lost_again = state is OdometryState.LOST and self._state is not state
        self._state = state
        is_news = state > self._reported or is_lost_again
        if is_news or now - self._missing_at > RECOVERY_TIME:
            self._reported = state
        return ClockCheck(state, age, is_news)
