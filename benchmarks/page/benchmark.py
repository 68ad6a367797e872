"""
Benchmark of the page: frames in a second, and what takes long, while a simulation runs.

A session of ``push play`` runs at real time in a process of its own; a browser without a window
shows it. Frames are counted by ``requestAnimationFrame``, and tasks that keep the page busy for
longer than 50 ms by a ``PerformanceObserver``. The time in which the page computes a frame is that
of its scripts; what the browser then paints is in the interval between frames alone.
"""

import argparse
from collections.abc import Generator
import contextlib
import os
import re
import signal
import subprocess
import sys
import time
from typing import Any

from benchmarks.controller.tables import table
from benchmarks.page.chromium import open_chromium
import numpy as np
from push_model.geometry import FloatArray

# Longest wait for the simulation [s]; chosen: the first time it is compiled, on a busy machine.
PATIENCE = 300.0
# Widths and heights that are measured [pixels].
SIZES = {'desktop': (1280, 900), 'phone': (380, 800)}
START = """
window.measured = { frames: [], scripts: [], tasks: [] };
new PerformanceObserver((list) => {
  for (const entry of list.getEntries()) measured.tasks.push(entry.duration);
}).observe({ type: 'longtask' });
const count = (now) => { measured.frames.push(now); requestAnimationFrame(count); };
requestAnimationFrame(count);
app.frames.length = 0;
"""


def options() -> argparse.Namespace:
    """Parse the command line."""
    parser = argparse.ArgumentParser(
        description='Benchmark of the page: frames in a second while a simulation runs.')
    parser.add_argument('--scenario', default='task_demo')
    parser.add_argument('--duration', type=float, default=20.0,
                        help='how long frames are counted at each size [s]')
    parser.add_argument('--profile', action='store_true',
                        help='list the functions in which the page spends its time')
    return parser.parse_args()


@contextlib.contextmanager
def playing(*scene: str) -> Generator[str, None, None]:
    """
    Run ``push play`` inside this context; return the address of the page.

    :param scene: name of a scenario, or ``--room`` and the name of a room.
    """
    words = [sys.executable, '-m', 'push_view.cli', *scene, '--no-browser', '--port', '0']
    with subprocess.Popen(words, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        try:
            match = re.search(r'http\S+', process.stdout.readline())
            if match is None:
                raise RuntimeError('play: got no address, expected one')
            yield match[0]
        finally:
            process.send_signal(signal.SIGINT)


def wait_for(driver: Any, condition: str, patience: float = PATIENCE) -> None:
    """
    Wait until a JavaScript expression is true.

    :param driver: of selenium.
    :param condition: the expression.
    :param patience: longest wait [s].
    :raises TimeoutError: where it is not true by then.
    """
    end = time.monotonic() + patience
    while not driver.execute_script(f'return Boolean({condition})'):
        if time.monotonic() > end:
            raise TimeoutError(f'{condition}: not true after {patience:g} s')
        time.sleep(0.1)


def measure(driver: Any, url: str, size: tuple[int, int], duration: float) -> dict[str, Any]:
    """
    Count frames of a page at one size.

    :param driver: of selenium.
    :param url: of the page.
    :param size: width and height [pixels].
    :param duration: how long [s].
    :return: ``frames``, times [ms]; ``scripts`` and ``tasks``, durations [ms]; ``simulated``,
        simulated over real time.
    """
    driver.execute_cdp_cmd('Emulation.setDeviceMetricsOverride', {
        'width': size[0], 'height': size[1], 'deviceScaleFactor': 1, 'mobile': size[0] < 600})
    driver.get(url)
    wait_for(driver, 'typeof app !== "undefined" && app.canEdit && app.recording.end > 0.2')
    driver.execute_script('app.send({type: "restart"}); app.player.setSpeed(1)')
    wait_for(driver, 'app.recording.end > 1.0 && app.recording.end < 5.0')
    driver.execute_script(START)
    before = driver.execute_script('return [app.recording.end, performance.now()]')
    time.sleep(duration)
    measured = driver.execute_script('return {...measured, scripts: app.frames, '
                                     'end: [app.recording.end, performance.now()]}')
    seconds = 1e-3 * (measured['end'][1] - before[1])
    measured['simulated'] = (measured['end'][0] - before[0]) / seconds
    return measured


def line(name: str, measured: dict[str, Any]) -> list[str]:
    """Sum up a measurement."""
    intervals: FloatArray = np.diff(measured['frames'])
    scripts = np.array(measured['scripts'])
    rate = 1e3 / intervals.mean()
    return [name, f'{rate:.1f}',
            *(f'{value:.1f}' for value in np.percentile(intervals, (50, 95, 99))),
            *(f'{value:.1f}' for value in np.percentile(scripts, (50, 95, 99))),
            str(len(measured['tasks'])), f'{sum(measured["tasks"]):.0f}',
            f'{measured["simulated"]:.2f}']


def main() -> int:
    """Measure and print."""
    chosen = options()
    with playing(chosen.scenario) as url, open_chromium() as driver:
        lines = [line(name, measure(driver, url, size, chosen.duration))
                 for name, size in SIZES.items()]
    print(f'load {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores')
    print(table(['size', 'frames/s', 'interval median [ms]', 'p95', 'p99', 'scripts median [ms]',
                 'p95', 'p99', 'long tasks', 'in all [ms]', 'simulated over real time'], lines))
    return 0
