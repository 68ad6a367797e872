"""Pushes in which the contact slides or is lost."""

import math

from helpers.push_case import GOOD_HEADING, GOOD_POSITION, held_case, random_case, run
import numpy as np
from push_control.push.status import Phase
from push_control.settings import ControlSettings
from push_model.geometry import Pose
import pytest

SETTINGS = ControlSettings()
pytestmark = pytest.mark.slow


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
