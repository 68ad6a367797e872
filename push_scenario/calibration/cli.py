"""Command line ``calibrate``: find out what a base is like, and write it down."""

import argparse
from collections.abc import Sequence
from pathlib import Path
import sys
from typing import TYPE_CHECKING

from push_base.calibration.estimation import BaseCalibration, estimate
from push_base.calibration.program import CalibrationProgram
from push_base.calibration.recording import Interruption
from push_base.calibration.report import files, summary

if TYPE_CHECKING:
    from push_scenario.definition.scenario import Scenario
    from push_sim_node.simulation import Simulation

ROS_ARGUMENTS = '--ros-args'
DONE, MISUSE, INTERRUPTED = 0, 2, 130
BAR_WIDTH = 30
# Where the robot stands beside the object of a scenario [m]: out of reach.
AWAY = 3.0


def main(arguments: Sequence[str] | None = None) -> int:
    """
    Run the command line.

    :param arguments: words after the command's name; None for those of the process.
    :return: exit status: 0 when the files are written, 2 on an error, 130 when interrupted.
    """
    words = list(sys.argv[1:] if arguments is None else arguments)
    end = words.index(ROS_ARGUMENTS) if ROS_ARGUMENTS in words else len(words)
    options = _parser().parse_args(words[:end])
    try:
        options.out.mkdir(parents=True, exist_ok=True)
        if options.sim:
            return _calibrate_simulated(options)
        return _calibrate_over_ros(options, words[end:] or [ROS_ARGUMENTS])
    except (ValueError, OSError, RuntimeError) as error:
        print(f'calibrate: {error}', file=sys.stderr)
        return MISUSE


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog='calibrate', allow_abbrev=False, description='Drive a base for two minutes within a '
        'free square of two metres, in whose middle it stands, and write down what it is like. '
        'Parameters and topics follow --ros-args, as --params-file FILE -r odom:=/odom; see '
        'docs/robots/calibrate.md.')
    parser.add_argument('--sim', metavar='SCENARIO',
                        help='calibrate the true robot of a scenario, in one process without ROS')
    parser.add_argument('--out', type=Path, default=Path('calibration'), metavar='DIR',
                        help='folder for the files (default: calibration)')
    return parser


class ProgressBar:
    """Shows how far the program is, in a terminal; elsewhere each of its parts."""

    def __init__(self) -> None:
        """Show nothing yet."""
        self._shown = ''

    def __call__(self, program: CalibrationProgram) -> None:
        """Show the progress, where it has changed."""
        is_terminal = sys.stderr.isatty()
        done = round(BAR_WIDTH * program.progress)
        bar = f'[{"#" * done}{"." * (BAR_WIDTH - done)}] ' if is_terminal else ''
        line = f'{bar}{program.title}'
        if line == self._shown:
            return
        self._shown = line
        sys.stderr.write(f'\r{line:<70}' if is_terminal else f'{line}\n')
        sys.stderr.flush()


def _calibrate_simulated(options: argparse.Namespace) -> int:
    from push_scenario.calibration.simulated import RobotTracker, run_program
    from push_scenario.definition.catalogue import find_scenario
    from push_scenario.definition.loader import read_scenario
    scenario = read_scenario(find_scenario(options.sim))
    program, bar = CalibrationProgram(scenario.robot), ProgressBar()
    tracker = RobotTracker(scenario.sensors, scenario.simulation.seed)
    try:
        run_program(program, _simulation(scenario), tracker, lambda _: bar(program))
    except KeyboardInterrupt:
        program.interrupt(Interruption.BY_USER, program.recording.commands[-1].time
                          if program.recording.commands else 0.0)
    return _finish(program, options.out)


def _simulation(scenario: 'Scenario') -> 'Simulation':
    from push_sim_node.simulation import Simulation
    start = scenario.start.object.pose
    robot_pose = start._replace(x=start.x + AWAY, theta=0.0)
    return Simulation(scenario.true_object, scenario.true_robot, start, robot_pose,
                      scenario.simulation, scenario.sensors)


def _calibrate_over_ros(options: argparse.Namespace, arguments: list[str]) -> int:
    try:
        from push_scenario.calibration.ros.calibrator import Calibrator
    except ModuleNotFoundError as error:
        raise RuntimeError(f'no module {error.name}: source a ROS installation, or use '
                           '--sim SCENARIO') from error
    from push_ros.executor import run
    statuses: list[int] = []
    status = run(lambda: Calibrator(
        lambda program: statuses.append(_finish(program, options.out)), ProgressBar()), arguments)
    return status or (statuses[0] if statuses else MISUSE)


def _finish(program: CalibrationProgram, folder: Path) -> int:
    """Write what is known, and say it."""
    calibration = estimate(program.recording)
    written = [folder / name for name in files(calibration)]
    for path, text in zip(written, files(calibration).values()):
        path.write_text(text, encoding='utf-8')
    written += _draw(calibration, folder / 'calibration.png')
    sys.stderr.write('\n')
    print(summary(calibration))
    print('written: ' + ', '.join(map(str, written)), flush=True)
    is_interrupted = program.recording.interruption is Interruption.BY_USER
    return INTERRUPTED if is_interrupted else DONE


def _draw(calibration: BaseCalibration, path: Path) -> list[Path]:
    # Imported here: only the picture needs matplotlib.
    try:
        from push_scenario.plots.calibration import draw_calibration
    except ModuleNotFoundError as error:
        print(f'calibrate: no picture: module {error.name} is not installed', file=sys.stderr)
        return []
    draw_calibration(calibration, path)
    return [path]


if __name__ == '__main__':
    sys.exit(main())
