"""
Test the tests: plant one mistake after the other, and see whether they notice it.

Results are kept in a file; Ctrl-C ends the run, and --resume continues it.
"""

import argparse
from collections.abc import Sequence
import json
from pathlib import Path
import sys
import time

from benchmarks.mutants.catalogue import GROUPS
from benchmarks.mutants.mutant import Mutant
from benchmarks.mutants.runner import copied_tree, MutantTester, Result

RESULTS = Path('out') / 'mutants.jsonl'
# Part of the mutants that has to be killed.
REQUIRED_RATIO = 0.95
# Exit status of a program that Ctrl-C has ended, as shells have it.
INTERRUPTED = 130


def main(arguments: Sequence[str] | None = None) -> int:
    """
    Run the tests.

    :param arguments: command line; None for that of the process.
    :return: exit status: 1 where too few mutants are killed.
    """
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--group', action='append', choices=list(GROUPS),
                        help='again for more; all by default')
    parser.add_argument('--only', default='', metavar='TEXT', help='mutants whose name has it')
    parser.add_argument('--results', type=Path, default=RESULTS, help='file of the results')
    parser.add_argument('--resume', action='store_true',
                        help='leave out what was killed in the file of the results')
    parser.add_argument('--brief', action='store_true',
                        help='run only the first tests of each mutant; what survives may be '
                        'killed by others')
    options = parser.parse_args(arguments)
    chosen = {(group, mutant): None for group in options.group or GROUPS
              for mutant in GROUPS[group] if options.only in mutant.name}
    try:
        return _run(list(chosen), options)
    except KeyboardInterrupt:
        print('\ninterrupted; --resume continues')
        return INTERRUPTED


def _run(chosen: Sequence[tuple[str, Mutant]], options: argparse.Namespace) -> int:
    path: Path = options.results
    if not options.resume:
        path.unlink(missing_ok=True)
    path.parent.mkdir(parents=True, exist_ok=True)
    results = _read(path)
    remaining = [(group, mutant) for group, mutant in chosen
                 if results.get((group, mutant.name)) is not Result.KILLED]
    start = time.monotonic()
    with copied_tree() as copy:
        tester = MutantTester(copy)
        for number, (group, mutant) in enumerate(remaining, 1):
            result = results[group, mutant.name] = tester.test(mutant, options.brief)
            with path.open('a', encoding='utf-8') as file:
                file.write(json.dumps([group, mutant.name, result.value]) + '\n')
            minutes = (time.monotonic() - start) / 60.0 * (len(remaining) / number - 1.0)
            print(f'{number} of {len(remaining)}, {minutes:.0f} min left: {group}: {mutant.name}: '
                  f'{result.value}', flush=True)
    return _summarize([(group, mutant, results[group, mutant.name]) for group, mutant in chosen])


def _read(path: Path) -> dict[tuple[str, str], Result]:
    if not path.is_file():
        return {}
    lines = [json.loads(line) for line in path.read_text(encoding='utf-8').splitlines()]
    return {(group, name): Result(value) for group, name, value in lines}


def _summarize(results: Sequence[tuple[str, Mutant, Result]]) -> int:
    for group, mutant, result in results:
        if result is not Result.KILLED:
            print(f'{result.value}: {group}: {mutant.name} ({mutant.file})')
    killed = sum(result is Result.KILLED for _, _, result in results)
    print(f'{killed} of {len(results)} mutants killed')
    return int(killed < REQUIRED_RATIO * len(results))


if __name__ == '__main__':
    sys.exit(main())
