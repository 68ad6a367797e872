"""The command ``stable-regions``: where any robot pushes any object stably."""

import argparse
import functools
from typing import Any, Callable, NamedTuple

from push_model.files.parameter_files import named_file, read_object, read_robot
from push_model.parameters import PushedObject, RoundRobot
from studies.framework.parameters import (
    check_known, ChosenValues, Overrides, read_chosen_values, read_overrides,
)
from studies.framework.study import Study
from studies.maps import object_map

RunStudy = Callable[[Study, ChosenValues, Overrides, argparse.Namespace], None]
Subparsers = Any


class Subject(NamedTuple):
    """
    Subject of a map.

    :param object_name: name of the object's file.
    :param obj: the object.
    :param robot_name: name of the robot's file.
    :param robot: the robot.
    """

    object_name: str
    obj: PushedObject
    robot_name: str
    robot: RoundRobot


def register(actions: Subparsers, run_study: RunStudy) -> argparse.ArgumentParser:
    """
    Add the command.

    :param actions: subparsers of the command line.
    :param run_study: function of (study, chosen values, overrides, options).
    :return: its parser.
    """
    parser = actions.add_parser(
        object_map.NAME, help='map where a robot pushes an object stably, at several speeds')
    parser.add_argument('--object', required=True, metavar='NAME',
                        help='file of an object, or name among config/objects')
    parser.add_argument('--robot', required=True, metavar='NAME',
                        help='file of a robot, or name among config/robots')
    parser.add_argument('--set', action='append', default=[], metavar='NAME=VALUE',
                        help='another value for locations, distance, duration or accuracy')
    parser.add_argument('--speed', type=float, nargs='+', default=(), metavar='V',
                        help='speeds of the push [m/s] (default: '
                        f"{object_map.SLOW_SPEED:g} and the robot's greatest)")
    parser.set_defaults(action=functools.partial(_map_stable_regions, run_study))
    return parser


def _map_stable_regions(run_study: RunStudy, options: argparse.Namespace) -> None:
    """Run the study with the values that the options give, and those of its section."""
    subject = _read_subject(options)
    study = object_map.object_study(*subject)
    identifying = object_map.identifying_values(*subject, options.speed)
    overrides = read_overrides(options.set)
    check_known(overrides, study.parameters)
    for name in identifying:
        if name in overrides:
            raise ValueError(f'--set {name}: got {overrides[name]!r}, expected the options '
                             '--object, --robot and --speed')
    chosen = {study.figure: {**read_chosen_values()[object_map.NAME], **identifying}}
    run_study(study, chosen, {**overrides, **identifying}, options)


def _read_subject(options: argparse.Namespace) -> Subject:
    obj, robot = named_file('objects', options.object), named_file('robots', options.robot)
    return Subject(obj.stem, read_object(obj), robot.stem, read_robot(robot))
