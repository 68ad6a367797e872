"""What the controller's node keeps of its measurements, and what it says of them."""

from push_control.ros.measurements import (
    CovarianceCheck, LatestMeasurements, OdometryState, OdometryWatchdog,
)
from push_control.supervision_settings import SupervisionSettings
from push_model.geometry import Pose
from push_model.signals import ObjectPose, Odometry, PoseCovariance, STOP
import pytest

SILENT = Odometry(0.0, Pose(0.0, 0.0, 0.0), STOP)
STATED = SILENT._replace(covariance=PoseCovariance.from_deviations(1e-3, 2e-3))


def test_absolute_odometry_without_a_covariance_is_reported_once():
    """And again after it was there."""
    check = CovarianceCheck(SupervisionSettings(odometry_reference='absolute'))
    texts = [check.update(odometry) for odometry in (SILENT, SILENT, STATED, SILENT, SILENT)]
    assert [bool(text) for text in texts] == [True, False, False, True, False]
    assert 'odom.pose.covariance: got none' in texts[0]


def test_drifting_odometry_needs_no_covariance():
    check = CovarianceCheck(SupervisionSettings())
    assert not check.update(SILENT) and not check.update(STATED)


def test_an_object_pose_of_another_clock_before_the_first_odometry_is_forgotten():
    """Odometry sets the time; a pose that has come a moment before it is kept."""
    for time, is_kept in ((1e5, False), (10.2, True), (0.0, True)):
        latest = LatestMeasurements()
        latest.add(ObjectPose(time, Pose(1.0, 0.0, 0.0)))
        latest.add(SILENT._replace(time=10.0))
        assert (latest.object_pose is not None) == is_kept
        assert latest.time == (max(10.0, time) if is_kept else 10.0)


@pytest.mark.parametrize('kind', ['odometry', 'object_pose'])
def test_what_is_older_than_the_newest_of_its_kind_is_ignored(kind):
    """And no time passes by it; the other kind goes on."""
    make = moving if kind == 'odometry' else lambda time: ObjectPose(time, Pose(time, 0.0, 0.0))
    latest = LatestMeasurements()
    latest.add(moving(0.0))
    assert latest.add(make(2.0)) == 2.0
    assert latest.add(make(1.0)) == 0.0
    assert getattr(latest, kind) == make(2.0) and latest.time == 2.0


def moving(time):
    """Make odometry of a robot that drives an arc."""
    return Odometry(time, Pose(0.3 * time, 0.1, 0.4 * time), STOP)


@pytest.mark.parametrize('news, expected', [
    ([], None), ([False], False), ([True], True), ([True, False], True), ([False, True], True)])
def test_a_touch_of_the_bumper_counts_with_the_next_odometry(
        news: list[bool], expected: bool | None) -> None:
    """However short it was; a bumper that nobody tells of is none."""
    latest = LatestMeasurements()
    for is_pressed in news:
        latest.add_bumper(is_pressed)
    latest.add(moving(0.0))
    assert latest.observation.is_bumper_pressed is expected
    latest.add(moving(1.0))
    assert latest.observation.is_bumper_pressed is (news[-1] if news else None)


def test_a_relative_pose_is_placed_by_odometry_of_its_own_time():
    """Late or early; until there is such odometry, nothing has been measured."""
    relative = Pose(0.8, -0.1, 0.2)
    for stamp, arrival in ((1.0, 1.15), (1.0, 1.0), (1.0, 0.98), (0.99, 1.15)):
        latest = LatestMeasurements()
        for tick in range(48, 60):
            time = tick * 0.02
            if latest.odometry is not None and arrival <= time and latest.object_pose is None:
                latest.add(ObjectPose(stamp, relative, relative=relative))
                assert (latest.object_pose is None) == (latest.odometry.time < stamp)
            latest.add(moving(time))
        assert latest.object_pose.relative == relative and latest.object_pose.time == stamp
        assert latest.object_pose.pose == pytest.approx(moving(stamp).pose @ relative, abs=1e-5)


def test_a_relative_pose_from_before_the_first_odometry_is_ignored():
    latest = LatestMeasurements()
    latest.add(moving(1.0))
    latest.add(ObjectPose(0.9, Pose(1.0, 0.0, 0.0), relative=Pose(1.0, 0.0, 0.0)))
    assert latest.object_pose is None and latest.time == 1.0


def test_a_relative_pose_of_another_object_is_not_placed() -> None:
    """It waited for odometry as the object was changed."""
    latest = LatestMeasurements()
    latest.add(moving(1.0))
    latest.add(ObjectPose(1.01, Pose(1.0, 0.0, 0.0), relative=Pose(1.0, 0.0, 0.0)))
    latest.forget_object()
    latest.add(moving(1.02))
    assert latest.object_pose is None


def reports(arrivals, end):
    """Look at the clock 20 times a second while odometry comes at times; list what is news."""
    watchdog, news = OdometryWatchdog(0.25, is_simulated=False), []
    for now in (round(tick * 0.05, 2) for tick in range(round(end / 0.05))):
        if now in arrivals:
            watchdog.feed(round(now * 1e9), 0, now)
        check = watchdog.check(0, now)
        assert (check.state is OdometryState.PRESENT) == (check.age <= 0.25)
        if check.is_news:
            news.append((check.state, now))
    return news


def ticks(start, end):
    """List the ticks of the clock between two times."""
    return {round(tick * 0.05, 2) for tick in range(round(start / 0.05), round(end / 0.05))}


def test_odometry_that_is_late_is_reported_before_odometry_that_is_lost():
    """First that it is missing, then that it stays away; nothing before the first of all."""
    assert reports(ticks(0.0, 1.0), 3.0) == [(OdometryState.MISSING, 1.25),
                                             (OdometryState.LOST, 2.0)]
    assert reports(set(), 3.0) == []


def test_gaps_that_follow_each_other_are_reported_once():
    """As on a machine under load; again after odometry has come for a while."""
    flickering = ticks(0.0, 1.0) | ticks(1.5, 2.0) | ticks(2.5, 3.0) | ticks(3.5, 10.0)
    assert reports(flickering | ticks(10.5, 11.0), 11.0) == [(OdometryState.MISSING, 1.25),
                                                             (OdometryState.MISSING, 10.25)]


def test_odometry_that_is_lost_again_is_reported_again():
    """However shortly it has come in between: a robot that stands is not taken for pushing."""
    assert reports(ticks(0.0, 1.0) | ticks(3.0, 3.3), 6.0) == [
        (OdometryState.MISSING, 1.25), (OdometryState.LOST, 2.0), (OdometryState.LOST, 4.3)]


def test_odometry_that_repeats_its_stamp_is_missing():
    """As from a driver that is stuck."""
    watchdog = OdometryWatchdog(0.25, is_simulated=False)
    for tick in range(10):
        watchdog.feed(1, 0, 0.1 * tick)
    assert watchdog.check(0, 0.2).state is OdometryState.PRESENT
    assert watchdog.check(0, 0.3).state is OdometryState.MISSING


def test_simulated_time_may_stand_still_for_a_moment_only():
    """A simulator is slow, or it has died, and the clock with it."""
    watchdog = OdometryWatchdog(0.25, is_simulated=True)
    watchdog.feed(10, 10, 5.0)
    assert watchdog.check(10, 5.9).state is OdometryState.PRESENT
    assert watchdog.check(10 + round(0.3e9), 5.1).state is OdometryState.MISSING
    assert watchdog.check(10, 6.1).state is OdometryState.LOST


def test_a_gap_is_noticed_by_the_first_odometry_behind_it():
    """However many stamps come at once, as in a process that was suspended."""
    watchdog, gaps = OdometryWatchdog(0.25, is_simulated=False), []
    for stamp, now in enumerate([0.0, 0.05, 3.05, 3.06, 3.07, 3.1, 3.9]):
        gaps.append(watchdog.has_gap(now))
        watchdog.feed(stamp, 0, now)
    assert gaps == [False, False, True, False, False, False, False]
