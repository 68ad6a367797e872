"""
Do contacts fit the object poses: a tracker that shows another object is known by those that don't.

The robot feels nothing: that it pushes shows in object poses alone. Where these are of another
object, mirrored, in other axes or of the robot itself, pushes leave the object where it is or move
it aside, or it moves although the robot does not touch it, and no place of the robot explains all.
"""

import enum

# Contacts in a row that do not fit the poses until none will. Measured: after random faults, with
# poses that are off by 0.3 m or rotated by 30 deg, and with wheels that have slipped, robots have
# found their object after at most three.
MAX_CONTRADICTIONS = 6
# Standard deviation of the robot's position after a push beyond which what was seen of the push
# does not fit what was driven [m]; measured: 5 cm at most where it does, 6 to 15 cm with poses
# that are mirrored.
FITTING_STD = 0.055


class Contact(enum.Enum):
    """What a contact, or one that there should have been, has shown."""

    # The object has moved as the robot has.
    PUSHED = 'pushed'
    # It has moved, but too little to compare the directions.
    TAPPED = 'tapped'
    # It has moved in another direction than the robot.
    ASIDE = 'aside'
    # It has not moved.
    IN_VAIN = 'in vain'
    # It has moved although the robot should not touch it.
    UNEXPECTED = 'unexpected'


class ContactEvidence:
    """
    Counts contacts in a row that do not fit the object poses.

    ``vain_pushes``: those that have not moved the object.
    """

    def __init__(self) -> None:
        """Begin without any contact."""
        self.vain_pushes = 0
        self._contradictions = 0
        # Of the robot's position after the last contact [m].
        self._deviation = 0.0

    def clear(self) -> None:
        """Forget contacts, as the poses that they did not fit were a mistake."""
        self.vain_pushes = self._contradictions = 0

    def add(self, contact: Contact, position_deviation: float) -> None:
        """
        Take note of a contact.

        :param contact: ``Contact``.
        :param position_deviation: standard deviation of the robot's position after it [m].
        """
        if contact is Contact.IN_VAIN:
            self.vain_pushes += 1
        elif contact is not Contact.UNEXPECTED:
            self.vain_pushes = 0
        if contact is Contact.PUSHED and position_deviation <= FITTING_STD:
            self._contradictions = 0
        elif contact is not Contact.TAPPED and not (
                contact is Contact.PUSHED and position_deviation < self._deviation):
            # A robot that was known less well still, and is known better by a push, has pushed.
            self._contradictions += 1
        self._deviation = position_deviation

    @property
    def fits(self) -> bool:
        """Whether the last contact fits the object poses."""
        return self._contradictions == 0

    @property
    def is_refuting(self) -> bool:
        """Whether no place of the robot explains the contacts."""
        return self._contradictions >= MAX_CONTRADICTIONS

    @property
    def doubt(self) -> str:
        """What does not fit, one clause; empty where all does."""
        if self.is_refuting:
            return f'{self._contradictions} contacts in a row did not fit the object poses'
        if self.vain_pushes == 0:
            return ''
        pushes = 'a push' if self.vain_pushes == 1 else f'{self.vain_pushes} pushes in a row'
        return f'{pushes} moved no object at its poses'
