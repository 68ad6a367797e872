"""What tests need beyond the requirements of the package: the extras of setup.py."""

import importlib
from importlib import util
from types import ModuleType

import pytest


def import_extra(module: str, extra: str, submodule: str = '') -> ModuleType:
    """
    Import a module of an extra; skip the test, or the whole file of tests, where it is missing.

    :param module: top-level module that the extra installs.
    :param extra: name of the extra in setup.py.
    :param submodule: what to import of it, or a module of ours that needs it.
    :return: the module.
    """
    if util.find_spec(module) is None:
        pytest.skip(f'{module} is not installed, which the extra {extra!r} brings',
                    allow_module_level=True)
    return importlib.import_module(submodule or module)


def skip_without_graphics() -> None:
    """Skip a test that draws images in MuJoCo where there is neither EGL nor OSMesa."""
    rendering = import_extra('mujoco', 'mujoco', 'push_mujoco.rendering')
    try:
        rendering.check_graphics()
    except rendering.NoRenderer as error:
        pytest.skip(str(error))
