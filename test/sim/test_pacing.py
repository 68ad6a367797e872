"""Simulated time against the wall clock, which is a number here."""

from push_sim_node.ros.pacing import (
    CATCH_UP, JITTER, Pacer, SPEED_WINDOW, SpeedMeter, StampLag, SUSPENSION,
)
import pytest

PERIOD = 0.02


def run(pacer, start, count, delay=lambda i: 0.0):
    """Reach one measurement after the other with delays; return the wall time at the end."""
    now = start
    for i in range(1, count + 1):
        now = max(now, pacer.due(i * PERIOD)) + delay(i)
        pacer.reached(i * PERIOD, now)
    return now


@pytest.mark.parametrize('scale', [0.5, 1.0, 4.0])
def test_jitter_of_single_measurements_does_not_slow_time_down(scale):
    jitter = 0.003 / scale
    end = run(Pacer(scale, 100.0), 100.0, 500, lambda i: jitter * (i % 3))
    assert end == pytest.approx(100.0 + 500 * PERIOD / scale, abs=2.1 * jitter)


def test_what_was_lost_is_not_made_up():
    """After a second in which nothing went on, time runs as fast as before and not faster."""
    pacer = Pacer(1.0, 0.0)
    end = run(pacer, 0.0, 200, lambda i: 1.0 if i == 100 else 0.0)
    assert end == pytest.approx(200 * PERIOD + 1.0, abs=1e-9)
    assert pacer.due(201 * PERIOD) - end == pytest.approx(PERIOD)


def test_a_machine_that_is_too_slow_is_behind_by_no_more_than_jitter():
    pacer = Pacer(10.0, 0.0)
    end = run(pacer, 0.0, 500, lambda i: 0.01)
    assert pacer.time(end) - 500 * PERIOD <= 10.0 * JITTER


def test_a_delay_that_is_dropped_is_told_once():
    pacer = Pacer(1.0, 0.0)
    assert pacer.reached(1.0, 1.0 + 0.9 * JITTER) == 0.0
    assert pacer.reached(2.0, 5.0) == pytest.approx(3.0)
    assert pacer.reached(3.0, 6.0) == 0.0


def slow_run(count, lag, *, rests_from):
    """Take 5 ms too long for each measurement; return the greatest and the last lag of stamps."""
    pacer, now, epoch, lags = Pacer(1.0, 0.0), 0.0, 0.0, []
    for i in range(1, count + 1):
        now = max(now, pacer.due(i * PERIOD)) + (PERIOD + 0.005 if i < rests_from else 0.0)
        epoch += lag.update(pacer.reached(i * PERIOD, now), is_at_rest=i >= rests_from)
        lags.append(now - (epoch + i * PERIOD))
    return max(lags), lags[-1]


def test_stamps_of_a_slow_machine_catch_up_at_rest():
    """While something moves they fall behind by all that is lost, then they are right again."""
    lag = StampLag()
    worst, last = slow_run(400, lag, rests_from=200)
    assert worst > 0.9 * 200 * 0.005 and abs(last) <= JITTER
    assert lag.time == 0.0


def test_stamps_never_run_back_nor_ahead():
    """A step is at most that of one measurement; a suspension is made up at once."""
    lag = StampLag()
    assert lag.update(0.4, is_at_rest=False) == 0.0
    assert lag.update(2.0 * SUSPENSION, is_at_rest=False) == 2.0 * SUSPENSION
    steps = [lag.update(0.0, is_at_rest=True) for _ in range(30)]
    assert sum(steps) == pytest.approx(0.4) and 0.0 <= min(steps) and max(steps) == CATCH_UP


def test_another_pace_begins_where_time_stands():
    pacer = Pacer(1.0, 0.0)
    pacer.set_scale(4.0, 2.0)
    assert pacer.scale == 4.0
    assert pacer.time(2.0) == 2.0
    assert pacer.due(6.0) == pytest.approx(3.0)


def test_the_speed_of_time_is_measured_over_windows():
    meter = SpeedMeter(0.0)
    assert meter.speed is None and not meter.is_slow
    assert not meter.update(0.5 * SPEED_WINDOW, 0.5 * SPEED_WINDOW, 1.0)
    assert meter.update(SPEED_WINDOW, SPEED_WINDOW, 1.0)
    assert meter.speed == pytest.approx(1.0) and not meter.is_slow
    assert meter.update(1.8 * SPEED_WINDOW, 2.0 * SPEED_WINDOW, 1.0)
    assert meter.speed == pytest.approx(0.8) and meter.is_slow
    # A little better is not yet right.
    assert meter.update(2.73 * SPEED_WINDOW, 3.0 * SPEED_WINDOW, 1.0) and meter.is_slow
    assert meter.update(3.73 * SPEED_WINDOW, 4.0 * SPEED_WINDOW, 1.0) and not meter.is_slow


def test_a_new_time_scale_restarts_the_measurement_of_the_speed():
    meter = SpeedMeter(0.0)
    assert meter.update(0.5 * SPEED_WINDOW, SPEED_WINDOW, 1.0) and meter.is_slow
    meter.restart(0.5 * SPEED_WINDOW, 1.5 * SPEED_WINDOW)
    assert meter.speed is None and not meter.is_slow
    assert meter.update(0.7 * SPEED_WINDOW, 2.5 * SPEED_WINDOW, 0.2)
    assert meter.speed == pytest.approx(0.2) and not meter.is_slow
