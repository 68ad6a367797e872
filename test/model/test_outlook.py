"""What a plan states of the end."""

import dataclasses
import math

from helpers.outlooks import OUTLOOK
from push_model.outlook import Outlook, Quantiles
import pytest


def test_times_pass_and_what_has_passed_is_not_stated_again() -> None:
    """Chance and errors stay; no time falls below 0."""
    later = OUTLOOK.later(25.0)
    assert later.time == (0.0, 5.0, 10.0, 25.0)
    assert dataclasses.replace(later, time=OUTLOOK.time) == OUTLOOK


def test_its_numbers_say_everything() -> None:
    """Thirteen of them, from which it is made again."""
    values = OUTLOOK.values()
    assert len(values) == 13 and values['time.p95'] == 35.0
    assert Outlook.from_values(values) == OUTLOOK


@pytest.mark.parametrize('field, value', [
    ('chance', 1.01), ('chance', math.nan), ('time', Quantiles(2.0, 1.0, 3.0, 4.0)),
    ('position_error', Quantiles(-0.1, 0.1, 0.2, 0.3)),
    ('heading_error', Quantiles(0.1, 0.2, 0.3, math.inf))])
def test_what_is_no_chance_and_no_quantile_is_refused(field: str, value: object) -> None:
    """The error names the field."""
    with pytest.raises(ValueError, match=f'Outlook.{field}: got'):
        dataclasses.replace(OUTLOOK, **{field: value})
