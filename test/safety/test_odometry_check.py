"""Odometry against itself: laws of a drive whose poses and twists mean the same, or do not."""

from collections.abc import Callable, Sequence
import dataclasses
import math

from helpers.push_problems import HOLONOMIC
import numpy as np
from push_model.geometry import distance, Pose, wrap_angle
from push_model.signals import Odometry, PoseCovariance, STOP, Twist
from push_safety.odometry_check import OdometryCheck
from push_safety.status import SafetyReason, SafetyReport
from push_safety.tolerances import (
    CORRECTION_PERIOD, DIRECTION_PATH, ODOMETRY_JUMP_DISTANCE, ODOMETRY_JUMP_ROTATION)
import pytest

ROBOT = dataclasses.replace(HOLONOMIC, max_speed=0.4, max_yaw_rate=1.5)
# Steps of the integration in a period; the check uses one.
FINE_STEPS = 10
Spoiler = Callable[[int, Odometry], Odometry]


@dataclasses.dataclass(frozen=True)
class Drive:
    """
    A smooth drive with drawn speeds, of a robot whose odometry is right.

    :param period: of its odometry [s].
    :param messages: in order.
    """

    period: float
    messages: list[Odometry]

    def first_fault(self, spoil: Spoiler | None = None, *,
                    is_absolute: bool = False) -> tuple[int, SafetyReport] | None:
        """Return the index of the first message with a fault, and the fault, if any."""
        check = OdometryCheck(ROBOT, is_absolute=is_absolute)
        for index, message in enumerate(self.messages):
            fault = check.check(message if spoil is None else spoil(index, message))
            if fault is not None:
                return index, fault
        return None

    def path_length(self, first: int, last: int) -> float:
        """Sum up the steps from one message to another [m]."""
        poses = [message.pose for message in self.messages[first:last + 1]]
        return sum(distance(a, b) for a, b in zip(poses, poses[1:]))


def drive(seed: int, duration: float = 8.0, min_speed: float = 0.0) -> Drive:
    """Draw a drive: speeds that vary along both axes, turns, and 10 to 100 messages a second."""
    rng = np.random.default_rng(seed)
    period = float(rng.choice([0.01, 0.02, 0.05, 0.1]))
    speed, lateral, yaw = rng.uniform((0.03, -0.1, -0.8), (0.3, 0.1, 0.8)).tolist()
    rates, phases = rng.uniform(0.2, 2.0, 3), rng.uniform(-math.pi, math.pi, 3)

    def twist(time: float) -> Twist:
        a, b, c = np.sin(rates * time + phases).tolist()
        return Twist(max(min_speed, speed * (1.0 + 0.5 * a)), lateral * b, yaw * c)
    pose, messages = Pose(*rng.uniform(-3.0, 3.0, 3).tolist()), list[Odometry]()
    step = period / FINE_STEPS
    for index in range(round(duration / period)):
        messages.append(Odometry(index * period, pose, twist(index * period)))
        for fine in range(FINE_STEPS):
            v_x, v_y, omega = twist(index * period + (fine + 0.5) * step)
            x, y = Pose(0.0, 0.0, pose.theta + 0.5 * omega * step).rotate((v_x * step, v_y * step))
            pose = Pose(pose.x + x, pose.y + y, wrap_angle(pose.theta + omega * step))
    return Drive(period, messages)


def mirrored(message: Odometry) -> Odometry:
    """Return the odometry of a robot that drives as in a mirror."""
    (x, y, theta), (v_x, v_y, omega) = message.pose, message.twist
    return message._replace(pose=Pose(x, -y, -theta), twist=Twist(v_x, -v_y, -omega))


def scaled(ratio: float) -> Spoiler:
    """Return a mistake of the unit of the twist."""
    return lambda _, message: message._replace(
        twist=Twist(*(ratio * value for value in message.twist)))


def turned(angle: float) -> Spoiler:
    """Return a mistake of the heading of the pose."""
    return lambda _, message: message._replace(pose=message.pose._replace(
        theta=wrap_angle(message.pose.theta + angle)))


@pytest.mark.parametrize('seed', range(40))
def test_odometry_that_agrees_with_itself_is_never_a_fault(seed: int) -> None:
    """With noise of the twist, wheels that are not quite of the stated size, lost messages."""
    rng, right = np.random.default_rng(seed), drive(seed)
    ratio, noise = rng.uniform(0.9, 1.1), rng.choice([0.0, 0.01, 0.02])

    def disturbed(_: int, message: Odometry) -> Odometry:
        errors = (noise * rng.standard_normal(3) * (1.0, 1.0, 2.0)).tolist()
        return message._replace(twist=Twist(*(
            ratio * value + error for value, error in zip(message.twist, errors))))
    assert right.first_fault() is None and right.first_fault(disturbed) is None
    some = Drive(right.period, [message for message in right.messages if rng.random() < 0.7])
    assert some.first_fault(disturbed) is None


@pytest.mark.parametrize('spoil', [scaled(1.5), scaled(0.6), turned(0.4), turned(-0.4)],
                         ids=['too fast', 'too slow', 'left', 'right'])
@pytest.mark.parametrize('seed', range(6))
def test_axes_of_the_world_and_its_mirror_image_make_no_difference(
        spoil: Spoiler, seed: int) -> None:
    """The same message is the first with a fault, for the same reason, by the same values."""
    right = drive(seed, min_speed=0.05)
    fault = right.first_fault(spoil)
    assert fault is not None
    for axes in (Pose(0.0, 0.0, 2.0), Pose(5.0, -7.0, -3.0)):
        elsewhere = right.first_fault(lambda index, message: spoil(index, message)._replace(
            pose=axes @ spoil(index, message).pose))
        assert elsewhere is not None and elsewhere[0] == fault[0]
        assert elsewhere[1].code is fault[1].code
        assert elsewhere[1].values == pytest.approx(fault[1].values, abs=1e-6)
    image = right.first_fault(lambda index, message: mirrored(spoil(index, message)))
    assert image is not None and image[0] == fault[0] and image[1].code is fault[1].code


@pytest.mark.parametrize('start', [0.0, 0.9, 2.3, 3.1])
@pytest.mark.parametrize('spoil', [scaled(1.4), scaled(0.6), turned(0.25), turned(-0.25)],
                         ids=['too fast', 'too slow', 'left', 'right'])
@pytest.mark.parametrize('seed', range(5))
def test_units_and_axes_that_are_wrong_show_within_a_path(
        spoil: Spoiler, start: float, seed: int) -> None:
    """From any moment on: after 0.3 m of a straight path, and little more than twice on a bend."""
    right = drive(seed, duration=30.0, min_speed=0.05)
    first = round(start / right.period)
    fault = right.first_fault(
        lambda index, message: spoil(index, message) if index >= first else message)
    assert fault is not None and fault[1].code.is_of_odometry and fault[0] >= first
    assert right.path_length(first, fault[0]) < 2.2 * DIRECTION_PATH


@pytest.mark.parametrize('seed', range(6))
@pytest.mark.parametrize('angle', [0.0, 1.5, -2.5])
def test_a_jump_shows_at_once_in_any_direction(seed: int, angle: float) -> None:
    """At every message; one within the rounding does not."""
    right = drive(seed, duration=2.0)
    far = Pose(0.0, 0.0, angle).rotate((ODOMETRY_JUMP_DISTANCE + 0.05, 0.0))
    near = Pose(0.0, 0.0, angle).rotate((0.5 * ODOMETRY_JUMP_DISTANCE, 0.0))
    for at in range(1, len(right.messages), 7):
        def jumped(shift: tuple[float, float], at: int = at) -> Spoiler:
            return lambda index, message: message if index < at else message._replace(
                pose=Pose(message.pose.x + shift[0], message.pose.y + shift[1],
                          message.pose.theta))
        fault = right.first_fault(jumped(far))
        assert fault is not None and fault[0] == at
        assert fault[1].code is SafetyReason.ODOMETRY_JUMPED
        assert fault[1].values['distance'] == pytest.approx(math.hypot(*far), abs=0.02)
        assert right.first_fault(jumped(near)) is None


@pytest.mark.parametrize('seed', range(8))
def test_a_pose_that_repeats_itself_while_the_robot_drives_is_frozen(seed: int) -> None:
    """From any moment on, within the time of some messages and two of its steps."""
    right = drive(seed, duration=6.0, min_speed=0.05)
    for at in range(5, len(right.messages) // 2, max(1, len(right.messages) // 20)):
        frozen = right.messages[at].pose
        fault = right.first_fault(
            lambda index, message: message if index < at else message._replace(pose=frozen))
        assert fault is not None and fault[1].code.is_of_odometry
        late = right.messages[fault[0]].time - right.messages[at].time
        assert late <= max(0.15, 3.0 * right.period) + 1.01 * right.period


def corrected(first: int, second: int, jump: float, std: float | None) -> Spoiler:
    """Return corrections of a map, one to the left and one back, with a stated deviation."""
    covariance = None if std is None else PoseCovariance.from_deviations(std, std)

    def spoil(index: int, message: Odometry) -> Odometry:
        x, y, theta = message.pose
        offset = jump if first <= index < second else 0.0
        return message._replace(pose=Pose(x, y + offset, theta), covariance=covariance)
    return spoil


@pytest.mark.parametrize('seed', range(10))
def test_a_correction_of_a_map_is_a_fault_only_beyond_what_is_stated(seed: int) -> None:
    """Where the pose is measured in the world; the twist of a drive goes on as before."""
    right = drive(seed, min_speed=0.05)
    first = round(3.0 / right.period)
    second = first + math.ceil(1.5 * CORRECTION_PERIOD / right.period)
    small = corrected(first, second, 0.2, 0.05)
    assert right.first_fault(small, is_absolute=True) is None
    for spoil, is_absolute in ((small, False), (corrected(first, second, 0.4, 0.05), True),
                               (corrected(first, second, 0.3, None), True),
                               (corrected(first, second, 1.1, 5.0), True)):
        found = right.first_fault(spoil, is_absolute=is_absolute)
        assert found is not None and found[0] == first
        assert found[1].code is SafetyReason.ODOMETRY_JUMPED


@pytest.mark.parametrize('seed', range(10))
def test_a_twist_that_is_missing_is_no_correction_of_a_map(seed: int) -> None:
    """However large an error is stated: it shows at every step, and corrections are rare."""
    right = drive(seed, min_speed=0.15)
    covariance = PoseCovariance.from_deviations(0.07, 0.04)
    found = right.first_fault(lambda _, message: message._replace(
        twist=Twist(0.0, 0.0, 0.0), covariance=covariance), is_absolute=True)
    assert found is not None and found[0] * right.period < 3.0 * CORRECTION_PERIOD


@pytest.mark.parametrize('drive_type', ['differential', 'holonomic'])
@pytest.mark.parametrize('side', [-1.0, 1.0])
def test_only_wheels_of_a_differential_drive_do_not_go_to_the_side(drive_type: str,
                                                                   side: float) -> None:
    """Their twist is in wrong axes then; a turn may show as much of it as its lever means."""
    check = OdometryCheck(dataclasses.replace(ROBOT, drive=drive_type))
    pose = Pose(0.0, 0.0, 0.0)
    for index, twist in enumerate((Twist(0.1, side * 0.04, 0.0), Twist(0.1, side * 0.2, side))):
        check.check(Odometry(0.02 * index, pose, twist))
        assert check.early_contradiction() is None
    check.check(Odometry(0.04, pose, Twist(0.1, side * 0.1, 0.0)))
    fault = check.early_contradiction()
    codes = [] if fault is None else [fault.code]
    assert codes == ([SafetyReason.ODOMETRY_LATERAL] if drive_type == 'differential' else [])


def first_fault_of_headings(headings: Sequence[float]) -> SafetyReason | None:
    """Tell what is wrong with odometry that turns on the spot while its twist is zero."""
    check = OdometryCheck(ROBOT)
    faults = (check.check(Odometry(0.02 * i, Pose(0.0, 0.0, heading), STOP))
              for i, heading in enumerate(headings))
    return next((fault.code for fault in faults if fault is not None), None)


@pytest.mark.parametrize('side', [-1.0, 1.0])
def test_a_heading_may_neither_jump_nor_creep_beside_its_twist(side: float) -> None:
    """At once by a step, within a window by less than that each time; a tremor is no fault."""
    tremor = [0.0, 0.3 * side * ODOMETRY_JUMP_ROTATION] * 50
    assert first_fault_of_headings(tremor) is None
    assert first_fault_of_headings([0.0] * 10 + [0.5 * side]) is SafetyReason.ODOMETRY_JUMPED
    creeping = [0.3 * side * ODOMETRY_JUMP_ROTATION * i for i in range(30)]
    assert first_fault_of_headings(creeping) is SafetyReason.ODOMETRY_CONTRADICTORY
