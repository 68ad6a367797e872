"""Studies as such: values and their sources, files kept or made anew, the command."""

import csv
import dataclasses
import json

import numpy as np
from push_scenario.batch.batch import run_batch
from push_study import catalogue, cli, gallery
from push_study.chapter2.rolling import flat_object
from push_study.framework import run
from push_study.framework.run import Runner
from push_study.framework.store import stamp_of, StudyFiles
from push_study.framework.study import Finding, Outcome, Parameter, Study
from push_study.framework.values import read_overrides, read_table, refuse_unknown, values_of
from push_study.maps import drive_map, object_regions, perimeter_table
import pytest

TABLE = {'all': {'count': 3, 'shared': 1.0}, '9.2': {'shared': 2.0}}
FLAT = flat_object.STUDIES[0]


def squares(job):
    """Stand in for a simulation."""
    return {'square': job ** 2}


def compute(values, batch):
    """Square some numbers in a batch."""
    records = batch(squares, list(range(int(values.count))))
    column = [record['square'] for record in records]
    return Outcome({'squares': {'square': column}},
                   {'sum': Finding(float(sum(column)), '', 'sum of squares')})


def draw(figure, outcome, values):
    """Draw the squares."""
    figure.subplots().plot(outcome.tables['squares']['square'])


PARAMETERS = (Parameter('count', '', 'how many'), Parameter('shared', 'm', 'of all'),
              Parameter('given', 'm', 'of the caption', 0.5))
SMALL = Study('9.1', 'Squares', PARAMETERS, compute, draw, 'The sum is {sum:.1f}.', 'It adds up.')


def test_values_come_from_caption_section_common_or_hand():
    """The caption counts, then the figure's section, then the common one; a hand outranks all."""
    other = dataclasses.replace(SMALL, figure='9.2')
    assert [(v.value, v.source) for v in values_of(SMALL, TABLE)] == [
        (3, 'ours'), (1.0, 'ours'), (0.5, 'caption')]
    assert values_of(other, TABLE).shared == 2.0
    changed = values_of(other, TABLE, {'given': 0.7, 'elsewhere': 1})
    assert changed.given == 0.7
    assert [value.source for value in changed] == ['ours', 'ours', 'set']
    with pytest.raises(AttributeError, match='elsewhere'):
        changed.elsewhere


@pytest.mark.parametrize('new', ['a', [1.0], True, float('nan'), float('inf'), None])
def test_another_kind_of_value_is_refused(new):
    with pytest.raises(ValueError, match=r'--set shared: got .*expected a finite number \[m\]'):
        values_of(SMALL, TABLE, {'shared': new})


def test_missing_value_is_named():
    with pytest.raises(ValueError, match='got no count for 9.1'):
        values_of(SMALL, {'all': {}})


def test_overrides_are_read_as_yaml():
    assert read_overrides(['mass=1e-3', 'radii=[0.1, 0.2]']) == {'mass': 1e-3,
                                                                 'radii': [0.1, 0.2]}
    for word in ('mass', 'mass=', '=3', 'a b=3'):
        with pytest.raises(ValueError, match='NAME=VALUE'):
            read_overrides([word])
    with pytest.raises(ValueError, match='got weight, expected some of .*ahead'):
        refuse_unknown({'weight': 1.0}, [FLAT])


def test_every_value_of_the_table_is_used():
    """Nothing in config/studies.yaml is for a figure or a parameter that does not exist."""
    table, everything = read_table(), catalogue.studies()
    known = {study.figure: {p.name for p in study.parameters if p.caption is None}
             for study in everything}
    known[object_regions.NAME] = {p.name for p in perimeter_table.PARAMETERS}
    known[drive_map.NAME] = {p.name for p in drive_map.PARAMETERS}
    for figure, section in table.items():
        names = set().union(*known.values()) if figure == 'all' else known[figure]
        assert set(section) <= names, figure


def test_catalogue_is_in_the_order_of_the_thesis():
    figures = [study.figure for study in catalogue.studies()]
    assert len(set(figures)) == len(figures)
    # The tables of a chapter come after its figures.
    assert figures == sorted(figures, key=lambda text: (
        int(text.lstrip('T').split('.')[0]), text[0] == 'T', int(text.split('.')[1])))
    assert [study.figure for study in catalogue.select(['2.13', '2.11'])] == ['2.11', '2.13']
    assert catalogue.select(['all']) == catalogue.studies()
    with pytest.raises(ValueError, match='2.99.*expected all, chapter2'):
        catalogue.select(['2.99'])


def test_files_tell_parameters_version_and_findings(tmp_path):
    done = Runner(tmp_path, read_table())(FLAT)
    lines = done.files.table('alpha').read_text().splitlines()
    head = [line for line in lines if line.startswith('# ')]
    assert '# parameter ahead = 0.3 m (caption)' in head
    assert any(line.startswith('# version: ') for line in head)
    assert any(line.startswith('# finding margin = 0.2') for line in head)
    rows = np.array(list(csv.reader(lines[len(head) + 1:])), dtype=float)
    assert lines[len(head)] == 'rho_rad,alpha_rad,force_alpha_rad,rolls'
    assert rows.shape == (401, 4)
    assert done.files.png.read_bytes().startswith(b'\x89PNG')
    svg = done.files.svg.read_text()
    assert 'As captioned' in svg and 'Our values' in svg


def test_the_same_study_gives_the_same_bytes(tmp_path):
    for folder in ('a', 'b'):
        Runner(tmp_path / folder, read_table())(FLAT)
    for path in (tmp_path / 'a').iterdir():
        assert path.read_bytes() == (tmp_path / 'b' / path.name).read_bytes(), path.name


def test_what_is_there_is_kept_until_something_changes(tmp_path):
    assert not Runner(tmp_path, TABLE)(SMALL).kept
    again = Runner(tmp_path, TABLE)(SMALL)
    assert again.kept and again.findings['sum'] == (5.0, '', 'sum of squares')
    assert not Runner(tmp_path, TABLE, {'count': 4})(SMALL).kept
    assert Runner(tmp_path, TABLE, {'count': 4})(SMALL).findings['sum'].value == 14.0
    (tmp_path / '9.1.svg').unlink()
    assert not Runner(tmp_path, TABLE, {'count': 4})(SMALL).kept
    stamp = tmp_path / '9.1.json'
    content = json.loads(stamp.read_text())
    stamp.write_text(json.dumps({**content, 'software': 'other'}))
    assert not Runner(tmp_path, TABLE, {'count': 4})(SMALL).kept


def test_an_interrupted_study_goes_on(tmp_path, monkeypatch):
    """What a batch has done is not done again; at the end nothing unfinished is left."""
    seen = []

    def interrupted(function, jobs, out, **options):
        run_batch(function, jobs, out, **options)
        lines = out.read_text().splitlines(keepends=True)
        out.write_text(''.join(lines[:-1]))
        raise KeyboardInterrupt

    monkeypatch.setattr(run, 'run_batch', interrupted)
    with pytest.raises(KeyboardInterrupt):
        Runner(tmp_path, TABLE)(SMALL)
    monkeypatch.undo()
    done = Runner(tmp_path, TABLE, progress=lambda jobs, total: seen.append((jobs, total)))(SMALL)
    assert seen == [(2, 3), (3, 3)]
    assert done.findings['sum'].value == 5.0
    assert not (tmp_path / 'unfinished').exists()


def test_a_job_that_fails_is_named(tmp_path):
    def broken(values, batch):
        return batch(fails, [1])

    with pytest.raises(RuntimeError, match='job 0, 1: ZeroDivisionError'):
        Runner(tmp_path, TABLE)(dataclasses.replace(SMALL, compute=broken))


def fails(job):
    """Stand in for a simulation that fails."""
    return {'never': job / 0}


def test_columns_of_one_table_have_one_length(tmp_path):
    outcome = Outcome({'t': {'a': [1, 2], 'b': [1]}}, {})
    files = StudyFiles(SMALL, tmp_path)
    with pytest.raises(ValueError, match='one length'):
        files.finish(stamp_of(SMALL, values_of(SMALL, TABLE)), outcome)


def test_page_is_filled_between_its_marks(tmp_path):
    done = Runner(tmp_path / 'pictures', TABLE)(SMALL)
    text = gallery.fill('head\n<!-- gallery -->\nold\n<!-- end -->\ntail\n',
                        gallery.page([done], tmp_path))
    assert 'old' not in text and text.startswith('head') and text.endswith('tail\n')
    assert '![Squares](pictures/9.1.png)' in text
    assert 'The sum is 5.0. It adds up.' in text
    assert gallery.fill(text, gallery.page([done], tmp_path)) == text
    with pytest.raises(ValueError, match='without the lines'):
        gallery.fill('no marks', 'x')


def test_command_line(tmp_path, capsys):
    out = ['--out', str(tmp_path)]
    assert cli.main(['list']) == 0
    assert '2.11   Flat object' in capsys.readouterr().out
    assert cli.main(['list', '2.11']) == 0
    assert 'robot_radius = 0.5 m (caption)' in capsys.readouterr().out
    assert cli.main(['run', '2.11', '2.12', '--set', 'robot_radius=0.6', *out]) == 0
    told = capsys.readouterr().out
    assert '2.11.png' in told and '0.3 m' in told and 'kept' not in told
    assert cli.main(['run', '2.11', '--set', 'robot_radius=0.6', *out]) == 0
    assert 'kept' in capsys.readouterr().out
    for wrong in (['run', '2.99'], ['run', '2.11', '--set', 'radius=1'],
                  ['run', '2.11', '--set', 'robot_radius=-1']):
        assert cli.main([*wrong, *out]) == 2
        assert 'expected' in capsys.readouterr().err
    with pytest.raises(SystemExit):
        cli.main(['run', '2.11', '--jobs', '0'])


def test_ctrl_c_is_told(tmp_path, monkeypatch, capsys):
    def interrupt(self, study):
        raise KeyboardInterrupt

    monkeypatch.setattr(Runner, '__call__', interrupt)
    assert cli.main(['run', '2.11', '--out', str(tmp_path)]) == 130
    assert 'the same command goes on' in capsys.readouterr().err
