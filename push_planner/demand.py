"""What is asked of a plan besides that it reaches the goal."""

import math
from typing import Callable, NamedTuple, Optional

from push_planner.warm_start import Route


def accepted(trajectory):
    """
    Find no fault with any plan.

    :param trajectory: ``PushTrajectory``; not looked at.
    :return: an empty text.
    """
    return ''


class Demand(NamedTuple):
    """
    What is asked of a plan.

    :param route: ``Route`` that is tried before all others; None for none.
    :param fault: function of a ``PushTrajectory`` to what is wrong with it, empty if nothing is.
    :param most: programmes that are solved at most.
    """

    route: Optional[Route] = None
    fault: Callable = accepted
    most: float = math.inf


ANY = Demand()
