"""How chains of pushes are searched for."""

import dataclasses
import math

from push_model.quantity import check, quantity


@dataclasses.dataclass(frozen=True)
class TaskSettings:
    """How chains of pushes are searched for."""

    max_pushes: int = quantity('most pushes in a chain', '', 1, 4, default=4)
    shortest_push: float = quantity('straight end of every push, at least', 'm', above=0.0,
                                    high=5.0, default=0.25)
    last_run_in: float = quantity('straight end of the last push, at least', 'm', above=0.0,
                                  high=5.0, default=0.6)
    switch_time: float = quantity('settling, touch and retreat, per push', 's', 0.0, 60.0,
                                  default=5.0)
    mending_time: float = quantity('time of the pushes that mend a miss of the last one; weighed '
                                   'with how likely that is', 's', 0.0, 600.0, default=16.0)
    widest_turn: float = quantity('most that one push of a chain turns the object', 'rad',
                                  above=0.0, high=2.0 * math.pi, default=math.pi)
    turn_slack: float = quantity('radius of turns in a chain over that of the tightest', '', 1.0,
                                 10.0, default=1.05)
    turn_steps: int = quantity('turns that are tried for each push but the last, at least', '', 3,
                               100, default=7)
    trials: int = quantity('combinations of sites and turns that are tried for each number of '
                           'pushes, at most, about', '', 1000, 10000000, default=50000)
    alternatives: int = quantity('chains that are kept, different in their sites', '', 1, 1000,
                                 default=10)

    def __post_init__(self):
        """Validate the fields."""
        check(self)
