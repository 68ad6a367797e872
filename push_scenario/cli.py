"""Command line: replay a scenario over DDS or in one process, judge it, draw it."""

import argparse
from pathlib import Path
import sys
import time

from push_control.settings import LAWS
from push_scenario.batch.interrupts import Interrupts
from push_scenario.definition.loader import (
    find_scenario, read_scenario, scenario_names, scenario_text,
)
from push_scenario.evaluation.metrics import is_as_expected, is_task_as_expected
from push_scenario.evaluation.report import table
from push_scenario.evaluation.task_report import task_table
from push_scenario.simulation import loop as closed_loop
from push_scenario.simulation.loop import run_task

TERMINAL_PERIOD = 0.1
LOG_PERIOD = 5.0


class ProgressLine:
    """
    Shows a run's progress: one line that is written over in a terminal, else a line now and then.

    :param stream: where to write, such as ``sys.stderr``.
    :param clock: function that returns wall-clock seconds.
    :param title: what is running.
    """

    def __init__(self, stream, clock, title):
        self._stream, self._clock, self._title = stream, clock, title
        self._terminal = stream.isatty()
        self._began = self._shown = clock()
        self._since = None
        self._stage, self._width = '', 0

    def __call__(self, progress):
        """
        Show progress, unless something was shown a moment ago.

        :param progress: the ``Progress``.
        """
        now = self._clock()
        if progress.stage != 'planning' and self._since is None:
            self._since = now, progress.time
        period = TERMINAL_PERIOD if self._terminal else LOG_PERIOD
        if progress.stage == self._stage and now - self._shown < period:
            return
        self._stage, self._shown = progress.stage, now
        self._write(f'{self._title}: {progress.stage}, {progress.time:.1f} s simulated'
                    f'{self._speed(progress.time, now)}, {progress.distance:.3f} m to the goal')

    def end(self, text):
        """
        Write the last line.

        :param text: how it ended.
        """
        self._write(f'{self._title}: {text}, {self._clock() - self._began:.1f} s')
        if self._terminal:
            self._stream.write('\n')
            self._stream.flush()

    def _speed(self, time, now):
        if self._since is None or now - self._since[0] < 0.2:
            return ''
        factor = (time - self._since[1]) / (now - self._since[0])
        return f' at {factor:.1f} x real time'

    def _write(self, text):
        if self._terminal:
            self._stream.write('\r' + text.ljust(self._width))
            self._width = len(text)
        else:
            self._stream.write(text + '\n')
        self._stream.flush()


DEMO = 'task_demo'
AS_EXPECTED, NOT_AS_EXPECTED, MISUSE, INTERRUPTED = 0, 1, 2, 130


def main(arguments=None):
    """
    Run the command line.

    :param arguments: words after the command's name; None for those of the process.
    :return: exit status: 0 where the run (with several, each that is not open loop) ended as its
        scenario expects, 1 where it did not, 2 on an error, 130 when interrupted.
    """
    parser = _parser()
    options = parser.parse_args(arguments)
    if options.list:
        _list_scenarios()
        return AS_EXPECTED
    if options.demo:
        options.scenario = options.scenario or DEMO
    if not options.scenario:
        parser.error('the following arguments are required: SCENARIO (or --list, or --demo)')
    try:
        return _replay(options)
    except (ValueError, OSError, RuntimeError) as error:
        return _complain(error, MISUSE)


def _parser():
    parser = argparse.ArgumentParser(
        prog='replay', description='Replay a pushing scenario and judge it. Exit status 0 only '
        'if the run ends as the scenario expects.')
    parser.add_argument('scenario', nargs='?', metavar='SCENARIO',
                        help='path of a scenario file, or the name of one that comes with the '
                        'package')
    parser.add_argument('--list', action='store_true', help='list the scenarios and exit')
    parser.add_argument('--demo', action='store_true',
                        help=f'replay {DEMO}; pictures are demo.png and demo.gif')
    parser.add_argument('--law', action='append', choices=LAWS,
                        help="control law instead of the scenario's; may be repeated, to "
                        'compare')
    parser.add_argument('--in-process', action='store_true',
                        help='without ROS: the same planner, controller and plant in one process')
    parser.add_argument('--real-time', action='store_true',
                        help='over DDS on the wall clock, not in lockstep')
    parser.add_argument('--out', type=Path, default=Path('out'), metavar='DIR',
                        help='where tapes, pictures and recordings go (default: out)')
    parser.add_argument('--no-record', action='store_true', help='no MCAP recording')
    parser.add_argument('--no-pictures', action='store_true', help='no PNG and no GIF')
    return parser


def _complain(text, status):
    begin = '\n' if sys.stderr.isatty() else ''
    print(f'{begin}replay: {text}', file=sys.stderr)
    return status


def _list_scenarios():
    names = scenario_names()
    width = max(map(len, names))
    for name in names:
        print(f'{name.ljust(width)}  {read_scenario(find_scenario(name)).description}')


def _replay(options):
    if options.in_process and options.real_time:
        raise ValueError('--real-time: got --in-process too, expected one of the two')
    scenario = read_scenario(find_scenario(options.scenario))
    laws = list(dict.fromkeys(options.law or [scenario.control.control_law]))
    options.out.mkdir(parents=True, exist_ok=True)
    (options.out / f'{scenario.name}.yaml').write_text(scenario_text(scenario), encoding='utf-8')
    results = []
    try:
        with Interrupts() as interrupts:
            for law in laws:
                results.append(_run(scenario, law, options, interrupts))
            _finish(results, options)
            interrupts.check()
    except KeyboardInterrupt:
        if results:
            print(_table(results))
        return _complain('interrupted', INTERRUPTED)
    judged = [r for r in results if r.control_law != 'open_loop'] or results
    judge = is_as_expected if scenario.task is None else is_task_as_expected
    return AS_EXPECTED if all(map(judge, judged)) else NOT_AS_EXPECTED


def _run(scenario, law, options, interrupts):
    line = ProgressLine(sys.stderr, time.monotonic, f'{scenario.name}, {law}')

    def show(progress):
        interrupts.check()
        line(progress)

    if options.in_process:
        # As over DDS in lockstep, time stands still while a task is planned.
        result = (closed_loop.run(scenario, law, show) if scenario.task is None else
                  run_task(scenario, law, show, planning_time=0.0))
    else:
        run_over_dds = _dds_replay()
        result = run_over_dds(scenario, law, options.out, real_time=options.real_time,
                              record=not options.no_record, progress=show)
    line.end(result.outcome)
    if result.tape is not None:
        result.tape.save(options.out / f'{scenario.name}_{law}.csv')
    return result


def _table(results):
    return (table if results[0].scenario.task is None else task_table)(results)


def _dds_replay():
    try:
        from push_ros.dds_replay import run_over_dds
    except ModuleNotFoundError as error:
        raise RuntimeError(f'a replay over DDS needs ROS 2: no module {error.name}; source a ROS '
                           'installation, or use --in-process') from error
    return run_over_dds


def _finish(results, options):
    print(_table(results), flush=True)
    written = [bag for bag in (getattr(result, 'bag', None) for result in results) if bag]
    if not options.no_pictures and all(result.tape for result in results):
        written += _draw(results, options)
    if written:
        print('written: ' + ', '.join(map(str, written)))


def _draw(results, options):
    try:
        pictures = _pictures(results[0].scenario)
    except ModuleNotFoundError as error:
        print(f'replay: no pictures, for want of the module {error.name}', file=sys.stderr)
        return
    name = 'demo' if options.demo else results[0].scenario.name
    for draw, suffix in zip(pictures, ('png', 'gif')):
        path = options.out / f'{name}.{suffix}'
        line = ProgressLine(sys.stderr, time.monotonic, str(path))
        draw(results, path)
        line.end('drawn')
        yield path


def _pictures(scenario):
    """Return what draws the picture and the animation; matplotlib may be missing."""
    if scenario.task is None:
        from push_scenario.animation import draw_animation
        from push_scenario.figure import draw_figure
        return draw_figure, draw_animation
    from push_scenario.task_animation import draw_task_animation
    from push_scenario.task_figure import draw_task_figure
    return draw_task_figure, draw_task_animation


if __name__ == '__main__':
    sys.exit(main())
