"""
Command line ``push replay``: run a scenario over DDS or in one process, report on it, draw it.

What runs a scenario is imported where it is used: the list of scenarios and the help need none of
it, and are there at once.
"""

import argparse
from collections.abc import Callable, Sequence
import dataclasses
import importlib
from importlib import util
from pathlib import Path
import sys
import time
from typing import TYPE_CHECKING

from push_control.law_names import is_own_law, law_file_name
from push_dynamics.cache_activity import CacheActivity
from push_model.optional import how_to_install
import push_scenario
from push_scenario.definition.catalogue import (
    find_scenario, scenario_description, scenario_names)
from push_scenario.interrupts import Interrupts
from push_scenario.progress_line import ProgressLine
from push_scenario.replay_options import DEMO, make_parser
from push_scenario.terminal_line import shows_colors
from push_scenario.ticker import Ticker

if TYPE_CHECKING:
    from push_scenario.definition.scenario import Scenario
    from push_scenario.evaluation.result_files import Replay
    from push_scenario.simulation.loop import Progress
    from push_scenario.simulation.result import RunResult
    from push_view.belief import BeliefRecorder

AS_EXPECTED, NOT_AS_EXPECTED, MISUSE, INTERRUPTED = 0, 1, 2, 130
# Time between two looks at what is compiled, where nothing else shows progress [s]; chosen.
REFRESH_PERIOD = 0.5
# Commands of a recording that are listed where they differ; chosen: the first tell most.
MAX_DIFFERENCES = 5


def main(arguments: Sequence[str] | None = None) -> int:
    """
    Run the command line.

    :param arguments: words after the command's name; None for those of the process.
    :return: exit status: 0 where every scenario ended as it expects (with several laws, each that
        is not open loop), 1 where one did not, 2 on an error, 130 when interrupted.
    """
    parser = make_parser()
    options = parser.parse_args(arguments)
    if options.list:
        _list_scenarios()
        return AS_EXPECTED
    if options.demo:
        options.scenario = options.scenario or [DEMO]
    if not options.scenario:
        parser.error('the following arguments are required: SCENARIO (or --list, or --demo)')
    try:
        return _replay_all(options)
    except (ValueError, OSError, RuntimeError) as error:
        return _report_error(error, MISUSE)


def _note(text: object) -> None:
    # In a terminal the line of the progress may have no end yet.
    start = '\n' if sys.stderr.isatty() else ''
    print(f'{start}push replay: {text}', file=sys.stderr)


def _report_error(text: object, status: int) -> int:
    _note(text)
    return status


def _list_scenarios() -> None:
    names = scenario_names()
    width = max(map(len, names))
    for name in names:
        print(f'{name.ljust(width)}  {scenario_description(name)}')


def _replay_all(options: argparse.Namespace) -> int:
    """Replay all scenarios; where one of several cannot be run, the others are."""
    if options.in_process and options.real_time:
        raise ValueError('--real-time: got --in-process too, expected one of the two')
    scenarios = [_read_scenario(name, options) for name in options.scenario]
    if options.bag:
        if len(scenarios) > 1:
            raise ValueError(f'--bag: got {len(scenarios)} scenarios, expected that of the '
                             'recording')
        return _play_back(scenarios[0], options.bag)
    if options.plan:
        from push_scenario.plan_command import show_plan
        has_plan = [show_plan(scenario, options.out) for scenario in scenarios]
        return AS_EXPECTED if all(has_plan) else NOT_AS_EXPECTED
    _choose_mode(options)
    if any(map(is_own_law, options.law or ())):
        # As Python does for a script: a law of one's own is in a module of this folder.
        sys.path.insert(0, '')
    # Imported before there is something that an interrupt would have to end.
    from push_scenario.evaluation.result_files import to_json, to_junit
    importlib.import_module('push_view.belief')
    replays: list['Replay'] = []
    try:
        for scenario in scenarios:
            replays.append(_replay(scenario, options, is_alone=len(scenarios) == 1))
    except KeyboardInterrupt:
        return _report_error('interrupted', INTERRUPTED)
    finally:
        if options.json:
            print(to_json(replays), end='', flush=True)
        if options.junit:
            options.junit.write_text(to_junit(replays), encoding='utf-8')
    if any(replay.error for replay in replays):
        return MISUSE
    return AS_EXPECTED if all(replay.is_as_expected for replay in replays) else NOT_AS_EXPECTED


def _choose_mode(options: argparse.Namespace) -> None:
    """Run in one process where there is no ROS, unless its clock is asked for."""
    if not options.in_process and not options.real_time and util.find_spec('rclpy') is None:
        _note('no ROS 2 here (no module rclpy): one process runs all')
        options.in_process = True


def _is_in_process(scenario: 'Scenario', options: argparse.Namespace) -> bool:
    """Tell whether one process runs all, as it does in another engine."""
    return options.in_process or scenario.engine != 'own'


def _replay(scenario: 'Scenario', options: argparse.Namespace, *, is_alone: bool) -> 'Replay':
    """
    Run a scenario under its laws, report on it and write its files.

    :param is_alone: whether it is the only one; an error of one of several ends it alone.
    """
    from push_scenario.evaluation.result_files import Replay
    from push_view.belief import BeliefRecorder
    results: list['RunResult'] = []
    beliefs: list['BeliefRecorder'] = []
    try:
        _write_scenario(scenario, options.out)
        with Interrupts() as interrupts:
            for law in dict.fromkeys(options.law or [scenario.control.control_law]):
                beliefs.append(BeliefRecorder(scenario.object))
                results.append(_run(scenario, law, options, interrupts, beliefs[-1]))
            _finish(results, options, beliefs)
            interrupts.check()
    except KeyboardInterrupt:
        if results:
            _print_report(results, options)
        raise
    except (ValueError, OSError, RuntimeError) as error:
        if is_alone:
            raise
        _note(f'{scenario.name}: {error}')
        return Replay(scenario.name, results, False, str(error))
    evaluated = [result for result in results if result.control_law != 'open_loop'] or results
    return Replay(scenario.name, results, all(map(push_scenario.is_as_expected, evaluated)))


def _write_scenario(scenario: 'Scenario', folder: Path) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
        (folder / f'{scenario.name}.yaml').write_text(push_scenario.scenario_text(scenario),
                                                      encoding='utf-8')
    except OSError as error:
        raise ValueError(f'--out: got {folder}: {error.strerror}, expected a folder in which '
                         'files can be written') from error


def _read_scenario(name: str, options: argparse.Namespace) -> 'Scenario':
    """Read a scenario, with sensors, engine and map of the command line."""
    from push_model.files.parameter_files import named_file
    from push_scenario.definition.expected_poses import with_sensors
    from push_scenario.definition.loader import read_scenario, read_sensors, with_map
    scenario = read_scenario(find_scenario(name))
    if options.sensors:
        sensors = read_sensors(named_file('sensors', options.sensors))
        scenario = (with_sensors(scenario, sensors) if scenario.task is not None
                    else dataclasses.replace(scenario, sensors=sensors))
    if options.engine:
        scenario = dataclasses.replace(scenario, engine=options.engine)
    if options.real_time and scenario.engine != 'own':
        raise ValueError(f'--real-time: got the engine {scenario.engine!r} of {scenario.name} '
                         'too, expected one of the two')
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
    line = ProgressLine(sys.stderr, time.monotonic, f'{scenario.name}, {law}', CacheActivity())

    def show(progress: 'Progress') -> None:
        interrupts.check()
        line(progress)

    with Ticker(line.refresh, REFRESH_PERIOD):
        if _is_in_process(scenario, options):
            # As over DDS in lockstep, time stands still while a task is planned.
            result = push_scenario.simulate(scenario, law, progress=show, intervene=belief,
                                            planning_time=0.0)
        else:
            result = _run_over_dds(scenario, law, options, show)
    from push_scenario.evaluation.metrics import bounds_missed, verdict
    line.end('; '.join([verdict(result), *bounds_missed(result)]))
    if result.tape is not None:
        result.tape.save(options.out / f'{scenario.name}_{law_file_name(law)}.csv')
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
        _note(f'no recording: {how_to_install("rosbags")}')
    return is_installed


def _print_report(results: Sequence['RunResult'], options: argparse.Namespace) -> None:
    if not options.json:
        print(push_scenario.format_report(results, is_colored=shows_colors(sys.stdout)),
              flush=True)


def _finish(results: Sequence['RunResult'], options: argparse.Namespace,
            beliefs: Sequence['BeliefRecorder']) -> None:
    """Print the report, then write page and pictures: where one fails, the others are written."""
    _print_report(results, options)
    name = options.out / ('demo' if options.demo else results[0].scenario.name)
    written = [result.bag for result in results if result.bag is not None]
    page = None
    if not options.no_pictures and all(result.tape is not None for result in results):
        # Nodes keep to themselves what they believe.
        page = _attempt(name.with_suffix('.html'), lambda path: _write_page(
            results, path, beliefs if _is_in_process(results[0].scenario, options) else ()))
        pictures = [_attempt(name.with_suffix('.png'), lambda path: _draw_figure(results, path))]
        if options.gif:
            pictures.append(_attempt(name.with_suffix('.gif'),
                                     lambda path: _draw_animation(results, path)))
        written += [path for path in pictures if path is not None]
    if not options.json:
        if page is not None:
            print(f'\npage: {page.resolve().as_uri()}')
        if written:
            print('written: ' + ', '.join(map(str, written)))


def _attempt(path: Path, write: Callable[[Path], None]) -> Path | None:
    """
    Write a file that nobody's result depends on.

    :return: its path; None, with a line that says why, where it could not be written.
    """
    try:
        write(path)
    except Exception as error:  # noqa: B902 (named)
        missing = how_to_install(error.name) if isinstance(error, ModuleNotFoundError) else ''
        _note(f'no {path.name}: {missing or f"{type(error).__name__}: {error}"}')
        return None
    return path


def _write_page(results: Sequence['RunResult'], path: Path,
                beliefs: Sequence['BeliefRecorder']) -> None:
    from push_view.report import write_report
    write_report(results, path, beliefs)


def _draw_figure(results: Sequence['RunResult'], path: Path) -> None:
    # Imported here, like the next: only the plots need matplotlib.
    from push_scenario.plots.figure import draw_figure
    draw_figure(results, path)


def _draw_animation(results: Sequence['RunResult'], path: Path) -> None:
    from push_scenario.plots.animation import draw_animation
    line = ProgressLine(sys.stderr, time.monotonic, str(path))
    draw_animation(results, path)
    line.end('drawn')


if __name__ == '__main__':
    sys.exit(main())
