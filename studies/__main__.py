"""Command line: list the studies and run them."""

import argparse
from collections.abc import Generator
from concurrent.futures import Executor
import contextlib
import os
from pathlib import Path
import sys
from typing import Any, Sequence

from push_scenario.interrupts import Interrupts
from studies import catalogue, gallery, schedule
from studies.experiment.recorded import read_experiment, save_picture, summary, Topics
from studies.framework.parameters import (
    check_known, ChosenValues, Overrides, read_chosen_values, read_overrides,
)
from studies.framework.runner import StudyResult, StudyRunner
from studies.framework.study import Study
from studies.maps import commands
from studies.recordings import block, page, prediction, repeats
from tqdm import tqdm

EXIT_DONE = 0
EXIT_MISUSE = 2
# As of a shell: 128 plus the number of SIGINT.
EXIT_INTERRUPTED = 130
# Likewise, of SIGPIPE.
EXIT_BROKEN_PIPE = 141
BAR_FORMAT = '{desc} {percentage:3.0f}% |{bar:30}| {elapsed}, {remaining} left'
# Chosen: jobs fill the bar of their study up to here; the rest is for drawing.
JOBS_FRACTION = 0.9


def main(arguments: Sequence[str] | None = None) -> int:
    """
    Run the command line.

    :param arguments: words after the command's name; None for those of the process.
    :return: exit status: 0 when everything is done, 2 on an error, 130 when interrupted.
    """
    options = make_parser().parse_args(arguments)
    try:
        options.action(options)
    except KeyboardInterrupt:
        return _complain('interrupted; the same command continues', EXIT_INTERRUPTED)
    except BrokenPipeError:
        # Nobody reads on, as behind ``| head``; what is in the buffer goes nowhere.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return EXIT_BROKEN_PIPE
    except (ValueError, OSError, RuntimeError) as error:
        return _complain(str(error), EXIT_MISUSE)
    return EXIT_DONE


def make_parser() -> argparse.ArgumentParser:
    """Make the parser of the command line."""
    parser = argparse.ArgumentParser(
        prog='push study', description='Compute and draw how pushed objects behave: the '
        'figures of the thesis, and stable regions of any object.')
    actions = parser.add_subparsers(required=True)
    listing = actions.add_parser('list', help='list the studies and their parameters')
    listing.set_defaults(action=_list)
    listing.add_argument('study', nargs='*', metavar='STUDY',
                         help='list these only, with all their parameters')
    run = actions.add_parser('run', help='compute and draw studies, as PNG, SVG and CSV')
    run.set_defaults(action=_run)
    run.add_argument('study', nargs='+', metavar='STUDY',
                     help='number such as 2.11, chapter such as chapter2, or all')
    run.add_argument('--set', action='append', default=[], metavar='NAME=VALUE',
                     help='another value for a parameter; may be given more than once')
    run.add_argument('--page', type=Path, metavar='FILE',
                     help='Markdown page in which to insert the gallery')
    data = actions.add_parser('data', help='predict recorded pushes of a block')
    data.set_defaults(action=_predict_recordings)
    data.add_argument('folder', type=Path, metavar='FOLDER',
                      help='recordings, see docs/reports/real_pushes.md')
    data.add_argument('--repeats', type=Path, metavar='FOLDER',
                      help='logs of repeated pushes, for the noise floor')
    data.add_argument('--out', type=Path, default=Path('out') / 'studies', metavar='DIR',
                      help='where the picture goes (default: out/studies)')
    data.add_argument('--page', type=Path, metavar='FILE',
                      help='Markdown page in which to insert the tables')
    experiment = actions.add_parser('experiment', help='draw recorded straight pushes on a side')
    experiment.set_defaults(action=_draw_experiment)
    experiment.add_argument('bag', nargs='+', metavar='NAME=BAG',
                            help='recordings of a box, see docs/experiment.md')
    experiment.add_argument('--odom', default='odom', metavar='TOPIC', help='poses of the robot')
    experiment.add_argument('--object-pose', default='object_pose', metavar='TOPIC',
                            help='poses of the object')
    experiment.add_argument('--out', type=Path, default=Path('out') / 'studies', metavar='DIR',
                            help='where the picture goes (default: out/studies)')
    for subparser in (run, commands.register(actions, _run_map)):
        _add_common_options(subparser)
    return parser


def _add_common_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument('--out', type=Path, default=Path('out') / 'studies', metavar='DIR',
                        help='where files go (default: out/studies)')
    parser.add_argument('--jobs', type=_count, metavar='N',
                        help='number of processes (default: one per core)')
    parser.add_argument('--scheduler', metavar='ADDRESS', help='Dask cluster to run on instead')


def _count(text: str) -> int:
    if not text.isdigit() or int(text) < 1:
        raise argparse.ArgumentTypeError(f'got {text!r}, expected a whole number of at least 1')
    return int(text)


def _complain(text: str, status: int) -> int:
    print(f'push study: {text}', file=sys.stderr)
    return status


def _list(options: argparse.Namespace) -> None:
    chosen = read_chosen_values()
    for study in catalogue.select(options.study or ['all']):
        values = study.values(chosen)
        print(f'{study.figure:<6} {study.title_of(values)}')
        for value in values if options.study else ():
            print(f'         {value.text()} ({value.source.value}): {value.parameter.meaning}')


def _run(options: argparse.Namespace) -> None:
    studies = catalogue.select(options.study)
    overrides = read_overrides(options.set)
    check_known(overrides, [parameter for study in studies for parameter in study.parameters])
    results = _run_studies(studies, read_chosen_values(), overrides, options)
    if options.page is not None:
        text = gallery.insert(options.page.read_text(encoding='utf-8'),
                              gallery.page(results, options.page.parent))
        options.page.write_text(text, encoding='utf-8')


def _predict_recordings(options: argparse.Namespace) -> None:
    recordings = block.read_recordings(options.folder)
    reports = prediction.reports(recordings)
    options.out.mkdir(parents=True, exist_ok=True)
    picture = options.out / 'real_pushes.png'
    page.save_picture(reports, picture)
    folder = options.page.parent if options.page else Path()
    text = page.page(reports, os.path.relpath(picture, folder).replace(os.sep, '/'))
    if options.repeats is not None:
        text = f'{page.repeats_text(repeats.read_repeats(options.repeats))}\n\n{text}'
    print(text)
    if options.page is not None:
        shown = options.page.read_text(encoding='utf-8')
        options.page.write_text(gallery.insert(shown, text), encoding='utf-8')


def _draw_experiment(options: argparse.Namespace) -> None:
    trials = read_experiment(options.bag, Topics(options.odom, options.object_pose))
    print(summary(trials))
    print(f'written: {save_picture(trials, options.out)}')


def _run_map(study: Study, chosen: ChosenValues, overrides: Overrides,
             options: argparse.Namespace) -> None:
    _run_studies([study], chosen, overrides, options)


def _run_studies(studies: Sequence[Study], chosen: ChosenValues, overrides: Overrides,
                 options: argparse.Namespace) -> list[StudyResult]:
    """Run studies with a progress bar, and print what they found."""
    results: dict[str, StudyResult] = {}
    with (contextlib.ExitStack() as stack, _progress_bar(len(studies)) as bar,
          Interrupts() as interrupts):
        def show(finished: float) -> None:
            # Without progress as well, so that the bar shows how long it has been.
            bar.update(max(0.0, finished - bar.n))

        executor, workers = (stack.enter_context(_cluster(options.scheduler))
                             if options.scheduler else (None, options.jobs))
        runner = StudyRunner(
            options.out, chosen, overrides, workers=workers, executor=executor,
            on_progress=lambda finished, total: show(
                len(results) + JOBS_FRACTION * finished / total))
        old = [study for study in studies if runner.find(study) is not None]
        if executor is None:
            schedule.run_in_processes(
                [study for study in studies if study not in old], options.out, overrides, workers,
                lambda finished: show(len(old) + finished))
        # Those that are finished first, so that the bar does not go back.
        for study in sorted(studies, key=lambda study: runner.find(study) is None):
            bar.set_description(study.figure)
            result = runner.run(study)
            results[study.figure] = result._replace(is_cached=study in old)
            show(len(results))
            interrupts.check()
    for study in studies:
        _print(results[study.figure])
    return [results[study.figure] for study in studies]


@contextlib.contextmanager
def _cluster(address: str) -> Generator[tuple[Executor, int], None, None]:
    """Connect to a Dask cluster; yield its executor and the number of its threads."""
    try:
        import distributed
    except ImportError as error:
        raise ValueError(f'--scheduler: got {address}, expected that distributed is installed '
                         '(extra "cluster")') from error
    client: Any = distributed.Client(address, set_as_default=False)
    with client:
        yield client.get_executor(pure=False), max(1, sum(client.nthreads().values()))


def _print(result: StudyResult) -> None:
    note = ' (up to date)' if result.is_cached else ''
    print(f'{result.files.png}{note}: {result.title}')
    for finding in result.findings.values():
        print(f'    {finding.meaning}: {finding.value:.4g} {finding.unit}'.rstrip())


def _progress_bar(count: int) -> 'tqdm[Any]':
    # Every 5 s into a file, so that a log stays short.
    period = 0.1 if sys.stderr.isatty() else 5.0
    return tqdm(total=count, file=sys.stderr, miniters=0, mininterval=period,
                bar_format=BAR_FORMAT)


if __name__ == '__main__':
    sys.exit(main())
