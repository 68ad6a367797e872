"""The galleries of the docs are what the command makes, sentence by sentence."""

from pathlib import Path
import re

from helpers.study_outcomes import outcome_of, QUICK, quick_outcome_of, values_of
import pytest
from studies import __main__ as cli, catalogue, gallery
from studies.framework import plot_style
from studies.framework.files import stamp_of, StudyFiles
from studies.framework.runner import draw_figure, StudyResult
from studies.framework.study import Finding, Outcome, Study

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / 'docs'
# Page -> words of the command that makes its gallery.
PAGES = {'studies.md': ['chapter2', 'chapter3', 'chapter4', 'appendix', 'beyond'],
         'one_push.md': ['primitives']}
# Counted in the thesis' list of figures and tables: chapter -> its figures and tables.
THESIS = {'chapter2': (32, ('T2.1', 'T2.2')),
          'chapter3': (13, tuple(f'T3.{number}' for number in range(1, 8))),
          'chapter4': (15, ())}


def title(study):
    """Write the title of a study with the values of studies/values.yaml."""
    return study.title_of(values_of(study))


def without_numbers(page):
    """Mask the numbers below the figures of studies of which tests compute less."""
    entries = re.split('(?m)^### ', page)
    return [re.sub(r'-?\d+(\.\d+)?', '#', entry.partition('\n')[2])
            if entry.split(' ')[0] in QUICK else entry for entry in entries]


@pytest.mark.slow
@pytest.mark.parametrize('name', PAGES)
def test_page_is_what_the_studies_find(name, tmp_path):
    """The sentences quote findings, so the numbers of the page are computed here."""
    results = [StudyResult(study, title(study), quick_outcome_of(study).findings,
                           StudyFiles(study, tmp_path / 'studies'), False,
                           quick_outcome_of(study).page_table)
               for study in catalogue.select(PAGES[name])]
    shown = (DOCS / name).read_text(encoding='utf-8')
    found = gallery.insert(shown, gallery.page(results, tmp_path))
    assert without_numbers(found) == without_numbers(shown)


@pytest.mark.slow
@pytest.mark.parametrize('study', catalogue.studies(), ids=lambda study: study.figure)
def test_every_study_is_drawn_and_has_tables(study: Study, tmp_path: Path) -> None:
    outcome, values = quick_outcome_of(study), values_of(study, **QUICK.get(study.figure, {}))
    with plot_style.applied():
        figure = draw_figure(study, outcome, values)
        # Where its parts go takes longest to compute; sketches have laws on that.
        figure.set_layout_engine('none')
        figure.draw_without_rendering()
    assert figure.axes
    files = StudyFiles(study, tmp_path)
    files.write(stamp_of(study, values), outcome)
    assert outcome.tables
    for name in outcome.tables:
        assert files.table(name).stat().st_size > 500


@pytest.mark.slow
def test_the_command_writes_figures_and_page(tmp_path):
    figures = ['2.11', '2.12']
    page = tmp_path / 'page.md'
    page.write_text(f'{gallery.START}\n{gallery.END}\n', encoding='utf-8')
    assert cli.main(['run', *figures, '--out', str(tmp_path / 'studies'), '--page',
                     str(page)]) == 0
    results = [StudyResult(study, title(study), outcome_of(study).findings,
                           StudyFiles(study, tmp_path / 'studies'), False,
                           outcome_of(study).page_table)
               for study in catalogue.select(figures)]
    assert gallery.page(results, tmp_path) in page.read_text(encoding='utf-8')
    for study in figures:
        for suffix in ('.png', '.svg', '.json'):
            path = tmp_path / 'studies' / f'{study}{suffix}'
            assert path.stat().st_size > 500, path.name


@pytest.mark.parametrize('chapter', THESIS)
def test_chapters_are_complete(chapter):
    count, tables = THESIS[chapter]
    figures = [f'{chapter[-1]}.{number}' for number in range(1, count + 1)]
    assert [study.figure for study in catalogue.select([chapter])] == [*figures, *tables]
    assert [study.figure for study in catalogue.select(['appendix'])] == ['C.1']


def test_every_study_is_shown_on_one_page():
    shown = []
    for page in PAGES:
        shown += re.findall(r'!\[.*\]\((.*)\)', (DOCS / page).read_text(encoding='utf-8'))
    assert len(shown) == len(set(shown))
    assert {f'studies/{study.figure}.png' for study in catalogue.studies()} <= set(shown)
    for target in shown:
        assert (DOCS / target).is_file(), target


def test_gallery_is_inserted_between_the_marks(tmp_path):
    study = Study('2.99', 'Squares', (), lambda values, run_jobs: Outcome({}, {}),
                  lambda figure, outcome, values: None, 'The sum is {sum:.1f}.', 'It adds up.')
    result = StudyResult(study, title(study), {'sum': Finding(5.0, '', 'sum of squares')},
                         StudyFiles(study, tmp_path / 'figures'), is_cached=False)
    page = gallery.page([result], tmp_path)
    text = gallery.insert('head\n<!-- gallery -->\nold\n<!-- end -->\ntail\n', page)
    assert 'old' not in text and text.startswith('head') and text.endswith('tail\n')
    assert '![2.99](figures/2.99.png)' in text
    assert 'The sum is 5.0. It adds up.' in text
    assert gallery.insert(text, page) == text
    with pytest.raises(ValueError, match='without the lines'):
        gallery.insert('no marks', 'x')
