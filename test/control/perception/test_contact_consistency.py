"""Contacts that do not fit the object poses."""

import math

import numpy as np
from push_control.events import PerceptionEvent
from push_control.perception.contact_consistency import (
    ContactConsistency, FITTING_STD, LATERAL_SIGMAS, MAX_CONTRADICTIONS, Touch,
)
from push_control.perception.object_at_rest import ObjectAtRest, Tap, TapMotion
from push_model.geometry import Pose
import pytest

WITHOUT_EFFECT = PerceptionEvent.PUSH_WITHOUT_EFFECT, PerceptionEvent.PUSHES_WITHOUT_EFFECT
CERTAIN, UNCERTAIN = 0.5 * FITTING_STD, 2.0 * FITTING_STD


def consistency_of(contacts: list[Touch], deviation: float = CERTAIN) -> ContactConsistency:
    """Take in contacts, one after the other."""
    consistency = ContactConsistency()
    for contact in contacts:
        consistency.add(contact, deviation)
    return consistency


def test_the_first_push_without_effect_is_named_and_some_in_a_row_refute() -> None:
    for count in range(1, MAX_CONTRADICTIONS + 1):
        consistency = consistency_of(count * [Touch.WITHOUT_EFFECT])
        assert consistency.is_refuting == (count == MAX_CONTRADICTIONS)
        assert consistency.is_refuting or consistency.inconsistency.code in WITHOUT_EFFECT


def test_contacts_of_all_kinds_that_do_not_fit_add_up() -> None:
    """An object that moves but leaves the robot's place uncertain has not moved as it should."""
    mixed = [Touch.UNEXPECTED, Touch.WITHOUT_EFFECT, Touch.PUSHED, Touch.LATERAL]
    contacts = (mixed * MAX_CONTRADICTIONS)[:MAX_CONTRADICTIONS]
    assert not consistency_of(contacts[:-1], UNCERTAIN).is_refuting
    refuting = consistency_of(contacts, UNCERTAIN)
    assert refuting.is_refuting
    assert refuting.inconsistency.code is PerceptionEvent.CONTACTS_DO_NOT_FIT
    assert consistency_of(MAX_CONTRADICTIONS * [Touch.LATERAL], CERTAIN).is_refuting


def test_a_robot_that_gets_known_by_its_pushes_is_not_refuted_by_them() -> None:
    """However unsure it was at first; where it gets no surer they do not fit."""
    better, worse = ContactConsistency(), ContactConsistency()
    for number in range(2 * MAX_CONTRADICTIONS):
        better.add(Touch.PUSHED, (10.0 - 0.2 * number) * FITTING_STD)
        worse.add(Touch.PUSHED, (10.0 + 0.2 * number) * FITTING_STD)
    assert worse.is_refuting and not better.is_refuting and not better.fits


@pytest.mark.parametrize('contact', [Touch.WITHOUT_EFFECT, Touch.UNEXPECTED])
def test_a_push_that_fits_ends_all_inconsistency(contact: Touch) -> None:
    """However often that happens."""
    before = (MAX_CONTRADICTIONS - 1) * [contact]
    consistency = consistency_of(20 * [*before, Touch.PUSHED])
    assert not consistency.is_refuting and consistency.inconsistency is None and consistency.fits


def test_a_tap_shows_that_there_is_an_object_but_not_that_its_poses_fit() -> None:
    taps = 20 * [Touch.TAPPED]
    assert not consistency_of(taps, UNCERTAIN).is_refuting
    before = (MAX_CONTRADICTIONS - 1) * [Touch.WITHOUT_EFFECT]
    assert not consistency_of(before + taps).is_refuting
    alternating = (MAX_CONTRADICTIONS - 1) * [Touch.WITHOUT_EFFECT, Touch.TAPPED]
    assert not consistency_of(alternating).is_refuting
    assert consistency_of([*alternating, Touch.WITHOUT_EFFECT]).is_refuting


def test_a_robot_that_has_never_missed_is_consistent() -> None:
    assert not ContactConsistency().is_refuting and ContactConsistency().inconsistency is None
    assert ContactConsistency().fits
    consistency = consistency_of(MAX_CONTRADICTIONS * [Touch.WITHOUT_EFFECT])
    consistency.clear()
    assert not consistency.is_refuting and consistency.inconsistency is None


def tapped(rotation: float, frame: float, is_mirrored: bool, error: float = 3e-4) -> TapMotion:
    """Tap an object that takes the robot's front along while it turns, in a rotated frame."""
    contact, driven = np.array((-0.2, -0.08)), 0.012 * np.array((0.9, -0.4))
    c, s = math.cos(rotation), math.sin(rotation)
    moved = contact + driven - np.array([(c, -s), (s, c)]) @ contact
    # The tracker shows the object with the wrong sign of its place across, and of its rotation.
    sign = -1.0 if is_mirrored else 1.0
    axes = Pose(0.3, -0.7, frame)
    before = ObjectAtRest(axes, 1.0, error, 2.0 * error)
    after = before._replace(pose=axes @ Pose(moved[0], sign * moved[1], sign * rotation))
    point = axes.transform(tuple(contact + driven))
    return Tap(before, 0.012, axes.rotate(tuple(driven)), point, 0.01, None).motion(after)


@pytest.mark.parametrize('frame', [0.0, 2.0, -3.0])
@pytest.mark.parametrize('rotation', [-0.06, -0.02, 0.0, 0.03, 0.06])
def test_the_point_that_is_pushed_goes_where_the_robot_goes(rotation: float, frame: float) -> None:
    """However the object turns about it, and whatever axes the world has."""
    motion = tapped(rotation, frame, False)
    assert motion.lateral_excess < -motion.std
    assert motion == pytest.approx(tapped(rotation, 0.0, False), rel=1e-9)


@pytest.mark.parametrize('rotation', [0.05, 0.08])
def test_poses_that_are_mirrored_show_in_taps_that_turn_the_object(rotation: float) -> None:
    motion = tapped(rotation, 0.0, True)
    assert motion.lateral_excess > LATERAL_SIGMAS * motion.std


@pytest.mark.parametrize('count', range(1, 40, 6))
def test_taps_that_noise_hides_add_up_to_what_it_does_not(count: int) -> None:
    """To the side n times as far is seen as n times the variance: by what noise lets one say."""
    consistency, excess = ContactConsistency(), 1.01 * LATERAL_SIGMAS / math.sqrt(count)
    for index in range(count):
        assert consistency.fits, index
        consistency.add_tap(TapMotion(excess, 1.0))
    assert not consistency.fits and not consistency.is_refuting


def test_taps_that_move_the_object_to_the_side_refute_its_poses() -> None:
    """As contacts of any other kind; a push that fits takes that back."""
    consistency = ContactConsistency()
    for count in range(MAX_CONTRADICTIONS):
        assert not consistency.is_refuting
        consistency.add(Touch.TAPPED, CERTAIN)
        consistency.add_tap(TapMotion(1.1 * LATERAL_SIGMAS, 1.0))
    assert consistency.is_refuting
    assert consistency.inconsistency.code is PerceptionEvent.CONTACTS_DO_NOT_FIT
    consistency.add(Touch.PUSHED, CERTAIN)
    assert consistency.fits


@pytest.mark.parametrize('noise', [0.0, 0.003, 0.01, 0.03])
def test_taps_that_fit_never_speak_against_the_poses(noise: float) -> None:
    """A thousand of them, with headings as noisy as stated: with 3 degrees of noise, too."""
    rng, consistency = np.random.default_rng(0), ContactConsistency()
    for _ in range(1000):
        driven, rotation = 0.02 * rng.random(), 0.05 * rng.standard_normal()
        contact = np.array((-0.2, rng.uniform(-0.15, 0.15)))
        c, s = math.cos(rotation), math.sin(rotation)
        x, y = contact + (driven, 0.0) - np.array([(c, -s), (s, c)]) @ contact
        errors = rng.normal(0.0, (5e-4, 5e-4, noise), (2, 3))
        poses = [Pose(*(a + b for a, b in zip(pose, error)))
                 for pose, error in zip(((0.0, 0.0, 0.0), (x, y, rotation)), errors.tolist())]
        before, after = (ObjectAtRest(pose, 1.0, 5e-4, noise) for pose in poses)
        front = contact[0] + driven, contact[1]
        consistency.add_tap(Tap(before, driven, (driven, 0.0), front, 0.005, True).motion(after))
        assert consistency.fits
