"""README and docs agree with the code: tables, links, names, commands and examples."""

import importlib
from pathlib import Path
import re

from docs.tools import reference
from helpers.architecture import files, ROOT
from push_scenario.definition.catalogue import scenario_names
import pytest

PAGES = sorted(path.relative_to(ROOT).as_posix() for path in files(ROOT) if path.suffix == '.md')
TEXTS = {page: (ROOT / page).read_text(encoding='utf-8') for page in PAGES}
REPORTS = {
    'benchmarks/calibration/calibrate.md.in': 'docs/robots/calibrate.md',
    'benchmarks/chances/chances.md.in': 'docs/reports/chances.md',
    'benchmarks/controller/controller.md.in': 'docs/reports/controller.md',
    'benchmarks/faults/faults.md.in': 'docs/reports/faults.md',
    'benchmarks/pixels/pixels.md.in': 'docs/reports/pixels.md',
    'benchmarks/planner/planner.md.in': 'docs/reports/planner.md',
    'benchmarks/plant/mujoco.md.in': 'docs/reports/mujoco.md',
    'benchmarks/plant/plant.md.in': 'docs/reports/plant.md',
    'benchmarks/speed/performance.md.in': 'docs/reports/performance.md',
    'benchmarks/tasks/tasks.md.in': 'docs/reports/tasks.md',
    'benchmarks/tidy/tidy.md.in': 'docs/reports/tidy.md',
}
LINK = re.compile(r'\]\(([^)\s]+)\)')
CODE = re.compile(r'(?<!`)`([^`\n]+)`(?!`)')
FILE = re.compile(r'(push_\w+|studies|test|benchmarks|config|docs|examples|launch)/[\w./-]*\w/?$')
DOTTED = re.compile(r'(push_\w+|studies|benchmarks)(\.\w+)+$')
COMMAND = re.compile(r'(?:python -m|\bm) (benchmarks[\w.]*|studies|docs\.tools\.\w+)')
EXAMPLE = re.compile(r'```python\n(.*?)```', re.DOTALL)


# Name and year: how pages cite, and how entries of the bibliography are called.
CITATION = re.compile(r'(?<![\w/.-])([a-z]{2,}(?:19|20)\d\d)(?![\w/-])')


def test_each_citation_has_an_entry_and_each_entry_is_cited():
    entries = set(re.findall(r'^@\w+\{(\w+),', (ROOT / 'docs/references.bib').read_text(
        encoding='utf-8'), re.MULTILINE))
    cited = {key for page, text in TEXTS.items() if page.startswith('docs/')
             for key in CITATION.findall(text)}
    assert cited == entries


def heading_anchors(text):
    """Name the headings of a page as the links to them do."""
    headings = re.findall(r'^#+ (.+)$', text, re.MULTILINE)
    return {re.sub(r'[^\w -]', '', heading).strip().lower().replace(' ', '-')
            for heading in headings}


def resolve(name):
    """Import what a dotted name says; raise where there is no such thing."""
    parts = name.split('.')
    for count in range(len(parts), 0, -1):
        try:
            found = importlib.import_module('.'.join(parts[:count]))
        except ModuleNotFoundError:
            continue
        for attribute in parts[count:]:
            found = getattr(found, attribute)
        return found
    raise ModuleNotFoundError(name)


def parameter_names():
    """List the parameters of all nodes."""
    return {spec.name for _, specs in reference.parameter_groups().values() for spec in specs}


def unknown_parameters(text):
    """Find parameters in backquotes that no node has."""
    names = parameter_names()
    groups = {name.split('.')[0] for name in names if '.' in name}
    mentioned = [code for code in CODE.findall(text)
                 if re.match(r'\w+(\.\w+)+$', code) and code.split('.')[0] in groups]
    return [name for name in mentioned
            if not any(known == name or known.startswith(f'{name}.') for known in names)]


@pytest.mark.parametrize('path', reference.pages(), ids=lambda path: path.stem)
def test_reference_tables_are_those_of_the_code(path):
    """After a failure: ``python -m docs.tools.reference``."""
    text = path.read_text(encoding='utf-8')
    assert reference.fill_sections(text) == text


def test_the_reference_has_every_table_once():
    """No topic, service or parameter is left out."""
    names = [name for path in reference.pages()
             for name in reference.section_names(path.read_text(encoding='utf-8'))]
    assert sorted(names) == sorted(reference.tables())


def test_a_table_that_differs_would_be_noticed():
    """A changed default is put right, an unknown section is an error."""
    text = (reference.REFERENCE / 'parameters.md').read_text(encoding='utf-8')
    wrong = text.replace('| `0.65` |', '| `0.66` |', 1)
    assert wrong != text and reference.fill_sections(wrong) == text
    with pytest.raises(ValueError, match='parameters planer'):
        reference.fill_sections(text.replace('parameters planner', 'parameters planer'))


def test_every_scenario_is_listed():
    """The table of scenarios names those that ``push replay --list`` does."""
    listed = re.findall(r'^\| `(\w+)` \| \w[^|]*\|$', TEXTS['docs/scenarios.md'], re.MULTILINE)
    assert sorted(listed) == scenario_names()


def test_the_index_leads_to_every_page():
    """Each page below docs can be found from the index."""
    links = {(ROOT / 'docs' / target.partition('#')[0]).resolve()
             for target in LINK.findall(TEXTS['docs/index.md'])}
    pages = {ROOT / page for page in PAGES
             if page.startswith('docs/') and not page.startswith('docs/site/')}
    assert pages - links == {ROOT / 'docs/index.md'}


@pytest.mark.parametrize('page', PAGES)
def test_every_link_and_picture_is_there(page):
    """Relative links lead to files, and to headings where they name one."""
    wrong = []
    for target in LINK.findall(TEXTS[page]):
        if target.startswith('http'):
            continue
        name, _, anchor = target.partition('#')
        path = (ROOT / page).parent / name if name else ROOT / page
        anchors = heading_anchors(path.read_text(encoding='utf-8')) if anchor else ['']
        if not path.exists() or anchor not in anchors:
            wrong.append(target)
    assert wrong == []


@pytest.mark.parametrize('page', PAGES)
def test_names_in_the_text_exist(page):
    """Files, modules, functions and parameters in backquotes, and modules that are run."""
    codes = [code.partition(' ')[0] for code in CODE.findall(TEXTS[page])]
    assert [code for code in codes if FILE.match(code) and not (ROOT / code).exists()] == []
    for name in {code for code in codes if DOTTED.match(code)} | set(
            COMMAND.findall(TEXTS[page])):
        resolve(name)
    assert unknown_parameters(TEXTS[page]) == []


def test_a_name_that_does_not_exist_would_be_noticed():
    """The checks of names can fail."""
    assert unknown_parameters('`control.pose_timeout`, `object.supports`') == []
    assert unknown_parameters('`control.patience`') == ['control.patience']
    with pytest.raises(AttributeError):
        resolve('push_model.geometry.no_such_name')
    assert heading_anchors('# On a `real` robot, at last') == {'on-a-real-robot-at-last'}


@pytest.mark.parametrize('template, report', REPORTS.items())
def test_reports_have_the_text_of_their_templates(template, report):
    """A measured report differs from its template in the measured values alone."""
    pattern = re.sub(r'@[A-Z]+@', '.*?', re.escape((ROOT / template).read_text().rstrip()))
    assert re.fullmatch(pattern, TEXTS[report].rstrip(), re.DOTALL)


def test_every_template_has_a_report():
    """No template of a benchmark is left out of the check."""
    assert sorted(REPORTS) == sorted(path.relative_to(ROOT).as_posix() for path in files(ROOT)
                                     if path.name.endswith('.md.in'))


@pytest.mark.slow
@pytest.mark.parametrize('page', [page for page in PAGES if EXAMPLE.search(TEXTS[page])])
def test_python_examples_run(page, tmp_path, monkeypatch, capsys):
    """The examples of a page run one after the other, as one program that is imported."""
    monkeypatch.chdir(tmp_path)
    source = '\n'.join(EXAMPLE.findall(TEXTS[page]))
    exec(compile(source, page, 'exec'), {'__name__': Path(page).stem})
    assert page == 'docs/batches.md' or capsys.readouterr().out
