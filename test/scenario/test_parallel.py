"""Many simulations: the same to the bit however they are run, interrupted or spread."""

from concurrent import futures
import contextlib
import dataclasses
from functools import partial
import json
import os
import signal
import subprocess
import sys
import time

from helpers.extras import import_extra
from helpers.many_jobs import (
    extremes, interrupted, leave, noisy, recorded, slow, sometimes_failing,
)
from push_model.geometry import Pose
from push_scenario import load_scenario, measure, simulate
from push_scenario.parallel import job_digests, run_many, simulate_many, stored_jobs
import pytest

pytestmark = pytest.mark.slow
# For processes to end, also on a busy machine [s].
PATIENCE = 120.0
JOBS = [{'n': n, 'seed': 5 + n} for n in range(40)]


@pytest.fixture(scope='module')
def rows():
    """Run the jobs in this process."""
    return run_many(noisy, JOBS, workers=1)


def variations():
    """Vary the mass of a pushed object that its planner does not know."""
    scenario = load_scenario('straight_push')
    return [dataclasses.replace(scenario, true_object=dataclasses.replace(
        scenario.true_object, mass=mass)) for mass in (2.5, 3.5)]


def test_rows_of_scenarios_are_the_metrics_of_their_runs(tmp_path):
    scenarios = variations()
    rows = simulate_many(scenarios, folder=tmp_path, workers=1)
    for scenario, row in zip(scenarios, rows):
        result = simulate(scenario)
        assert row['outcome'] == result.outcome.value and row['scenario'] == scenario.name
        assert {name: row[name] for name in ('time', 'slip', 'position_error')} == {
            name: getattr(measure(result), name) for name in ('time', 'slip', 'position_error')}
    assert rows[0] != rows[1]
    again = simulate_many(scenarios[::-1], folder=tmp_path, workers=1)
    # As text, in which nan equals nan.
    assert repr(again) == repr(rows[::-1])


def test_the_source_of_a_law_of_ones_own_counts():
    jobs = variations()
    plain, own = job_digests(noisy, jobs), job_digests(noisy, jobs, ['helpers.own_laws'])
    assert not set(plain) & set(own) and own == job_digests(noisy, jobs, ['helpers.own_laws'])


def test_scenarios_that_differ_in_one_number_are_told_apart():
    scenario = variations()[0]
    other = dataclasses.replace(scenario, simulation=dataclasses.replace(
        scenario.simulation, seed=scenario.simulation.seed + 1))
    one, two, again = job_digests(noisy, [scenario, other, variations()[0]])
    assert one == again != two
    assert job_digests(noisy, JOBS)[0] != job_digests(extremes, JOBS)[0]
    assert job_digests(partial(recorded, 'a'), JOBS)[0] != job_digests(
        partial(recorded, 'b'), JOBS)[0]


def test_two_processes_give_the_rows_of_one(tmp_path, rows):
    assert run_many(noisy, JOBS, folder=tmp_path, workers=2, block=7) == rows
    assert run_many(noisy, JOBS, workers=2, block=1) == rows
    assert len({row['sum'] for row in rows}) == len(JOBS)


def test_a_cluster_gives_the_rows_of_one_process(rows):
    distributed = import_extra('distributed', 'cluster')
    with distributed.LocalCluster(2, threads_per_worker=1, processes=True, memory_limit=0,
                                  host='127.0.0.1', dashboard_address=':0') as cluster, \
            distributed.Client(cluster, set_as_default=False) as client:
        executor = client.get_executor(pure=False)
        assert run_many(noisy, JOBS, executor=executor, workers=2, block=7) == rows


def test_any_executor_gives_the_rows_of_one_process_and_stays_open(rows):
    with futures.ThreadPoolExecutor(2) as threads:
        assert run_many(noisy, JOBS, executor=threads) == rows
        assert threads.submit(sum, (1, 2)).result() == 3


def test_processes_are_copies_only_where_no_lock_may_be_held():
    """Another thread, or ROS with threads of its own, may hold one at that instant."""
    # Other tests of this process may have loaded ROS, or left threads.
    code = ('import sys, threading, types\n'
            'from push_scenario.parallel import start_method\n'
            'methods = [start_method()]\n'
            'wait = threading.Event()\n'
            'thread = threading.Thread(target=wait.wait)\n'
            'thread.start()\n'
            'methods.append(start_method())\n'
            'wait.set()\n'
            'thread.join()\n'
            "sys.modules['rclpy'] = types.ModuleType('rclpy')\n"
            'print(*methods, start_method())')
    done = subprocess.run([sys.executable, '-c', code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ['fork', 'spawn', 'spawn']


def test_finished_jobs_are_not_run_again(tmp_path):
    """Nor those of a shorter list; other jobs and other functions are."""
    log = tmp_path / 'log'
    function = partial(recorded, str(log))
    first = run_many(function, JOBS[:10], folder=tmp_path / 'rows', workers=1)
    assert stored_jobs(function, JOBS, tmp_path / 'rows') == JOBS[:10]
    assert run_many(function, JOBS, folder=tmp_path / 'rows', workers=1)[:10] == first
    assert sorted(map(int, log.read_text().split())) == list(range(40))
    run_many(function, [{'n': 99, 'seed': 1}], folder=tmp_path / 'rows', workers=1)
    assert log.read_text().split()[-1] == '99'
    assert 'sum' not in run_many(extremes, JOBS[:1], folder=tmp_path / 'rows', workers=1)[0]


def test_an_interrupted_call_goes_on_where_it_was(tmp_path, rows):
    flag, log, folder = (tmp_path / name for name in ('flag', 'log', 'rows'))
    function = partial(interrupted, str(flag), str(log))
    flag.touch()
    counts = []
    with pytest.raises(KeyboardInterrupt):
        run_many(function, JOBS, folder=folder, workers=1, block=3,
                 progress=lambda done, total: counts.append(done))
    assert counts == [0, 3, 6]
    flag.unlink()
    log.unlink()
    counts.clear()
    assert run_many(function, JOBS, folder=folder, workers=1,
                    progress=lambda done, total: counts.append(done)) == rows
    assert counts[0] == 6 and counts[-1] == len(JOBS)
    assert list(map(int, log.read_text().split())) == list(range(6, 40))


@pytest.mark.parametrize('ending', [signal.SIGINT, signal.SIGKILL])
def test_a_signal_leaves_rows_and_no_processes(tmp_path, ending):
    """Ctrl-C reaches all processes of a terminal, a kill only the one."""
    jobs = [{'n': n, 'seed': n} for n in range(2000)]
    pids, folder = tmp_path / 'pids', tmp_path / 'rows'
    pids.mkdir()
    (tmp_path / 'jobs.json').write_text(json.dumps(jobs))
    code = ('import json, sys\nfrom functools import partial\n'
            'from helpers.many_jobs import many_slow, slow\n'
            'many_slow(partial(slow, sys.argv[1]), json.load(open(sys.argv[2])), sys.argv[3])')
    process = subprocess.Popen(
        [sys.executable, '-c', code, pids, tmp_path / 'jobs.json', folder],
        env={**os.environ, 'PYTHONPATH': os.pathsep.join(sys.path)}, stdout=subprocess.PIPE,
        stderr=subprocess.PIPE, text=True, start_new_session=True)
    while int(process.stdout.readline()) < 8:
        pass
    (os.killpg if ending == signal.SIGINT else os.kill)(process.pid, ending)
    errors = process.communicate(timeout=PATIENCE)[1]
    assert process.returncode == -ending
    assert errors.count('KeyboardInterrupt\n') == (ending == signal.SIGINT)
    wait_for_the_end_of([int(path.name) for path in pids.iterdir()])
    lines = [line for path in folder.glob('*.jsonl') for line in path.read_text().splitlines()]
    assert 8 <= len(lines) < len(jobs)
    by_digest = dict(zip(job_digests(partial(slow, str(pids)), jobs), jobs))
    for line in lines:
        row = json.loads(line)
        assert noisy(by_digest[row.pop('job')]) == row


def wait_for_the_end_of(processes):
    """Wait until none of the processes runs."""
    deadline = time.monotonic() + PATIENCE
    assert processes
    for process in processes:
        with contextlib.suppress(ProcessLookupError):
            while True:
                os.kill(process, 0)
                assert time.monotonic() < deadline, f'{process} still runs'
                time.sleep(0.01)


@pytest.mark.parametrize('workers', [1, 2])
def test_a_job_that_fails_does_not_lose_the_others(tmp_path, rows, workers):
    """It is run again by the next call."""
    found = run_many(sometimes_failing, JOBS, folder=tmp_path, workers=workers)
    failed = {n for n in range(40) if n % 3 == 0 or n == 4}
    assert {n for n, row in enumerate(found) if 'error' in row} == failed
    assert found[3] == {'error': 'ZeroDivisionError: no 3'}
    assert 'list: got [1, 2]' in found[4]['error']
    assert all(found[n] == rows[n] for n in range(40) if n not in failed)
    counts = []
    assert run_many(sometimes_failing, JOBS, folder=tmp_path, workers=1,
                    progress=lambda done, total: counts.append(done)) == found
    assert counts[0] == 40 - len(failed)


def test_a_process_that_dies_does_not_take_rows_along(tmp_path):
    with pytest.raises(futures.BrokenExecutor):
        run_many(leave, JOBS, folder=tmp_path, workers=2, block=1)
    assert len(list(tmp_path.glob('*.jsonl'))) >= 10


def test_numbers_and_text_keep_every_bit(tmp_path):
    expected = {key: getattr(value, 'item', lambda v=value: v)()
                for key, value in extremes({}).items()}
    for _ in range(2):
        assert repr(run_many(extremes, [{}], folder=tmp_path, workers=1)[0]) == repr(expected)


@pytest.mark.parametrize('line', ['{"job": 3, "rec', '{"sum": 1}', '7', '{"job": [1]}'])
def test_a_file_of_something_else_is_named(tmp_path, line):
    (tmp_path / 'notes.jsonl').write_text(line + '\n')
    with pytest.raises(ValueError, match='notes.jsonl, line 1'):
        run_many(noisy, JOBS, folder=tmp_path, workers=1)
    assert (tmp_path / 'notes.jsonl').read_text() == line + '\n'


def test_functions_and_jobs_without_identity_are_refused():
    for function in (lambda job: {}, partial(lambda job: {}), print):
        with pytest.raises(ValueError, match='expected a function defined in a module'):
            run_many(function, JOBS)
    with pytest.raises(ValueError, match=r'jobs\[1\]'):
        run_many(noisy, [{}, {'pose': Pose}])
    for option in ('workers', 'block'):
        with pytest.raises(ValueError, match=f'{option}: got 0'):
            run_many(noisy, JOBS, **{option: 0})


def test_no_jobs_give_no_rows():
    assert run_many(noisy, []) == []
