"""Permission to move: what the services of the controller's node have decided."""

import enum


class StartState(enum.Enum):
    """A stop holds until ``controller/start``, whatever comes."""

    # Goals are taken, and pursued from the start on.
    WAITING = 'waiting'
    STARTED = 'started'
    # Goals are refused.
    STOPPED = 'stopped'

    @classmethod
    def first(cls, *, waits: bool) -> 'StartState':
        """
        Return the state of a new node.

        :param waits: value of ``wait_for_start``.
        """
        return cls.WAITING if waits else cls.STARTED
