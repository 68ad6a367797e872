"""Laws of the estimator and of the path it is compared with."""

import dataclasses
import math

from helpers.objects import bin_, box
import numpy as np
from push_control.estimation.contact_site import ContactSite, initial_contact_site
from push_control.estimation.estimator import Estimator
from push_control.estimation.push_motion import PushMotion, PushState
from push_control.laws.limit_surface_table import LimitSurfaceTable
from push_control.path.path import flat_output_pose, path_to_goal, project_on_path, SampledPath
from push_control.settings import ControlSettings
from push_model.dynamics import Input, kinematics, State
from push_model.friction import friction_center
from push_model.geometry import Pose
from push_model.parameters import RoundRobot
from push_model.quasi_static import quasi_static_yaw_rate, vehicle
from push_model.signals import ObjectPose, Odometry, Twist
from push_model.trajectory import PushTrajectory
import pytest

SETTINGS = ControlSettings()
ROBOT = RoundRobot(radius=0.17)
BELIEVED = box(foot=0.18)
VERTEX = ContactSite('vertex', 0.0, 0.17, 0.0, (-0.2, -0.2), math.pi / 4, math.pi / 4, (0.0, math.pi / 2))
FACE = ContactSite('face', 1.0, 0.17, math.inf, (-0.2, 0.03), 0.0, 0.1, (-math.inf, math.inf))
ROUND = ContactSite('round', 0.2 / 0.37, 0.17, 0.2, (-0.2, 0.0), 0.0, -0.1, (-math.inf, math.inf))
STEP = 0.02
POSE_EVERY = 3


def simulate(obj, seed, duration=40.0, drift=0.0, offset=0.0, noisy=True, latency=4):
    """Push quasi-statically at a vertex, weaving; return the estimator and the true states."""
    rng = np.random.default_rng(seed)
    true = PushMotion(0.17, VERTEX, LimitSurfaceTable(obj, VERTEX.point))
    x = PushState(0.3, -0.2, 0.4, 0.4 + math.pi / 4 + offset, *friction_center(obj))
    way, odometry = 0.0, Odometry(0.0, Pose(0.0, 0.0, x.phi - offset), Twist())
    estimator = Estimator(ROBOT, VERTEX, LimitSurfaceTable(BELIEVED, VERTEX.point), SETTINGS,
                          friction_center(BELIEVED), ObjectPose(0.0, x.pose), odometry)
    queue, history = [], []
    for k in range(1, round(duration / STEP)):
        c_x, c_y, normal = VERTEX.at(x.phi - x.theta)
        steer = 0.25 * math.sin(0.5 * k * STEP) - math.atan2(x.p_y - c_y, x.p_x - c_x) + normal
        twist = Twist(0.15, 0.0, -0.15 * math.sin(steer) / 0.17)
        x = true.moved(x, twist, STEP)
        way += 0.15 * STEP
        measured = Twist(twist.v_x, 0.0, twist.omega + drift * 0.15)
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


def test_the_friction_centre_is_found():
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
        seen = vehicle(BELIEVED, VERTEX.point, found.center).with_c_squared_ratio(math.exp(found.q))
        assert seen.wheelbase == pytest.approx(vehicle(obj, VERTEX.point).wheelbase, rel=0.03)


def test_the_estimate_is_not_biased_where_the_belief_is_right():
    """Over seeds, pose and friction centre are right on average and in spread."""
    errors = []
    for seed in range(10):
        _, history = simulate(BELIEVED, seed, duration=15.0)
        errors += [np.array(found) - np.array(true) for _, true, found in history[250::100]]
    errors = np.array(errors)
    assert np.abs(errors.mean(axis=0)[:4]).max() < 2e-3
    assert np.abs(errors.mean(axis=0)[4:]).max() < 4e-3
    assert errors.std(axis=0)[:2].max() < 2e-3
    assert errors.std(axis=0)[2:4].max() < 8e-3


def test_push_direction_takes_up_heading_drift_and_placement():
    """Odometry that drifts by 0.03 rad/m and starts 3 degrees off misleads for a moment only."""
    _, history = simulate(BELIEVED, seed=1, drift=0.03, offset=math.radians(3.0))
    late = np.array([np.array(found) - np.array(true) for _, true, found in history[500:]])
    assert np.abs(late[:, 3]).mean() < 0.01
    assert abs(late[:, 3].mean()) < 0.008
    assert np.abs(late[:, :2]).mean() < 2e-3


def test_without_errors_the_prediction_over_the_delay_is_exact():
    """Latency alone costs nothing: poses enter at their own time and are carried on."""
    _, history = simulate(BELIEVED, seed=0, duration=5.0, noisy=False, latency=7)
    worst = max(np.abs(np.array(found[:4]) - np.array(true[:4])).max()
                for _, true, found in history[20:])
    assert worst < 5e-4


def test_a_wild_pose_is_rejected_and_a_lasting_jump_is_followed():
    """One outlier changes nothing; an object that was really moved is found again."""
    estimator, history = simulate(BELIEVED, seed=2, duration=6.0)
    time, true, before = history[-1]
    assert not estimator.add_pose(ObjectPose(time, Pose(true.x + 0.3, true.y, true.theta)))
    assert estimator.predict(time) == before
    assert estimator.rejected == 1
    moved = Pose(true.x + 0.05, true.y - 0.05, true.theta + 0.1)
    for k in range(1, 12):
        time += 0.05
        estimator.add_odometry(Odometry(time, Pose(0.0, 0.0, 0.0), Twist()))
        estimator.add_pose(ObjectPose(time, moved))
    assert estimator.predict(time).pose == pytest.approx(moved, abs=5e-3)


def test_the_covariance_stays_symmetric_and_positive():
    """Even after hundreds of corrections."""
    estimator, _ = simulate(BELIEVED, seed=5)
    covariance = estimator.covariance
    assert np.array_equal(covariance, covariance.T)
    assert np.linalg.eigvalsh(covariance).min() > 0.0


def test_an_old_pose_is_ignored():
    """Poses that arrive out of order, or much too late, change nothing."""
    estimator, history = simulate(BELIEVED, seed=4, duration=6.0)
    time, true, before = history[-1]
    assert not estimator.add_pose(ObjectPose(time - 2.0, true.pose))
    assert estimator.predict(time) == before


@pytest.mark.parametrize('site, obj', [(VERTEX, box(foot=0.18)), (FACE, box(foot=0.18)),
                                       (ROUND, bin_())])
def test_motion_follows_the_rolling_rule(site, obj):
    """Object velocity as by the model's kinematics, turning as by the supports."""
    motion = PushMotion(0.17, site, LimitSurfaceTable(obj, site.point))
    belief = PushState(0.1, 0.2, 0.7, 0.7 + site.heading + 0.05, *friction_center(obj))
    twist = Twist(0.12, 0.01, 0.05)
    rates = motion.rates(belief, twist)
    c_x, c_y, normal = site.at(belief.phi - belief.theta)
    gamma = belief.theta + normal
    spin = 0.17 * twist.omega
    v_x, v_y = Pose(0.0, 0.0, belief.phi).rotate(twist[:2])
    v_x, v_y = v_x - spin * math.sin(gamma), v_y + spin * math.cos(gamma)
    omega = quasi_static_yaw_rate(obj, (c_x, c_y), *Pose(0.0, 0.0, -belief.theta).rotate((v_x, v_y)))
    assert rates.omega == pytest.approx(omega, rel=0.01)
    state = State(*belief.pose, rates.omega, gamma, c_x, c_y)
    lam = site.share
    rate = kinematics(state, Input(v_x, v_y, 0.0, 0.0, twist.omega), 0.0, (lam, 0.17 * lam))
    assert (rates.x, rates.y) == pytest.approx((float(rate.x), float(rate.y)))
    turn = 1e-6
    after = site.at(belief.phi - belief.theta + turn * (twist.omega - rates.omega))
    moved = [(b - a) / turn for a, b in zip((c_x, c_y), after[:2])]
    assert moved == pytest.approx((float(rate.c_x), float(rate.c_y)), abs=1e-6)
    assert (after[2] - normal) / turn == pytest.approx(
        (1 - lam) * (twist.omega - rates.omega), abs=1e-6)


def test_the_jacobian_is_that_of_the_motion():
    """Against central differences of one short step, at a vertex."""
    motion = PushMotion(0.17, VERTEX, LimitSurfaceTable(BELIEVED, VERTEX.point))
    belief = np.array((0.1, 0.2, 0.7, 0.72 + math.pi / 4, 0.01, -0.02, 0.3))
    twist, duration, h = Twist(0.15, 0.0, 0.1), 1e-4, 1e-5
    found, way = motion.jacobian(PushState(*belief), twist, duration)
    columns = [(np.array(motion.moved(PushState(*(belief + h * e)), twist, duration))
                - np.array(motion.moved(PushState(*(belief - h * e)), twist, duration))) / (2 * h)
               for e in np.eye(7)]
    rates = (np.array(columns).T - np.eye(7)) / duration
    assert (found - np.eye(7)) / duration == pytest.approx(rates, abs=0.02)
    assert way == pytest.approx(duration * math.hypot(0.15, 0.17 * 0.1), rel=0.2)


def test_an_object_does_not_follow_a_robot_that_backs_off():
    """A push is one-sided."""
    motion = PushMotion(0.17, VERTEX, LimitSurfaceTable(BELIEVED, VERTEX.point))
    belief = PushState(0.0, 0.0, 0.0, math.pi / 4, 0.0, 0.0)
    assert motion.rates(belief, Twist(-0.1, 0.0, 0.0))[:3] == (0.0, 0.0, 0.0)
    assert motion.rates(belief, Twist(0.1, 0.0, 0.0)).x > 0.0


def arc_trajectory(obj, site, curvature, length):
    """Carry the flat point along an arc; contact and robot follow."""
    local = flat_output_pose(vehicle(obj, site.point))
    base = Pose(*site.point, site.normal) @ Pose(-0.17, 0.0, site.heading - site.normal)
    ways = np.linspace(0.0, length, 40)
    poses = [Pose((math.sin(curvature * s)) / curvature, (1.0 - math.cos(curvature * s))
                  / curvature, curvature * s) @ local.inverse() for s in ways.tolist()]
    contacts = [pose @ Pose(*site.point, site.normal) for pose in poses]
    zeros = np.zeros((40, 3))
    return PushTrajectory(ways / 0.1, np.array(poses), zeros, np.array(contacts), zeros,
                          np.array([pose @ base for pose in poses]), zeros)


def test_the_path_ends_at_the_goal_with_its_curvature():
    """An arc of z comes out as that arc, in the frame of its end."""
    trajectory = arc_trajectory(BELIEVED, VERTEX, 0.8, 1.5)
    path = SampledPath(vehicle(BELIEVED, VERTEX.point), trajectory)
    assert path.length == pytest.approx(1.5, abs=1e-4)
    assert path.at(path.length)[0] == pytest.approx((0.0, 0.0, 0.0), abs=1e-9)
    for s in (0.0, 0.31, 1.0, 1.49):
        pose, curvature = path.at(s)
        assert curvature == pytest.approx(0.8, abs=1e-3)
        assert pose.theta == pytest.approx(-0.8 * (1.5 - s), abs=1e-3)


@pytest.mark.parametrize('s', [0.05, 0.7, 1.4])
@pytest.mark.parametrize('aside, turned', [(0.03, 0.1), (-0.05, -0.2)])
def test_a_pose_beside_the_path_is_found(s, aside, turned):
    """Way, lateral error (left positive) and heading error come back, from a guess nearby."""
    path = SampledPath(vehicle(BELIEVED, VERTEX.point), arc_trajectory(BELIEVED, VERTEX, 0.8, 1.5))
    pose = path.at(s)[0] @ Pose(0.0, aside, turned)
    found = project_on_path(path, pose, s - 0.06)
    assert found[:3] == pytest.approx((s, aside, turned), abs=1e-3)


def test_a_new_path_leads_from_here_to_the_goal_within_its_limits():
    """It starts at the pose, ends straight at the goal, and turns no tighter than allowed."""
    start = Pose(-1.5, 0.7, 2.0)
    path = path_to_goal(start, (-0.5, 0.9), 0.4)
    assert path.at(0.0)[0] == pytest.approx(start)
    x, y, theta = path.at(path.length)[0]
    assert (x, y) == pytest.approx((0.0, 0.0), abs=1e-9)
    assert math.remainder(theta, 2 * math.pi) == pytest.approx(0.0, abs=1e-9)
    curvatures = [path.at(s)[1] for s in np.linspace(0.0, path.length, 200)]
    assert min(curvatures) >= -0.5 - 1e-9 and max(curvatures) <= 0.9 + 1e-9
    assert all(path.at(s)[1] == 0.0 for s in np.linspace(path.length - 0.39, path.length, 9))


def test_the_site_of_a_trajectory():
    """Vertex, face and disc are told apart; a robot that does not touch is refused."""
    trajectory = arc_trajectory(BELIEVED, VERTEX, 0.5, 1.0)
    site = initial_contact_site(BELIEVED, ROBOT, trajectory)
    assert site.kind == 'vertex' and site.point == VERTEX.point
    assert site.normal == pytest.approx(VERTEX.normal)
    assert site.heading_offset == pytest.approx(0.0, abs=1e-9)
    face = initial_contact_site(BELIEVED, ROBOT, arc_trajectory(BELIEVED, FACE, 0.5, 1.0))
    assert face.kind == 'face' and face.point == pytest.approx(FACE.point)
    assert face.heading_offset == pytest.approx(-0.1)
    disc = initial_contact_site(bin_(), ROBOT, arc_trajectory(bin_(), ROUND, 0.5, 1.0))
    assert disc.kind == 'round' and disc.point == pytest.approx(ROUND.point)
    away = dataclasses.replace(trajectory, robot_poses=trajectory.robot_poses - (0.05, 0.05, 0.0))
    with pytest.raises(ValueError, match='robot_poses'):
        initial_contact_site(BELIEVED, ROBOT, away)
