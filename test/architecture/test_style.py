"""The style of ROS 2: what ament_flake8 and ament_pep257 check, by a linter that can fail."""

from pathlib import Path
import re
import subprocess
import sys

import pytest

ROOT = Path(__file__).resolve().parents[2]
SOURCES = [*sorted(path.name for path in ROOT.glob('push_*') if path.is_dir()),
           'test', 'launch', 'setup.py', 'docs/tools', 'examples',
           *(path.name for path in ROOT.glob('benchmarks'))]
FLAKE8 = [sys.executable, '-m', 'flake8', '--config', str(ROOT / 'setup.cfg'), '--jobs', '1']
# Code of the offence: a file that has it.
OFFENCES = {
    'Q000': 'TEXT = "double"\n',
    'E501': f"TEXT = '{'x' * 92}'\n",
    'I100': 'import sys\nimport os\n\nprint(os, sys)\n',
    'F401': 'import os\n',
    'C901': 'def f(x):\n' + ''.join(
        f'    if x == {n}:\n        print({n})\n' for n in range(10)),
    'B902': 'try:\n    print()\nexcept Exception:\n    print()\n',
    'D213': 'def f():\n    """Summary.\n\n    More.\n    """\n',
    'D400': 'def f():\n    """Summary without a full stop"""\n',
    'D401': 'def f():\n    """Summary not in the imperative mood."""\n'
            '\n\ndef g():\n    """Returns a value."""\n',
}


def run(paths):
    """Run the linter over paths below the root; return its exit status and findings."""
    done = subprocess.run([*FLAKE8, *paths], cwd=ROOT, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True)
    return done.returncode, done.stdout


@pytest.mark.slow
def test_sources_keep_the_style():
    """No findings in the whole tree."""
    status, findings = run(SOURCES)
    assert status == 0 and not findings, findings


@pytest.fixture(scope='module')
def offences(tmp_path_factory):
    """Check a file for each offence, called the same way; return status and findings."""
    folder = tmp_path_factory.mktemp('offences')
    for code, source in OFFENCES.items():
        (folder / f'{code}.py').write_text(source)
    return run([str(folder)])


@pytest.mark.parametrize('code', OFFENCES)
def test_an_offence_is_found(offences, code):
    """The linter names the offence."""
    status, findings = offences
    assert status != 0
    assert re.search(rf'{code}\.py:\d+:\d+: {code} ', findings), findings
