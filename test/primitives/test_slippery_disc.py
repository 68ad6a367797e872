"""Laws of discs without contact friction, and of the primitives that they get."""

import math

from helpers.objects import bin_, box
import numpy as np
from push_dynamics.private_folder import PrivateFolder
from push_model.friction import friction_center
from push_model.geometry import Pose
from push_model.parameters import RoundRobot
from push_primitives import store, value_iteration
from push_primitives.cost_settings import CostSettings
from push_primitives.cost_to_go import CostToGo
from push_primitives.slippery_disc import CENTER_STEP, rotated, slippery_disc
from push_primitives.table import build_table, sample_learned_friction, SLIPPERY_SAMPLES
from push_primitives.weights import FrictionBelief
import pytest

BIN = bin_(feet=3)
KNOWN = FrictionBelief((0.013, 0.016), 0.01, 0.003, 0.01)
# Mean of the squared distances of the supports along a line.
SQUARED_GYRATION = 0.5 * 0.16 ** 2


def test_a_slippery_disc_has_the_friction_that_is_known():
    """Centre and contact friction are as believed but for rounding, in both of its models."""
    disc = slippery_disc(BIN, KNOWN)
    np.testing.assert_allclose(friction_center(disc.obj), KNOWN.center, atol=0.5 * CENTER_STEP)
    assert disc.obj.contact_friction_coefficient == 0.0
    x, y = friction_center(disc.ring)
    assert x == pytest.approx(math.hypot(*KNOWN.center), rel=0.2)
    assert y == pytest.approx(0.0, abs=1e-6)
    assert disc.direction == pytest.approx(math.atan2(0.016, 0.013), abs=math.radians(1.0))


@pytest.mark.parametrize('obj, changes', [
    (BIN, {'contact_friction': 0.3}), (BIN, {'contact_friction_deviation': 0.1}), (box(), {})])
def test_what_the_contact_turns_has_common_primitives(obj, changes):
    """So have rough contacts, those that are not known yet, and faces."""
    assert slippery_disc(obj, KNOWN._replace(**changes)) is None


def test_only_the_centre_of_friction_turns_a_disc_without_contact_friction():
    """It falls behind: pushed at right angles to it, the disc turns by p / c^2 per distance."""
    distance = 0.01
    disc = slippery_disc(BIN, KNOWN._replace(center=(distance, 0.0)))
    table = build_table(disc.ring, 0.17, friction_samples=sample_learned_friction(disc.ring))
    p = friction_center(disc.ring)[0]
    for angle in (0.0, 0.5 * math.pi, math.pi, -0.5 * math.pi):
        errors = np.abs(np.remainder(table.starts[:, 2] - angle + math.pi, math.tau) - math.pi)
        index = int(np.flatnonzero((errors < 1e-6) & (table.approach_angles == 0.0))[0])
        step = int(np.searchsorted(table.lengths, 0.09))
        # Sample 0 is what is known.
        x, y, heading = table.displacements[index, 0, step]
        rate = heading / math.hypot(x, y)
        assert rate == pytest.approx(-math.sin(angle) * p / SQUARED_GYRATION, abs=0.1)


def test_a_rotated_disc_has_the_same_cost_to_go():
    """A goal that is rotated with it is as far."""
    values = np.random.default_rng(0).uniform(size=(4, 3, 8, 5)).astype(np.float32)
    solved = CostToGo(values, np.array((0.0, 0.1, 1.0)), np.linspace(-math.pi, math.pi, 5))
    for steps in (1, 3, -2):
        angle = steps * math.tau / 8
        turned = rotated(solved, angle)
        for x, y, theta in ((0.3, 0.1, 0.4), (-0.05, 0.7, -2.0)):
            goal = Pose(x, y, theta)
            x, y, _ = Pose(0.0, 0.0, angle) @ Pose(x, y, 0.0)
            assert (sorted(turned.at(Pose(x, y, theta), face) for face in range(4))
                    == pytest.approx(sorted(solved.at(goal, face) for face in range(4))))


def test_samples_about_learned_friction_are_close_to_it():
    """The first is what was learned; none has a negative contact friction."""
    learned = slippery_disc(BIN, KNOWN).obj
    samples = sample_learned_friction(learned)
    np.testing.assert_allclose(samples.centers[0], friction_center(learned))
    assert len(samples.centers) > SLIPPERY_SAMPLES
    assert np.hypot(*(samples.centers - samples.centers[0]).T).max() < 0.01
    assert samples.contact_frictions.min() >= 0.0 and samples.contact_frictions.max() < 0.05


@pytest.mark.slow
def test_turning_takes_longer_the_nearer_the_centre_of_friction_is(monkeypatch, tmp_path):
    """Moving on does not; and all that agree about friction have the same primitives."""
    for name, value in (('BEARINGS', 8), ('SELECTED_ACTIONS', 4)):
        monkeypatch.setattr(value_iteration, name, value)
    # Not by the environment: what is compiled is not compiled again.
    monkeypatch.setattr(store, 'cache_directory', lambda: PrivateFolder(tmp_path))
    robot, settings = RoundRobot(radius=0.17, drive='holonomic'), CostSettings(drive='holonomic')
    store.forget()
    near, far = (store.load_primitives(BIN, robot, settings, KNOWN._replace(center=center))
                 for center in ((0.01, 0.0), (0.0, 0.04)))
    assert store.load_primitives(BIN, robot, settings, KNOWN._replace(center=(0.0, 0.04))) is far
    assert near.is_learned and far.is_learned
    turn = [_least(found, Pose(0.0, 0.0, 0.5 * math.pi)) for found in (near, far)]
    assert turn[0] > 1.15 * turn[1]
    assert _least(near, Pose(0.02, 0.0, 0.0)) < turn[1]
    store.forget()


def _least(primitives, goal):
    return min(primitives.cost_to_go.at(goal, face) for face in range(4))
