"""The galleries of the docs are what the command makes, sentence by sentence."""

from pathlib import Path
import re

from push_study import catalogue, cli, gallery
from push_study.framework.files import StudyFiles
from push_study.framework.runner import StudyResult
from push_study.framework.study import Finding, Outcome, Study
import pytest

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / 'docs'
# Page -> words of the command that makes its gallery.
PAGES = {'studies.md': ['chapter2', 'chapter3', 'chapter4'], 'one_push.md': ['primitives']}
CHAPTER_2 = [f'2.{number}' for number in range(1, 34)]


@pytest.fixture(scope='module', params=PAGES)
def made(request, tmp_path_factory):
    """Run the studies of a page, and insert their gallery in a copy of it."""
    folder = tmp_path_factory.mktemp('gallery')
    page = folder / request.param
    page.write_text((DOCS / request.param).read_text(encoding='utf-8'), encoding='utf-8')
    assert cli.main(['run', *PAGES[request.param], '--out', str(folder / 'studies'), '--page',
                     str(page)]) == 0
    return page


@pytest.mark.slow
def test_page_is_what_the_command_makes(made):
    """The sentences quote findings, so every number of the page is computed here."""
    assert made.read_text(encoding='utf-8') == (DOCS / made.name).read_text(encoding='utf-8')


@pytest.mark.slow
def test_every_study_has_its_files(made):
    for study in catalogue.select(PAGES[made.name]):
        for suffix in ('.png', '.svg', '.json'):
            path = made.parent / 'studies' / f'{study.figure}{suffix}'
            assert path.stat().st_size > 500, path.name
        tables = list((made.parent / 'studies').glob(f'{study.figure}-*.csv'))
        assert tables, study.figure


def test_chapter_2_is_complete():
    assert [study.figure for study in catalogue.select(['chapter2'])] == CHAPTER_2


def test_every_study_is_shown_on_one_page():
    shown = []
    for page in PAGES:
        shown += re.findall(r'!\[.*\]\((.*)\)', (DOCS / page).read_text(encoding='utf-8'))
    assert len(shown) == len(set(shown))
    assert {f'studies/{study.figure}.png' for study in catalogue.studies()} <= set(shown)
    for target in shown:
        assert (DOCS / target).is_file(), target


def test_gallery_is_inserted_between_the_marks(tmp_path):
    study = Study('9.1', 'Squares', (), lambda values, run_jobs: Outcome({}, {}),
                  lambda figure, outcome, values: None, 'The sum is {sum:.1f}.', 'It adds up.')
    result = StudyResult(study, {'sum': Finding(5.0, '', 'sum of squares')},
                         StudyFiles(study, tmp_path / 'figures'), is_cached=False)
    page = gallery.page([result], tmp_path)
    text = gallery.insert('head\n<!-- gallery -->\nold\n<!-- end -->\ntail\n', page)
    assert 'old' not in text and text.startswith('head') and text.endswith('tail\n')
    assert '![Squares](figures/9.1.png)' in text
    assert 'The sum is 5.0. It adds up.' in text
    assert gallery.insert(text, page) == text
    with pytest.raises(ValueError, match='without the lines'):
        gallery.insert('no marks', 'x')
