"""Slip and loss of contact: seen from geometry, neither from noise nor late, and followed."""

import math

from helpers.push_case import held_case, random_case, run
import numpy as np
from push_control.estimation.contact_detection import ContactDetector, CusumTest
from push_control.estimation.contact_site import ContactOffset, ContactSite
from push_control.push.status import Phase
from push_control.settings import ControlSettings
from push_model.geometry import Pose
import pytest

SETTINGS = ControlSettings()
GOOD_POSITION, GOOD_HEADING = 0.02, math.radians(3.0)
SITES = {
    'vertex': ContactSite('vertex', 0.0, 0.17, 0.0, (-0.2, -0.2), 0.8, 0.6, (0.0, math.pi / 2)),
    'face': ContactSite('face', 1.0, 0.17, math.inf, (-0.2, 0.03), 0.0, 0.1, (-math.inf, math.inf)),
    'round': ContactSite('round', 0.6, 0.17, 0.255, (-0.255, 0.0), 0.0, 0.1, (-math.inf, math.inf))}
POSE, PHI = Pose(1.0, -2.0, 2.5), 3.3


def looks(watch, offset, count):
    """Show a watch the same offset at one place; return what it finds each time."""
    return [watch.look(ContactOffset(*offset), 0.5) for _ in range(count)]


def make_watch():
    """Watch a contact at the corner of a box."""
    return ContactDetector(SETTINGS, 0.17, SITES['vertex'])


@pytest.mark.parametrize('kind', sorted(SITES))
def test_a_robot_that_has_rolled_is_beside_nothing(kind):
    """And one that stands off along the normal, or beside it, is so far off."""
    site = SITES[kind]
    center = site.robot_center(POSE, PHI)
    gamma = POSE.theta + site.at(PHI - POSE.theta)[2]
    assert site.offset(POSE, PHI, center) == pytest.approx((0.0, 0.0), abs=1e-12)
    moved = Pose(*center, gamma).transform((-0.02, 0.005))
    assert site.offset(POSE, PHI, moved) == pytest.approx((0.02, 0.005), abs=1e-12)


@pytest.mark.parametrize('kind', sorted(SITES))
def test_a_contact_that_slides_takes_the_robot_along_and_stays_a_contact(kind):
    """The robot moves along t by what it slid; slides add up, and nothing else changes."""
    site, small = SITES[kind], 1e-4
    found = site.offset(POSE, PHI, site.slid(small).robot_center(POSE, PHI))
    assert found == pytest.approx((0.0, small), abs=1e-7)
    far = site.slid(0.03).slid(-0.05)
    assert far.robot_center(POSE, PHI) == pytest.approx(site.slid(-0.02).robot_center(POSE, PHI))
    c_x, c_y, _ = far.at(PHI - POSE.theta)
    reach = math.dist(far.robot_center(POSE, PHI), POSE.transform((c_x, c_y)))
    assert reach == pytest.approx(site.robot_radius)
    if kind == 'vertex':
        assert (c_x, c_y) == site.point
    if kind == 'round':
        assert math.hypot(c_x, c_y) == pytest.approx(site.object_radius)


def test_the_alarm_sums_up_what_lasts_and_no_single_error():
    """Page's test: sooner for more, on either side, not for one wild error among small ones."""
    def delay(score):
        alarm = CusumTest(5.0)
        return next(k for k in range(1, 1000) if alarm.update(score))

    assert 1 < delay(3.0) < delay(2.0) < delay(1.0)
    assert CusumTest(5.0).update(1e9) == 0
    alarm = CusumTest(5.0)
    assert [alarm.update(-3.0) for _ in range(3)] == [0, 0, -1]
    assert not any(CusumTest(5.0).update(0.7) for _ in range(1000))


def test_noise_and_drift_are_no_slip_and_no_loss():
    """Over 20 m in all, with the noise that is reckoned with and a heading error of 0.02 rad."""
    for seed in range(4):
        rng, watch = np.random.default_rng(seed), make_watch()
        noise = math.hypot(SETTINGS.pose_noise, 0.28 * SETTINGS.heading_noise)
        drift, slid = np.zeros(2), 0.0
        for k in range(500):
            drift += (2e-4, 2e-4)
            found = watch.look(ContactOffset(*(drift + rng.normal(0.0, noise, 2) - (0.0, slid))),
                               0.01 * (k + 1))
            drift -= found.drift
            slid += found.slid
        assert (watch.slips, watch.contact_losses, watch.lost) == (0, 0, False)
        assert abs(slid) < 0.5 * SETTINGS.push_direction_std * 0.17 + 2e-3


@pytest.mark.parametrize('side', [1.0, -1.0])
def test_slip_is_told_within_a_few_poses_and_followed(side):
    """From one pose to the next the contact has moved by 15 mm, and stays there."""
    watch = make_watch()
    looks(watch, (0.0, 0.0), 20)
    slid, seen = 0.0, None
    for k in range(10):
        left = side * 0.015 - slid
        found = watch.look(ContactOffset(0.0, left), 0.5 + 0.01 * (k + 1))
        slid += found.slid + found.drift.slid
        seen = k if seen is None and watch.slipping else seen
    assert watch.slips == 1 and seen <= 3
    assert slid == pytest.approx(side * 0.015, abs=2e-3)


def test_a_gap_is_told_within_a_few_poses_and_its_end_too():
    """While it is open nothing is said about slip; an overlap is no gap."""
    watch = make_watch()
    looks(watch, (0.0, 0.0), 20)
    found = looks(watch, (0.03, 0.02), 6)
    assert watch.lost and watch.contact_losses == 1 and watch.slips == 0
    assert found[-1] == (0.0, ContactOffset(0.0, 0.0))
    looks(watch, (0.001, 0.0), 6)
    assert not watch.lost and watch.contact_losses == 1
    looks(watch, (-0.05, 0.02), 6)
    assert not watch.lost and watch.slips == 0


def gapped(case, gap):
    """Let the robot begin away from the object, along the contact normal."""
    x, y, phi = case.robot_pose
    gamma = case.target.contact_poses[0, 2]
    return case._replace(robot_pose=Pose(x - gap * math.cos(gamma), y - gap * math.sin(gamma),
                                         phi))


@pytest.mark.parametrize('law', ['feedback', 'mpc'])
@pytest.mark.parametrize('kind', ['corner', 'face', 'round'])
def test_a_small_gap_is_closed_and_the_push_succeeds(kind, law):
    """The robot begins 30 mm away."""
    case = random_case(9) if kind == 'corner' else held_case(9, kind)
    outcome = run(gapped(case, 0.03), ControlSettings(control_law=law), 9)
    assert outcome.status.phase is Phase.DONE, outcome.status
    assert outcome.status.contact_losses == 1
    assert outcome.position_error < GOOD_POSITION and outcome.heading_error < GOOD_HEADING


def test_a_robot_that_is_pulled_back_returns_slowly_and_pushes_on():
    """It says so, touches gently, and reaches the goal."""
    told = []

    def pull(plant, controller, _):
        if 5.0 <= plant.time < 5.4:
            plant.command((-0.2, 0.0, 0.0))
        truth = plant.truth
        told.append((plant.time, controller.status.reason, truth.gap, truth.robot_twist.v_x))

    outcome = run(random_case(3), SETTINGS, 3, watch=pull)
    reasons = [reason for _, reason, _, _ in told]
    assert any('contact is lost' in reason for reason in reasons)
    touch = next(k for k, row in enumerate(told) if row[0] > 5.6 and row[2] < 1e-4)
    assert told[touch][3] < 1.5 * SETTINGS.start_speed
    assert max(gap for _, _, gap, _ in told) > 0.02
    assert outcome.status.phase is Phase.DONE and outcome.position_error < GOOD_POSITION


def test_a_wide_gap_stops_the_robot_with_a_reason():
    """Further away than it may approach by itself, it does not move at all."""
    outcome = run(gapped(random_case(3), 0.12), ControlSettings(start_tolerance=0.2), 3)
    assert outcome.status.phase is Phase.FAILED
    assert 'contact is lost' in outcome.status.reason and 'mm away' in outcome.status.reason
    assert outcome.status.travelled_distance < 0.05


@pytest.mark.parametrize('aside', [0.25, -0.25])
def test_a_contact_that_has_slid_is_known_where_it_is(aside):
    """A holonomic robot is pushed along the face: it knows where it is, and rolls back."""
    case, offsets = held_case(7, 'face'), []

    def shove(plant, controller, _):
        if 4.0 <= plant.time < 4.7:
            plant.command((0.04, aside, 0.0))
        truth, status = plant.truth, controller.status
        offsets.append([plant.time] + [(pose.inverse() @ Pose(*robot)).y for pose, robot in (
            (truth.object_pose, truth.robot_pose), (status.object_pose, status.robot_pose))])

    outcome = run(case, SETTINGS, 7, watch=shove)
    assert outcome.status.phase is Phase.DONE and outcome.status.slips >= 1
    assert outcome.position_error < GOOD_POSITION and outcome.heading_error < GOOD_HEADING
    time, true, believed = np.array(offsets).T
    before, after = (abs(time - middle) < 0.3 for middle in (3.5, 5.5))
    slid = true[after].mean() - true[before].mean()
    error = (believed - true)[after].mean() - (believed - true)[before].mean()
    assert abs(slid) > 0.02 and abs(error) < 0.3 * abs(slid)
