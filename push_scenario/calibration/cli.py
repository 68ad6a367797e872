"""Command line ``push calibrate``: find out what a base is like, and write it down."""

import argparse
from collections.abc import Callable, Sequence
from pathlib import Path
import sys
from typing import TextIO, TYPE_CHECKING, TypeVar

from push_base.calibration.estimation import BaseCalibration, estimate
from push_base.calibration.program import CalibrationProgram
from push_base.calibration.recording import Interruption, Recording
from push_base.calibration.recording_file import from_csv, to_csv
from push_base.calibration.report import summary, WRITERS
from push_base.calibration.touch_program import TouchPlan
from push_model.files.whole_file import write_whole
from push_model.optional import how_to_install
from push_scenario.terminal_line import TerminalLine

if TYPE_CHECKING:
    from push_scenario.definition.scenario import Scenario
    from push_sim_node.simulation import Simulation

ROS_ARGUMENTS = '--ros-args'
DONE, FAILED, MISUSE, INTERRUPTED = 0, 1, 2, 130
RECORDING, PICTURE = 'recording.csv', 'calibration.png'
Value = TypeVar('Value')
BAR_WIDTH = 30
# Pushes at an object, by the argument.
TOUCH_SIDES = {'once': 1, 'around': 2}
# Where the robot stands beside the object of a scenario [m]: out of reach.
AWAY = 3.0
# The same where it is to touch it: ahead, beside the square.
TOUCH_DISTANCE = 1.5


def main(arguments: Sequence[str] | None = None) -> int:
    """
    Run the command line.

    :param arguments: words after the command's name; None for those of the process.
    :return: exit status: 0 when all files are written, 1 where some of them could not be, 2 on an
        error, 130 when interrupted.
    """
    words = list(sys.argv[1:] if arguments is None else arguments)
    end = words.index(ROS_ARGUMENTS) if ROS_ARGUMENTS in words else len(words)
    options = make_parser().parse_args(words[:end])
    try:
        options.out.mkdir(parents=True, exist_ok=True)
        if options.recording:
            return _calibrate_recording(options)
        if options.sim:
            return _calibrate_simulated(options)
        return _calibrate_over_ros(options, words[end:] or [ROS_ARGUMENTS])
    except (ValueError, OSError, RuntimeError) as error:
        print(f'push calibrate: {error}', file=sys.stderr)
        return MISUSE


def make_parser() -> argparse.ArgumentParser:
    """Make the parser of the command line."""
    parser = argparse.ArgumentParser(
        prog='push calibrate', allow_abbrev=False, description='Drive a base for two minutes '
        'within a free square of two metres, in whose middle it stands, and write down what it '
        'is like. '
        'Parameters and topics follow --ros-args, as --params-file FILE -r odom:=/odom; see '
        'docs/robots/calibrate.md.')
    parser.add_argument('--sim', metavar='SCENARIO',
                        help='calibrate the true robot of a scenario, in one process without ROS')
    parser.add_argument('--touch', nargs='?', const='once', choices=TOUCH_SIDES,
                        metavar='around', help='then push the object of object_pose by 0.3 m: '
                        'it stands ahead, beside the square, on a free floor; around: '
                        'also from the other side, with free floor all around')
    parser.add_argument('--touch-only', action='store_true',
                        help='measure nothing but the touch')
    parser.add_argument('--from', dest='recording', type=Path, metavar='FILE',
                        help='drive nothing: evaluate the recording.csv of an earlier run')
    parser.add_argument('--out', type=Path, default=Path('calibration'), metavar='DIR',
                        help='folder for the files (default: calibration)')
    return parser


class ProgressBar:
    """Shows how far the program is, in a terminal; elsewhere each of its parts."""

    def __init__(self, stream: TextIO | None = None) -> None:
        """
        Show nothing yet.

        :param stream: where to write; None for the standard error stream.
        """
        self._line = TerminalLine(sys.stderr if stream is None else stream)
        self._shown = ''

    def __call__(self, program: CalibrationProgram) -> None:
        """Show the progress, where it has changed."""
        text = program.title
        if self._line.is_overwritten:
            text = _bar(program.progress, self._line.columns - len(text)) + text
        if text == self._shown:
            return
        self._shown = text
        self._line.write(text)


def _bar(progress: float, columns: int) -> str:
    """Draw a bar, with a space behind it, that is not longer than some columns."""
    width = min(BAR_WIDTH, columns - len('[] '))
    done = round(width * progress)
    return f'[{"#" * done}{"." * (width - done)}] ' if width > 0 else ''


def _calibrate_simulated(options: argparse.Namespace) -> int:
    from push_scenario.calibration.simulated import RobotTracker, run_program
    from push_scenario.definition.catalogue import find_scenario
    from push_scenario.definition.loader import read_scenario
    scenario = read_scenario(find_scenario(options.sim))
    sides = _touch_sides(options)
    touch = TouchPlan(scenario.object, sides, options.touch_only) if sides else None
    program, bar = CalibrationProgram(scenario.robot, touch=touch), ProgressBar()
    tracker = RobotTracker(scenario.sensors, scenario.simulation.seed)
    try:
        run_program(program, _simulation(scenario, has_touch=sides > 0), tracker,
                    lambda _: bar(program))
    except KeyboardInterrupt:
        program.interrupt(Interruption.BY_USER, program.recording.commands[-1].time
                          if program.recording.commands else 0.0)
    return _finish(program.recording, options.out)


def _touch_sides(options: argparse.Namespace) -> int:
    return TOUCH_SIDES[options.touch or 'once'] if options.touch or options.touch_only else 0


def _simulation(scenario: 'Scenario', *, has_touch: bool) -> 'Simulation':
    from push_scenario.simulation.engines import plant_type_of
    from push_sim_node.simulation import Simulation
    start = scenario.start.object.pose
    x = start.x - TOUCH_DISTANCE if has_touch else start.x + AWAY
    robot_pose = start._replace(x=x, theta=0.0)
    return Simulation(scenario.true_object, scenario.true_robot, start, robot_pose,
                      scenario.simulation, scenario.sensors,
                      plant_type=plant_type_of(scenario))


def _calibrate_over_ros(options: argparse.Namespace, arguments: list[str]) -> int:
    try:
        from push_scenario.calibration.ros.calibrator import Calibrator
    except ModuleNotFoundError as error:
        raise RuntimeError(f'no module {error.name}: source a ROS installation, or use '
                           '--sim SCENARIO') from error
    from push_ros.executor import run
    statuses: list[int] = []
    status = run(lambda: Calibrator(
        lambda program: statuses.append(_finish(program.recording, options.out)), ProgressBar(),
        _touch_sides(options), touches_only=options.touch_only), arguments)
    return status or (statuses[0] if statuses else MISUSE)


def _calibrate_recording(options: argparse.Namespace) -> int:
    recording = from_csv(options.recording.read_text(encoding='utf-8'), str(options.recording))
    return _evaluate(recording, options.out, [])


def _finish(recording: Recording, folder: Path) -> int:
    """Write what was recorded, then what it says."""
    path = folder / RECORDING
    write_whole(path, to_csv(recording).encode())
    sys.stderr.write('\n')
    return _evaluate(recording, folder, [path])


def _evaluate(recording: Recording, folder: Path, written: list[Path]) -> int:
    """
    Write what a recording says, and say it; each product that fails is named.

    :param written: paths of files that there are already.
    :return: exit status.
    """
    products = _Products(folder, written)
    try:
        products.write(recording)
    except KeyboardInterrupt:
        print(f'push calibrate: interrupted; continue with --from {folder / RECORDING}',
              file=sys.stderr)
        return INTERRUPTED
    finally:
        print('written: ' + ', '.join(map(str, written)), flush=True)
    if products.has_failed:
        return FAILED
    return INTERRUPTED if recording.interruption is Interruption.BY_USER else DONE


class _Products:
    """Products of a recording: where one fails, the others are made."""

    def __init__(self, folder: Path, written: list[Path]) -> None:
        """
        Write nothing yet.

        :param written: paths of files, to which others are added.
        """
        self._folder, self._written = folder, written
        self.has_failed = False

    def write(self, recording: Recording) -> None:
        """Write all that can be."""
        calibration = self._attempt('evaluation', lambda: estimate(recording))
        if calibration is None:
            return
        self.has_failed |= bool(calibration.failures)
        for name, text_of in WRITERS.items():
            self._attempt(name, lambda: self._write_text(name, text_of(calibration)))
        self._attempt('summary', lambda: print(summary(calibration)))
        self._attempt(PICTURE, lambda: self._draw(calibration))

    def _attempt(self, name: str, make: Callable[[], Value]) -> Value | None:
        try:
            return make()
        except Exception as error:  # noqa: B902 (named, and the exit status)
            self.has_failed = True
            print(f'push calibrate: {name} failed: {type(error).__name__}: {error}',
                  file=sys.stderr)
            return None

    def _write_text(self, name: str, text: str) -> None:
        write_whole(self._folder / name, text.encode())
        self._written.append(self._folder / name)

    def _draw(self, calibration: BaseCalibration) -> None:
        # Imported here: only the picture needs matplotlib.
        try:
            from push_scenario.plots.calibration import draw_calibration
        except ModuleNotFoundError as error:
            print(f'push calibrate: no picture: {how_to_install(error.name) or error}',
                  file=sys.stderr)
            return
        draw_calibration(calibration, self._folder / PICTURE)
        self._written.append(self._folder / PICTURE)


if __name__ == '__main__':
    sys.exit(main())
