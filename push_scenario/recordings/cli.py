"""Command line: identify the friction of objects from recordings of pushes."""

import argparse
from pathlib import Path
import sys
from typing import Sequence

from push_control.identification.identification import identify_together, PushedRecording
from push_model.files.parameter_files import read_object, read_robot
from push_scenario.recordings.bag import read_tracks
from push_scenario.recordings.object_file import object_file, summary
from push_scenario.recordings.segmentation import split_pushes

EXIT_DONE = 0
EXIT_MISUSE = 2


def main(arguments: Sequence[str] | None = None) -> int:
    """
    Run the command line.

    :param arguments: words after the command's name; None for those of the process.
    :return: exit status: 0 when the file is written, 2 on an error.
    """
    options = make_parser().parse_args(arguments)
    try:
        _identify(options)
    except (ValueError, OSError, RuntimeError) as error:
        print(f'push identify: {error}', file=sys.stderr)
        return EXIT_MISUSE
    return EXIT_DONE


def make_parser() -> argparse.ArgumentParser:
    """Make the parser of the command line."""
    parser = argparse.ArgumentParser(
        prog='push identify', description='Identify centre of friction, c^2 and contact friction '
        'of objects from recorded pushes; see docs/identify.md.')
    parser.add_argument('bag', type=Path, nargs='+', metavar='BAG',
                        help='folder of a rosbag2 recording, one for each object; all objects '
                        'are pushed with the same bumper')
    parser.add_argument('--object', required=True, nargs='+', metavar='OBJECT',
                        help='nominal object of each bag: a name in config/objects, or a file')
    parser.add_argument('--robot', required=True, metavar='ROBOT',
                        help='robot: a name in config/robots, or a file')
    parser.add_argument('--odom', default='odom', metavar='TOPIC',
                        help='poses of the robot, in the frame of the object poses')
    parser.add_argument('--object-pose', default='object_pose', metavar='TOPIC',
                        help='poses of the object')
    parser.add_argument('--out', type=Path, nargs='+', default=[Path('identified_object.yaml')],
                        metavar='FILE', help='object file to write for each bag')
    return parser


def _identify(options: argparse.Namespace) -> None:
    bags: list[Path] = options.bag
    for name, values in (('--object', options.object), ('--out', options.out)):
        if len(values) != len(bags):
            raise ValueError(f'{name}: got {len(values)}, expected one for each of the '
                             f'{len(bags)} bags')
    # Found now rather than when everything has been computed.
    for out in options.out:
        if not out.parent.is_dir():
            raise ValueError(f'--out: got {out}, expected a file in a folder that exists')
    robot = read_robot(options.robot)
    recordings: list[PushedRecording] = []
    for bag, name in zip(bags, options.object):
        obj = read_object(name)
        robot_track, object_track = read_tracks(bag, (options.odom, options.object_pose))
        pushes = split_pushes(obj, robot, robot_track, object_track)
        print(f'recorded pushes: {len(pushes)}', file=sys.stderr)
        recordings.append(PushedRecording(obj, pushes))
    for bag, out, result in zip(bags, options.out, identify_together(recordings, robot.radius)):
        out.write_text(object_file(result, bag.name), encoding='utf-8')
        print('\n'.join([*summary(result), f'written: {out}']))


if __name__ == '__main__':
    sys.exit(main())
