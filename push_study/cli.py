"""Command line: list the studies and run them."""

import argparse
from pathlib import Path
import sys

from push_scenario.batch.interrupts import Interrupts
from push_study import catalogue, gallery
from push_study.framework.run import Runner
from push_study.framework.values import read_overrides, read_table, refuse_unknown, values_of
from push_study.maps import cli_drive, cli_regions
from tqdm import tqdm

DONE, MISUSE, INTERRUPTED = 0, 2, 130
BAR = '{desc} {percentage:3.0f}% |{bar:30}| {elapsed}, {remaining} left'


def main(arguments=None):
    """
    Run the command line.

    :param arguments: words after the command's name; None for those of the process.
    :return: exit status: 0 where all is made, 2 on an error, 130 when interrupted.
    """
    options = _parser().parse_args(arguments)
    try:
        return options.action(options)
    except KeyboardInterrupt:
        return _complain('interrupted; the same command goes on', INTERRUPTED)
    except (ValueError, OSError, RuntimeError) as error:
        return _complain(error, MISUSE)


def _parser():
    parser = argparse.ArgumentParser(
        prog='push-study', description='Compute and draw how pushed objects behave: the figures '
        'of the thesis, and maps beyond it.')
    actions = parser.add_subparsers(required=True, metavar='ACTION')
    listing = actions.add_parser('list', help='list the studies and their parameters')
    listing.set_defaults(action=_list)
    listing.add_argument('study', nargs='*', metavar='STUDY', help='with all parameters of these')
    run = actions.add_parser('run', help='compute and draw studies, as PNG, SVG and CSV')
    run.set_defaults(action=_run)
    run.add_argument('study', nargs='+', metavar='STUDY',
                     help='number such as 2.11, chapter such as chapter2, or all')
    run.add_argument('--set', action='append', default=[], metavar='NAME=VALUE',
                     help='another value for a parameter; may be given more than once')
    run.add_argument('--page', type=Path, metavar='FILE',
                     help='Markdown page in which to fill the gallery in')
    regions = cli_regions.register(actions, run_studies)
    drive = cli_drive.register(actions, run_studies)
    for each in (run, regions, drive):
        _add_common(each)
    return parser


def _add_common(parser):
    parser.add_argument('--out', type=Path, default=Path('out') / 'studies', metavar='DIR',
                        help='where files go (default: out/studies)')
    parser.add_argument('--jobs', type=_count, metavar='N',
                        help='number of processes (default: one per core)')
    parser.add_argument('--scheduler', metavar='ADDRESS', help='Dask cluster to run on instead')


def _count(text):
    if not text.isdigit() or int(text) < 1:
        raise argparse.ArgumentTypeError(f'got {text!r}, expected a whole number of at least 1')
    return int(text)


def _complain(text, status):
    print(f'push-study: {text}', file=sys.stderr)
    return status


def _list(options):
    table = read_table()
    if not options.study:
        for study in catalogue.studies():
            print(f'{study.figure:<6} {study.title}')
        return DONE
    for study in catalogue.select(options.study):
        print(f'{study.figure:<6} {study.title}')
        for value in values_of(study, table):
            print(f'         {value.text()} ({value.source}): {value.parameter.meaning}')
    return DONE


def _run(options):
    chosen = catalogue.select(options.study)
    overrides = read_overrides(options.set)
    refuse_unknown(overrides, chosen)
    return run_studies(chosen, overrides, options)


def run_studies(chosen, overrides, options, table=None):
    """
    Run studies with a bar, and tell what they found.

    :param chosen: sequence of ``Study``.
    :param overrides: dict of parameter names to values.
    :param options: with ``out``, ``jobs``, ``scheduler``, and ``page`` or None.
    :param table: values as of ``read_table``; None for those of ``config/studies.yaml``.
    :return: exit status.
    """
    done = []
    with _bar(len(chosen)) as bar, Interrupts() as interrupts:
        def progress(jobs, total):
            # A batch is a part of its study; the study itself counts when it is drawn.
            bar.update(len(done) + 0.9 * jobs / total - bar.n if jobs else 0.0)

        runner = Runner(options.out, table or read_table(), overrides, options.jobs,
                        options.scheduler, progress)
        for study in chosen:
            bar.set_description(study.figure)
            done.append(runner(study))
            bar.update(len(done) - bar.n)
            interrupts.check()
    for one in done:
        print(f'{one.files.png}{" (kept)" if one.kept else ""}: {one.study.title}')
        for found in one.findings.values():
            print(f'    {found.meaning}: {found.value:.4g} {found.unit}'.rstrip())
    if options.page is not None:
        text = gallery.fill(options.page.read_text(encoding='utf-8'),
                            gallery.page(done, options.page.parent))
        options.page.write_text(text, encoding='utf-8')
    return DONE


def _bar(count):
    period = 0.1 if sys.stderr.isatty() else 5.0
    return tqdm(total=count, file=sys.stderr, miniters=0, mininterval=period, bar_format=BAR)


if __name__ == '__main__':
    sys.exit(main())
