"""Sections of ROS parameter files that a node does not get, as it was renamed."""

from pathlib import Path
from typing import Sequence

import yaml

PARAMETER_FILE = '--params-file'


def parameter_files(arguments: Sequence[str]) -> list[Path]:
    """
    List the parameter files of a command line.

    :param arguments: as of ``sys.argv``.
    """
    return [Path(file) for option, file in zip(arguments, arguments[1:])
            if option == PARAMETER_FILE]


def missed_section(path: Path, usual_name: str, name: str) -> str:
    """
    Find the section for a node's usual name, where the file has none for its present name.

    :param usual_name: name of the node where nobody renames it.
    :param name: its present name.
    :return: the section; empty where nothing is missed, or the file cannot be read.
    """
    if name == usual_name:
        return ''
    try:
        sections = yaml.safe_load(path.read_text(encoding='utf-8'))
    except (OSError, UnicodeDecodeError, yaml.YAMLError):
        # The middleware reads the file itself, and reports what is wrong with it.
        return ''
    if not isinstance(sections, dict):
        return ''
    nodes = {str(section).rpartition('/')[2]: str(section) for section in sections}
    return '' if name in nodes else nodes.get(usual_name, '')
