"""Read a recording of all topics, as ``make demo`` and ``push replay`` leave it in ``out/``."""

import math
from pathlib import Path
import sys

import numpy as np
from push_scenario import read_recording

DEMO = Path('out/task_demo_feedback_bag')


def main(bag: Path = DEMO) -> None:
    """List what was recorded, and measure how far the object was pushed."""
    recording = read_recording(bag)
    for topic, series in recording.items():
        print(topic, series)
    poses = recording['object_pose']
    x, y, heading = poses['x'], poses['y'], poses['heading']
    away = math.hypot(x[-1] - x[0], y[-1] - y[0])
    path = np.hypot(np.diff(x), np.diff(y)).sum()
    print(f'object in {poses.frame}: {away:.2f} m from its start, turned by '
          f'{math.degrees(heading[-1] - heading[0]):+.1f} degrees; path with noise {path:.2f} m')


if __name__ == '__main__':
    main(*map(Path, sys.argv[1:]))
