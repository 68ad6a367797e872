"""The gallery of docs/studies.md is what the command makes, sentence by sentence."""

from pathlib import Path
import re

from push_study import catalogue, cli
import pytest

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / 'docs' / 'studies.md'
FIGURES = [f'2.{number}' for number in range(1, 34)]


@pytest.fixture(scope='module')
def made(tmp_path_factory):
    """Run all studies, and fill a copy of the page in."""
    folder = tmp_path_factory.mktemp('gallery')
    page = folder / 'studies.md'
    page.write_text(PAGE.read_text(encoding='utf-8'), encoding='utf-8')
    assert cli.main(['run', 'all', '--out', str(folder / 'studies'), '--page', str(page)]) == 0
    return page


def test_page_is_what_the_command_makes(made):
    """Findings stand in the sentences, so every number of the page is computed here."""
    assert made.read_text(encoding='utf-8') == PAGE.read_text(encoding='utf-8')


def test_every_study_has_its_files(made):
    for study in catalogue.studies():
        for suffix in ('.png', '.svg', '.json'):
            path = made.parent / 'studies' / f'{study.figure}{suffix}'
            assert path.stat().st_size > 500, path.name
        tables = list((made.parent / 'studies').glob(f'{study.figure}-*.csv'))
        assert tables, study.figure


def test_chapter_2_is_complete_and_shown():
    assert [study.figure for study in catalogue.select(['chapter2'])] == FIGURES
    shown = re.findall(r'!\[.*\]\((.*)\)', PAGE.read_text(encoding='utf-8'))
    assert {f'studies/{study.figure}.png' for study in catalogue.studies()} <= set(shown)
    for target in shown:
        assert (ROOT / 'docs' / target).is_file(), target
