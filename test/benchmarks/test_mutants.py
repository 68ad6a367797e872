"""Mutants: a mistake is planted where it should be, and tests are found to notice it or not."""

from pathlib import Path
import subprocess

from benchmarks.mutants.catalogue import GROUPS
from benchmarks.mutants.mutant import check, Mutant, mutated
from benchmarks.mutants.runner import (
    copied_tree, FailingTests, MutantTester, Result, TREE)
import pytest

CODE = 'def double(x):\n    return 2 * x\n'
TEST = 'from code_here import double\n\n\ndef test_it():\n    assert double({0}) == {1}\n'
MUTANT = Mutant('it does not double', 'code_here.py', '2 * x', '1 * x', ('test_it.py',))


def make_tree(folder: Path, test: str) -> Path:
    """Make a repository of a module and its test."""
    (folder / 'code_here.py').write_text(CODE)
    (folder / 'test_it.py').write_text(test)
    subprocess.run(['git', 'init', '-q'], cwd=folder, check=True)
    return folder


@pytest.mark.slow
@pytest.mark.parametrize('value, result', [(3, Result.KILLED), (0, Result.SURVIVED)])
def test_a_mutant_survives_tests_that_do_not_notice_it(tmp_path: Path, value: int,
                                                       result: Result) -> None:
    """The repository stays as it is, and so does the copy."""
    tree = make_tree(tmp_path, TEST.format(value, 2 * value))
    with copied_tree(tree) as copy:
        assert MutantTester(copy).test(MUTANT) is result
        assert (copy / 'code_here.py').read_text() == CODE
    assert (tree / 'code_here.py').read_text() == CODE and not copy.exists()


@pytest.mark.slow
def test_tests_that_fail_without_a_mistake_say_nothing(tmp_path: Path) -> None:
    """They are named."""
    with copied_tree(make_tree(tmp_path, TEST.format(1, 1))) as copy:
        with pytest.raises(FailingTests, match='test_it.py'):
            MutantTester(copy).test(MUTANT)


@pytest.mark.parametrize('text', ['', '2 * x + 2 * x'])
def test_a_mistake_has_one_place(text: str) -> None:
    """A list that is out of date is noticed."""
    with pytest.raises(ValueError, match='expected one'):
        mutated(MUTANT, text)


def test_mutants_have_names_of_their_own_and_tests(tmp_path: Path) -> None:
    """Each of more than sixty has its place; one whose tests are gone is refused."""
    mutants = [mutant for group in GROUPS.values() for mutant in group]
    assert len({mutant.name for mutant in mutants}) == len(mutants) > 60
    for mutant in mutants:
        assert mutant.old != mutant.new
        check(mutant, TREE)
    make_tree(tmp_path, TEST)
    check(MUTANT, tmp_path)
    with pytest.raises(ValueError, match='expected a file or folder'):
        check(MUTANT._replace(tests=('gone.py',)), tmp_path)
