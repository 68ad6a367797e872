"""Where scenarios, objects, robots and parameters lie, however the package was installed."""

import os
from pathlib import Path
import sys

PACKAGE = 'push_control'


def share_directory(module_file=__file__, environment=None):
    """
    Find the directory that holds ``package.xml``, ``config`` and ``launch``.

    The data belong to the code that reads them, so the tree around this module comes first: the
    source tree, or the prefix of a pip or colcon installation. The ament index and the
    interpreter's prefix are asked only after it.

    :param module_file: the file whose surroundings are searched.
    :param environment: environment variables, those of the process by default.
    :return: the directory as a ``Path``.
    :raises FileNotFoundError: naming the places where it was looked for.
    """
    environment = os.environ if environment is None else environment
    tried = []
    for candidate in _candidates(Path(module_file).resolve(), environment):
        if (candidate / 'package.xml').is_file() and (candidate / 'config').is_dir():
            return candidate
        tried.append(str(candidate))
    raise FileNotFoundError(
        f'the data of {PACKAGE} (package.xml beside config/): got none of ' + ', '.join(tried)
        + '; expected an installation by pip or colcon, or the source tree')


def config_file(name):
    """
    Find one file of the package's ``config`` directory.

    :param name: path below ``config``, for example ``'scenarios/demo.yaml'``.
    :return: the file as a ``Path``.
    :raises FileNotFoundError: naming the file and where it should have been.
    """
    path = share_directory() / 'config' / name
    if not path.is_file():
        raise FileNotFoundError(f'config file {name!r}: expected at {path}, where there is none')
    return path


def _candidates(module, environment):
    yield module.parents[2]
    for prefix in module.parents:
        yield prefix / 'share' / PACKAGE
    for prefix in environment.get('AMENT_PREFIX_PATH', '').split(os.pathsep):
        if prefix:
            yield Path(prefix) / 'share' / PACKAGE
    yield Path(sys.prefix) / 'share' / PACKAGE
