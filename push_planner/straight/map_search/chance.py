"""
Chance of a goal from which no push leads back: in a corner, in a niche.

Pushes only push. Where the robot has no room behind an object that has gone too far, what a push
misses stays. With the miss m of the mean effect, the standard deviation s of the vertex that
varies most, and the error e that may remain, the chance is that of a normal deviation in the plane

    P(|m + s n| <= e)  >=  1 - exp(-z^2 / 2),    z = (e - m) / s.

Before the goal the remaining pushes correct what is within a part of the distance to it, so that
there e is larger: long pushes end early, and short ones follow.
"""

import math
from typing import Any

from push_dynamics.compiled import compiled

# Time that counts for a goal that is missed for good [s]; chosen: a dozen pushes.
FAILURE_COST = 60.0
# Chance of a miss that counts nothing; chosen: no push of the table is surer.
FREE_RISK = 0.15
# Error that later pushes still correct, over the distance to the goal; chosen: an object that is
# turned by a fifth to either side moves as far sideways.
CORRECTED_RATIO = 0.1


@compiled
def failure_cost(query: Any, miss: float, std: float, remaining: float) -> float:
    """
    Charge a push for the chance that what it misses cannot be corrected.

    :param query: ``Query``.
    :param miss: of its mean effect, in tolerances of the last push.
    :param std: standard deviation of the vertex that varies most [m].
    :param remaining: distance from the goal after it [m].
    :return: time [s], 0 where pushes lead back from the goal.
    """
    if not query.is_goal_enclosed:
        return 0.0
    settings = query.settings
    margin = (settings.accepted_error + CORRECTED_RATIO * remaining
              - miss * settings.position_tolerance)
    if margin <= 0.0:
        return FAILURE_COST
    ratio = margin / max(std, 1e-6)
    return FAILURE_COST * max(0.0, math.exp(-0.5 * ratio * ratio) - FREE_RISK)
