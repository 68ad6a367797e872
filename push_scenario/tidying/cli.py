"""Command line ``push tidy``: bring the objects of a room to their goals, in one process."""

import argparse
from collections.abc import Sequence
from pathlib import Path
import sys
import time
from typing import TYPE_CHECKING

from push_dynamics.cache_activity import CacheActivity
from push_model.optional import how_to_install
from push_scenario.interrupts import Interrupts
from push_scenario.progress_line import ProgressLine

if TYPE_CHECKING:
    from push_scenario.simulation.loop import Progress
    from push_scenario.tidying.tidy import MoveResult, TidyProgress, TidyResult

DONE, NOT_DONE, MISUSE, INTERRUPTED = 0, 1, 2, 130


def main(arguments: Sequence[str] | None = None) -> int:
    """
    Run the command line.

    :param arguments: words after the command's name; None for those of the process.
    :return: exit status: 0 where all objects are at their goals, 1 where one is not, 2 on an
        error, 130 when interrupted.
    """
    options = make_parser().parse_args(arguments)
    try:
        return _tidy(options)
    except KeyboardInterrupt:
        print('push tidy: interrupted', file=sys.stderr)
        return INTERRUPTED
    except (ValueError, OSError, RuntimeError) as error:
        print(f'push tidy: {error}', file=sys.stderr)
        return MISUSE


def make_parser() -> argparse.ArgumentParser:
    """Make the parser of the command line."""
    parser = argparse.ArgumentParser(
        prog='push tidy', description='Bring several objects to their goals, one after the other. '
        'The exit status is 0 only if all of them get there.')
    parser.add_argument('file', metavar='FILE',
                        help='YAML file of a room, which is a scenario with several objects; or '
                        'the name of one of config/rooms')
    parser.add_argument('--out', type=Path, default=Path('out'), metavar='DIR',
                        help='directory for the picture (default: out)')
    parser.add_argument('--json', action='store_true',
                        help='print the result as JSON in place of a table')
    parser.add_argument('--no-pictures', action='store_true', help='draw no PNG')
    parser.add_argument('--gif', action='store_true',
                        help='draw an animation (GIF) too: what comes next, and why')
    return parser


def _tidy(options: argparse.Namespace) -> int:
    # Imported here: the help needs none of it.
    from push_model.files.parameter_files import named_file
    from push_scenario.tidying.report import result_json, result_text
    from push_scenario.tidying.room import read_room
    from push_scenario.tidying.tidy import tidy
    room = read_room(named_file('rooms', options.file))
    with Interrupts() as interrupts:
        display = _Display(interrupts)
        result = tidy(room, progress=display.on_plan, run_progress=display.on_progress,
                      after_move=display.on_move)
    print(result_json(result) if options.json else result_text(result),
          end='' if options.json else '\n', flush=True)
    if not options.no_pictures:
        _draw(result, options.out, is_animated=options.gif)
    return DONE if all(map(result.is_placed, result.poses)) else NOT_DONE


def _draw(result: 'TidyResult', folder: Path, *, is_animated: bool) -> None:
    """Draw the pictures; without matplotlib, say how to install it."""
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f'{result.room.name}.png'
    try:
        from push_scenario.tidying.animation import draw_room_animation
        from push_scenario.tidying.picture import draw_room
    except ModuleNotFoundError as error:
        print(f'push tidy: no {path.name}: {how_to_install(error.name or "")}', file=sys.stderr)
        return
    draw_room(result, path)
    print(f'written: {path}', file=sys.stderr)
    if is_animated:
        draw_room_animation(result, path.with_suffix('.gif'))
        print(f'written: {path.with_suffix(".gif")}', file=sys.stderr)


class _Display:
    """Shows progress: a line for each move, which is overwritten in a terminal."""

    def __init__(self, interrupts: Interrupts) -> None:
        self._interrupts = interrupts
        self._line: ProgressLine | None = None

    def on_plan(self, progress: 'TidyProgress') -> None:
        from push_scenario.tidying.report import progress_text
        self._line = ProgressLine(sys.stderr, time.monotonic, progress_text(progress),
                                  CacheActivity())

    def on_progress(self, progress: 'Progress') -> None:
        self._interrupts.check()
        if self._line is not None:
            self._line(progress)

    def on_move(self, result: 'MoveResult') -> None:
        if self._line is not None:
            run = result.run
            self._line.end(f'{run.outcome.value} after {run.duration:.1f} s'
                           + (f', {run.reason}' if run.reason else ''))


if __name__ == '__main__':
    sys.exit(main())
