"""Laws of the benchmark of speeds: what counts as met, and what its measurements are."""

from benchmarks.speed import measures
from benchmarks.speed.growth import Growth, step_time
from benchmarks.speed.report import Row, table


def test_what_misses_its_aim_is_bold():
    """A ratio that should be small, a time, and a ratio that should be great."""
    rows = [Row('met', 2.0, 1.5), Row('late', 0.2, 0.25, ' s'), Row('fast', 20.0, 30.0, '', True),
            Row('slow', 20.0, 3.0, '', True)]
    assert [row.is_met for row in rows] == [True, False, True, False]
    lines = table(rows).splitlines()
    assert lines[2:] == ['| met | 2 | 1.5 |', '| late | 0.2 s | **0.25 s** |',
                         '| fast | 20 | 30 |', '| slow | 20 | **3** |']


def test_a_process_costs_what_it_does():
    """Some million additions more take longer."""
    loop = 'for i in range({}): pass'
    short, long = (measures.process_time(('-c', loop.format(count))) for count in (1, 5_000_000))
    assert long > short


def test_costs_that_grow_name_their_size_and_what_each_costs():
    """Times bear the unit that suits them."""
    assert Growth('tasks', 100_000, 'cases', 2.5).text() == (
        '| tasks | cases | 100,000 | 2.5 s | 25 us |')
    assert Growth('step', 40, 'supports', 8e-7).text() == (
        '| step | supports | 40 | 800 ns | 20 ns |')


def test_more_supports_cost_more():
    assert min(step_time(60) for _ in range(3)) > min(step_time(3) for _ in range(3)) > 0.0
