"""Wheels that lose a part of their way by the force they push with: found out, and allowed for."""

import math

from helpers.ensemble_runs import CONTROL, NO_NOISE, ROBOT, run
from helpers.objects import box
import numpy as np
from push_control.perception.ensemble.contact_hypotheses import ContactHypotheses
from push_control.perception.ensemble.members import Members
from push_control.perception.ensemble.push_ensemble import PushEnsemble
from push_control.perception.ensemble.wheel_creep import (
    CREEP_RANGE, MAX_LOSS, reduce_by_creep, spread_creep)
from push_dynamics.layout import NORMAL_FORCE, TANGENTIAL_FORCE
from push_model.geometry import Pose
from push_sim_node.drive_imperfections import DriveImperfections
from push_sim_node.sensors import SensorSettings
import pytest

CREEP = 0.006
SENSORS = SensorSettings(pose_noise=2e-3, pose_heading_noise=math.radians(0.3), pose_latency=0.08,
                         odometry_scale_noise=0.02, odometry_heading_drift_noise=0.02)
START, WAYPOINTS = Pose(-0.5, 0.02, 0.0), ((0.1, 0.02), (-0.2, 0.02))
HEAVY = box(mass=6.0)


def pushed(creep, seed, follow=ContactHypotheses):
    """Push a heavy box by 0.4 m, with wheels that creep."""
    return run(WAYPOINTS, HEAVY, HEAVY, SENSORS, seed=seed, start=START, follow=follow,
               imperfections=DriveImperfections(wheel_creep=creep))


@pytest.mark.parametrize('seed', [1, 2])
def test_creep_is_found_in_the_first_push(seed):
    """Its amount is right within its own uncertainty, and the robot keeps its place."""
    outcome, alone = pushed(CREEP, seed), pushed(CREEP, seed, lambda ensemble: ensemble)
    creep = outcome.ensemble.members.wheel_creep
    assert abs(creep.mean() - CREEP) < 3.0 * creep.std() < CREEP
    assert math.hypot(*outcome.error[:2]) < 0.5 * math.hypot(*alone.error[:2])
    assert abs(outcome.error[0]) < 3.0 * outcome.ensemble.standard_deviations[0]


@pytest.mark.parametrize('seed', [1, 2])
def test_wheels_that_do_not_creep_are_not_said_to(seed):
    """Errors of odometry that come with the distance are not taken for it."""
    assert not pushed(0.0, seed).ensemble.members.wheel_creep.any()


def members_with(forces, creep):
    """Return members that push with these forces along both axes of the contact [N]."""
    members = Members(box(), ROBOT, len(forces))
    members.states[:, [NORMAL_FORCE, TANGENTIAL_FORCE]] = forces
    members.wheel_creep[:, 0] = creep
    return members


def test_the_way_is_lost_in_proportion_to_the_force():
    """The rotation is not; without a contact nothing is, and never more than the bound."""
    members = members_with([(0.0, 0.0), (3.0, 4.0), (6.0, -8.0), (1e4, 0.0)], CREEP)
    increments = np.tile((0.01, -0.02, 0.03), (4, 1))
    reduce_by_creep(increments, members)
    expected = 1.0 - np.array([0.0, 5.0 * CREEP, 10.0 * CREEP, MAX_LOSS])
    np.testing.assert_allclose(increments[:, 0], 0.01 * expected, rtol=1e-12)
    np.testing.assert_allclose(increments[:, 1], -0.02 * expected, rtol=1e-12)
    assert np.all(increments[:, 2] == 0.03)


def test_creep_that_is_not_known_makes_the_place_less_certain_the_heavier_the_push():
    """The deviation of the way is that of the creep times the force."""
    creep = spread_creep(100, np.random.default_rng(0))[:, 0]
    assert CREEP_RANGE[0] < creep.min() < creep.max() < CREEP_RANGE[1]
    stds = []
    for force in (0.0, 10.0, 20.0):
        increments = np.tile((0.1, 0.0, 0.0), (100, 1))
        reduce_by_creep(increments, members_with([(force, 0.0)] * 100, creep))
        stds.append(increments[:, 0].std())
    np.testing.assert_allclose(stds, [0.0, creep.std(), 2.0 * creep.std()], rtol=1e-9, atol=1e-12)


def test_another_object_is_pushed_by_the_same_wheels():
    """What is known of their creep goes with the robot."""
    before = pushed(CREEP, 1).ensemble
    after = ContactHypotheses(PushEnsemble(box(), ROBOT, CONTROL, NO_NOISE))
    after.take_over_robot(before)
    assert np.array_equal(after.members.wheel_creep, before.members.wheel_creep)
