"""Which command answers which measurement, when both may come twice or not at all."""

from push_sim_node.ros.lockstep import MeasurementExchange, RESEND_PERIOD
import pytest


@pytest.mark.parametrize('stamped', [True, False])
def test_one_answer_each(stamped):
    exchange = MeasurementExchange(5.0, stamped)
    for stamp in range(4):
        exchange.sent(stamp, 0.1 * stamp)
        assert exchange.is_answer(stamp if stamped else None)


@pytest.mark.parametrize('later', [0, 20_000_000])
def test_the_second_answer_to_a_repeated_measurement_counts_for_no_other(later):
    """With a stamp of its own the next measurement does not need that; commands may have none."""
    exchange = MeasurementExchange(5.0, stamped=False)
    exchange.sent(0, 0.0)
    assert exchange.is_resend_due(RESEND_PERIOD)
    exchange.resent(RESEND_PERIOD)
    assert exchange.is_answer(None)
    exchange.sent(later, 0.3)
    assert not exchange.is_answer(None)
    assert exchange.is_answer(None)
    exchange.sent(later + 1, 0.4)
    assert exchange.is_answer(None)


def test_a_measurement_that_was_lost_costs_one_repetition_only():
    """Its one answer leaves one that never comes; the next is answered at its repetition."""
    exchange = MeasurementExchange(5.0, stamped=False)
    exchange.sent(0, 0.0)
    exchange.resent(0.2)
    assert exchange.is_answer(None)
    exchange.sent(1, 0.3)
    assert not exchange.is_answer(None)
    exchange.resent(0.5)
    assert exchange.is_answer(None)
    exchange.sent(2, 0.6)
    assert exchange.is_answer(None)


def test_stamps_tell_answers_apart():
    exchange = MeasurementExchange(5.0)
    exchange.sent(0, 0.0)
    exchange.resent(0.2)
    assert exchange.is_answer(0)
    exchange.sent(1, 0.3)
    assert not exchange.is_answer(0)
    assert exchange.is_answer(1)
