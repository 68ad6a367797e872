"""States of a run: when the simulator offers, starts, goes on and ends; no clock is needed."""

from push_sim_node.ros.run_control import (
    MAX_START, OFFER_PERIOD, QUIET_TIME, RunAction, RunControl, RunState,
)
import pytest


def test_until_it_is_started_it_offers_the_first_measurements_again_and_again():
    control = RunControl(10.0, autostart=False)
    times = [10.0 + 0.01 * i for i in range(100)]
    offers = [time for time in times
              if control.tick(time) is RunAction.OFFER_FIRST_MEASUREMENTS]
    assert control.state is RunState.HOLDING
    assert offers[0] == 10.0 and len(offers) == pytest.approx(1.0 / OFFER_PERIOD, abs=2)


@pytest.mark.parametrize('autostart', [False, True])
def test_in_lockstep_it_starts_once_no_answer_has_come_for_a_while(autostart):
    """Those to what was offered must not count."""
    control = RunControl(0.0, autostart, QUIET_TIME)
    if not autostart:
        assert control.request_start(0.0)
    assert control.state is RunState.STARTING
    control.on_answer(0.3)
    assert control.tick(0.3 + 0.9 * QUIET_TIME) is RunAction.WAIT
    assert control.tick(0.3 + 1.1 * QUIET_TIME) is RunAction.START
    assert control.state is RunState.RUNNING
    assert control.started_at == 0.3 + 1.1 * QUIET_TIME
    assert control.tick(1.0) is RunAction.CONTINUE
    # While it runs, answers come all the time.
    control.on_answer(1.0)
    assert control.tick(1.0) is RunAction.CONTINUE


def test_a_controller_that_repeats_its_stop_does_not_keep_it_from_starting():
    """In lockstep it waits for a while, on the wall clock not at all."""
    control = RunControl(0.0, True, QUIET_TIME)
    times = [0.05 * i for i in range(1, 100)]
    for time in times:
        control.on_answer(time)
        if control.tick(time) is RunAction.START:
            break
    assert control.started_at == pytest.approx(MAX_START, abs=0.051)
    control = RunControl(0.0, True)
    control.on_answer(0.0)
    assert control.tick(0.0) is RunAction.START


def test_an_end_is_an_end():
    control = RunControl(0.0, autostart=True)
    control.tick(1.0)
    assert control.duration(3.0) == 2.0
    control.end(4.0)
    assert control.state is RunState.ENDED and control.tick(9.0) is RunAction.WAIT
    assert control.duration(9.0) == 3.0
    assert not control.request_start(9.0) and control.state is RunState.ENDED


def test_a_request_while_it_runs_changes_nothing():
    control = RunControl(0.0, autostart=True)
    control.tick(1.0)
    assert control.request_start(2.0)
    assert control.state is RunState.RUNNING and control.started_at == 1.0
