"""
How well pushes repeat: logs of the same planned pushes, several times each.

J. Zhou, Y. Hou and M. T. Mason, "Pushing revisited: differential flatness, trajectory planning,
and stabilization", IJRR 2019. Public repository robinzhoucmu/Pushing, folder
differential_flat/exp_data/robot_exp_logs (Apache-2.0): a folder for each object, in it one for
each case, in it a log for each repeat. Its rows are ``t, x, y, theta`` of the object, ``x, y,
theta`` of the pusher [s, mm, rad] and the kind of motion.
"""

from pathlib import Path
from typing import NamedTuple

import numpy as np
from push_model.geometry import FloatArray, wrap_angles

MILLIMETRE = 1e-3


class Repeats(NamedTuple):
    """
    How far repeated pushes end from the mean of their case, corrected for that mean.

    :param cases: number of cases.
    :param travel: of the object from start to end, median [m].
    :param position: distances, shape (n,) [m].
    :param heading: magnitudes, shape (n,) [rad].
    """

    cases: int
    travel: float
    position: FloatArray
    heading: FloatArray


def read_repeats(folder: Path) -> Repeats:
    """
    Read the logs.

    :param folder: with a folder for each object.
    :raises ValueError: where it has no case of two logs.
    """
    cases = [sorted(case.glob('log*.txt')) for case in sorted(folder.glob('*/*'))]
    cases = [logs for logs in cases if len(logs) > 1]
    if not cases:
        raise ValueError(f'--repeats: got {folder}, expected OBJECT/CASE/log*.txt')
    position: list[FloatArray] = []
    heading: list[FloatArray] = []
    travels: list[FloatArray] = []
    for logs in cases:
        poses = np.array([_start_and_end(path) for path in logs])
        ends = poses[:, 1]
        # The mean of n ends is as if it were nearer to each: by n / (n - 1) in the mean square.
        factor = float(np.sqrt(len(ends) / (len(ends) - 1)))
        off = ends[:, :2] - ends[:, :2].mean(axis=0)
        turns = wrap_angles(ends[:, 2] - ends[0, 2])
        position.append(factor * np.hypot(*off.T))
        heading.append(factor * np.abs(turns - turns.mean()))
        travels.append(np.hypot(*(ends - poses[:, 0])[:, :2].T))
    return Repeats(len(cases), float(np.median(np.concatenate(travels))), np.concatenate(position),
                   np.concatenate(heading))


def _start_and_end(path: Path) -> FloatArray:
    """Poses of the object in the first and the last row, shape (2, 3) [m, rad]."""
    rows = np.loadtxt(path, delimiter=',', ndmin=2)[[0, -1], 1:4]
    return rows * (MILLIMETRE, MILLIMETRE, 1.0)
