"""A contact that is far more slippery than stated is recognized, one that is not stays rough."""

import math

from helpers.ensemble_runs import ROBOT, run
from helpers.objects import bin_, box
import numpy as np
from push_control.perception.ensemble.ensemble_state import OdometryNoise
from push_control.perception.ensemble.hypothesis_odds import (
    ACCEPTED_ODDS, PRIOR_ODDS, REJECTED_ODDS, Verdict)
from push_control.perception.ensemble.push_ensemble import PushEnsemble
from push_control.perception.ensemble.slip_detector import (
    SlipDetector, SLIPPERY_FRACTION, slippery_friction)
from push_control.perception.object_knowledge import ObjectKnowledge
from push_control.settings import ControlSettings
from push_model.geometry import Pose
from push_sim_node.sensors import SensorSettings
import pytest

NOMINAL = 0.5
PRIOR = np.random.default_rng(0).normal(NOMINAL, 0.3 * NOMINAL, 100)
DRIFTING = SensorSettings(pose_noise=2e-3, pose_heading_noise=math.radians(0.3),
                          pose_latency=0.08, odometry_scale_noise=0.02,
                          odometry_heading_drift_noise=0.02)
# On the path to it the robot gets some centimetres beside where it believes to be.
START = Pose(-0.9, 0.9, 2.0)
WAYPOINTS = ((-0.6, 0.05), (0.2, 0.05))
CASES = ((bin_, 0), (bin_, 1), (box, 0))


def pushed(make, friction, seed):
    """Push an object once, which is believed to have another contact friction."""
    believed = make(contact_friction_coefficient=NOMINAL)
    return run(WAYPOINTS, make(contact_friction_coefficient=friction), believed, DRIFTING,
               seed=seed, start=START)


@pytest.mark.parametrize('make, seed', CASES)
def test_a_contact_without_friction_is_recognized_in_the_first_push(make, seed):
    """So the robot keeps its place, although the object moves as nobody expected."""
    outcome = pushed(make, 0.0, seed)
    assert outcome.ensemble.knowledge.contact_friction < 0.3 * NOMINAL
    assert math.hypot(*outcome.error[:2]) < 0.03
    assert abs(outcome.error[2]) < math.radians(3.0)


@pytest.mark.parametrize('make, seed', CASES)
def test_a_rough_contact_stays_rough(make, seed):
    """Nothing is taken for slippery only because the robot is not where it is believed to be."""
    outcome = pushed(make, 0.8 * NOMINAL, seed)
    assert outcome.ensemble.knowledge.contact_friction > SLIPPERY_FRACTION * NOMINAL
    assert math.hypot(*outcome.error[:2]) < 0.03


def test_evidence_adds_up_over_contacts():
    """What each contact shows counts in the next, until one hypothesis is certain."""
    whole, parts = SlipDetector(), SlipDetector()
    ratio = 0.6 * math.log(ACCEPTED_ODDS / PRIOR_ODDS)
    assert whole.evaluate(ratio) is Verdict.OPEN
    assert whole.evaluate(2.0 * ratio) is Verdict.ACCEPTED
    assert parts.evaluate_after_contact(0.3 * ratio) is Verdict.REJECTED
    assert parts.is_needed(NOMINAL, PRIOR)
    assert parts.evaluate(1.7 * ratio) is Verdict.ACCEPTED
    assert not parts.is_needed(NOMINAL, PRIOR)


def test_a_hypothesis_that_is_refuted_is_not_followed_again():
    """Nor is one that what was learned of friction excludes, or that is believed already."""
    test = SlipDetector()
    assert test.is_needed(NOMINAL, PRIOR)
    assert test.evaluate(math.log(REJECTED_ODDS)) is Verdict.REJECTED
    assert not test.is_needed(NOMINAL, PRIOR)
    known = NOMINAL + 0.1 * (PRIOR - NOMINAL)
    assert not SlipDetector().is_needed(NOMINAL, known)
    assert not SlipDetector().is_needed(NOMINAL, 0.1 * known)


def test_slippery_members_keep_their_order():
    """So what correlates with contact friction still does."""
    friction = slippery_friction(NOMINAL, PRIOR)
    np.testing.assert_array_equal(np.argsort(friction), np.argsort(PRIOR))
    assert 0.0 < friction.min() and friction.max() < SLIPPERY_FRACTION * NOMINAL


def test_knowledge_of_a_slippery_contact_is_kept():
    """It needs no test: the second task begins with what the first has learned."""
    ensemble = PushEnsemble(bin_(contact_friction_coefficient=NOMINAL), ROBOT, ControlSettings(),
                            OdometryNoise(0.02, 0.02, 0.003, 0.01))
    ensemble.start_from(ObjectKnowledge((0.0, 0.0), 0.01, 0.03, 0.02))
    assert ensemble.knowledge.contact_friction == pytest.approx(0.03, abs=0.005)
