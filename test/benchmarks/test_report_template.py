"""Templates of reports: a benchmark of hours must not end with a name that is missing."""

import ast
from pathlib import Path
import re

from benchmarks.report_template import fill_template, NAME, updated_page
import pytest

ROOT = Path(__file__).resolve().parents[2]
REPORTS = sorted(path for path in (ROOT / 'benchmarks').glob('*/*.py')
                 if 'fill_template(' in path.read_text(encoding='utf-8'))


@pytest.mark.parametrize('module', REPORTS, ids=lambda path: f'{path.parent.name}/{path.stem}')
def test_a_report_gives_all_names_of_its_template(module):
    text = module.read_text(encoding='utf-8')
    template, = re.findall(r"'(\w+\.md\.in)'", text)
    call, = (node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Call)
             and getattr(node.func, 'id', '') == 'fill_template')
    names = NAME.findall((module.parent / template).read_text(encoding='utf-8'))
    assert {keyword.arg for keyword in call.keywords} == set(names)


def test_names_are_replaced_and_no_other_ones_taken(tmp_path):
    template = Path(tmp_path / 'text.md.in')
    template.write_text('@COUNT@ of @ALL@, mail@example.org')
    assert fill_template(template, COUNT=3, ALL='@COUNT@') == '3 of @COUNT@, mail@example.org'
    for values in ({'COUNT': 3}, {'COUNT': 3, 'ALL': 4, 'NONE': 5}):
        with pytest.raises(ValueError, match='text.md.in: .*(ALL|NONE)'):
            fill_template(template, **values)


def test_what_is_not_measured_stays_as_it_was(tmp_path):
    """Value by value, over several lines; of a page of another template nothing stays."""
    template = Path(tmp_path / 'text.md.in')
    template.write_text('First: @ONE@\nsecond:\n@TWO@\nEnd.\n')
    previous = fill_template(template, ONE='1', TWO='| a |\n| b |')
    page = fill_template(template, ONE='3', TWO='-')

    def is_kept(name, value):
        return value == '-'

    assert updated_page(template, page, previous, is_kept) == (
        'First: 3\nsecond:\n| a |\n| b |\nEnd.\n')
    for other in ('', previous + 'more'):
        assert updated_page(template, page, other, is_kept) == page
