"""What follows from how far a straight push has come."""

import dataclasses
import math

from push_control.behaviors.failures import BehaviorFailure
from push_control.behaviors.push_progress import (
    decide, EXCESS_DISTANCE, EXCESS_RATIO, MAX_UNSEEN_HEADING_STD, MAX_UNSEEN_STD, MIN_SPEED, Miss,
    MISS_DISTANCE, MISS_SIGMAS, PushProgress, Stage, Steer, Stop, TIMEOUT)
from push_control.perception.contact_consistency import Touch
import pytest

COURSE = Steer(0.5, 0.2)
LENGTH, DEVIATION = 0.3, 0.01
RUN_IN = PushProgress(LENGTH, COURSE, deviation=DEVIATION, braking_distance=0.02)
TAP = dataclasses.replace(RUN_IN, stage=Stage.PUSHING)
PUSH = dataclasses.replace(TAP, has_moved=True, pushed=0.1)
LIMIT = EXCESS_DISTANCE + EXCESS_RATIO * LENGTH
BEYOND = MISS_DISTANCE + MISS_SIGMAS * DEVIATION + 1e-6
AT_END = Steer(0.5, 0.019)


def test_progress_cannot_be_changed():
    """What one step knows is not written by another."""
    with pytest.raises(dataclasses.FrozenInstanceError):
        PUSH.pushed = 0.0


@pytest.mark.parametrize('progress', [RUN_IN, TAP, PUSH])
def test_a_push_under_way_goes_on_as_chosen(progress):
    """In every stage before the stop."""
    assert decide(progress) == COURSE


@pytest.mark.parametrize('progress, values, expected', [
    (PUSH, {'course': AT_END}, Stop()),
    (TAP, {'course': AT_END}, Stop()),
    (TAP, {'course': AT_END, 'is_lost': True}, AT_END),
    (PUSH, {'pushed': LIMIT + 1e-6}, Stop()),
    (RUN_IN, {'time': TIMEOUT + LIMIT / MIN_SPEED + 1e-6}, Stop()),
    (PUSH, {'is_near_obstacle': True}, Stop()),
    (TAP, {'is_spinning': True}, Miss(BehaviorFailure.WHEELS_SPIN)),
    (PUSH, {'is_spinning': True}, Miss(BehaviorFailure.WHEELS_SPIN)),
    (RUN_IN, {'overrun': BEYOND}, Miss(BehaviorFailure.OBJECT_NOT_FOUND)),
    (RUN_IN, {'overrun': BEYOND - 2e-6}, COURSE),
    (TAP, {'pushed': BEYOND}, Miss(BehaviorFailure.OBJECT_NOT_MOVED)),
    (TAP, {'pushed': BEYOND, 'unseen_distance': 0.01}, COURSE),
    (TAP, {'pushed': BEYOND, 'deviation': 2.0 * DEVIATION}, COURSE),
    (PUSH, {'pushed': BEYOND}, COURSE),
    (PUSH, {'pushed': BEYOND, 'is_without_effect': True}, Miss(BehaviorFailure.OBJECT_NOT_MOVED)),
    (PUSH, {'pushed': BEYOND, 'is_without_effect': True, 'is_creeping': True},
     Miss(BehaviorFailure.WHEELS_SPIN)),
    (PUSH, {'pushed': BEYOND - 2e-6, 'is_without_effect': True}, COURSE),
    (PUSH, {'is_hindered': True}, COURSE),
    (PUSH, {'course': AT_END, 'is_hindered': True}, Miss(BehaviorFailure.OBJECT_NOT_MOVED)),
    (PUSH, {'course': AT_END, 'is_hindered': True, 'is_creeping': True},
     Miss(BehaviorFailure.WHEELS_SPIN)),
    (RUN_IN, {'has_touched_early': True}, Miss(BehaviorFailure.TOUCHED_EARLY))])
def test_what_ends_a_push(progress, values, expected):
    """A good progress with one value that is not."""
    assert decide(dataclasses.replace(progress, **values)) == expected


@pytest.mark.parametrize('progress, values, expected', [
    (RUN_IN, {'has_touched_early': True, 'overrun': BEYOND}, Miss(BehaviorFailure.TOUCHED_EARLY)),
    (RUN_IN, {'has_touched_early': True, 'pushed': LIMIT + 1e-6}, Stop()),
    (TAP, {'course': AT_END, 'pushed': BEYOND}, Miss(BehaviorFailure.OBJECT_NOT_MOVED))])
def test_of_two_reasons_to_end_the_graver_one_counts(progress, values, expected):
    """A robot that is elsewhere does not end its push as planned."""
    assert decide(dataclasses.replace(progress, **values)) == expected


@pytest.mark.parametrize('angle, contact', [
    (0.0, Touch.PUSHED), (1.0, Touch.PUSHED), (1.1, Touch.LATERAL), (3.0, Touch.LATERAL)])
def test_an_object_moves_along_with_what_pushes_it(angle, contact):
    """Within sixty degrees; short displacements are not compared."""
    moved = 0.1 * math.cos(angle), 0.1 * math.sin(angle)
    assert dataclasses.replace(PUSH, driven=(0.1, 0.0), moved=moved).contact is contact
    assert dataclasses.replace(PUSH, driven=(0.02, 0.0), moved=moved).contact is Touch.TAPPED


@pytest.mark.parametrize('moved, is_at_rest', [
    ((0.0, 0.0), True), ((0.005, 0.0), True), ((0.1, 0.0), False), ((0.0, 0.1), False)])
def test_an_object_that_moves_aside_is_not_at_rest(moved, is_at_rest):
    """Poses in other axes show that something moves."""
    assert dataclasses.replace(PUSH, moved=moved).is_at_rest == is_at_rest


BLIND = {'is_blind': True, 'was_blind': True}


@pytest.mark.parametrize('progress, values, expected', [
    (PUSH, {'course': AT_END}, Stop()),
    (PUSH, {'pushed': LIMIT + 1e-6}, Stop()),
    (PUSH, {'is_near_obstacle': True}, Stop()),
    (RUN_IN, {'overrun': BEYOND}, Stop()),
    (TAP, {'pushed': BEYOND}, COURSE),
    (PUSH, {'object_std': MAX_UNSEEN_STD - 1e-6}, COURSE),
    (PUSH, {'object_std': MAX_UNSEEN_STD + 1e-6}, Stop()),
    (PUSH, {'object_heading_std': MAX_UNSEEN_HEADING_STD - 1e-6}, COURSE),
    (PUSH, {'object_heading_std': MAX_UNSEEN_HEADING_STD + 1e-6}, Stop())])
def test_a_push_that_is_not_seen_ends_but_misses_nothing(progress, values, expected):
    """It ends as planned, by its limits, or where nobody knows where the object is by now."""
    assert decide(dataclasses.replace(progress, **BLIND, **values)) == expected


def test_a_push_that_is_seen_goes_on_however_uncertain_the_object_is():
    """The next pose tells where it is."""
    assert decide(dataclasses.replace(PUSH, object_std=1.0, object_heading_std=1.0)) == COURSE
