"""Random inputs: how many, and numbers and texts as nobody expects them."""

import math
import os

from helpers.extras import import_extra

hypothesis = import_extra('hypothesis', 'test')
st = hypothesis.strategies

# Steps of one test; ``make fuzz STEPS=100000`` takes an hour or two.
STEPS = int(os.environ.get('PUSH_CONTROL_FUZZ', '60'))
STEPS_PER_EXAMPLE = 50
NUMBERS = st.one_of(
    st.floats(-10.0, 10.0), st.floats(),
    st.sampled_from([0.0, 1e7, -1e7, 1e155, 1e308, 5e-324, math.nan, math.inf, -math.inf]))
TEXTS = st.one_of(st.sampled_from(['odom', '/odom', 'base_link', '', 'x' * 5000]),
                  st.text(st.characters(exclude_categories=['Cs']), max_size=20))


def settings(examples: int = STEPS, **others: object) -> object:
    """Make settings of hypothesis that give the same examples every time."""
    return hypothesis.settings(
        max_examples=examples, derandomize=True, database=None, deadline=None,
        suppress_health_check=list(hypothesis.HealthCheck), **others)
