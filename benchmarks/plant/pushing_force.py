"""
How hard a simulated robot pushes a wall, and which objects of the package it can push.

``python -m benchmarks.plant.pushing_force [ROBOT]`` prints a table for three floors.
"""

import dataclasses
import sys
from typing import Sequence

from push_model.files.data import share_directory
from push_model.files.parameter_files import files_by_name, read_object
from push_mujoco.simulated_robot import DEFAULT_ROBOTS, read_simulated_robot
from push_mujoco.wheeled_robot import pushing_force

# Friction coefficients of the wheels, chosen: a dusty floor, a clean one, rubber on a good one.
FRICTIONS = 0.4, 0.6, 0.8


def main(arguments: Sequence[str] | None = None) -> int:
    """
    Print the table.

    :param arguments: words behind the command's name; None for those of the process.
    """
    words = sys.argv[1:] if arguments is None else arguments
    robot = read_simulated_robot(words[0] if words else DEFAULT_ROBOTS['differential'])
    names = files_by_name(share_directory() / 'config' / 'objects')
    needed = {name: sum(read_object(name).capacities) for name in names}
    print(f'the caster is lifted at {robot.lifting_force:.1f} N')
    for friction in FRICTIONS:
        floor = dataclasses.replace(robot, wheel_friction=friction)
        force = pushing_force(floor)
        pushes = ', '.join(name for name, least in needed.items() if least < force)
        print(f'friction {friction}: {force:.1f} N, by moments {floor.traction:.1f} N; {pushes}')
    print(', '.join(f'{name} takes {least:.1f} N' for name, least in needed.items()))
    return 0


if __name__ == '__main__':
    sys.exit(main())
