"""Pushes with the predictive law: random ones, without a solver, mirrored, slow and slower."""

import dataclasses

from helpers.push_case import (
    box, Case, GOOD_HEADING, GOOD_POSITION, holonomic_case, mirrored_object, mirrored_target,
    random_case, run, SENSORS, vertex_plan)
import numpy as np
from push_control.settings import ControlSettings
from push_control.steered.contact_model import ContactModel
from push_control.steered.laws.steering_law import SolverFailure
from push_control.steered.path.path import CurvatureLimits
from push_control.steered.status import Phase
from push_model.geometry import Pose
from push_model.parameters import RoundRobot
from push_sim_node.sensors import SensorSettings
import pytest

SETTINGS = ControlSettings(control_law='mpc')
pytestmark = pytest.mark.slow


def test_a_push_goes_on_without_a_solver(monkeypatch):
    """Every call fails, every failure is counted, and the object arrives."""
    monkeypatch.setattr('push_control.steered.laws.mpc.MAX_ITERATIONS', 1)
    outcome = run(random_case(44), SETTINGS, 44)
    assert outcome.status.phase is Phase.DONE
    assert outcome.status.solver_failures > 500
    assert outcome.status.solver_failure is SolverFailure.LIMITS_NOT_MET
    assert outcome.position_error < GOOD_POSITION and outcome.heading_error < GOOD_HEADING


@pytest.mark.parametrize('seed', [0, 11])
def test_random_pushes_at_a_corner_succeed(seed):
    """A differential drive; nothing was left to the closed-form law."""
    outcome = run(random_case(seed), SETTINGS, seed)
    assert outcome.status.phase is Phase.DONE, outcome.status
    assert outcome.status.solver_failures == 0
    assert outcome.position_error < GOOD_POSITION and outcome.heading_error < GOOD_HEADING


@pytest.mark.parametrize('kind', ['face', 'vertex', 'round'])
def test_a_holonomic_base_pushes_anywhere(kind):
    """On a face, at a vertex and on a disc."""
    outcome = run(holonomic_case(3, kind), SETTINGS, 3)
    assert outcome.status.phase is Phase.DONE, outcome.status
    assert outcome.position_error < GOOD_POSITION and outcome.heading_error < GOOD_HEADING


def test_the_limits_of_curvature_keep_the_contact_from_jackknifing(monkeypatch):
    """Object and floor give the most that is allowed for; without limits the push is lost."""
    case = random_case(7)
    kept = run(case, SETTINGS, 7, SENSORS)
    assert kept.status.phase is Phase.DONE
    monkeypatch.setattr(ContactModel, 'limits_now', CurvatureLimits(-20.0, 20.0))
    monkeypatch.setattr(ContactModel, 'limits', lambda *_: CurvatureLimits(-20.0, 20.0))
    loose = dataclasses.replace(SETTINGS, cone_weight=1e-6)
    assert run(case, loose, 7, SENSORS).status.phase is Phase.FAILED


@pytest.mark.parametrize('law', ['feedback', 'mpc'])
def test_a_mirrored_world_is_pushed_in_a_mirrored_way(law):
    """Plant, sensors without noise, estimator and law: left and right are alike to the end."""
    case = random_case(4)
    case = case._replace(robot_pose=Pose(*case.target.robot_poses[0].tolist()))
    pose = case.robot_pose
    mirror = Case(mirrored_object(case.nominal), mirrored_object(case.true), case.robot,
                  mirrored_target(case.target), Pose(pose.x, -pose.y, -pose.theta))
    settings = ControlSettings(control_law=law)
    sensors = SensorSettings(pose_latency=0.08)
    one, other = (run(item, settings, sensors=sensors, max_time=15.0)
                  for item in (case, mirror))
    first, second = np.array(one.commands), np.array(other.commands)
    assert np.ptp(first[:, 2]) > 0.05
    assert second == pytest.approx(first * (1.0, 1.0, -1.0), abs=1e-5)
    x, y, theta = one.final
    assert other.final == pytest.approx((x, -y, -theta), abs=1e-5)


@pytest.mark.parametrize('law', ['feedback', 'mpc'])
def test_in_the_slow_limit_the_speed_does_not_matter(law):
    """With as many measurements per path length, errors grow with the square of the speed."""
    nominal, robot, paths = box(0.4, 2.0, [0.3] * 4), RoundRobot(radius=0.17), []
    true = box(0.4, 2.0, [0.4, 0.3, 0.25, 0.3])
    for speed in (0.01, 0.02, 0.04):
        target = vertex_plan(nominal, robot, Pose(1.2, 0.9, 0.3), speed, vertices=(2,))
        case = Case(nominal, true, robot, target, Pose(*target.robot_poses[0].tolist()))
        rows = []

        def record(plant, controller, _, rows=rows):
            rows.append((controller.status.travelled_distance, *plant.truth.object_pose))

        run(case, ControlSettings(control_law=law, start_speed=speed),
            sensors=SensorSettings(pose_rate=500.0 * speed, odometry_rate=1250.0 * speed),
            max_time=1.0 / speed, on_step=record)
        distances, *columns = np.array(rows).T
        paths.append([np.interp(np.linspace(0.1, 0.8, 50), distances, column)
                      for column in columns])
    slow, fast = (np.abs(np.subtract(paths[k], paths[0])).max() for k in (1, 2))
    assert np.ptp(paths[0][2]) > 0.02
    assert slow < 1e-3 and fast < 3e-3
