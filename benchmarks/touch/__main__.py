"""
Print force and energy of the first touch as a table.

Without --robot-mass the robot counts as much heavier than the object.
"""

import argparse
from collections.abc import Sequence
import math
import sys

from benchmarks.touch.first_touch import FirstTouch, reduced_mass

HEADER = ('mass [kg]', 'stiffness [N/m]', 'speed [m/s]', 'force [N]', 'energy [J]')


def main(arguments: Sequence[str] | None = None) -> int:
    """
    Print the table.

    :param arguments: command line; None for that of the process.
    :return: exit status.
    """
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--robot-mass', type=float, default=math.inf)
    parser.add_argument('--mass', type=float, nargs='+', default=[3.0, 10.0, 30.0])
    parser.add_argument('--stiffness', type=float, nargs='+', default=[5e3, 5e4])
    parser.add_argument('--speed', type=float, nargs='+', default=[0.15, 0.3])
    parser.add_argument('--force', type=float, default=math.inf, help='limit [N]')
    parser.add_argument('--energy', type=float, default=math.inf, help='limit [J]')
    options = parser.parse_args(arguments)
    rows: list[tuple[float, float, float, float, float]] = []
    for mass in options.mass:
        for stiffness in options.stiffness:
            touch = FirstTouch(reduced_mass(options.robot_mass, mass), stiffness)
            limit = touch.speed_limit(options.force, options.energy)
            speeds = [limit] if math.isfinite(limit) else options.speed
            rows += [(mass, stiffness, speed, touch.force(speed), touch.energy(speed))
                     for speed in speeds]
    print('| ' + ' | '.join(HEADER) + ' |\n' + '| --- ' * len(HEADER) + '|')
    for row in rows:
        print('| ' + ' | '.join(f'{value:.3g}' for value in row) + ' |')
    return 0


if __name__ == '__main__':
    sys.exit(main())
