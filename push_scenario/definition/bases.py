"""Bases that do not do what they are told, as in ``config/bases``."""

import dataclasses
from pathlib import Path
from typing import Any

from push_model.files.data import share_directory
from push_model.files.mapping import expect_mapping, from_mapping, Location, merge, to_mapping
from push_model.files.parameter_files import files_by_name
from push_model.files.strict_yaml import load_yaml
from push_model.parameters import RoundRobot
from push_scenario.definition.scenario import Scenario
from push_sim_node.drive_imperfections import DriveImperfections

FOLDER = 'bases'
KEYS = 'robot', 'drive'


def base_names() -> list[str]:
    """List the names of the bases of the package, sorted."""
    return list(files_by_name(share_directory() / 'config' / FOLDER))


def read_base(path: Path) -> dict[str, dict[str, Any]]:
    """
    Read a file of ``config/bases``.

    :param path: the file.
    :return: ``robot``, true values of the robot, and ``drive``, those of ``simulation.drive``.
    :raises ParameterFileError: naming file and key, what came and what was expected.
    """
    values, at = load_yaml(path), Location(path)
    for key in values:
        if key not in KEYS:
            raise at.key(key).error('got an unknown key, expected robot or drive')
    return {key: expect_mapping(values.get(key, {}), at.key(key)) for key in KEYS}


def with_base(scenario: Scenario, path: Path) -> Scenario:
    """
    Let the simulated base be another one, of which planner and controller are not informed.

    :param path: file as of ``read_base``; what it leaves out is as stated of the robot, and ideal.
    :raises ParameterFileError: naming what is wrong.
    """
    base, at = read_base(path), Location(path)
    robot = merge(to_mapping(scenario.robot), base['robot'], at.key('robot'))
    drive = from_mapping(DriveImperfections, base['drive'], at.key('drive'))
    return dataclasses.replace(
        scenario, true_robot=from_mapping(RoundRobot, robot, at.key('robot')),
        simulation=dataclasses.replace(scenario.simulation, drive=drive))
