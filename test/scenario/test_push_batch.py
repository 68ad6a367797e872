"""Batches of pushes on disk: the same however they are run, broken off and continued."""

import dataclasses
from functools import partial
import json
import os
from pathlib import Path
import subprocess
import sys

from helpers.push_draws import draw, draw_in, PUSH
import numpy as np
from push_dynamics.cases import CaseEnd
from push_scenario.batch import push_batch
from push_scenario.batch.push_batch import run_pushes
from push_scenario.batch.push_cases import simulate_cases
import pytest

pytestmark = pytest.mark.slow
COUNT, BLOCK = 95, 10


@pytest.fixture(scope='module')
def alone(tmp_path_factory):
    """Run a batch in this process; return its result and its file."""
    out = tmp_path_factory.mktemp('alone') / 'rows.npy'
    return run_pushes(PUSH, draw, COUNT, out, seed=4, block=BLOCK, workers=1), out


def test_rows_are_those_of_the_draws_whoever_runs_them(tmp_path, alone):
    result, out = alone
    counts = []
    two = run_pushes(PUSH, draw, COUNT, tmp_path / 'two.npy', seed=4, block=BLOCK, workers=2,
                     progress=lambda *numbers: counts.append(numbers))
    assert (tmp_path / 'two.npy').read_bytes() == out.read_bytes()
    assert counts == sorted(counts) and counts[0] == (0, COUNT) and counts[-1] == (COUNT, COUNT)
    assert len(np.load(out)) == len(two.rows) == COUNT
    for block in (0, 9):
        rng = np.random.default_rng(np.random.SeedSequence(4, spawn_key=(block,)))
        rows = simulate_cases(PUSH, draw(rng, BLOCK))
        found = result.rows[BLOCK * block:BLOCK * (block + 1)]
        assert found.tobytes() == rows[:len(found)].tobytes() and len(found) > 4
    assert len(set(result.column('object_y'))) == COUNT
    with pytest.raises(ValueError, match="'mass', expected one of object.mass, "):
        result.column('mass')


def test_cases_are_opened_one_by_one(alone):
    result = alone[0]
    case = int(np.argmax(result.column('object_x')))
    plant = result.run(case)
    assert tuple(plant.object_pose) == tuple(
        result.column(name)[case] for name in ('object_x', 'object_y', 'object_theta'))
    assert result.plant(case).obj.mass == result.column('object.mass')[case] != PUSH.object.mass


def test_more_cases_begin_with_the_same_ones(tmp_path, alone):
    fewer = run_pushes(PUSH, draw, 33, tmp_path / 'few.npy', seed=4, block=BLOCK, workers=1)
    assert fewer.rows.tobytes() == alone[0].rows[:33].tobytes()


def test_an_interrupted_batch_goes_on_where_it_was(tmp_path, alone):
    drawn, out = tmp_path / 'drawn', tmp_path / 'rows.npy'
    drawn.mkdir()
    (drawn / 'flag').touch()
    arguments = PUSH, partial(draw_in, str(drawn)), COUNT, out
    with pytest.raises(KeyboardInterrupt):
        run_pushes(*arguments, seed=4, block=BLOCK, workers=1)
    rows = np.load(out)
    assert list(rows['end']) == [CaseEnd.COMPLETED] * 30 + [CaseEnd.NOT_RUN] * 65
    for path in drawn.iterdir():
        path.unlink()
    run_pushes(*arguments, seed=4, block=BLOCK, workers=1)
    assert out.read_bytes() == alone[1].read_bytes()
    # The first block is drawn for the columns too.
    assert len(list(drawn.iterdir())) == 8
    before = out.with_suffix('.jsonl').read_bytes()
    run_pushes(*arguments, seed=4, block=BLOCK, workers=1)
    assert out.with_suffix('.jsonl').read_bytes() == before


def test_rows_that_did_not_reach_the_disk_are_made_again(tmp_path, alone):
    """As after a power cut, or where the file of rows was removed."""
    out = tmp_path / 'rows.npy'
    run_pushes(PUSH, draw, COUNT, out, seed=4, block=BLOCK, workers=1)
    rows = np.load(out, mmap_mode='r+')
    rows['object_x'][42] += 1e-9
    rows.flush()
    run_pushes(PUSH, draw, COUNT, out, seed=4, block=BLOCK, workers=1)
    assert out.read_bytes() == alone[1].read_bytes()
    blocks = [json.loads(line)['job']
              for line in out.with_suffix('.jsonl').read_text().splitlines()[1:]]
    assert blocks == [*range(10), 4]
    out.unlink()
    run_pushes(PUSH, draw, COUNT, out, seed=4, block=BLOCK, workers=1)
    assert out.read_bytes() == alone[1].read_bytes()


def test_files_of_other_batches_are_left_alone(tmp_path):
    out = tmp_path / 'rows.npy'
    run_pushes(PUSH, draw, 20, out, seed=4, block=BLOCK, workers=1)
    content = out.read_bytes()
    heavier = dataclasses.replace(PUSH, object=dataclasses.replace(PUSH.object, mass=3.0))
    for arguments, options, words in (
            ((PUSH, draw, 20, out), {'seed': 5, 'block': BLOCK}, 'another batch: function'),
            ((heavier, draw, 20, out), {'seed': 4, 'block': BLOCK}, 'another batch: function'),
            ((PUSH, partial(draw_in, str(tmp_path)), 20, out), {'seed': 4, 'block': BLOCK},
             'another batch: function'),
            ((PUSH, draw, 30, out), {'seed': 4, 'block': BLOCK}, r'got \(20,\) rows'),
            ((PUSH, draw, 0, out), {}, 'count: got 0'),
            ((PUSH, lambda rng, count: {'object.mass': rng.uniform(1.0, 2.0, count)}, 20,
              tmp_path / 'new.npy'), {}, 'expected a function defined in a module'),
            ((PUSH, draw, 20, tmp_path / 'rows.csv'), {}, 'out: got .*rows.csv')):
        with pytest.raises(ValueError, match=words):
            run_pushes(*arguments, workers=1, **options)
    out.with_suffix('.jsonl').unlink()
    with pytest.raises(ValueError, match='rows without rows.jsonl'):
        run_pushes(PUSH, draw, 20, out, seed=4, block=BLOCK, workers=1)
    assert out.read_bytes() == content


def draw_too_near(rng, count):
    """Let some robots overlap with the object."""
    drawn = draw(rng, count)
    drawn['robot_pose'][::4, 0] = -0.3
    return drawn


def draw_two_kinds(rng, count):
    """Forget a column now and then."""
    drawn = draw(rng, count)
    if drawn['object.mass'][0] > 3.0:
        del drawn['object.mass']
    return drawn


def test_refused_cases_keep_their_reason_and_blocks_that_fail_are_named(tmp_path):
    result = run_pushes(PUSH, draw_too_near, 20, tmp_path / 'rows.npy', block=BLOCK, workers=1)
    refusals = result.refusals()
    assert list(refusals) == [0, 4, 8, 10, 14, 18]
    assert all('robot_pose: got an overlap' in text for text in refusals.values())
    assert np.isnan(result.column('object_x')).sum() == 6
    with pytest.raises(ValueError, match='overlap'):
        result.plant(4)
    with pytest.raises(RuntimeError, match='expected .* as in the first block'):
        run_pushes(PUSH, draw_two_kinds, 100, tmp_path / 'other.npy', block=BLOCK, workers=1)


def test_memory_does_not_grow_with_the_number_of_cases(tmp_path, monkeypatch):
    """Rows go to disk block by block: nothing but what a block is noted by is kept."""
    most = []
    monkeypatch.setattr(push_batch, 'simulate_cases', lambda push, values: most.append(
        max(map(len, values.values()))) or simulate_cases(push, values))
    result = run_pushes(PUSH, draw, COUNT, tmp_path / 'rows.npy', block=BLOCK, workers=1)
    assert max(most) == BLOCK and len(most) == 10
    assert isinstance(result.rows, np.memmap)
    lines = (tmp_path / 'rows.jsonl').read_text().splitlines()
    assert len(lines) == 11 and max(map(len, lines[1:])) < 200


def test_the_documented_example_runs(tmp_path):
    text = (Path(__file__).parents[2] / 'docs' / 'batches.md').read_text()
    example = text.split('```python\n')[1].split('```')[0]
    assert '1_000_000' in example
    (tmp_path / 'example.py').write_text(example.replace('1_000_000', '1_200'))
    done = subprocess.run([sys.executable, 'example.py'], cwd=tmp_path, timeout=600, text=True,
                          env={**os.environ, 'PYTHONPATH': os.pathsep.join(sys.path)},
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    assert done.returncode == 0 and '1200/1200' in done.stdout, done.stdout
    rows = np.load(tmp_path / 'out' / 'friction.npy')
    assert len(rows) == 1200 and np.all(rows['object_x'] > 0.3)
