"""The safety layer: whatever the controller commands and the robot does, bounds hold."""

import dataclasses
import math

import numpy as np
from push_dynamics.actuation import track_command
from push_dynamics.layout import MAX_ACCELERATION, MAX_YAW_ACCELERATION, TIME_CONSTANT
from push_model.geometry import distance, Pose, wrap_angle
from push_model.parameters import PushedObject, RoundRobot, Support
from push_model.signals import Odometry, STOP, Twist
from push_safety.layer import SafetyLayer
from push_safety.status import SafetyReason, SafetyState
from push_safety.tolerances import MAX_RESPONSE_TIME, REST_TIME
import pytest

ROBOTS = {drive: RoundRobot(radius=0.17, drive=drive, max_speed=0.4, max_yaw_rate=1.5,
                            max_acceleration=0.8, time_constant=0.1)
          for drive in ('differential', 'holonomic')}
PERIOD = 0.02
BOX = PushedObject(mass=5.0, supports=(Support(0.0, 0.0, 0.3),),
                   outline=((-0.2, -0.2), (0.2, -0.2), (0.2, 0.2), (-0.2, 0.2)))


class Base:
    """A base that follows its commands after a delay, and its odometry."""

    def __init__(self, robot, delay=0.0):
        self.robot = robot
        self.delay = delay
        self._drive = np.zeros(64)
        self._drive[TIME_CONSTANT] = robot.time_constant
        self._drive[MAX_ACCELERATION] = robot.max_acceleration
        self._drive[MAX_YAW_ACCELERATION] = robot.max_yaw_acceleration
        self.odometry = Odometry(0.0, Pose(1.0, -2.0, 0.5), STOP)
        self.commands = []

    def drive(self, command):
        """Drive for a period; return the odometry after it."""
        time, pose, twist, _ = self.odometry
        self.commands.append((time, command))
        late = [sent for at, sent in self.commands if at <= time - self.delay] or [STOP]
        x, y, omega, *mean = track_command(*twist, tuple(late[-1]), self._drive, PERIOD)
        middle = Pose(pose.x, pose.y, pose.theta + 0.5 * PERIOD * mean[2])
        place = middle.transform((PERIOD * mean[0], PERIOD * mean[1]))
        heading = wrap_angle(pose.theta + PERIOD * mean[2])
        self.odometry = Odometry(time + PERIOD, Pose(*place, heading), Twist(x, y, omega))
        return self.odometry


def random_command(rng, robot):
    """Draw a command; now and then one that is beyond all limits, or none at all."""
    scale = rng.choice([0.1, 0.4, 3.0, math.inf, math.nan], p=[0.5, 0.4, 0.09, 0.005, 0.005])
    v_x, v_y, omega = (scale * rng.uniform(-1.0, 1.0, 3)).tolist()
    return Twist(v_x, v_y if robot.drive == 'holonomic' or scale > 1.0 else 0.0, omega)


def faulty(rng, odometry):
    """Spoil odometry in a random manner."""
    kind = rng.integers(6)
    if kind == 0:
        return odometry._replace(pose=Pose(*rng.uniform(-1e6, 1e6, 3)))
    if kind == 1:
        return odometry._replace(twist=Twist(*rng.uniform(-10.0, 10.0, 3)))
    if kind == 2:
        return odometry._replace(time=odometry.time + rng.uniform(-2.0, 2.0))
    if kind == 3:
        return odometry._replace(twist=Twist(math.nan, 0.0, 0.0))
    if kind == 4:
        return odometry._replace(pose=Pose(math.inf, 0.0, 0.0))
    return odometry._replace(twist=STOP)


@pytest.mark.parametrize('drive', ROBOTS)
@pytest.mark.parametrize('seed', range(20))
def test_whatever_comes_what_is_sent_is_within_the_limits(drive, seed):
    """And zero for as long as there is a reason to stop."""
    rng, robot = np.random.default_rng(seed), ROBOTS[drive]
    layer, base, command = SafetyLayer(robot, BOX), Base(robot), STOP
    for _ in range(250):
        if rng.random() < 0.1:
            command = random_command(rng, robot)
        odometry = base.odometry if rng.random() < 0.98 else faulty(rng, base.odometry)
        layer.observe(odometry)
        sent = layer.filter(command, base.odometry.time)
        assert all(map(math.isfinite, sent))
        assert math.hypot(sent.v_x, sent.v_y) <= robot.max_speed * (1.0 + 1e-6)
        assert abs(sent.omega) <= robot.max_yaw_rate * (1.0 + 1e-6)
        assert drive == 'holonomic' or sent.v_y == 0.0
        assert (layer.state is SafetyState.STOPPED) == (layer.report is not None)
        if layer.report is not None:
            assert sent == STOP and str(layer.report)
        base.drive(sent)


@pytest.mark.parametrize('drive', ROBOTS)
@pytest.mark.parametrize('seed', range(10))
def test_a_robot_that_follows_is_never_stopped(drive, seed):
    """Slower than stated, late within reason, with noise, and commands that jump at random."""
    rng, nominal = np.random.default_rng(seed), ROBOTS[drive]
    true = dataclasses.replace(nominal, time_constant=rng.uniform(0.02, 0.2),
                               max_acceleration=rng.uniform(0.5, 1.5) * nominal.max_acceleration)
    layer, base, command = SafetyLayer(nominal, BOX), Base(true, rng.uniform(0.0, 0.2)), STOP
    for _ in range(500):
        if rng.random() < 0.05:
            v_x, v_y, omega = (rng.uniform(-1.0, 1.0, 3) * (0.3, 0.3, 1.5)).tolist()
            command = Twist(v_x, v_y if drive == 'holonomic' else 0.0, omega)
        noise = Twist(*(rng.standard_normal(3) * (0.005, 0.005, 0.01)).tolist())
        twist = Twist(*(a + b for a, b in zip(base.odometry.twist, noise)))
        assert layer.observe(base.odometry._replace(twist=twist)) is None
        base.drive(layer.filter(command, base.odometry.time))


@pytest.mark.parametrize('delay', [0.0, 0.05])
def test_a_clock_of_object_poses_that_is_ahead_is_no_fault_of_the_base(delay):
    """A command is not one of the future, which a base cannot follow."""
    layer, base = SafetyLayer(ROBOTS['differential'], BOX), Base(ROBOTS['differential'], delay)
    for i in range(1000):
        assert layer.observe(base.odometry) is None
        speed = 0.3 if i % 100 < 50 else 0.0
        base.drive(layer.filter(Twist(speed, 0.0, 4.0 * speed), base.odometry.time + 2e-4 * i))


def driven(layer, base, command, duration, spoil=lambda odometry: odometry, heed=True):
    """Drive for a while; return when and why the robot was stopped, and how far it went then."""
    start = base.odometry
    while base.odometry.time < start.time + duration:
        layer.observe(spoil(base.odometry))
        sent = layer.filter(command, base.odometry.time)
        if layer.report is not None:
            return base.odometry.time - start.time, layer.report
        base.drive(sent if heed is True else heed(sent))
    return duration, None


@pytest.mark.parametrize('heed, reason, limit', [
    (lambda sent: STOP, SafetyReason.NOT_MOVING, 0.8),
    (lambda sent: Twist(-sent.v_x, 0.0, sent.omega), SafetyReason.MOVES_OTHERWISE, 0.5),
    (lambda sent: Twist(0.4, 0.0, 0.0), SafetyReason.MOVES_OTHERWISE, 0.5)],
    ids=['ignores', 'reversed', 'somebody else'])
def test_a_base_that_does_something_else_is_stopped(heed, reason, limit):
    """Soon, and for its reason; standing for a while it may go on."""
    layer, base = SafetyLayer(ROBOTS['differential'], BOX), Base(ROBOTS['differential'])
    time, report = driven(layer, base, Twist(0.2, 0.0, 0.0), 3.0, heed=heed)
    assert time < limit and report.code is reason
    for _ in range(100):
        layer.observe(base.odometry)
        assert layer.report is None or layer.filter(Twist(0.2, 0.0, 0.0), 0.0) == STOP
        base.drive(STOP)
    assert layer.state is SafetyState.CLEAR


def test_the_report_tells_where_the_robot_has_followed_least():
    """Not what holds when it is found: by then it may have been commanded to stand."""
    reports = []
    for count in range(1, 40):
        layer, base = SafetyLayer(ROBOTS['differential'], BOX), Base(ROBOTS['differential'])
        _, before = driven(layer, base, Twist(0.3, 0.0, 0.0), count * PERIOD,
                           heed=lambda sent: STOP)
        _, after = driven(layer, base, STOP, 1.0)
        if before is None and after is not None:
            reports.append(str(after))
    assert reports
    for report in reports:
        speed = float(report.partition(': (')[2].partition(' m/s')[0])
        assert speed > 0.03 and report.endswith(
            ' expected, (0.00 m/s, 0.00 m/s, 0.00 rad/s) measured')


@pytest.mark.parametrize('speed', [0.03, 0.1, 0.3])
@pytest.mark.parametrize('heed', [lambda sent: STOP, lambda sent: Twist(-sent.v_x, 0.0, 0.0)],
                         ids=['ignores', 'reversed'])
def test_a_base_at_speed_that_fails_is_stopped_within_centimetres(heed, speed):
    """And soon, the slower the later."""
    layer, base = SafetyLayer(ROBOTS['differential'], BOX), Base(ROBOTS['differential'])
    command = Twist(speed, 0.0, 0.0)
    assert driven(layer, base, command, 2.0) == (pytest.approx(2.0, abs=PERIOD), None)
    start = base.odometry.pose
    time, _ = driven(layer, base, command, 3.0, heed=heed)
    assert time < (0.6 if speed < 0.05 else 0.31)
    assert distance(start, base.odometry.pose) < 0.05


def test_a_base_that_has_followed_closely_is_held_to_that():
    """What begins at once is noticed later; with another load for good it is no fault."""
    times = []
    for seconds in (1.0, 6.0):
        layer, base = SafetyLayer(ROBOTS['differential'], BOX), Base(ROBOTS['differential'])
        command = Twist(0.2, 0.0, 0.2)
        assert driven(layer, base, command, seconds)[1] is None
        times.append(driven(layer, base, command, 3.0,
                            heed=lambda sent: Twist(0.75 * sent.v_x, 0.0, sent.omega))[0])
    assert times[1] < 0.4 < 0.5 < times[0]
    layer, base = SafetyLayer(ROBOTS['differential'], BOX), Base(ROBOTS['differential'])
    assert driven(layer, base, Twist(0.2, 0.0, 0.2), 10.0,
                  heed=lambda sent: Twist(0.92 * sent.v_x, 0.0, sent.omega))[1] is None


def test_a_base_that_now_and_then_follows_less_closely_is_stopped_once():
    """Under another load or on a slope, within what any base may do."""
    layer, base = SafetyLayer(ROBOTS['differential'], BOX), Base(ROBOTS['differential'])
    command = Twist(0.2, 0.0, 0.2)
    assert driven(layer, base, command, 6.0)[1] is None

    def loaded(sent):
        return Twist(0.86 * sent.v_x, 0.0, sent.omega)
    time, report = driven(layer, base, command, 3.0, heed=loaded)
    assert time < 3.0 and report.code is SafetyReason.NOT_MOVING
    for _ in range(100):
        layer.observe(base.odometry)
        base.drive(STOP)
    assert layer.state is SafetyState.CLEAR
    for _ in range(2):
        assert driven(layer, base, command, 10.0)[1] is None
        assert driven(layer, base, command, 3.0, heed=loaded)[1] is None


@pytest.mark.parametrize('step, is_stuck', [(1.0, True), (0.015, False)])
def test_a_base_that_does_not_answer_small_changes_is_stuck(step: float, is_stuck: bool) -> None:
    """Before it is 25 mm beside where it should be; one that only ignores the smallest is not."""
    layer, base = SafetyLayer(ROBOTS['differential'], BOX), Base(ROBOTS['differential'], 0.1)
    assert driven(layer, base, Twist(0.15, 0.0, 0.0), 3.0)[1] is None
    start, kept = base.odometry.time, Twist(0.15, 0.0, 0.0)

    def keep(sent: Twist) -> Twist:
        nonlocal kept
        if max(abs(sent.v_x - kept.v_x), 0.2 * abs(sent.omega - kept.omega)) > step:
            kept = sent
        return kept
    beside = 0.0
    for _ in range(500):
        time = base.odometry.time - start
        command = Twist(0.15 - 0.04 * math.sin(time), 0.0, 0.1 * math.sin(1.3 * time))
        report = driven(layer, base, command, 0.5 * PERIOD, heed=keep)[1]
        beside += PERIOD * abs(command.v_x - kept.v_x)
        if report is not None:
            break
    assert (report is not None) == is_stuck
    assert not is_stuck or beside < 0.025


def after_a_gap(delay: float, duration: float, *,
                is_noticed: bool = True) -> tuple[SafetyLayer, Base, Twist]:
    """Drive, and let a while pass in which the base stops by itself for want of commands."""
    layer, base = SafetyLayer(ROBOTS['differential'], BOX), Base(ROBOTS['differential'], delay)
    command = Twist(0.2, 0.0, 1.0)
    assert driven(layer, base, command, 4.0)[1] is None
    lost_at = base.odometry.time
    while base.odometry.time < lost_at + duration:
        base.drive(command if base.odometry.time < lost_at + 0.5 else STOP)
    if is_noticed:
        layer.interrupt()
    return layer, base, command


@pytest.mark.parametrize('delay', [0.0, 0.1, 0.2])
@pytest.mark.parametrize('duration', [0.3, 0.6, 0.7, 0.8, 1.0, 3.0])
def test_what_a_base_did_in_a_gap_is_no_fault_after_it(delay, duration):
    """Nor is the way in which it takes up its commands again."""
    layer, base, command = after_a_gap(delay, duration)
    assert driven(layer, base, command, 5.0)[1] is None


def test_a_gap_that_nobody_has_noticed_shows_in_odometry() -> None:
    """What a base did in it is no fault after it."""
    layer, base, command = after_a_gap(0.1, 1.0, is_noticed=False)
    assert driven(layer, base, command, 2.0)[1] is None


@pytest.mark.parametrize('heed, limit', [
    (lambda sent: STOP, 0.3), (lambda sent: Twist(-sent.v_x, 0.0, -sent.omega), 0.3),
    (lambda sent: Twist(0.4, 0.0, 0.0), 0.5)], ids=['ignores', 'reversed', 'somebody else'])
def test_a_base_that_fails_in_a_gap_is_stopped_soon_after_it(heed, limit):
    """No later than by what it may follow from before, and than at any other time."""
    layer, base, command = after_a_gap(0.1, 1.0)
    time, report = driven(layer, base, command, 3.0, heed=heed)
    assert report is not None and time < MAX_RESPONSE_TIME + limit


def test_a_base_that_moves_while_it_is_commanded_to_stand_is_named_at_once():
    """As one that keeps its last command."""
    layer, base = SafetyLayer(ROBOTS['differential'], BOX), Base(ROBOTS['differential'])
    driven(layer, base, Twist(0.15, 0.0, 0.3), 2.0)
    time, report = driven(layer, base, STOP, 2.0, heed=lambda sent: Twist(0.15, 0.0, 0.3))
    assert time < 0.7 and report.code is SafetyReason.MOVES_OTHERWISE
    for _ in range(50):
        layer.observe(base.drive(Twist(0.15, 0.0, 0.3)))
    assert layer.report is report
    for _ in range(100):
        layer.observe(base.drive(STOP))
    assert layer.report is None


def test_a_base_that_follows_late_is_named_as_such():
    """With its delay, as soon as the base has moved at all."""
    layer = SafetyLayer(ROBOTS['differential'], BOX)
    base, reports = Base(ROBOTS['differential'], delay=0.5), []
    for i in range(200):
        layer.observe(base.odometry)
        base.drive(layer.filter(Twist(0.2 if i % 60 < 30 else 0.0, 0.0, 0.0),
                                base.odometry.time))
        if layer.report is not None and layer.report not in reports:
            reports.append(layer.report)
    late = [report for report in reports if report.code is SafetyReason.FOLLOWS_LATE]
    assert late and late[0].values['delay'] == pytest.approx(0.5, abs=0.11)


@pytest.mark.parametrize('spoil, reason', [
    (lambda odometry: odometry._replace(pose=Pose(0.3, 0.0, 0.0) @ odometry.pose),
     SafetyReason.ODOMETRY_JUMPED),
    (lambda odometry: odometry._replace(pose=Pose(1.0, 2.0, 0.0)), SafetyReason.ODOMETRY_JUMPED),
    (lambda odometry: odometry._replace(pose=Pose(*(1e-3 * x for x in odometry.pose))),
     SafetyReason.ODOMETRY_JUMPED)],
    ids=['jump', 'reset', 'unit'])
def test_odometry_that_contradicts_itself_stops_the_robot(spoil, reason):
    """Within a third of a second of a robot at speed."""
    layer, base = SafetyLayer(ROBOTS['differential'], BOX), Base(ROBOTS['differential'])
    command = Twist(0.3, 0.0, 0.1)
    assert driven(layer, base, command, 1.0) == (pytest.approx(1.0, abs=PERIOD), None)
    time, report = driven(layer, base, command, 2.0, spoil)
    assert time < MAX_RESPONSE_TIME and report.code is reason


def test_a_twist_that_is_never_filled_in_stops_the_robot():
    """It is odometry that is wrong, and not the base."""
    layer, base = SafetyLayer(ROBOTS['holonomic'], BOX), Base(ROBOTS['holonomic'])
    time, report = driven(layer, base, Twist(0.0, 0.3, 0.0), 2.0,
                          lambda odometry: odometry._replace(twist=STOP))
    assert time < 0.5 and report.code is SafetyReason.ODOMETRY_CONTRADICTORY


def test_a_heading_beside_the_motion_stops_the_robot():
    """However slowly it drives; a unit of the twist that is a third off is told apart."""
    for spoil, reason in (
            (lambda odometry: odometry._replace(pose=odometry.pose._replace(
                theta=wrap_angle(odometry.pose.theta + 0.5))), SafetyReason.ODOMETRY_DIRECTION),
            (lambda odometry: odometry._replace(twist=Twist(
                *(1.35 * value for value in odometry.twist))), SafetyReason.ODOMETRY_SCALE)):
        layer, base = SafetyLayer(ROBOTS['differential'], BOX), Base(ROBOTS['differential'])
        time, report = driven(layer, base, Twist(0.1, 0.0, 0.1), 5.0, spoil)
        assert time < 3.5 and report.code is reason and report.code.is_of_odometry


def test_a_clock_that_falls_back_stops_the_robot_and_nothing_has_jumped():
    """Not even where it has driven on meanwhile; what has jumped with its clock has jumped."""
    for moved, expected in ((Pose(0.0, 0.0, 0.0), None),
                            (Pose(0.3, 0.0, 0.0), SafetyReason.ODOMETRY_JUMPED)):
        layer, base = SafetyLayer(ROBOTS['differential'], BOX), Base(ROBOTS['differential'])
        driven(layer, base, Twist(0.3, 0.0, 1.0), 1.0)

        def late(odometry):
            return odometry._replace(time=odometry.time - 0.5, pose=moved @ odometry.pose)
        time, report = driven(layer, base, Twist(0.3, 0.0, 1.0), 1.0, late)
        assert report.code is SafetyReason.CLOCK_FELL_BACK and time < 5 * PERIOD
        # The base obeys nobody until it has caught up.
        faults = [layer.observe(late(base.drive(Twist(0.3, 0.0, 1.0)))) for _ in range(30)]
        found = {fault.code for fault in faults if fault} - {SafetyReason.CLOCK_FELL_BACK}
        assert found - {SafetyReason.MOVES_OTHERWISE} == ({expected} if expected else set())


def test_a_message_that_comes_late_is_no_reason_to_stop():
    """Nor two: best effort may change their order."""
    layer, base = SafetyLayer(ROBOTS['holonomic'], BOX), Base(ROBOTS['holonomic'])
    messages = [base.drive(layer.filter(Twist(0.1, 0.1, 0.3), i * PERIOD)) for i in range(60)]
    for i in (20, 30, 31, 40, 50):
        messages.insert(i, messages.pop(i + 2))
    assert [layer.observe(message) for message in messages] == [None] * 60


def test_a_twist_in_world_axes_is_a_fault_of_odometry_and_not_of_the_base():
    """Although the base seems to drive elsewhere, which shows first."""
    layer, base = SafetyLayer(ROBOTS['differential'], BOX), Base(ROBOTS['differential'])
    base.odometry = base.odometry._replace(pose=Pose(0.0, 0.0, 2.9))
    driven(layer, base, Twist(0.3, 0.0, 0.1), 2.0)

    def in_world_axes(odometry):
        v_x, v_y = odometry.pose.rotate(odometry.twist[:2])
        return odometry._replace(twist=Twist(v_x, v_y, odometry.twist.omega))
    time, report = driven(layer, base, Twist(0.3, 0.0, 0.1), 2.0, in_world_axes)
    assert time < MAX_RESPONSE_TIME and report.code.is_of_odometry


@pytest.mark.parametrize('angle', [0.3, 1.0, -2.0])
def test_axes_of_a_twist_that_are_right_again_let_the_robot_go_on(angle):
    """Once it has stood: what was covered before adds nothing to what is wrong."""
    robot = ROBOTS['holonomic']
    layer, base = SafetyLayer(robot, BOX), Base(robot)

    def turned(odometry):
        v_x, v_y, omega = odometry.twist
        x, y = Pose(0.0, 0.0, angle).rotate((v_x, v_y))
        return odometry._replace(twist=Twist(x, y, omega))
    time, _ = driven(layer, base, Twist(0.15, 0.0, 0.0), 5.0, turned)
    # That it is odometry, and not the base, shows while the robot comes to rest.
    for _ in range(10):
        layer.observe(turned(base.drive(layer.filter(STOP, base.odometry.time))))
    assert layer.report.code.is_of_odometry and time < 2.5
    for _ in range(100):
        layer.observe(turned(base.drive(layer.filter(STOP, base.odometry.time))))
    assert layer.state is SafetyState.CLEAR
    assert driven(layer, base, Twist(0.15, 0.0, 0.0), 5.0)[1] is None


@pytest.mark.parametrize('period', [0.02, 0.1])
def test_a_robot_whose_odometry_ends_slows_down_before_the_time_out(period):
    """Where it is silent for longer than it has been of late; up to then nothing changes."""
    layer, command = SafetyLayer(ROBOTS['holonomic'], BOX), Twist(0.3, 0.1, 0.0)
    for i in range(round(3.0 / period)):
        place = Pose(0.3 * i * period, 0.1 * i * period, 0.0)
        layer.observe(Odometry(i * period, place, command))
        sent = [layer.filter(command, (i + part) * period) for part in (0.0, 0.5, 0.99)]
        layer.release()
        assert sent == [command] * 3
    later = [layer.filter(command, i * period + 0.01 * j) for j in range(32)]
    assert later[5] == command and later[31] == STOP
    assert all(a.v_x >= b.v_x for a, b in zip(later, later[1:]))
    assert later[20].v_y / 0.1 == pytest.approx(later[20].v_x / 0.3)
    assert period == 0.1 or later[15].v_x < 0.5 * 0.3 and later[22] == STOP
    layer.observe(Odometry(10.0, place, STOP))
    assert layer.filter(Twist(0.1, 0.0, 0.0), 10.0) == Twist(0.1, 0.0, 0.0)


def test_a_network_that_is_late_at_times_slows_the_robot_once():
    """Stamps come as regularly as ever; how long they take is learned from when they come."""
    layer, base = SafetyLayer(ROBOTS['holonomic'], BOX), Base(ROBOTS['holonomic'])
    command, measured, slowed = Twist(0.3, 0.0, 0.0), [base.odometry], []
    for i in range(800):
        # Later on odometry is late twice a second by up to 0.15 s, while poses come on time.
        layer.observe(measured[i - i % 25 if i > 400 and i % 25 < 8 else i])
        sent = layer.filter(command, base.odometry.time)
        measured.append(base.drive(sent))
        if i > 400 and sent != command:
            slowed.append(i)
    assert slowed and max(slowed) < 425


@pytest.mark.parametrize('delay', [0.0, 0.1])
@pytest.mark.parametrize('longest', [0.15, 0.3])
def test_a_good_base_whose_odometry_comes_late_at_times_is_not_stopped(
        delay: float, longest: float) -> None:
    """It is slowed down meanwhile, which it shows when its odometry comes all at once."""
    rng = np.random.default_rng(5)
    layer, base = SafetyLayer(ROBOTS['holonomic'], BOX), Base(ROBOTS['holonomic'], delay)
    waiting, late_until, is_slowed = [base.odometry], 0.0, False
    for i in range(3000):
        now = base.odometry.time
        if i % 50 == 25:
            late_until = now + rng.uniform(0.05, longest)
        command = Twist(0.3 * math.sin(0.5 * now), 0.1 * math.cos(0.7 * now), math.sin(0.3 * now))
        while waiting and now >= late_until:
            layer.observe(waiting.pop(0))
        # Object poses, which are not late, let time go on.
        sent = layer.filter(command, now)
        assert layer.report is None
        is_slowed |= sent != command
        waiting.append(base.drive(sent))
    assert is_slowed


def test_stamps_that_come_out_of_order_by_a_little_are_no_fault() -> None:
    """As of odometry at 100 Hz from a busy computer; a clock that falls back further is one."""
    layer, base = SafetyLayer(ROBOTS['holonomic'], BOX), Base(ROBOTS['holonomic'])
    driven(layer, base, Twist(0.2, 0.0, 0.0), 1.0)
    newest = base.odometry
    layer.observe(newest)
    for shift, is_fault in ((0.035, False), (0.06, True)):
        for i in range(3):
            layer.observe(newest._replace(time=newest.time - shift + 1e-3 * i))
        assert (layer.report is not None) is is_fault


def test_who_else_commands_the_base_is_named():
    """Where it moves otherwise; while it follows nothing is wrong."""
    layer, base = SafetyLayer(ROBOTS['differential'], BOX), Base(ROBOTS['differential'])
    layer.other_commanders = '/teleop'
    assert driven(layer, base, Twist(0.2, 0.0, 0.0), 1.0) == (pytest.approx(1.0), None)
    _, report = driven(layer, base, Twist(0.2, 0.0, 0.0), 3.0,
                       heed=lambda sent: Twist(0.0, 0.0, 1.0))
    assert report.code is SafetyReason.COMMANDED_BY_OTHERS and '/teleop' in str(report)


@pytest.mark.parametrize('drive', ROBOTS)
def test_odometry_that_has_stood_still_and_catches_up_has_not_jumped(drive):
    """Where the commands since explain it; where the robot was not commanded, it has jumped."""
    for command, is_explained in ((Twist(0.2, 0.0, 1.0), True), (STOP, False)):
        layer, base = SafetyLayer(ROBOTS[drive], BOX), Base(ROBOTS[drive])
        driven(layer, base, command, 0.5, lambda odometry: odometry)
        frozen = base.odometry
        for _ in range(100):
            layer.observe(frozen._replace(time=base.odometry.time, twist=STOP))
            base.drive(layer.filter(command, base.odometry.time))
        here = base.odometry
        if not is_explained:
            here = here._replace(pose=Pose(0.1, 0.0, 0.0) @ here.pose)
        layer.observe(here._replace(time=here.time + PERIOD))
        found = layer.observe(here._replace(time=here.time + 2 * PERIOD))
        assert distance(frozen.pose, here.pose) > 0.05 and found is None
        assert (layer.report is not None
                and layer.report.code is SafetyReason.ODOMETRY_JUMPED) is not is_explained


def test_frozen_odometry_stops_the_robot():
    """Fresh stamps alone are no news."""
    layer, base = SafetyLayer(ROBOTS['differential'], BOX), Base(ROBOTS['differential'])
    driven(layer, base, Twist(0.3, 0.0, 0.0), 1.0)
    frozen = base.odometry
    time, report = driven(layer, base, Twist(0.3, 0.0, 0.0), 2.0,
                          lambda odometry: frozen._replace(time=odometry.time))
    assert time < MAX_RESPONSE_TIME and report.code is SafetyReason.ODOMETRY_FROZEN


@pytest.mark.parametrize('speed', [0.03, 0.06, 0.2])
def test_odometry_that_is_rounded_does_not_repeat_a_pose(speed):
    """To a centimetre and a degree, from the first step on or later."""
    def rounded(odometry):
        x, y, theta = odometry.pose
        return odometry._replace(pose=Pose(round(x, 2), round(y, 2), round(theta / 0.02) * 0.02))

    layer, base = SafetyLayer(ROBOTS['differential'], BOX), Base(ROBOTS['differential'])
    for command in (Twist(speed, 0.0, 0.0), Twist(speed, 0.0, 0.08), Twist(-speed, 0.0, 0.0)):
        assert driven(layer, base, command, 4.0, spoil=rounded)[1] is None
    # Rounded later on, it is stopped once at most.
    assert driven(layer, base, Twist(-speed, 0.0, 0.0), 2.0)[1] is None
    driven(layer, base, Twist(-speed, 0.0, 0.0), 1.0, spoil=rounded)
    for _ in range(100):
        layer.observe(rounded(base.drive(layer.filter(STOP, base.odometry.time))))
    assert driven(layer, base, Twist(-speed, 0.0, 0.0), 4.0, spoil=rounded)[1] is None
    frozen = base.odometry.pose
    time, report = driven(layer, base, Twist(-speed, 0.0, 0.0), 2.0,
                          spoil=lambda odometry: odometry._replace(pose=frozen))
    assert report.code is SafetyReason.ODOMETRY_FROZEN and time * speed < 0.041


def test_a_base_that_fails_again_soon_stands_for_longer():
    """So that a fault of some seconds stops the robot twice, and no third time."""
    layer, base = SafetyLayer(ROBOTS['differential'], BOX), Base(ROBOTS['differential'])
    stops = []
    while base.odometry.time < 10.0:
        held = layer.report is not None
        layer.observe(base.odometry)
        sent = layer.filter(Twist(0.2, 0.0, 0.0), base.odometry.time)
        if layer.report is not None and not held:
            stops.append(base.odometry.time)
        base.drive(STOP if base.odometry.time < 4.0 else sent)
    assert len(stops) == 2 and stops[1] < 2.5
    assert layer.report is None and base.odometry.twist.v_x > 0.19


def test_a_robot_that_nobody_commands_may_be_driven_by_others():
    """As by teleoperation, and then be taken over at speed."""
    layer, base = SafetyLayer(ROBOTS['differential'], BOX), Base(ROBOTS['differential'])
    for _ in range(100):
        layer.release()
        assert layer.observe(base.odometry) is None
        base.drive(Twist(0.3, 0.0, 0.5))
    assert driven(layer, base, STOP, 1.0) == (pytest.approx(1.0, abs=PERIOD), None)


def test_a_command_that_is_not_finite_stops_the_robot():
    """Until it has stood for a while."""
    layer, base = SafetyLayer(ROBOTS['differential'], BOX), Base(ROBOTS['differential'])
    assert layer.filter(Twist(math.nan, 0.0, 0.0), 0.0) == STOP
    assert layer.report.code is SafetyReason.COMMAND_NOT_FINITE
    time, _ = driven(layer, base, Twist(0.1, 0.0, 0.0), 1.0)
    assert time == 0.0
    for _ in range(round((REST_TIME + 0.1) / PERIOD)):
        layer.observe(base.drive(STOP))
    assert layer.filter(Twist(0.1, 0.0, 0.0), base.odometry.time) == Twist(0.1, 0.0, 0.0)
