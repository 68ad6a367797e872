"""Templates of reports: a benchmark of hours must not end with a name that is missing."""

import ast
from pathlib import Path
import re

from benchmarks.report_template import fill_template, NAME
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
