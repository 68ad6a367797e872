"""Picture of a calibration: commands and velocities, with what the fitted drive would do."""

from os import PathLike

from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
import numpy as np
from push_base.calibration.drive_response import predict
from push_base.calibration.estimation import BaseCalibration
from push_base.calibration.findings import find_faults
from push_base.calibration.recording import Purpose
from push_base.calibration.report import rows
from push_scenario.plots.drawing import GOAL, INK, PLAN, PUSH_COLORS, style_axes, WARNING

SIZE = 11.0, 7.5  # [inch]
DPI = 100
# Lines of the table: height, of its axes, and size of the font where that is enough.
LINE_HEIGHT, FONT_SIZE = 0.052, 7.5
LABELS = 'speed ahead [m/s]', 'yaw rate [rad/s]'


def draw_calibration(calibration: BaseCalibration, path: str | PathLike[str]) -> None:
    """
    Draw a calibration.

    :param path: of the PNG.
    """
    figure = Figure(figsize=SIZE, dpi=DPI, facecolor='white', layout='constrained')
    FigureCanvasAgg(figure)
    grid = figure.add_gridspec(3, 2, height_ratios=(1.0, 1.0, 1.3), width_ratios=(1.0, 1.15))
    start = calibration.signals.sent[0] if len(calibration.signals.sent) else 0.0
    for row, (axis, label) in enumerate(zip((0, 2), LABELS)):
        axes = figure.add_subplot(grid[row, :])
        _velocities(axes, calibration, axis, start)
        axes.set_ylabel(label)
        axes.set_xlabel('time [s]')
    _ramp(figure.add_subplot(grid[2, 0]), calibration)
    _table(figure.add_subplot(grid[2, 1]), calibration)
    figure.savefig(path, metadata={'Software': None})


def _velocities(axes: Axes, calibration: BaseCalibration, axis: int, start: float) -> None:
    signals, drive = calibration.signals, calibration.drive
    axes.step(signals.sent - start, signals.commands[:, axis], where='post', color=PLAN,
              linewidth=0.8, label='command')
    axes.plot(signals.times - start, signals.velocities[:, axis], color=PUSH_COLORS[0],
              linewidth=0.9, label='odometry')
    if drive is not None:
        predicted = predict(calibration.recording.robot, drive.response, signals.sent,
                            signals.commands, signals.times)
        axes.plot(signals.times - start, predicted[:, axis], color=PUSH_COLORS[1],
                  linewidth=0.9, linestyle='--', label='fitted drive')
    style_axes(axes)
    axes.legend(loc='lower right', bbox_to_anchor=(1.0, 1.0), borderaxespad=0.0, ncols=3,
                frameon=False, fontsize='small')


def _ramp(axes: Axes, calibration: BaseCalibration) -> None:
    """Draw the measured speed over the command a dead time before, in ramps."""
    signals, drive = calibration.signals, calibration.drive
    style_axes(axes)
    axes.set_xlabel('command of a ramp [m/s]')
    axes.set_ylabel('measured speed [m/s]')
    if drive is None:
        return
    dead_time = drive.dead_time.value
    inside = signals.during({Purpose.RAMP}, dead_time)
    index = np.maximum(np.searchsorted(signals.sent, signals.times - dead_time, 'right') - 1, 0)
    commands = np.abs(signals.commands[index, 0])
    moving = inside & (commands > 0.0)
    axes.plot(commands[moving], np.abs(signals.velocities[moving, 0]), '.', markersize=2,
              color=PUSH_COLORS[0])
    top = float(commands[moving].max()) if moving.any() else 0.1
    axes.plot([0.0, top], [0.0, top], color=PLAN, linewidth=0.8)
    least = drive.least_speeds[0]
    if least is not None and least.value > 0.0:
        axes.axvspan(least.low, least.high, color=GOAL, alpha=0.3)


def _table(axes: Axes, calibration: BaseCalibration) -> None:
    axes.axis('off')
    faults = find_faults(calibration)
    lines = [(f'{name}: {text}', INK) for name, text in rows(calibration)]
    lines.append(('', INK))
    lines += [(f'! {finding.sentence}', WARNING) for finding in faults] or [
        ('nothing is wrong', GOAL)]
    step = min(LINE_HEIGHT, 1.0 / len(lines))
    for row, (text, color) in enumerate(lines):
        axes.text(0.0, 1.0 - row * step, text, va='top', color=color,
                  fontsize=FONT_SIZE * step / LINE_HEIGHT, transform=axes.transAxes)
