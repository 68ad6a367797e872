"""What is installed only where it is needed."""

from importlib import util

# Extra of the package that brings a module.
EXTRAS = {'aiohttp': 'play', 'argcomplete': 'completion', 'casadi': 'steered',
          'cv2': 'vision', 'distributed': 'cluster', 'gymnasium': 'gym', 'matplotlib': 'plot',
          'mujoco': 'mujoco', 'pandas': 'table', 'PIL': 'plot', 'py_trees': 'trees',
          'rosbags': 'record', 'segno': 'play', 'tqdm': 'plot'}


def is_casadi_installed() -> bool:
    """Tell whether there are solvers: steered pushes are planned, and predicted, by casadi."""
    return util.find_spec('casadi') is not None


def how_to_install(module: str | None) -> str:
    """
    Say what is missing, and how to get it.

    :param module: name of a module that could not be imported.
    :return: half a sentence, such as ``no module aiohttp: pip install 'push_control[play]'``;
        empty for a module that no extra brings.
    """
    name = (module or '').partition('.')[0]
    if name not in EXTRAS:
        return ''
    return f"no module {name}: pip install 'push_control[{EXTRAS[name]}]'"
