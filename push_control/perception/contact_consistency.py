"""
Consistency of contacts with the object poses.

The robot feels nothing: that it pushes shows in object poses alone. Where these are of another
object, mirrored, in other axes or of the robot itself, pushes leave the object where it is or move
it sideways, or it moves although the robot does not touch it. No pose of the robot explains all.
"""

import enum
import math

from push_control.events import PerceptionEvent
from push_control.perception.object_at_rest import TapMotion
from push_model.events import Report

# Contacts in a row that do not fit the poses until none will. Measured: after random faults, with
# poses that are off by 0.3 m or rotated by 30 deg, and with wheels that have slipped, robots have
# found their object after at most three.
MAX_CONTRADICTIONS = 6
# Standard deviation of the robot's position after a push beyond which what was seen of the push
# does not fit what was driven [m]; measured: 5 cm at most where it does, 6 to 15 cm with poses
# that are mirrored.
FITTING_STD = 0.055
# Standard deviations by which taps have to have moved the object to the side, all in all, before
# that counts as a contact that does not fit; chosen.
LATERAL_SIGMAS = 3.0


class Touch(enum.Enum):
    """Result of a contact, or of one that there should have been."""

    # The object has moved as the robot has.
    PUSHED = 'pushed'
    # It has moved, but too little to compare the directions at once.
    TAPPED = 'tapped'
    # It has moved in another direction than the robot.
    LATERAL = 'lateral'
    # It has not moved.
    WITHOUT_EFFECT = 'without effect'
    # It has moved although the robot should not touch it.
    UNEXPECTED = 'unexpected'


class ContactConsistency:
    """
    Counts contacts in a row that do not fit the object poses.

    ``pushes_without_effect``: those that have not moved the object.
    """

    def __init__(self) -> None:
        """Start without any contact."""
        # Of the robot's position after the last contact [m].
        self._std = 0.0
        self.clear()

    def clear(self) -> None:
        """Forget all contacts, as when the poses that they did not fit were a mistake."""
        self.pushes_without_effect = self._contradictions = 0
        self._clear_taps()

    def _clear_taps(self) -> None:
        # What taps have moved the object to the side [m], and the variance of that [m^2].
        self._lateral_excess = self._lateral_variance = 0.0

    def add(self, contact: Touch, position_std: float) -> None:
        """
        Count a contact.

        :param position_std: standard deviation of the robot's position after it [m].
        """
        if contact is Touch.WITHOUT_EFFECT:
            self.pushes_without_effect += 1
        elif contact is not Touch.UNEXPECTED:
            self.pushes_without_effect = 0
        if contact is Touch.PUSHED and position_std <= FITTING_STD:
            self._contradictions = 0
            self._clear_taps()
        elif contact is not Touch.TAPPED and not (
                contact is Touch.PUSHED and position_std < self._std):
            # A push that makes a robot better known has moved the object.
            self._contradictions += 1
        self._std = position_std

    def add_tap(self, motion: TapMotion) -> None:
        """
        Add up how taps have moved the object, until that is more than noise explains.

        As in Page's test, a tap that has moved it forward counts against those before it only.
        """
        self._lateral_excess += motion.lateral_excess
        self._lateral_variance += motion.std ** 2
        if self._lateral_excess <= 0.0:
            self._clear_taps()
        elif self._lateral_excess > LATERAL_SIGMAS * math.sqrt(self._lateral_variance):
            self._contradictions += 1
            self._clear_taps()

    @property
    def fits(self) -> bool:
        """Tell whether the last contact fits the object poses."""
        return self._contradictions == 0

    @property
    def is_refuting(self) -> bool:
        """Tell whether no place of the robot explains the contacts."""
        return self._contradictions >= MAX_CONTRADICTIONS

    @property
    def inconsistency(self) -> Report[PerceptionEvent] | None:
        """What does not fit; None if all contacts fit."""
        if self.is_refuting:
            return PerceptionEvent.CONTACTS_DO_NOT_FIT.report(count=self._contradictions)
        count = self.pushes_without_effect
        if count > 1:
            return PerceptionEvent.PUSHES_WITHOUT_EFFECT.report(count=count)
        return PerceptionEvent.PUSH_WITHOUT_EFFECT.report() if count else None
