"""What is installed only where it is needed."""

from importlib import util


def is_casadi_installed() -> bool:
    """Tell whether there are solvers: steered pushes are planned, and predicted, by casadi."""
    return util.find_spec('casadi') is not None
