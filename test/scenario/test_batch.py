"""Batches: the same to the bit however they are run, interrupted or spread."""

from concurrent import futures
import contextlib
from functools import partial
import json
import os
import signal
import subprocess
import sys
import time
import tracemalloc

from helpers.batch_jobs import (
    extremes, interrupted, leave, long_text, noisy, recorded, slow, sometimes_failing,
)
from helpers.extras import import_extra
import numpy as np
from push_model.geometry import Pose
from push_scenario.batch.batch import run_batch, seeds
import pytest

pytestmark = pytest.mark.slow
# For processes to end, also on a busy machine [s].
PATIENCE = 120.0
JOBS = [{'n': n, 'seed': seed} for n, seed in enumerate(seeds(5, 40))]


def table(out):
    """Return the bytes of the table beside a file of results."""
    return out.with_suffix('.csv').read_bytes()


@pytest.fixture(scope='module')
def cluster():
    """Start a local Dask cluster of two worker processes; yield its executor."""
    distributed = import_extra('distributed', 'cluster')
    with distributed.LocalCluster(2, threads_per_worker=1, processes=True, memory_limit=0,
                                  host='127.0.0.1', dashboard_address=':0') as cluster, \
            distributed.Client(cluster, set_as_default=False) as client:
        yield client.get_executor(pure=False)


@pytest.fixture(scope='module')
def alone(tmp_path_factory):
    """Run the jobs in this process; return result and table."""
    out = tmp_path_factory.mktemp('alone') / 'out.jsonl'
    return run_batch(noisy, JOBS, out, workers=1), table(out)


def test_two_processes_give_the_result_of_one(tmp_path, alone):
    out = tmp_path / 'out.jsonl'
    assert run_batch(noisy, JOBS, out, workers=2, chunk=7) == alone[0]
    assert table(out) == alone[1]
    assert len(set(alone[0].column('sum'))) == len(JOBS)


def test_processes_are_copies_only_where_no_lock_may_be_held():
    """Another thread, or ROS with threads of its own, may hold one at that instant."""
    # Other tests of this process may have loaded ROS, or left threads.
    code = ('import sys, threading, types\n'
            'from push_scenario.batch.workers import start_method\n'
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


def test_a_cluster_gives_the_result_of_one_process(tmp_path, alone, cluster):
    out = tmp_path / 'out.jsonl'
    assert run_batch(noisy, JOBS, out, executor=cluster, workers=2, chunk=7) == alone[0]
    assert table(out) == alone[1]


def test_any_executor_gives_the_result_of_one_process_and_stays_open(tmp_path, alone):
    out = tmp_path / 'out.jsonl'
    with futures.ThreadPoolExecutor(2) as threads:
        assert run_batch(noisy, JOBS, out, executor=threads) == alone[0]
        assert threads.submit(sum, (1, 2)).result() == 3
    assert table(out) == alone[1]


def test_a_cluster_keeps_errors_and_stops_at_an_interrupt(tmp_path, cluster):
    failed = run_batch(sometimes_failing, JOBS, executor=cluster)
    assert failed == run_batch(sometimes_failing, JOBS, workers=1) and len(failed.errors) == 15
    flag, out = tmp_path / 'flag', tmp_path / 'out.jsonl'
    flag.touch()
    with pytest.raises(KeyboardInterrupt):
        run_batch(partial(interrupted, str(flag)), JOBS, out, executor=cluster, chunk=1)
    flag.unlink()
    again = run_batch(partial(interrupted, str(flag)), JOBS, out, executor=cluster)
    assert again.records == run_batch(noisy, JOBS, workers=1).records


def test_order_and_chunks_change_nothing():
    records = run_batch(noisy, JOBS, workers=1).records
    order = np.random.default_rng(0).permutation(len(JOBS))
    shuffled = run_batch(noisy, [JOBS[i] for i in order], workers=1, chunk=3).records
    assert [shuffled[i] for i in np.argsort(order)] == list(records)
    assert run_batch(noisy, JOBS, workers=2, chunk=1).records == records


def test_seeds_are_those_of_any_longer_list_and_all_differ():
    assert seeds(7, 10) == seeds(7, 1000)[:10]
    assert len({*seeds(7, 1000), *seeds(8, 1000)}) == 2000
    assert all(0 <= seed < 2 ** 63 for seed in seeds(7, 1000))


@pytest.mark.parametrize('workers', [1, 2])
def test_an_interrupted_batch_goes_on_where_it_was(tmp_path, workers):
    flag, out, whole = (tmp_path / name for name in ('flag', 'out.jsonl', 'whole.jsonl'))
    function = partial(interrupted, str(flag))
    run_batch(function, JOBS, whole, workers=1)
    flag.touch()
    counts = []
    with pytest.raises(KeyboardInterrupt):
        run_batch(function, JOBS, out, workers=workers, chunk=5,
                  progress=lambda done, total: counts.append(done))
    done = {json.loads(line)['job'] for line in out.read_text().splitlines()[1:]}
    assert done == set(range(7)) if workers == 1 else done >= {5, 6}
    assert counts[-1] == len(done) < len(JOBS) and not out.with_suffix('.csv').exists()
    flag.unlink()
    before, counts = counts[-1], []
    run_batch(function, JOBS, out, workers=workers,
              progress=lambda done, total: counts.append((done, total)))
    assert counts[0] == (before, len(JOBS)) and counts[-1] == (len(JOBS), len(JOBS))
    assert counts == sorted(counts)
    assert table(out) == table(whole)


def test_a_torn_last_line_costs_its_job_only(tmp_path):
    out, log = tmp_path / 'out.jsonl', tmp_path / 'log'
    function = partial(recorded, str(log))
    run_batch(function, JOBS, out, workers=1)
    content, expected = out.read_bytes(), table(out)
    header = content.index(b'\n') + 1
    last = content.rindex(b'\n', 0, -1) + 1
    for cut, missing in ((last + 1, 1), (len(content) - 1, 1), (last, 1), (header, len(JOBS)),
                         (header - 1, len(JOBS)), (5, len(JOBS)), (0, len(JOBS))):
        out.write_bytes(content[:cut])
        log.write_text('')
        run_batch(function, JOBS, out, workers=1)
        assert len(log.read_text().split()) == missing
        assert out.read_bytes() == content and table(out) == expected


def test_a_finished_batch_runs_nothing_again(tmp_path):
    out, log = tmp_path / 'out.jsonl', tmp_path / 'log'
    first = run_batch(partial(recorded, str(log)), JOBS, out, workers=1)
    assert run_batch(partial(recorded, str(log)), JOBS, out, workers=1) == first
    assert len(log.read_text().split()) == len(JOBS)


@pytest.mark.parametrize('ending', [signal.SIGINT, signal.SIGKILL])
def test_a_signal_leaves_results_and_no_processes(tmp_path, ending):
    """Ctrl-C reaches all processes of a terminal, a kill only the one."""
    jobs = [{'n': n, 'seed': n} for n in range(2000)]
    (tmp_path / 'pids').mkdir()
    (tmp_path / 'jobs.json').write_text(json.dumps(jobs))
    code = ('import json, sys\nfrom helpers.batch_jobs import slow_batch\n'
            'slow_batch(sys.argv[1], json.load(open(sys.argv[2])), sys.argv[3])')
    out = tmp_path / 'out.jsonl'
    process = subprocess.Popen(
        [sys.executable, '-c', code, tmp_path / 'pids', tmp_path / 'jobs.json', out],
        env={**os.environ, 'PYTHONPATH': os.pathsep.join(sys.path)}, stdout=subprocess.PIPE,
        stderr=subprocess.PIPE, text=True, start_new_session=True)
    while int(process.stdout.readline()) < 8:
        pass
    (os.killpg if ending == signal.SIGINT else os.kill)(process.pid, ending)
    errors = process.communicate(timeout=PATIENCE)[1]
    assert process.returncode == -ending
    assert errors.count('Traceback') == (ending == signal.SIGINT)
    wait_for_the_end_of([int(path.name) for path in (tmp_path / 'pids').iterdir()])
    done = out.read_bytes().count(b'\n') - 1
    assert 8 <= done < 500
    few, rest = jobs[:10], partial(slow, str(tmp_path / 'pids'))
    with pytest.raises(ValueError, match='number of jobs: got 2000, expected 10'):
        run_batch(rest, few, out, workers=1)
    entries = [json.loads(line) for line in out.read_bytes().splitlines(True)[1:]
               if line.endswith(b'\n')]
    assert all(entry['record'] == noisy(jobs[entry['job']]) for entry in entries)


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


def test_errors_stay_with_their_jobs(tmp_path):
    out = tmp_path / 'out.jsonl'
    result = run_batch(sometimes_failing, JOBS, out, workers=1)
    assert set(result.errors) == {n for n in range(40) if n % 3 == 0 or n == 4}
    assert result.errors[3] == 'ZeroDivisionError: no 3'
    assert "record['list']" in result.errors[4]
    assert [record is None for record in result.records] == [n in result.errors
                                                             for n in range(40)]
    assert np.isnan(result.column('sum')).sum() == len(result.errors)
    assert list(result.column('word')[:3]) == ['', 'n1', 'n2']
    assert run_batch(sometimes_failing, JOBS, out, workers=1) == result
    with pytest.raises(ValueError, match="'total', expected one of seed, sum, word"):
        result.column('total')


def test_a_process_that_dies_does_not_take_results_along(tmp_path):
    out = tmp_path / 'out.jsonl'
    with pytest.raises(RuntimeError, match=r'jobs \[.*20'):
        run_batch(leave, JOBS, out, workers=2, chunk=1)
    entries = [json.loads(line) for line in out.read_text().splitlines()[1:]]
    assert len(entries) >= 10
    assert all(entry['record'] == noisy(JOBS[entry['job']]) for entry in entries)


def test_two_batches_do_not_write_to_one_file(tmp_path):
    out = tmp_path / 'out.jsonl'

    def again(done, total):
        if done == 20:
            with pytest.raises(ValueError, match='another process'):
                run_batch(noisy, JOBS, out, workers=1)

    result = run_batch(noisy, JOBS, out, workers=1, chunk=5, progress=again)
    assert run_batch(noisy, JOBS, out, workers=1) == result


def test_other_jobs_or_functions_are_refused(tmp_path):
    out = tmp_path / 'out.jsonl'
    run_batch(noisy, JOBS, out, workers=1)
    content = out.read_bytes()
    for function, jobs, what in ((noisy, JOBS[:-1], 'number of jobs: got 40, expected 39'),
                                 (noisy, [*JOBS[:-1], {'n': 39, 'seed': 0}], 'digest of the jobs'),
                                 (noisy, JOBS[::-1], 'digest of the jobs'),
                                 (extremes, JOBS, 'function: got .*noisy')):
        with pytest.raises(ValueError, match=what):
            run_batch(function, jobs, out, workers=1)
    assert out.read_bytes() == content


@pytest.mark.parametrize('key', ['version', 'software'])
def test_results_of_other_software_are_refused_unless_accepted(tmp_path, key):
    out = tmp_path / 'out.jsonl'
    records = list(run_batch(noisy, JOBS, out, workers=1).records)
    header, rest = out.read_text().split('\n', 1)
    out.write_text(json.dumps({**json.loads(header), key: 'old'}) + '\n' + rest)
    with pytest.raises(ValueError, match="got 'old'.*any_software"):
        run_batch(noisy, JOBS, out, workers=1)
    assert run_batch(noisy, JOBS, out, workers=1, any_software=True).records == records


def test_memory_does_not_hold_the_records_of_a_file(tmp_path):
    """Neither while jobs run nor afterwards; without a file it has to."""
    jobs = list(range(100))
    peaks = {}
    for out in (None, tmp_path / 'out.jsonl'):
        tracemalloc.start()
        result = run_batch(long_text, jobs, out, workers=1, chunk=1)
        peaks[out] = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        assert list(result.records) == [long_text(job) for job in jobs]
        assert result.records[-1] == long_text(99) and result.records[:2][1] == long_text(1)
    whole = len(jobs) * len(long_text(0)['text'])
    assert peaks[None] > whole > 4 * peaks[tmp_path / 'out.jsonl']


def test_a_result_whose_file_has_been_changed_is_not_read(tmp_path):
    out = tmp_path / 'out.jsonl'
    result = run_batch(noisy, JOBS, out, workers=1)
    out.write_text('x' + out.read_text())
    with pytest.raises(ValueError, match='in place of job 3'):
        assert result.records[3]


@pytest.mark.parametrize('content', ['notes', 'notes\n', '[]\n', '{"a": 1}\n'])
def test_a_file_of_something_else_is_left_alone(tmp_path, content):
    out = tmp_path / 'out.jsonl'
    out.write_text(content)
    with pytest.raises(ValueError, match='out.jsonl'):
        run_batch(noisy, JOBS, out, workers=1)
    assert out.read_text() == content


@pytest.mark.parametrize('line', ['{"job": 3, "rec', '{"job": "3", "record": {}}', '{"job": 3}',
                                  '7'])
def test_a_damaged_line_is_named(tmp_path, line):
    out = tmp_path / 'out.jsonl'
    run_batch(noisy, JOBS, out, workers=1)
    lines = out.read_text().splitlines()
    out.write_text('\n'.join([*lines[:5], line, *lines[6:]]) + '\n')
    with pytest.raises(ValueError, match='line 6'):
        run_batch(noisy, JOBS, out, workers=1)


def test_numbers_and_text_keep_every_bit(tmp_path):
    out = tmp_path / 'out.jsonl'
    run_batch(extremes, [{}], out, workers=1)
    read = run_batch(extremes, [{}], out, workers=1).records[0]
    expected = extremes({})
    assert repr(read) == repr({key: getattr(value, 'item', lambda v=value: v)()
                               for key, value in expected.items()})
    text = table(out).decode()
    assert '0.3333333333333333' in text and '"a, ""b""\n"' in text


def test_functions_and_jobs_without_identity_are_refused():
    for function in (lambda job: {}, partial(lambda job: {}), print):
        with pytest.raises(ValueError, match='expected a function defined in a module'):
            run_batch(function, JOBS)
    with pytest.raises(ValueError, match=r'jobs\[1\]'):
        run_batch(noisy, [{}, {'pose': Pose}])
    for option in ('workers', 'chunk'):
        with pytest.raises(ValueError, match=f'{option}: got 0'):
            run_batch(noisy, JOBS, **{option: 0})


def test_a_batch_of_nothing_is_empty():
    assert run_batch(noisy, []).records == ()
