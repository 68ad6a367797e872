"""
How far the wheels of a simulated robot slip: its odometry against the truth.

``python -m benchmarks.plant.wheel_drift [ROBOT]`` prints a table of drives and pushes, with the
heading by the ticks of the wheels and by a gyro.
"""

import dataclasses
import math
import sys
from typing import NamedTuple, Sequence

from push_model.files.parameter_files import read_object, read_robot
from push_model.geometry import distance, Pose, wrap_angle
from push_model.signals import STOP, Twist
from push_mujoco.engine_plant import engine_plant, EnginePlant
from push_mujoco.simulated_robot import DEFAULT_ROBOTS, read_simulated_robot

OBJECT, BASE = 'box_04', 'create3'
# Period of a command, and how long everything comes to rest [s].
PERIOD, REST = 0.1, 1.0
# Where the robot starts from an object that it pushes, and from one that it does not touch [m].
NEAR, FAR = -0.4, -5.0


class Drive(NamedTuple):
    """
    A drive from rest to rest.

    :param start: of the robot; the middle of the object is at 0.
    :param command: ``Twist`` that holds all the time.
    :param duration: [s].
    """

    start: Pose
    command: Twist
    duration: float


DRIVES = {
    'ahead, 1 m': Drive(Pose(FAR, 0.0, 0.0), Twist(0.2, 0.0, 0.0), 5.0),
    'a turn in place': Drive(Pose(FAR, 0.0, 0.0), Twist(0.0, 0.0, 0.5 * math.pi), 4.0),
    **{f'push of 0.6 m at {speed} m/s, {1e3 * offset:.0f} mm off the middle': Drive(
        Pose(NEAR, offset, 0.0), Twist(speed, 0.0, 0.0), 0.6 / speed)
        for speed in (0.1, 0.3) for offset in (0.0, 0.1)},
    'push of 0.6 m in a bend of 1 m': Drive(Pose(NEAR, 0.0, 0.0), Twist(0.15, 0.0, 0.15), 4.0)}


class OdometryError(NamedTuple):
    """
    Error of odometry at the end of a drive.

    :param position: distance from the robot to where odometry has it [m].
    :param heading: of odometry over that of the robot [rad].
    """

    position: float
    heading: float

    def __str__(self) -> str:
        return f'{1e3 * self.position:.1f} mm, {math.degrees(self.heading):.2f} degrees'


def odometry_error(plant: EnginePlant, drive: Drive) -> OdometryError:
    """
    Drive, and compare odometry with the truth.

    :param plant: with the robot at the start of the drive.
    """
    for _ in range(round(drive.duration / PERIOD)):
        plant.advance(PERIOD, drive.command)
    plant.advance(REST, STOP)
    counted, true = plant.odometry_pose, plant.robot_pose
    return OdometryError(distance(counted, true), wrap_angle(counted.theta - true.theta))


def main(arguments: Sequence[str] | None = None) -> int:
    """
    Print the table.

    :param arguments: words behind the command's name; None for those of the process.
    """
    words = sys.argv[1:] if arguments is None else arguments
    simulated = read_simulated_robot(words[0] if words else DEFAULT_ROBOTS['differential'])
    makers = [engine_plant(dataclasses.replace(simulated, has_gyro=has_gyro))
              for has_gyro in (False, True)]
    obj, robot = read_object(OBJECT), read_robot(BASE)
    print('| drive | error by ticks alone | with the heading of a gyro |\n| --- | --- | --- |')
    for name, drive in DRIVES.items():
        errors = (odometry_error(make(obj, robot, Pose(0.0, 0.0, 0.0), drive.start), drive)
                  for make in makers)
        print(f"| {name} | {' | '.join(map(str, errors))} |")
    return 0


if __name__ == '__main__':
    sys.exit(main())
