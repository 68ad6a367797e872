"""Pushes in which the contact slides or is lost."""

import math

from helpers.push_case import GOOD_HEADING, GOOD_POSITION, holonomic_case, random_case, run
import numpy as np
from push_control.settings import ControlSettings
from push_control.steered.status import Phase
from push_model.events import PushEvent
from push_model.geometry import Pose
import pytest

SETTINGS = ControlSettings()
pytestmark = pytest.mark.slow


def with_gap(case, gap):
    """Let the robot begin away from the object, along the contact normal."""
    x, y, phi = case.robot_pose
    gamma = case.target.contact_poses[0, 2]
    return case._replace(robot_pose=Pose(x - gap * math.cos(gamma), y - gap * math.sin(gamma),
                                         phi))


@pytest.mark.parametrize('law', ['feedback', 'mpc'])
@pytest.mark.parametrize('kind', ['corner', 'face', 'round'])
def test_a_small_gap_is_closed_and_the_push_succeeds(kind, law):
    """The robot begins 30 mm away."""
    case = random_case(9) if kind == 'corner' else holonomic_case(9, kind)
    outcome = run(with_gap(case, 0.03), ControlSettings(control_law=law), 9)
    assert outcome.status.phase is Phase.DONE, outcome.status
    assert outcome.status.contact_losses == 1
    assert outcome.position_error < GOOD_POSITION and outcome.heading_error < GOOD_HEADING


def test_a_robot_that_is_pulled_back_returns_slowly_and_pushes_on():
    """It reports that, touches gently, and reaches the goal."""
    steps = []

    def pull(plant, controller, _):
        if 5.0 <= plant.time < 5.4:
            plant.command((-0.2, 0.0, 0.0))
        truth = plant.truth
        steps.append((plant.time, controller.status.event, truth.gap, truth.robot_twist.v_x))

    outcome = run(random_case(3), SETTINGS, 3, on_step=pull)
    assert any(event is PushEvent.CLOSING_GAP for _, event, _, _ in steps)
    touch = next(k for k, row in enumerate(steps) if row[0] > 5.6 and row[2] < 1e-4)
    assert steps[touch][3] < 1.5 * SETTINGS.start_speed
    assert max(gap for _, _, gap, _ in steps) > 0.02
    assert outcome.status.phase is Phase.DONE and outcome.position_error < GOOD_POSITION


def test_a_wide_gap_stops_the_robot_with_a_reason():
    """Further away than it may approach by itself, it does not move at all."""
    outcome = run(with_gap(random_case(3), 0.12), ControlSettings(start_tolerance=0.2), 3)
    assert outcome.status.phase is Phase.FAILED
    assert outcome.status.event is PushEvent.GAP_TOO_WIDE
    assert outcome.status.travelled_distance < 0.05


@pytest.mark.parametrize('sideways', [0.25, -0.25])
def test_a_contact_that_has_slid_is_known_where_it_is(sideways):
    """A holonomic robot is pushed along the face: it knows where it is, and rolls back."""
    case, offsets = holonomic_case(7, 'face'), []

    def push_aside(plant, controller, _):
        if 4.0 <= plant.time < 4.7:
            plant.command((0.04, sideways, 0.0))
        truth, status = plant.truth, controller.status
        offsets.append([plant.time] + [(pose.inverse() @ Pose(*robot)).y for pose, robot in (
            (truth.object_pose, truth.robot_pose), (status.object_pose, status.robot_pose))])

    outcome = run(case, SETTINGS, 7, on_step=push_aside)
    assert outcome.status.phase is Phase.DONE and outcome.status.slips >= 1
    assert outcome.position_error < GOOD_POSITION and outcome.heading_error < GOOD_HEADING
    time, true, estimated = np.array(offsets).T
    before, after = (abs(time - middle) < 0.3 for middle in (3.5, 5.5))
    slid = true[after].mean() - true[before].mean()
    error = (estimated - true)[after].mean() - (estimated - true)[before].mean()
    assert abs(slid) > 0.02 and abs(error) < 0.3 * abs(slid)
