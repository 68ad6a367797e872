"""The style of ROS 2: what ament_flake8 and ament_pep257 check, with tools that can fail."""

from pathlib import Path
import subprocess
import sys

import pytest

ROOT = Path(__file__).resolve().parents[2]
SOURCES = [*sorted(path.name for path in ROOT.glob('push_*') if path.is_dir()),
           'test', 'launch', 'setup.py', 'docs/tools', 'examples',
           *(path.name for path in ROOT.glob('benchmarks'))]
PEP257_IGNORED = 'D100,D101,D102,D103,D104,D105,D106,D107,D203,D212,D404'
FLAKE8 = [sys.executable, '-m', 'flake8', '--config', str(ROOT / 'setup.cfg'), '--jobs', '1']
PEP257 = [sys.executable, '-m', 'pydocstyle', f'--ignore={PEP257_IGNORED}', '--match=.*\\.py']
OFFENCES = [
    (FLAKE8, 'Q000', 'TEXT = "double"\n'),
    (FLAKE8, 'E501', f"TEXT = '{'x' * 92}'\n"),
    (FLAKE8, 'I100', 'import sys\nimport os\n\nprint(os, sys)\n'),
    (FLAKE8, 'F401', 'import os\n'),
    (FLAKE8, 'C901', 'def f(x):\n' + ''.join(
        f'    if x == {n}:\n        print({n})\n' for n in range(10))),
    (FLAKE8, 'B902', 'try:\n    print()\nexcept Exception:\n    print()\n'),
    (PEP257, 'D213', 'def f():\n    """Summary.\n\n    More.\n    """\n'),
    (PEP257, 'D400', 'def f():\n    """Summary without a full stop"""\n'),
    (PEP257, 'D401', 'def f():\n    """Summary not in the imperative mood."""\n'
                     '\n\ndef g():\n    """Returns a value."""\n'),
]


def run(linter, paths):
    """Run a linter over paths below the root; return its exit status and findings."""
    done = subprocess.run([*linter, *paths], cwd=ROOT, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True)
    return done.returncode, done.stdout


@pytest.mark.slow
@pytest.mark.parametrize('linter', [FLAKE8, PEP257], ids=['flake8', 'pep257'])
def test_sources_keep_the_style(linter):
    """No findings in the whole tree."""
    status, findings = run(linter, SOURCES)
    assert status == 0 and not findings, findings


@pytest.mark.parametrize('linter, code, source', OFFENCES, ids=[item[1] for item in OFFENCES])
def test_an_offence_is_found(tmp_path, linter, code, source):
    """Each linter, called the same way, names the offence."""
    path = tmp_path / 'sample.py'
    path.write_text(source)
    status, findings = run(linter, [str(path)])
    assert status != 0
    assert code in findings
