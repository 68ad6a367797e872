"""The README says what the code does."""

from pathlib import Path
import re

from docs.tools.readme import filled
from push_scenario.definition.loader import scenario_names
import pytest

ROOT = Path(__file__).resolve().parents[2]
README = (ROOT / 'README.md').read_text(encoding='utf-8')


def test_tables_are_those_of_the_code():
    assert filled(README) == README


def test_a_table_that_differs_would_be_noticed():
    wrong = README.replace('`/', '`').replace('| `0.65` |', '| `0.66` |', 1)
    assert wrong != README and filled(wrong) != wrong
    with pytest.raises(ValueError, match='topics'):
        filled(README.replace('<!-- topics -->', '<!-- subjects -->'))


def test_every_scenario_is_listed():
    listed = re.findall(r'^\| `(\w+)` \| \w[^|]*\|$', README, re.MULTILINE)
    assert sorted(listed) == scenario_names()


def test_every_link_and_picture_is_there():
    for target in re.findall(r'\]\(([^)#]+)\)', README):
        assert target.startswith('http') or (ROOT / target).is_file(), target


def test_python_example_runs(capsys):
    example = re.search(r'```python\n(.*?)```', README, re.DOTALL)[1]
    exec(compile(example, 'README.md', 'exec'), {})
    assert 'position_error' in capsys.readouterr().out
