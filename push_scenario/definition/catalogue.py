"""Scenarios of the package: their names, files and descriptions, read without the rest of them."""

from pathlib import Path

from push_model.files.data import share_directory
from push_model.files.strict_yaml import first_value, ParameterFileError
from push_model.suggestion import did_you_mean


def scenario_directory() -> Path:
    """Return the folder of the scenarios of the package."""
    return share_directory() / 'config' / 'scenarios'


def scenario_names() -> list[str]:
    """List the names of the scenarios of the package, sorted."""
    return sorted(path.stem for path in scenario_directory().glob('*.yaml'))


def find_scenario(name: str | Path) -> Path:
    """
    Find a scenario by path, or by name among those of the package.

    :param name: path of a file, or name such as ``straight_push``.
    :return: its path.
    :raises ParameterFileError: where there is none, with the names there are.
    """
    path = Path(name)
    if path.suffix in ('.yaml', '.yml') or path.is_file():
        return path
    path = scenario_directory() / f'{name}.yaml'
    if not path.is_file():
        names = scenario_names()
        raise ParameterFileError(f'{name}: got no such scenario, expected a path or one of '
                                 + ', '.join(names) + did_you_mean(str(name), names))
    return path


def scenario_description(name: str | Path) -> str:
    """
    Read the description of a scenario, with which its file begins.

    :param name: as for ``find_scenario``.
    :return: some sentences.
    :raises ParameterFileError: where the file cannot be read, or begins with something else.
    """
    return first_value(find_scenario(name), 'description')
