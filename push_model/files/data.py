"""Where scenarios, objects, robots and parameters are, however the package was installed."""

from collections.abc import Iterator, Mapping
import os
from pathlib import Path
import sys

PACKAGE = 'push_control'


def share_directory(module_file: str | Path = __file__,
                    environment: Mapping[str, str] | None = None) -> Path:
    """
    Find the directory that holds ``package.xml``, ``config`` and ``launch``.

    The data belong to the code that reads them, so the tree around this module comes first: the
    source tree, or the prefix of a pip or colcon installation. The ament index and the
    interpreter's prefix are searched only after it.

    :param module_file: the file whose surroundings are searched.
    :param environment: environment variables, those of the process by default.
    :return: the directory.
    :raises FileNotFoundError: naming the places that were searched.
    """
    environment = os.environ if environment is None else environment
    searched: list[str] = []
    for candidate in _candidates(Path(module_file).resolve(), environment):
        if (candidate / 'package.xml').is_file() and (candidate / 'config').is_dir():
            return candidate
        searched.append(str(candidate))
    raise FileNotFoundError(
        f'the data of {PACKAGE} (package.xml beside config/): got none of ' + ', '.join(searched)
        + '; expected an installation by pip or colcon, or the source tree')


def config_file(name: str) -> Path:
    """
    Find one file of the package's ``config`` directory.

    :param name: path below ``config``, for example ``'scenarios/task_demo.yaml'``.
    :return: the file.
    :raises FileNotFoundError: naming the file and where it should have been.
    """
    path = share_directory() / 'config' / name
    if not path.is_file():
        raise FileNotFoundError(f'config file {name!r}: expected at {path}, where there is none')
    return path


def _candidates(module: Path, environment: Mapping[str, str]) -> Iterator[Path]:
    # push_model/files/data.py: two folders up is the source tree.
    yield module.parents[2]
    for prefix in module.parents:
        yield prefix / 'share' / PACKAGE
    for prefix in environment.get('AMENT_PREFIX_PATH', '').split(os.pathsep):
        if prefix:
            yield Path(prefix) / 'share' / PACKAGE
    yield Path(sys.prefix) / 'share' / PACKAGE
