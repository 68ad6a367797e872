"""The commands ``stable-regions`` and ``drive-map``: maps of any object and any robot."""

import argparse
import functools
from typing import Any, Callable, NamedTuple

from push_model.files.parameter_files import named_file, read_object, read_robot
from push_model.parameters import PushedObject, RoundRobot
from push_study.framework.parameters import (
    check_known, ChosenValues, Overrides, read_chosen_values, read_overrides,
)
from push_study.framework.study import Study
from push_study.maps import drive_map, object_map

RunStudy = Callable[[Study, ChosenValues, Overrides, argparse.Namespace], None]
Subparsers = Any


class Subject(NamedTuple):
    """
    What a map is about.

    :param object_name: name of the object's file.
    :param obj: the object.
    :param robot_name: name of the robot's file.
    :param robot: the robot.
    """

    object_name: str
    obj: PushedObject
    robot_name: str
    robot: RoundRobot


def register(actions: Subparsers, run_study: RunStudy) -> tuple[argparse.ArgumentParser, ...]:
    """
    Add both commands.

    :param actions: subparsers of the command line.
    :param run_study: function of (study, chosen values, overrides, options).
    :return: their parsers.
    """
    regions = _add_parser(actions, object_map.NAME,
                          'map where a robot pushes an object stably, at several speeds',
                          'locations, distance, duration or accuracy')
    regions.set_defaults(action=functools.partial(_map_stable_regions, run_study))
    regions.add_argument('--speed', type=float, nargs='+', default=(), metavar='V',
                         help='speeds of the push [m/s] (default: '
                         f"{object_map.SLOW_SPEED:g} and the robot's greatest)")
    steering = _add_parser(actions, drive_map.NAME,
                           'map how sharply a robot can steer an object, contact by contact',
                           'speed, heading_offset or contacts')
    steering.set_defaults(action=functools.partial(_map_steering, run_study))
    return regions, steering


def _add_parser(actions: Subparsers, name: str, text: str,
                settable: str) -> argparse.ArgumentParser:
    parser = actions.add_parser(name, help=text)
    parser.add_argument('--object', required=True, metavar='NAME',
                        help='file of an object, or name among config/objects')
    parser.add_argument('--robot', required=True, metavar='NAME',
                        help='file of a robot, or name among config/robots')
    parser.add_argument('--set', action='append', default=[], metavar='NAME=VALUE',
                        help=f'another value for {settable}')
    return parser


def _map_stable_regions(run_study: RunStudy, options: argparse.Namespace) -> None:
    subject = _read_subject(options)
    study = object_map.object_study(*subject)
    given = object_map.identifying_values(*subject, options.speed)
    _run_map(run_study, options, study, object_map.NAME, given,
             'the options --object, --robot and --speed')


def _map_steering(run_study: RunStudy, options: argparse.Namespace) -> None:
    subject = _read_subject(options)
    study = drive_map.drive_study(*subject)
    values = object_map.identifying_values(*subject)
    given = {name: values[name] for name in ('object', 'robot')}
    _run_map(run_study, options, study, drive_map.NAME, given, 'the options --object and --robot')


def _read_subject(options: argparse.Namespace) -> Subject:
    obj, robot = named_file('objects', options.object), named_file('robots', options.robot)
    return Subject(obj.stem, read_object(obj), robot.stem, read_robot(robot))


def _run_map(run_study: RunStudy, options: argparse.Namespace, study: Study, section: str,
             given: dict[str, Any], instead: str) -> None:
    """Run a study with the values that the options give, and those of its section."""
    overrides = read_overrides(options.set)
    check_known(overrides, study.parameters)
    for name in given:
        if name in overrides:
            raise ValueError(f'--set {name}: got {overrides[name]!r}, expected {instead}')
    chosen = {study.figure: {**read_chosen_values()[section], **given}}
    run_study(study, chosen, {**overrides, **given}, options)
