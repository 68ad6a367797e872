"""
Runs the tests of a package with one planted mistake after the other, in a copy of the repository.

Tests that fail without a mistake say nothing: they run once without any first, and how long that
takes bounds how long they may take with one.
"""

from collections.abc import Generator
import contextlib
import enum
import os
from pathlib import Path
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from typing import NamedTuple

from benchmarks.mutants.mutant import Mutant, mutated

TREE = Path(__file__).parents[2]
# Time that tests may take with a mistake: over that without one, and besides [s]; chosen: other
# programs may be busy, and failures are written down.
TIME_RATIO, TIME_MARGIN = 3.0, 60.0


class Result(enum.Enum):
    """What tests have made of a mutant."""

    KILLED = 'killed'
    SURVIVED = 'survived'
    # They did not end in time, or by a signal: it is noticed, but not by an assertion.
    HUNG = 'hung'


class Run(NamedTuple):
    """
    A run of tests.

    :param status: exit status, negative for a signal; None where they did not end in time.
    :param duration: [s].
    """

    status: int | None
    duration: float


class FailingTests(RuntimeError):
    """Tests fail without any mistake."""


@contextlib.contextmanager
def copied_tree(tree: Path = TREE) -> Generator[Path, None, None]:
    """
    Copy the files of a repository to a scratch folder, for as long as it is needed.

    :param tree: top of the repository.
    """
    listed = subprocess.run(
        ['git', 'ls-files', '--cached', '--others', '--exclude-standard', '-z'], cwd=tree,
        check=True, capture_output=True, text=True).stdout
    with tempfile.TemporaryDirectory(prefix='mutants') as folder:
        for name in filter(None, listed.split('\0')):
            if (tree / name).is_file():
                (Path(folder) / name).parent.mkdir(parents=True, exist_ok=True)
                shutil.copy2(tree / name, Path(folder) / name)
        yield Path(folder)


class MutantTester:
    """Runs tests in a copy of the repository."""

    def __init__(self, copy: Path) -> None:
        """
        Run none yet.

        :param copy: top of the copy.
        """
        self._copy = copy
        # How long tests take without a mistake [s].
        self._durations: dict[str, float] = {}

    def test(self, mutant: Mutant, is_brief: bool = False) -> Result:
        """
        Run the tests of a mutant.

        :param mutant: the ``Mutant``.
        :param is_brief: whether only the first of its tests are run.
        :raises FailingTests: where they fail without it.
        :raises ValueError: where it cannot be planted.
        """
        path = self._copy / mutant.file
        text = path.read_text(encoding='utf-8')
        planted = mutated(mutant, text)
        result = Result.SURVIVED
        for tests in mutant.tests[:1 if is_brief else None]:
            limit = TIME_MARGIN + TIME_RATIO * self._duration(tests)
            path.write_text(planted, encoding='utf-8')
            try:
                status = self._run(tests, limit).status
            finally:
                path.write_text(text, encoding='utf-8')
            if status is None or status < 0:
                result = Result.HUNG
            elif status != 0:
                return Result.KILLED
        return result

    def _duration(self, tests: str) -> float:
        """Tell how long tests take without a mistake [s]."""
        if tests not in self._durations:
            status, self._durations[tests] = self._run(tests, None)
            if status != 0:
                raise FailingTests(f'{tests}: exit status {status} without any mistake')
        return self._durations[tests]

    def _run(self, tests: str, limit: float | None) -> Run:
        environment = {**os.environ, 'PYTEST_ADDOPTS': '', 'PYTHONPATH': str(self._copy),
                       'PYTHONDONTWRITEBYTECODE': '1'}
        start = time.monotonic()
        # In a group of its own: tests start processes, which have to end with them.
        process = subprocess.Popen(
            [sys.executable, '-m', 'pytest', '-q', '-x', '-p', 'no:cacheprovider', tests],
            cwd=self._copy, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
            start_new_session=True)
        try:
            status = process.wait(limit)
        except subprocess.TimeoutExpired:
            status = None
        finally:
            _end(process)
        return Run(status, time.monotonic() - start)


def _end(process: subprocess.Popen[bytes]) -> None:
    """End a process and all that it has started."""
    with contextlib.suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)
    process.wait()
