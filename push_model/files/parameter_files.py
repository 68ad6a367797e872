"""Objects and robots by name or path, as in ``config/objects`` and ``config/robots``."""

from pathlib import Path

from push_model.files.data import share_directory
from push_model.files.mapping import from_mapping, Location
from push_model.files.strict_yaml import load_yaml, ParameterFileError
from push_model.parameters import PushedObject, RoundRobot


def read_object(name: str | Path) -> PushedObject:
    """
    Read an object by path, or by name among those of the package.

    :param name: path of a file, or name such as ``box_04``.
    :raises ParameterFileError: naming file and key, what came and what was expected.
    """
    path = named_file('objects', name)
    return from_mapping(PushedObject, load_yaml(path), Location(path))


def read_robot(name: str | Path) -> RoundRobot:
    """
    Read a robot by path, or by name among those of the package.

    :param name: path of a file, or name such as ``disc_017``.
    :raises ParameterFileError: naming file and key, what came and what was expected.
    """
    path = named_file('robots', name)
    return from_mapping(RoundRobot, load_yaml(path), Location(path))


def named_file(folder: str, name: str | Path) -> Path:
    """
    Find a file of objects, robots or sensors by path, or by name among those of the package.

    :param folder: below ``config``, as ``objects``.
    :param name: path of a file, or name such as ``box_04``.
    :return: its path.
    :raises ParameterFileError: where there is none, with the name and those there are.
    """
    path = Path(name)
    if path.suffix in ('.yaml', '.yml') or path.is_file():
        return path
    files = files_by_name(share_directory() / 'config' / folder)
    if str(name) not in files:
        raise ParameterFileError(f'{folder[:-1]}: got {str(name)!r}, expected a path or one of '
                                 + ', '.join(files))
    return files[str(name)]


def files_by_name(folder: Path) -> dict[str, Path]:
    """
    List the parameter files of a folder, sorted.

    :param folder: the folder.
    :return: paths by name, which is that of the file without its suffix.
    """
    return {path.stem: path for path in sorted(folder.glob('*.yaml'))}
