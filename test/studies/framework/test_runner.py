"""Running studies: files are kept while nothing changes, and jobs continue."""

import csv
import dataclasses
import json

import numpy as np
from push_scenario.parallel import run_many
import pytest
from studies.chapter2.rolling import flat_object
from studies.framework import runner
from studies.framework.files import stamp_of, StudyFiles
from studies.framework.parameters import Parameter, read_chosen_values
from studies.framework.runner import StudyRunner
from studies.framework.study import Finding, Outcome, Study

pytestmark = pytest.mark.slow
CHOSEN = {'all': {'count': 3, 'shared': 1.0}}
FLAT = flat_object.STUDIES[0]


def square(job):
    """Stand in for a simulation."""
    return {'square': job ** 2}


def compute(values, run_jobs):
    """Square some numbers, one in each job."""
    records = run_jobs(square, list(range(int(values.count))))
    column = [record['square'] for record in records]
    return Outcome({'squares': {'square': column}},
                   {'sum': Finding(float(sum(column)), '', 'sum of squares')})


def draw(figure, outcome, values):
    """Draw the squares."""
    figure.subplots().plot(outcome.tables['squares']['square'])


PARAMETERS = (Parameter('count', '', 'how many'), Parameter('shared', 'm', 'of all'),
              Parameter('given', 'm', 'of the caption', 0.5))
SQUARES = Study('9.1', 'Squares', PARAMETERS, compute, draw, 'The sum is {sum:.1f}.',
                'It adds up.')


def test_files_state_parameters_version_and_findings(tmp_path):
    result = StudyRunner(tmp_path, read_chosen_values()).run(FLAT)
    lines = result.files.table('alpha').read_text().splitlines()
    head = [line for line in lines if line.startswith('# ')]
    assert '# parameter ahead = 0.3 m (caption)' in head
    assert any(line.startswith('# version: ') for line in head)
    assert any(line.startswith('# finding margin = 0.2') for line in head)
    rows = np.array(list(csv.reader(lines[len(head) + 1:])), dtype=float)
    assert lines[len(head)] == 'rho_rad,alpha_rad,turn,rolls'
    assert rows.shape == (401, 4)
    assert result.files.png.read_bytes().startswith(b'\x89PNG')
    svg = result.files.svg.read_text()
    assert 'From the caption' in svg and 'Chosen values' in svg


def test_the_same_study_gives_the_same_bytes(tmp_path):
    for folder in ('a', 'b'):
        StudyRunner(tmp_path / folder, read_chosen_values()).run(FLAT)
    for path in (tmp_path / 'a').iterdir():
        assert path.read_bytes() == (tmp_path / 'b' / path.name).read_bytes(), path.name


def test_a_finished_study_is_kept_until_something_changes(tmp_path):
    assert not StudyRunner(tmp_path, CHOSEN).run(SQUARES).is_cached
    again = StudyRunner(tmp_path, CHOSEN).run(SQUARES)
    assert again.is_cached and again.findings['sum'] == (5.0, '', 'sum of squares')
    other = StudyRunner(tmp_path, CHOSEN, {'count': 4})
    assert not other.run(SQUARES).is_cached
    assert other.run(SQUARES).findings['sum'].value == 14.0
    (tmp_path / '9.1.svg').unlink()
    assert not other.run(SQUARES).is_cached
    stamp = tmp_path / '9.1.json'
    content = json.loads(stamp.read_text())
    stamp.write_text(json.dumps({**content, 'software': 'other'}))
    assert not other.run(SQUARES).is_cached


def test_an_interrupted_study_continues(tmp_path, monkeypatch):
    """What is done is not done again; at the end nothing unfinished is left."""
    progress = []

    def interrupted(function, jobs, **options):
        run_many(function, jobs[:2], **options)
        raise KeyboardInterrupt

    monkeypatch.setattr(runner, 'run_many', interrupted)
    with pytest.raises(KeyboardInterrupt):
        StudyRunner(tmp_path, CHOSEN).run(SQUARES)
    monkeypatch.undo()
    result = StudyRunner(tmp_path, CHOSEN, on_progress=lambda finished, total: progress.append(
        (finished, total))).run(SQUARES)
    assert progress == [(2, 3), (3, 3)]
    assert result.findings['sum'].value == 5.0
    assert not (tmp_path / 'unfinished').exists()


def test_a_job_that_fails_is_named(tmp_path):
    def broken(values, run_jobs):
        return run_jobs(fail, [1])

    with pytest.raises(RuntimeError, match='job 0, 1: ZeroDivisionError'):
        StudyRunner(tmp_path, CHOSEN).run(dataclasses.replace(SQUARES, compute=broken))


def fail(job):
    """Stand in for a simulation that fails."""
    return {'never': job / 0}


def test_columns_of_one_table_have_one_length(tmp_path):
    outcome = Outcome({'t': {'a': [1, 2], 'b': [1]}}, {})
    files = StudyFiles(SQUARES, tmp_path)
    with pytest.raises(ValueError, match='one length'):
        files.write(stamp_of(SQUARES, SQUARES.values(CHOSEN)), outcome)
