"""The estimator: unbiased, and undisturbed by late, wild and old poses."""

from collections.abc import Iterable
import math

from helpers.contact_sites import VERTEX
from helpers.objects import box
import numpy as np
from push_control.settings import ControlSettings
from push_control.steered.estimation.estimator import Estimator
from push_control.steered.estimation.limit_surface_table import LimitSurfaceTable
from push_control.steered.estimation.push_motion import MotionState, PushMotion
from push_model.events import PushEvent
from push_model.friction import friction_center
from push_model.geometry import Pose
from push_model.quasi_static import vehicle, vehicle_along
from push_model.signals import ObjectPose, Odometry, STOP, Twist
import pytest

SETTINGS = ControlSettings()
NOMINAL = box(foot=0.18)
STEP = 0.02
POSE_EVERY = 3


def simulate(obj, seed, duration=40.0, drift=0.0, offset=0.0, noisy=True, latency=4, slip=0.0,
             later=None):
    """
    Push quasi-statically at a vertex, weaving; return the estimator and the true states.

    :param slip: part of the motion of the wheels that is none of the robot.
    :param later: the object from the middle of the push on, or None for the same.
    """
    rng = np.random.default_rng(seed)
    true = PushMotion(0.17, VERTEX, LimitSurfaceTable(obj, VERTEX.point))
    x = MotionState(0.3, -0.2, 0.4, 0.4 + math.pi / 4 + offset, *friction_center(obj))
    way, odometry = 0.0, Odometry(0.0, Pose(0.0, 0.0, x.phi - offset), Twist())
    nominal = PushMotion(0.17, VERTEX, LimitSurfaceTable(NOMINAL, VERTEX.point))
    estimator = Estimator(nominal, SETTINGS, friction_center(NOMINAL), ObjectPose(0.0, x.pose),
                          odometry)
    queue, history = [], []
    for k in range(1, round(duration / STEP)):
        c_x, c_y, normal = VERTEX.contact_at(x.phi - x.theta)
        steer = 0.25 * math.sin(0.5 * k * STEP) - math.atan2(x.p_y - c_y, x.p_x - c_x) + normal
        twist = Twist(0.15, 0.0, -0.15 * math.sin(steer) / 0.17)
        if later is not None and k == round(0.5 * duration / STEP):
            true = PushMotion(0.17, VERTEX, LimitSurfaceTable(later, VERTEX.point))
            x = MotionState(*x[:4], *friction_center(later), x.q)
        x = true.propagate(x, twist, STEP)
        way += 0.15 * STEP
        measured = Twist(twist.v_x / (1.0 - slip), 0.0,
                         (twist.omega + drift * 0.15) / (1.0 - slip))
        odometry = Odometry(k * STEP, Pose(0.0, 0.0, 0.0), measured)
        if k == 1:
            estimator.add_odometry(odometry._replace(time=1e-6))
        estimator.add_odometry(odometry)
        if k % POSE_EVERY == 0:
            noise = rng.normal(0.0, (2e-3, 2e-3, 5e-3)) if noisy else np.zeros(3)
            queue.append((k + latency, ObjectPose(k * STEP, Pose(*(np.array(x.pose) + noise)))))
        while queue and queue[0][0] <= k:
            estimator.add_pose(queue.pop(0)[1])
        history.append((k * STEP, x, estimator.predict(k * STEP)))
    return estimator, history


def test_the_centre_of_friction_is_found():
    """
    Unequal feet move it by centimetres; in six metres it is found across the push.

    Along the push neither it nor c^2 can be told from the other: what a push tells is the
    wheelbase that both come to.
    """
    for friction in ((0.2, 0.3, 0.4, 0.3), (0.3, 0.2, 0.3, 0.4), (0.4, 0.35, 0.25, 0.2)):
        obj = box(foot=0.18, friction=friction)
        _, history = simulate(obj, seed=3)
        _, true, found = history[-1]
        assert math.hypot(*true.center) > 0.02
        along = np.array(VERTEX.point) / math.hypot(*VERTEX.point)
        aside = np.array((-along[1], along[0]))
        error = np.array(found.center) - np.array(true.center)
        assert abs(error @ aside) < 0.004
        seen = vehicle(NOMINAL, VERTEX.point, found.center)
        seen = vehicle_along(seen.contact_point, seen.arm, seen.angle,
                             math.exp(found.q) * seen.c_squared)
        assert seen.wheelbase == pytest.approx(vehicle(obj, VERTEX.point).wheelbase, rel=0.03)


@pytest.mark.parametrize('seed', [5, 6])
def test_a_jump_of_the_centre_of_friction_is_found_in_half_a_metre(seed: int) -> None:
    """Twice the friction of one foot beside the push moves it by a fifth of their distance."""
    later = box(foot=0.18, friction=(0.3, 0.6, 0.3, 0.3))
    along = np.array(VERTEX.point) / math.hypot(*VERTEX.point)
    across = np.array((-along[1], along[0]))
    jump = abs(across @ (np.array(friction_center(later)) - friction_center(NOMINAL)))
    _, history = simulate(NOMINAL, seed, duration=16.0, later=later)
    errors = np.array([across @ (np.array(estimate.center) - true.center)
                       for _, true, estimate in history])
    half = len(errors) // 2
    assert jump > 0.04 and np.abs(errors[:half - 1]).max() < 0.02
    # 0.15 m/s for 3.3 s and more.
    assert np.abs(errors[half + round(3.3 / STEP):]).max() < 0.4 * jump


def test_the_estimate_is_not_biased_where_the_nominal_values_are_right():
    """Over seeds, pose and centre of friction are right on average and in spread."""
    errors = []
    for seed in range(10):
        _, history = simulate(NOMINAL, seed, duration=15.0)
        errors += [np.array(found) - np.array(true) for _, true, found in history[250::100]]
    errors = np.array(errors)
    assert np.abs(errors.mean(axis=0)[:4]).max() < 2e-3
    assert np.abs(errors.mean(axis=0)[4:]).max() < 4e-3
    assert errors.std(axis=0)[:2].max() < 2e-3
    assert errors.std(axis=0)[2:4].max() < 8e-3


def test_push_direction_takes_up_heading_drift_and_placement():
    """Odometry that drifts by 0.03 rad/m and starts 3 degrees off misleads for a moment only."""
    _, history = simulate(NOMINAL, seed=1, drift=0.03, offset=math.radians(3.0))
    late = np.array([np.array(found) - np.array(true) for _, true, found in history[500:]])
    assert np.abs(late[:, 3]).mean() < 0.01
    assert abs(late[:, 3].mean()) < 0.008
    assert np.abs(late[:, :2]).mean() < 2e-3


def test_without_errors_the_prediction_over_the_delay_is_exact():
    """Latency alone costs nothing: poses enter at their own time and are carried on."""
    _, history = simulate(NOMINAL, seed=0, duration=5.0, noisy=False, latency=7)
    worst = max(np.abs(np.array(found[:4]) - np.array(true[:4])).max()
                for _, true, found in history[20:])
    assert worst < 5e-4


def test_a_wild_pose_is_rejected_and_a_lasting_jump_is_followed():
    """One outlier changes nothing; an object that was really moved is found again."""
    estimator, history = simulate(NOMINAL, seed=2, duration=6.0)
    time, true, before = history[-1]
    wild = Pose(true.x + 0.3, true.y, true.theta)
    assert not estimator.add_pose(ObjectPose(time, wild)).is_accepted
    assert estimator.predict(time) == before
    assert estimator.rejected_poses == 1
    moved = Pose(true.x + 0.05, true.y - 0.05, true.theta + 0.1)
    for k in range(1, 12):
        time += 0.05
        estimator.add_odometry(Odometry(time, Pose(0.0, 0.0, 0.0), Twist()))
        estimator.add_pose(ObjectPose(time, moved))
    assert estimator.predict(time).pose == pytest.approx(moved, abs=5e-3)


def poses_after(estimator: Estimator, start: float, poses: Iterable[Pose]) -> float:
    """Measure poses while the robot stands, at 20 Hz; return the time of the last one."""
    time = start
    for pose in poses:
        time += 0.05
        estimator.add_odometry(Odometry(time, Pose(0.0, 0.0, 0.0), STOP))
        estimator.add_pose(ObjectPose(time, pose))
    return time


@pytest.mark.parametrize('shift', [Pose(0.3, 0.0, 0.0), Pose(0.0, -0.15, 0.1),
                                   Pose(0.0, 0.0, 0.5)])
def test_an_object_that_is_elsewhere_for_a_while_is_awaited_where_it_was(shift: Pose) -> None:
    """Its poses are not believed, and said to be off, until they are true again."""
    estimator, history = simulate(NOMINAL, seed=2, duration=6.0)
    start, true, _ = history[-1]
    time = poses_after(estimator, start, [true.pose] * 20)
    assert estimator.pose_fault(time) is None
    before = estimator.predict(time).pose
    away = Pose(true.x + shift.x, true.y + shift.y, true.theta + shift.theta)
    time = poses_after(estimator, time, [away] * 40)
    assert estimator.predict(time).pose == pytest.approx(before, abs=1e-9)
    fault = estimator.pose_fault(time)
    assert fault is not None and fault.code is PushEvent.OBJECT_ELSEWHERE
    assert fault.values['distance'] == pytest.approx(
        1e3 * math.hypot(shift.x, shift.y), abs=2.0)
    time = poses_after(estimator, time, [true.pose])
    assert estimator.pose_fault(time) is None


@pytest.mark.parametrize('gap', [1.0, 5.0])
def test_an_object_is_found_again_after_a_gap_of_odometry(gap: float) -> None:
    """The robot has stood meanwhile, which no odometry has told."""
    estimator, history = simulate(NOMINAL, seed=2, duration=6.0)
    start, true, _ = history[-1]
    time = poses_after(estimator, start + gap, [true.pose] * 20)
    assert estimator.pose_fault(time) is None
    assert estimator.predict(time).pose == pytest.approx(true.pose, abs=5e-3)


@pytest.mark.parametrize('slip, is_fault', [(0.0, False), (0.02, False), (0.5, True)])
def test_an_object_that_stays_behind_again_and_again_is_a_fault(
        slip: float, is_fault: bool) -> None:
    """Wheels that slip by half move it half as far, which is no accident."""
    estimator, _ = simulate(NOMINAL, seed=2, duration=15.0, slip=slip)
    fault = estimator.pose_fault(15.0)
    assert (fault is not None and fault.code is PushEvent.OBJECT_STAYS_BEHIND) is is_fault


def test_poses_with_more_noise_than_stated_move_the_estimate_by_less_than_that() -> None:
    """They are no displacement of the object, and said to scatter."""
    estimator, history = simulate(NOMINAL, seed=3, duration=6.0)
    start, true, _ = history[-1]
    time = poses_after(estimator, start, [true.pose] * 20)
    noise = np.random.default_rng(1).normal(0.0, (0.02, 0.02, 0.02), (100, 3))
    errors, reasons = [], []
    for row in noise:
        time = poses_after(estimator, time, [Pose(*(np.array(true.pose) + row))])
        found = estimator.predict(time).pose
        errors.append(math.dist(found[:2], true.pose[:2]))
        fault = estimator.pose_fault(time)
        reasons.append(None if fault is None else fault.code)
    assert np.median(errors) < 0.005
    assert reasons.count(PushEvent.OBJECT_POSES_SCATTER) > 50


@pytest.mark.parametrize('noise', [0.0, 0.005, 0.02])
def test_the_covariance_stays_symmetric_and_positive(noise: float) -> None:
    """Even after hundreds of corrections, and hundreds of poses that do not fit."""
    estimator, history = simulate(NOMINAL, seed=5)
    start, true, _ = history[-1]
    rng = np.random.default_rng(2)
    poses_after(estimator, start, (Pose(*(np.array(true.pose) + row))
                                   for row in rng.normal(0.0, noise, (300, 3))))
    covariance = estimator.covariance
    assert np.array_equal(covariance, covariance.T)
    assert np.linalg.eigvalsh(covariance).min() > 0.0


def test_an_old_pose_is_ignored():
    """Poses that arrive out of order, or much too late, change nothing."""
    estimator, history = simulate(NOMINAL, seed=4, duration=6.0)
    time, true, before = history[-1]
    assert not estimator.add_pose(ObjectPose(time - 2.0, true.pose)).is_accepted
    assert estimator.predict(time) == before
