"""The command ``stable-regions``: where a robot can push an object without steering."""

import functools
from pathlib import Path

from push_scenario.definition.data import share_directory
from push_scenario.definition.loader import read_object, read_robot
from push_study.framework.values import read_overrides, read_table, refuse_unknown
from push_study.maps import object_regions

FIXED = ('object', 'robot', 'speeds')


def register(actions, run_studies):
    """
    Add the command.

    :param actions: subparsers of the command line.
    :param run_studies: function of (studies, overrides, options, table) that runs studies.
    :return: its parser.
    """
    parser = scene_parser(
        actions, 'stable-regions', 'map where a robot pushes an object stably, at several speeds',
        'places, distance, duration or accuracy')
    parser.set_defaults(action=functools.partial(_run, run_studies), page=None)
    parser.add_argument('--speed', type=float, nargs='+', default=(), metavar='V',
                        help='speeds of the push [m/s] (default: '
                        f"{object_regions.SLOW:g} and the robot's greatest)")
    return parser


def scene_parser(actions, name, text, names):
    """
    Make the parser of a command about an object and a robot.

    :param actions: subparsers of the command line.
    :param name: of the command.
    :param text: what it does.
    :param names: of the values that ``--set`` takes, for the help.
    :return: the parser.
    """
    parser = actions.add_parser(name, help=text)
    parser.add_argument('--object', required=True, metavar='NAME',
                        help='file of an object, or name among config/objects')
    parser.add_argument('--robot', required=True, metavar='NAME',
                        help='file of a robot, or name among config/robots')
    parser.add_argument('--set', action='append', default=[], metavar='NAME=VALUE',
                        help=f'another value for {names}')
    return parser


def find(folder, name):
    """
    Find a file by path, or by name among those that come with the package.

    :param folder: ``objects`` or ``robots``.
    :param name: path of a file, or name such as ``coffee_table``.
    :return: its path.
    :raises ValueError: where there is none, with the names there are.
    """
    path = Path(name)
    if path.suffix in ('.yaml', '.yml') or path.is_file():
        return path
    known = {path.stem: path for path in (share_directory() / 'config' / folder).glob('*.yaml')}
    if name not in known:
        raise ValueError(f'{folder[:-1]}: got {name!r}, expected a path or one of '
                         + ', '.join(sorted(known)))
    return known[name]


def _run(run_studies, options):
    paths = find('objects', options.object), find('robots', options.robot)
    what = paths[0].stem, read_object(paths[0]), paths[1].stem, read_robot(paths[1])
    study = object_regions.study_of(*what)
    chosen = object_regions.choices(*what, options.speed)
    overrides = read_overrides(options.set)
    refuse_unknown(overrides, [study])
    for name in FIXED:
        if name in overrides:
            raise ValueError(f'--set {name}: got {overrides[name]!r}, expected the options '
                             '--object, --robot and --speed')
    section = {**read_table()[object_regions.NAME], **chosen}
    return run_studies([study], {**overrides, **chosen}, options, {study.figure: section})
