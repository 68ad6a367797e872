"""
The style of ROS 2: what ament_flake8 and ament_pep257 check, by a linter that can fail.

The linter looks at one file at a time, and takes half a minute for all. What it has passed is
noted in pytest's cache, so that only files are checked that have changed since.
"""

import hashlib
from importlib import metadata
from pathlib import Path
import re
import subprocess
import sys
from typing import Iterable, NamedTuple

from helpers.architecture import files
import pytest

ROOT = Path(__file__).resolve().parents[2]
SOURCES = [*sorted(path.name for path in ROOT.glob('push_*') if path.is_dir()),
           'test', 'launch', 'setup.py', 'docs', 'examples',
           *(name for name in ('benchmarks', 'studies') if (ROOT / name).is_dir())]
FLAKE8 = [sys.executable, '-m', 'flake8', '--config', str(ROOT / 'setup.cfg'), '--jobs', '1']
# Key in pytest's cache: digests of files without findings.
PASSED = 'style/passed'
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


class Result(NamedTuple):
    """What the linter returned and printed."""

    status: int
    findings: str


def run(paths: Iterable[str | Path]) -> Result:
    """Run the linter over paths below the root."""
    done = subprocess.run([*FLAKE8, *map(str, paths)], cwd=ROOT, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True)
    return Result(done.returncode, done.stdout)


def sources() -> list[Path]:
    """List the files below ``SOURCES``."""
    found: list[Path] = []
    for name in SOURCES:
        path = ROOT / name
        found += [path] if path.is_file() else sorted(path.rglob('*.py'))
    return found


def linter_digest() -> bytes:
    """Digest what findings depend on besides a file: settings, and all that is installed."""
    installed = sorted(f'{found.name} {found.version}' for found in metadata.distributions())
    settings = (ROOT / 'setup.cfg').read_bytes()
    return '\n'.join([sys.version, *FLAKE8, *installed]).encode() + settings


@pytest.mark.slow
def test_sources_keep_the_style(cache: pytest.Cache) -> None:
    """No findings in the whole tree."""
    linter = linter_digest()
    digests = {path: hashlib.sha256(
        linter + str(path.relative_to(ROOT)).encode() + path.read_bytes()).hexdigest()
        for path in sources()}
    passed = set(cache.get(PASSED, []))
    changed = [path for path, digest in digests.items() if digest not in passed]
    if changed:
        status, findings = run(changed)
        assert status == 0 and not findings, findings
    cache.set(PASSED, sorted(digests.values()))


def test_the_linter_is_given_every_source() -> None:
    """No package and no folder with Python is forgotten."""
    missing = {path.relative_to(ROOT).as_posix() for path in files(ROOT)
               if path.suffix == '.py' and path.is_file()} - {
        path.relative_to(ROOT).as_posix() for path in sources()}
    assert missing == set()


@pytest.fixture(scope='module')
def offences(tmp_path_factory: pytest.TempPathFactory) -> Result:
    """Check a file for each offence, called the same way."""
    folder = tmp_path_factory.mktemp('offences')
    for code, source in OFFENCES.items():
        (folder / f'{code}.py').write_text(source)
    return run(sorted(folder.iterdir()))


@pytest.mark.parametrize('code', OFFENCES)
def test_an_offence_is_found(offences: Result, code: str) -> None:
    """The linter names the offence."""
    assert offences.status != 0
    assert re.search(rf'{code}\.py:\d+:\d+: {code} ', offences.findings), offences.findings
