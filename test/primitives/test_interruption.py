"""Ctrl-C while primitives are made: it takes effect within a small part of their time."""

import signal
import time
from typing import Callable, Iterator

from helpers.objects import bin_
from push_primitives.table import build_table, FrictionSamples, PrimitiveTable, sample_friction
from push_primitives.value_iteration import solve_cost_to_go
import pytest

BIN = bin_(feet=4)
RADIUS = 0.17
# Parts of the CPU time of the whole: when the signal comes, and until when it has taken effect.
EARLY, SOON = 0.02, 0.1


@pytest.fixture(scope='module')
def table() -> PrimitiveTable:
    """Return the table of a bin for nominal friction only."""
    nominal = FrictionSamples(*(array[:1] for array in sample_friction(BIN)))
    return build_table(BIN, RADIUS, friction_samples=nominal)


@pytest.fixture
def interrupt_after() -> Iterator[Callable[[float], object]]:
    """Return a function that interrupts this process when it has taken so much CPU time [s]."""
    def interrupt(number: int, frame: object) -> None:
        raise KeyboardInterrupt

    former = signal.signal(signal.SIGVTALRM, interrupt)
    yield lambda duration: signal.setitimer(signal.ITIMER_VIRTUAL, duration)
    signal.setitimer(signal.ITIMER_VIRTUAL, 0.0)
    signal.signal(signal.SIGVTALRM, former)


@pytest.mark.slow
@pytest.mark.parametrize('kind', ['table', 'cost-to-go'])
def test_a_signal_interrupts_what_takes_seconds(kind, table, interrupt_after):
    """No call of a compiled function, within which Python notices nothing, is most of it."""
    make = {'table': lambda: build_table(BIN, RADIUS), 'cost-to-go': lambda: solve_cost_to_go(
        table)}[kind]
    make()
    began = time.process_time()
    make()
    duration = time.process_time() - began
    began = time.process_time()
    interrupt_after(EARLY * duration)
    with pytest.raises(KeyboardInterrupt):
        make()
    assert time.process_time() - began < SOON * duration
