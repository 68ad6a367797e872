"""Two hypotheses of a contact: when they fork and how they end."""

import functools
import math
from typing import Callable

from helpers.ensemble_runs import CONTROL, drive, HOME, NOISE, ROBOT
from helpers.objects import bin_
import numpy as np
from push_control.perception.ensemble.contact_hypotheses import ContactHypotheses
from push_control.perception.ensemble.measurement_update import COUPLING_TIME
from push_control.perception.ensemble.push_ensemble import PushEnsemble
from push_control.perception.ensemble.slip_detector import SLIPPERY_FRACTION
from push_control.perception.object_knowledge import ObjectKnowledge
from push_model.geometry import Pose
from push_model.signals import ObjectPose, Odometry, STOP
from push_sim_node.sensors import SensorSettings
from push_sim_node.simulation import Simulation, SimulationSettings
import pytest

NOMINAL = 0.5
STATED = bin_(contact_friction_coefficient=NOMINAL)
# The robot pushes beside the middle, so that a slippery contact slides.
START, WAYPOINTS = Pose(-0.5, 0.09, 0.0), ((0.0, 0.09), (-0.4, 0.09))
SENSORS = SensorSettings(pose_noise=2e-3, pose_heading_noise=math.radians(0.3), pose_latency=0.08)
Filter = PushEnsemble | ContactHypotheses


def ensemble() -> PushEnsemble:
    """Return an ensemble of the contact as stated."""
    return PushEnsemble(STATED, ROBOT, CONTROL, NOISE)


@functools.lru_cache(maxsize=None)
def recorded(friction: float) -> tuple[Odometry | ObjectPose, ...]:
    """Record what the robot measures of a push and of its way back."""
    true = bin_(contact_friction_coefficient=friction)
    simulation = Simulation(true, ROBOT, HOME, START, SimulationSettings(seed=3), SENSORS)
    return tuple(drive(simulation, WAYPOINTS))


def take(estimate: Filter, measured: Odometry | ObjectPose) -> None:
    """Give a filter a measurement."""
    if isinstance(measured, Odometry):
        estimate.predict(measured)
    else:
        estimate.update(measured)


def play(estimate: Filter, friction: float) -> None:
    """Give a filter the whole record."""
    for measured in recorded(friction):
        take(estimate, measured)


def in_contact() -> ContactHypotheses:
    """Return hypotheses that have just forked."""
    hypotheses = ContactHypotheses(ensemble())
    for measured in recorded(NOMINAL):
        take(hypotheses, measured)
        if hypotheses.is_undecided:
            return hypotheses
    raise AssertionError('no contact')


def test_a_fork_starts_at_first_contact_and_ends_after_it() -> None:
    """Not before a member touches the object, nor later than object poses tell of the robot."""
    hypotheses, touched_at = ContactHypotheses(ensemble()), -math.inf
    forks = 0
    for measured in recorded(NOMINAL):
        was_undecided = hypotheses.is_undecided
        take(hypotheses, measured)
        if not isinstance(measured, Odometry):
            continue
        if hypotheses.contact_ratio > 0.0:
            touched_at = measured.time
        forks += hypotheses.is_undecided and not was_undecided
        if hypotheses.is_undecided:
            assert measured.time - touched_at <= COUPLING_TIME + 0.1
    assert forks >= 1 and not hypotheses.is_undecided


def test_a_rough_contact_is_estimated_as_by_an_ensemble_alone() -> None:
    """Bit by bit: the slippery hypothesis draws no random number of the rough one."""
    alone, hypotheses = ensemble(), ContactHypotheses(ensemble())
    play(alone, NOMINAL)
    play(hypotheses, NOMINAL)
    assert hypotheses.knowledge.contact_friction > SLIPPERY_FRACTION * NOMINAL
    assert np.array_equal(hypotheses.members.states, alone.members.states)
    assert np.array_equal(hypotheses.members.parameters, alone.members.parameters)


def test_a_slippery_contact_is_read_from_the_same_members() -> None:
    """Whoever holds the members, as the law of a push, sees what was decided."""
    alone, hypotheses = ensemble(), ContactHypotheses(ensemble())
    members = hypotheses.members
    play(alone, 0.0)
    play(hypotheses, 0.0)
    assert hypotheses.members is members
    assert not np.array_equal(members.parameters, alone.members.parameters)
    assert hypotheses.knowledge.contact_friction < 0.5 * alone.knowledge.contact_friction
    assert hypotheses.knowledge.contact_friction < SLIPPERY_FRACTION * NOMINAL
    assert np.all(members.parameters[:, -1] < NOMINAL)


@pytest.mark.parametrize('infer', [
    lambda estimate: estimate.update_along(0.0, 0.0, 0.01),
    lambda estimate: estimate.inflate_covariance(0.01),
    lambda estimate: estimate.place_robot(START, (0.01, 0.01, 0.01)),
    lambda estimate: estimate.restore_robot(estimate.remember_robot(), 0.0, 0.0)])
def test_what_is_inferred_of_the_robot_ends_the_comparison(
        infer: Callable[[ContactHypotheses], None]) -> None:
    """The likelihoods were those of a robot elsewhere; the rough contact remains."""
    hypotheses = in_contact()
    friction = hypotheses.members.parameters[:, -1].mean()
    infer(hypotheses)
    assert not hypotheses.is_undecided
    assert hypotheses.members.parameters[:, -1].mean() == pytest.approx(friction, rel=0.1)


def test_a_measured_robot_pose_ends_no_comparison() -> None:
    """It is a measurement, which both hypotheses explain alike."""
    hypotheses, exact = in_contact(), np.diag((1e-10, 1e-10, 1e-10))
    estimate = hypotheses.pose
    measured = Pose(estimate.x, estimate.y + 0.01, estimate.theta)
    for _ in range(5):
        hypotheses.update_robot(measured, exact)
    assert hypotheses.is_undecided
    assert hypotheses.pose == pytest.approx(measured, abs=2e-3)


def test_a_contact_that_is_known_needs_no_fork() -> None:
    """Neither one that is known to be rough nor one that is known to be slippery."""
    for friction in (NOMINAL, 0.03):
        hypotheses = ContactHypotheses(ensemble())
        hypotheses.start_from(ObjectKnowledge((0.0, 0.0), 0.01, friction, 0.02))
        for measured in recorded(NOMINAL):
            take(hypotheses, measured)
            assert not hypotheses.is_undecided


def test_an_object_that_was_never_seen_forks_nothing() -> None:
    """There is nothing to touch."""
    hypotheses = ContactHypotheses(ensemble())
    for k in range(20):
        hypotheses.predict(Odometry(0.05 * k, Pose(0.02 * k, 0.0, 0.0), STOP))
    assert hypotheses.is_initialized and not hypotheses.has_object
    assert not hypotheses.is_undecided


def after_unseen_push(friction: float) -> ContactHypotheses:
    """Return hypotheses of a push and of the way back, of which nothing is seen."""
    hypotheses = ContactHypotheses(PushEnsemble(STATED, ROBOT, CONTROL, NOISE))
    for index, measured in enumerate(recorded(friction)):
        if index < 2 or isinstance(measured, Odometry):
            take(hypotheses, measured)
    return hypotheses


def look(hypotheses: ContactHypotheses, friction: float, count: int) -> None:
    """Let hypotheses see the object where it is at the end, while odometry stands."""
    last = [each for each in recorded(friction) if isinstance(each, ObjectPose)][-1]
    odometry = [each for each in recorded(friction) if isinstance(each, Odometry)][-1]
    for index in range(1, count + 1):
        time = odometry.time + 0.05 * index
        hypotheses.predict(odometry._replace(time=time, twist=STOP))
        hypotheses.update(last._replace(time=time))


@pytest.mark.parametrize('friction, is_slippery', [(NOMINAL, False), (0.0, True)])
def test_a_contact_that_nobody_has_seen_is_decided_by_the_look_after_it(
        friction: float, is_slippery: bool) -> None:
    """Until then both hypotheses go on, however long that takes."""
    hypotheses = after_unseen_push(friction)
    assert hypotheses.is_undecided
    look(hypotheses, friction, math.ceil(COUPLING_TIME / 0.05) + 2)
    assert not hypotheses.is_undecided
    estimate = hypotheses.knowledge.contact_friction
    assert (estimate < SLIPPERY_FRACTION * NOMINAL) is is_slippery


def test_the_first_look_after_a_contact_tells_of_robot_and_friction() -> None:
    """Later ones tell of the object alone, as does every pose of an object at rest."""
    hypotheses = after_unseen_push(NOMINAL)
    before = hypotheses.members.parameters.copy(), hypotheses.standard_deviations.copy()
    look(hypotheses, NOMINAL, 4)
    assert not np.array_equal(before[0], hypotheses.members.parameters)
    assert hypotheses.standard_deviations[0] < before[1][0]
    look(hypotheses, NOMINAL, 20)
    learned = hypotheses.members.parameters.copy()
    look(hypotheses, NOMINAL, 22)
    assert np.array_equal(hypotheses.members.parameters, learned)
