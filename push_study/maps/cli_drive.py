"""The command ``drive-map``: what a drive can steer at each contact of an object."""

import functools

from push_scenario.definition.loader import read_object, read_robot
from push_study.framework.values import read_overrides, read_table, refuse_unknown
from push_study.maps import drive_map, object_regions
from push_study.maps.cli_regions import find, scene_parser

FIXED = ('object', 'robot')


def register(actions, run_studies):
    """
    Add the command.

    :param actions: subparsers of the command line.
    :param run_studies: function of (studies, overrides, options, table) that runs studies.
    :return: its parser.
    """
    parser = scene_parser(
        actions, 'drive-map', 'map how sharply a robot can steer an object, contact by contact',
        'speed, heading_offset or contacts')
    parser.set_defaults(action=functools.partial(_run, run_studies), page=None)
    return parser


def _run(run_studies, options):
    paths = find('objects', options.object), find('robots', options.robot)
    what = paths[0].stem, read_object(paths[0]), paths[1].stem, read_robot(paths[1])
    study = drive_map.study_of(*what)
    labels = object_regions.choices(*what)
    chosen = {name: labels[name] for name in FIXED}
    overrides = read_overrides(options.set)
    refuse_unknown(overrides, [study])
    for name in FIXED:
        if name in overrides:
            raise ValueError(f'--set {name}: got {overrides[name]!r}, expected the option '
                             f'--{name}')
    section = {**read_table()[drive_map.NAME], **chosen}
    return run_studies([study], {**overrides, **chosen}, options, {study.figure: section})
