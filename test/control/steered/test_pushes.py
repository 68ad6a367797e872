"""Pushes with the closed-form law, against plant and sensors, that must succeed."""

import dataclasses

from helpers.push_case import (
    box, Case, GOOD_HEADING, GOOD_POSITION, holonomic_case, random_case, run, SENSORS, vertex_plan,
    with_friction)
from push_control.settings import ControlSettings
from push_control.steered.status import Phase
from push_model.geometry import Pose
from push_model.parameters import RoundRobot
from push_sim_node.sensors import SensorSettings
import pytest

SETTINGS = ControlSettings()
OPEN_LOOP = ControlSettings(control_law='open_loop')
ROBOT = RoundRobot(radius=0.17)
pytestmark = pytest.mark.slow


@pytest.mark.parametrize('seed', [7, 31, 49])
def test_random_pushes_at_a_corner_succeed(seed):
    """Friction, mass, contact, placement and sensors as wrong as they may be."""
    case = random_case(seed)
    outcome = run(case, SETTINGS, seed)
    assert outcome.status.phase is Phase.DONE, outcome.status
    assert outcome.position_error < GOOD_POSITION and outcome.heading_error < GOOD_HEADING
    assert abs(outcome.status.position_error - outcome.position_error) < 8e-3


@pytest.mark.parametrize('kind', ['face', 'vertex', 'round'])
def test_a_holonomic_base_pushes_anywhere(kind):
    """On a face, at a vertex and on a disc, with the same errors."""
    outcome = run(holonomic_case(7, kind), SETTINGS, 7)
    assert outcome.status.phase is Phase.DONE, outcome.status
    assert outcome.position_error < GOOD_POSITION and outcome.heading_error < GOOD_HEADING


def test_a_contact_that_cannot_push_straight_is_given_up():
    """With the centre of friction far to one side, the robot does not wander about."""
    case = with_friction(random_case(3), lambda foot: 1.8 if foot.y < 0.0 else 0.1)
    outcome = run(case, SETTINGS)
    assert outcome.status.phase is Phase.FAILED and outcome.status.reason
    assert outcome.status.travelled_distance < 2.0


@pytest.mark.parametrize('rate', [25.0, 100.0])
def test_the_rate_of_odometry_hardly_matters(rate):
    """The law counts time and path length, not steps."""
    outcome = run(random_case(9), SETTINGS, 9,
                  dataclasses.replace(SENSORS, odometry_rate=rate))
    assert outcome.status.phase is Phase.DONE
    assert outcome.position_error < 0.01 and outcome.heading_error < 0.01


def test_it_stops_for_a_drop_out_and_goes_on():
    """The robot stands while poses are missing, and the push still succeeds."""
    sensors = dataclasses.replace(SENSORS, pose_dropouts=((4.0, 6.0), (9.0, 9.4)))
    speeds = []
    outcome = run(random_case(2), SETTINGS, 2, sensors,
                  on_step=lambda plant, controller, _: speeds.append(
                      (plant.time, controller.status.phase, plant.truth.robot_twist.v_x)))
    standing = [(phase, speed) for time, phase, speed in speeds if 4.9 < time < 6.0]
    assert all(phase is Phase.WAITING and abs(speed) < 1e-3 for phase, speed in standing)
    assert outcome.status.phase is Phase.DONE
    assert outcome.status.rejected_poses == 0
    assert outcome.position_error < GOOD_POSITION and outcome.heading_error < GOOD_HEADING


def test_with_true_nominal_values_open_loop_arrives_and_feedback_arrives_better():
    """A straight push of a metre; without feedback errors grow slowly."""
    obj = box(0.4, 2.0, [0.3] * 4)
    target = vertex_plan(obj, ROBOT, Pose(0.8, 0.8, 0.0), 0.15, vertices=(2,))
    case = Case(obj, obj, ROBOT, target, Pose(*target.robot_poses[0].tolist()))
    open_loop = run(case, OPEN_LOOP, sensors=SensorSettings())
    feedback = run(case, SETTINGS, sensors=SensorSettings())
    assert open_loop.status.phase is feedback.status.phase is Phase.DONE
    assert open_loop.position_error < 0.03
    assert feedback.position_error < 0.002 and feedback.heading_error < 2e-3


@pytest.mark.parametrize('kind', ['face', 'vertex', 'round'])
def test_uneven_supports_are_pushed_from_where_their_centre_is(kind):
    """The centre lies further to the side than the cone reaches from where the push begins."""
    case = with_friction(holonomic_case(3, kind),
                         lambda foot: 0.4 * (1.8 if foot.y < 0 else 0.6))
    outcome = run(case, ControlSettings(), 3)
    assert outcome.status.phase is Phase.DONE, outcome.status
    assert outcome.position_error < GOOD_POSITION and outcome.heading_error < GOOD_HEADING
