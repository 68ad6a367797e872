"""
Command line ``push replay``: run a scenario over DDS or in one process, report on it, draw it.

What runs a scenario is imported where it is used: the list of scenarios and the help need none of
it, and are there at once.
"""

import argparse
from collections.abc import Callable, Iterator, Sequence
import dataclasses
from importlib import util
import math
from pathlib import Path
import sys
import time
from typing import TextIO, TYPE_CHECKING

from push_control.settings import LAWS
import push_scenario
from push_scenario.definition.catalogue import (
    find_scenario, scenario_description, scenario_names,
)
from push_scenario.interrupts import Interrupts
from push_scenario.terminal_line import TerminalLine

if TYPE_CHECKING:
    from push_scenario.definition.scenario import Scenario
    from push_scenario.simulation.loop import Progress
    from push_scenario.simulation.result import RunResult
    from push_view.belief import BeliefRecorder

DEMO = 'task_demo'
AS_EXPECTED, NOT_AS_EXPECTED, MISUSE, INTERRUPTED = 0, 1, 2, 130
# How often progress is shown: smoothly in a terminal, without flooding a log [s].
TERMINAL_PERIOD = 0.1
LOG_PERIOD = 5.0
# Commands of a recording that are listed where they differ; chosen: the first tell most.
MAX_DIFFERENCES = 5
# What a first run compiles and computes takes longer than this [s]; chosen.
HINT_DELAY = 5.0
# A ratio to wall time is shown once so much of it can be trusted [s].
MIN_TIMED = 0.2


class ProgressLine:
    """
    Shows the progress of a run: one line that is overwritten in a terminal, else a line at times.

    :param stream: where to write, such as ``sys.stderr``.
    :param clock: function that returns wall-clock seconds.
    :param title: what is running.
    """

    def __init__(self, stream: TextIO, clock: Callable[[], float], title: str) -> None:
        self._line = TerminalLine(stream)
        self._clock = clock
        self._title = title
        self._started = self._shown = clock()
        # Wall and simulated time when the latter began to run: until then, nodes start and plan.
        self._first: tuple[float, float] | None = None
        self._last_time = math.inf
        self._stage = ''

    def __call__(self, progress: 'Progress') -> None:
        """Show progress, unless something was shown a moment ago."""
        now = self._clock()
        if self._first is None and progress.time > self._last_time:
            self._first = now, progress.time
        self._last_time = progress.time
        period = TERMINAL_PERIOD if self._line.is_overwritten else LOG_PERIOD
        if progress.stage == self._stage and now - self._shown < period:
            return
        self._stage, self._shown = progress.stage, now
        self._line.write(f'{self._title}: {progress.stage}, {progress.time:.1f} s simulated'
                         f'{self._speed(progress.time, now)}, '
                         f'{progress.distance:.3f} m to the goal{self._hint(now)}')

    def end(self, text: str) -> None:
        """
        Write the last line.

        :param text: how it ended.
        """
        self._line.write(f'{self._title}: {text}, {self._clock() - self._started:.1f} s',
                         is_last=True)

    def _speed(self, time: float, now: float) -> str:
        if self._first is None or now - self._first[0] < MIN_TIMED:
            return ''
        return f' at {(time - self._first[1]) / (now - self._first[0]):.1f} x real time'

    def _hint(self, now: float) -> str:
        """Tell why nothing moves at first."""
        if self._first is not None or now - self._started < HINT_DELAY:
            return ''
        return ' (nodes start and plan; what is used for the first time is compiled: a minute)'


def main(arguments: Sequence[str] | None = None) -> int:
    """
    Run the command line.

    :param arguments: words after the command's name; None for those of the process.
    :return: exit status: 0 where the run (with several, each that is not open loop) ended as its
        scenario expects, 1 where it did not, 2 on an error, 130 when interrupted.
    """
    parser = make_parser()
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
        return _report_error(error, MISUSE)


def make_parser() -> argparse.ArgumentParser:
    """Make the parser of the command line."""
    parser = argparse.ArgumentParser(
        prog='push replay', description='Replay a pushing scenario and evaluate it. The exit '
        'status is 0 only if the run ends as the scenario expects.')
    scenario = parser.add_argument(
        'scenario', nargs='?', metavar='SCENARIO',
        help='path of a scenario file, or name of a scenario of the package')
    # Read by argcomplete.
    setattr(scenario, 'completer', lambda **_: scenario_names())
    parser.add_argument('--list', action='store_true',
                        help='list the scenarios of the package and exit')
    parser.add_argument('--demo', action='store_true',
                        help=f'replay {DEMO}; page and plot are demo.html and demo.png')
    parser.add_argument('--law', action='append', choices=LAWS,
                        help="control law, in place of the scenario's; repeat it to compare laws")
    parser.add_argument('--sensors', metavar='NAME',
                        help="sensors of the simulator, in place of the scenario's: path of a "
                        'file, or name of one of config/sensors; a task expects their poses')
    parser.add_argument('--map', metavar='FILE', type=Path,
                        help="map of a task, in place of the scenario's: YAML file of "
                        'nav2_map_server, or one drawn in characters as in config/maps')
    parser.add_argument('--in-process', action='store_true',
                        help='run planner, controller and simulator in one process, without ROS')
    parser.add_argument('--real-time', action='store_true',
                        help='run over DDS at the speed of the wall clock instead of in lockstep')
    parser.add_argument('--out', type=Path, default=Path('out'), metavar='DIR',
                        help='directory for tapes, plots and recordings (default: out)')
    parser.add_argument('--bag', type=Path, metavar='DIR',
                        help='play a recording of this scenario to the controller, and tell '
                        'whether it commands the same, to the byte')
    parser.add_argument('--no-record', action='store_true', help='write no MCAP recording')
    parser.add_argument('--no-pictures', action='store_true',
                        help='write no page (HTML) and draw no PNG')
    parser.add_argument('--gif', action='store_true', help='draw an animation (GIF) too')
    return parser


def _report_error(text: object, status: int) -> int:
    # In a terminal the line of the progress has no end yet.
    start = '\n' if sys.stderr.isatty() else ''
    print(f'{start}push replay: {text}', file=sys.stderr)
    return status


def _list_scenarios() -> None:
    names = scenario_names()
    width = max(map(len, names))
    for name in names:
        print(f'{name.ljust(width)}  {scenario_description(name)}')


def _replay(options: argparse.Namespace) -> int:
    if options.in_process and options.real_time:
        raise ValueError('--real-time: got --in-process too, expected one of the two')
    scenario = _read_scenario(options)
    if options.bag:
        return _play_back(scenario, options.bag)
    from push_view.belief import BeliefRecorder
    laws = list(dict.fromkeys(options.law or [scenario.control.control_law]))
    _write_scenario(scenario, options.out)
    results: list['RunResult'] = []
    beliefs: list['BeliefRecorder'] = []
    try:
        with Interrupts() as interrupts:
            for law in laws:
                beliefs.append(BeliefRecorder(scenario.object))
                results.append(_run(scenario, law, options, interrupts, beliefs[-1]))
            _finish(results, options, beliefs)
            interrupts.check()
    except KeyboardInterrupt:
        if results:
            print(push_scenario.format_report(results))
        return _report_error('interrupted', INTERRUPTED)
    evaluated = [result for result in results if result.control_law != 'open_loop'] or results
    is_as_expected = all(map(push_scenario.is_as_expected, evaluated))
    return AS_EXPECTED if is_as_expected else NOT_AS_EXPECTED


def _write_scenario(scenario: 'Scenario', folder: Path) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
        (folder / f'{scenario.name}.yaml').write_text(push_scenario.scenario_text(scenario),
                                                      encoding='utf-8')
    except OSError as error:
        raise ValueError(f'--out: got {folder}: {error.strerror}, expected a folder in which '
                         'files can be written') from error


def _read_scenario(options: argparse.Namespace) -> 'Scenario':
    """Read the scenario, with the sensors and the map of the command line."""
    from push_model.files.parameter_files import named_file
    from push_scenario.definition.expected_poses import with_sensors
    from push_scenario.definition.loader import read_scenario, read_sensors, with_map
    scenario = read_scenario(find_scenario(options.scenario))
    if options.sensors:
        sensors = read_sensors(named_file('sensors', options.sensors))
        scenario = (with_sensors(scenario, sensors) if scenario.task is not None
                    else dataclasses.replace(scenario, sensors=sensors))
    return with_map(scenario, options.map) if options.map else scenario


def _play_back(scenario: 'Scenario', bag: Path) -> int:
    """Compare the commands of a recording with those of the present controller."""
    # Imported here: without a recording, in one process, there need be no ROS.
    from push_scenario.dds.bag_playback import play_back
    result = play_back(scenario, bag)
    print(f'{result.commands} commands, {len(result.differences)} differ')
    for difference in result.differences[:MAX_DIFFERENCES]:
        print(f'{difference.time:.3f} s: recorded {tuple(difference.recorded)}, '
              f'computed {tuple(difference.computed)}')
    return NOT_AS_EXPECTED if result.differences else AS_EXPECTED


def _run(scenario: 'Scenario', law: str, options: argparse.Namespace,
         interrupts: Interrupts, belief: 'BeliefRecorder') -> 'RunResult':
    line = ProgressLine(sys.stderr, time.monotonic, f'{scenario.name}, {law}')

    def show(progress: 'Progress') -> None:
        interrupts.check()
        line(progress)

    if options.in_process:
        # As over DDS in lockstep, time stands still while a task is planned.
        result = push_scenario.simulate(scenario, law, progress=show, intervene=belief,
                                        planning_time=0.0)
    else:
        result = _run_over_dds(scenario, law, options, show)
    from push_scenario.evaluation.metrics import bounds_missed, verdict
    line.end('; '.join([verdict(result), *bounds_missed(result)]))
    if result.tape is not None:
        result.tape.save(options.out / f'{scenario.name}_{law}.csv')
    return result


def _run_over_dds(scenario: 'Scenario', law: str, options: argparse.Namespace,
                  show: Callable[['Progress'], None]) -> 'RunResult':
    # Imported here: everything else works without ROS.
    from push_scenario.dds.private_network import make_process_private
    make_process_private()
    try:
        from push_scenario.dds.replay import run_over_dds
    except ModuleNotFoundError as error:
        raise RuntimeError(f'a replay over DDS needs ROS 2: no module {error.name}; source a ROS '
                           'installation, or use --in-process') from error
    return run_over_dds(scenario, law, options.out, real_time=options.real_time,
                        record=not options.no_record and _can_record(), progress=show)


def _can_record() -> bool:
    """Return whether rosbags is there, and print where it is not."""
    is_installed = util.find_spec('rosbags') is not None
    if not is_installed:
        print('push replay: no recording: module rosbags is not installed', file=sys.stderr)
    return is_installed


def _finish(results: Sequence['RunResult'], options: argparse.Namespace,
            beliefs: Sequence['BeliefRecorder']) -> None:
    print(push_scenario.format_report(results), flush=True)
    written = [result.bag for result in results if result.bag is not None]
    if not options.no_pictures and all(result.tape is not None for result in results):
        page = options.out / f'{_picture_name(results, options)}.html'
        # Nodes keep to themselves what they believe.
        from push_view.report import write_report
        write_report(results, page, beliefs if options.in_process else ())
        written += [page, *_draw(results, options)]
    if written:
        print('written: ' + ', '.join(map(str, written)))


def _draw(results: Sequence['RunResult'], options: argparse.Namespace) -> Iterator[Path]:
    """Draw the figure, and the animation where it is asked for; yield their paths."""
    # Imported here: only the plots need matplotlib.
    try:
        from push_scenario.plots.animation import draw_animation
        from push_scenario.plots.figure import draw_figure
    except ModuleNotFoundError as error:
        print(f'push replay: no plots: module {error.name} is not installed', file=sys.stderr)
        return
    drawings = [(draw_figure, 'png')]
    if options.gif:
        drawings.append((draw_animation, 'gif'))
    for draw, suffix in drawings:
        path = options.out / f'{_picture_name(results, options)}.{suffix}'
        line = ProgressLine(sys.stderr, time.monotonic, str(path))
        draw(results, path)
        line.end('drawn')
        yield path


def _picture_name(results: Sequence['RunResult'], options: argparse.Namespace) -> str:
    return 'demo' if options.demo else results[0].scenario.name


if __name__ == '__main__':
    sys.exit(main())
