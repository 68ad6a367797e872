"""Contacts that do not fit the object poses."""

from push_control.localization.contact_evidence import (
    Contact, ContactEvidence, FITTING_STD, MAX_CONTRADICTIONS,
)
import pytest

CERTAIN, UNCERTAIN = 0.5 * FITTING_STD, 2.0 * FITTING_STD


def evidence_of(contacts: list[Contact], deviation: float = CERTAIN) -> ContactEvidence:
    """Take in contacts, one after the other."""
    evidence = ContactEvidence()
    for contact in contacts:
        evidence.add(contact, deviation)
    return evidence


def test_the_first_push_in_vain_is_named_and_some_in_a_row_refute() -> None:
    for count in range(1, MAX_CONTRADICTIONS + 1):
        evidence = evidence_of(count * [Contact.IN_VAIN])
        assert evidence.is_refuting == (count == MAX_CONTRADICTIONS)
        assert evidence.is_refuting or 'moved no object' in evidence.doubt


def test_contacts_of_all_kinds_that_do_not_fit_add_up() -> None:
    """An object that moves but leaves the robot's place uncertain has not moved as it should."""
    mixed = [Contact.UNEXPECTED, Contact.IN_VAIN, Contact.PUSHED, Contact.ASIDE]
    contacts = (mixed * MAX_CONTRADICTIONS)[:MAX_CONTRADICTIONS]
    assert not evidence_of(contacts[:-1], UNCERTAIN).is_refuting
    refuting = evidence_of(contacts, UNCERTAIN)
    assert refuting.is_refuting and 'did not fit the object poses' in refuting.doubt
    assert evidence_of(MAX_CONTRADICTIONS * [Contact.ASIDE], CERTAIN).is_refuting


def test_a_robot_that_gets_known_by_its_pushes_is_not_refuted_by_them() -> None:
    """However unsure it was at first; where it gets no surer they do not fit."""
    better, worse = ContactEvidence(), ContactEvidence()
    for number in range(2 * MAX_CONTRADICTIONS):
        better.add(Contact.PUSHED, (10.0 - 0.2 * number) * FITTING_STD)
        worse.add(Contact.PUSHED, (10.0 + 0.2 * number) * FITTING_STD)
    assert worse.is_refuting and not better.is_refuting and not better.fits


@pytest.mark.parametrize('contact', [Contact.IN_VAIN, Contact.UNEXPECTED])
def test_a_push_that_fits_ends_all_doubt(contact: Contact) -> None:
    """However often that happens."""
    before = (MAX_CONTRADICTIONS - 1) * [contact]
    evidence = evidence_of(20 * [*before, Contact.PUSHED])
    assert not evidence.is_refuting and evidence.doubt == '' and evidence.fits


def test_a_tap_shows_that_there_is_an_object_but_not_that_its_poses_fit() -> None:
    taps = 20 * [Contact.TAPPED]
    assert not evidence_of(taps, UNCERTAIN).is_refuting
    assert not evidence_of((MAX_CONTRADICTIONS - 1) * [Contact.IN_VAIN] + taps).is_refuting
    vain = (MAX_CONTRADICTIONS - 1) * [Contact.IN_VAIN, Contact.TAPPED]
    assert not evidence_of(vain).is_refuting
    assert evidence_of([*vain, Contact.IN_VAIN]).is_refuting


def test_a_robot_that_has_never_missed_is_not_doubted() -> None:
    assert not ContactEvidence().is_refuting and ContactEvidence().doubt == ''
    assert ContactEvidence().fits
    evidence = evidence_of(MAX_CONTRADICTIONS * [Contact.IN_VAIN])
    evidence.clear()
    assert not evidence.is_refuting and evidence.doubt == ''
