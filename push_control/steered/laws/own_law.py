"""Steering laws of one's own: imported by name, and watched."""

import functools
import importlib
import inspect
import math
from typing import Any

from push_control.law_names import is_own_law, law_reference
from push_control.settings import ControlSettings
from push_control.steered.laws.steering_law import SolverReport, SteeringInput, SteeringLaw
from push_model.parameters import RoundRobot


class OwnLaw(SteeringLaw):
    """A law of one's own, whose answers are checked: what is no number would steer to a side."""

    def __init__(self, robot: RoundRobot, settings: ControlSettings):
        """
        Make the law that the settings name.

        :raises ValueError: as of ``import_law``.
        """
        law: Any = import_law(settings.control_law)
        self._law: SteeringLaw = law(robot, settings)
        self._name = settings.control_law

    @property
    def solver(self) -> SolverReport:
        """Report of the law's solver."""
        return self._law.solver

    def reset(self) -> None:
        """Forget what was planned and commanded."""
        self._law.reset()

    def curvature(self, steering: SteeringInput) -> float:
        """
        Choose the curvature of z.

        :raises ValueError: where the law chooses none.
        """
        curvature: Any = self._law.curvature(steering)
        try:
            number = float(curvature)
        except (TypeError, ValueError):
            number = math.nan
        if not math.isfinite(number):
            raise ValueError(f'{self._name}.curvature: got {curvature!r}, expected a finite '
                             'number [1/m]')
        return number


def check_own_law(settings: ControlSettings) -> None:
    """
    Check a law of one's own before anything starts; those of the package need no check.

    :raises ValueError: as of ``import_law``.
    """
    if is_own_law(settings.control_law):
        import_law(settings.control_law)


def import_law(name: str) -> type[SteeringLaw]:
    """
    Import a law of one's own.

    :param name: ``module:Class``, or that of an entry point.
    :return: a subclass of ``SteeringLaw`` that can be made from ``(robot, settings)``.
    :raises ValueError: where it cannot be imported, or has another interface.
    """
    module, _, attribute = law_reference(name).partition(':')
    try:
        law: Any = functools.reduce(getattr, attribute.split('.'), importlib.import_module(module))
    except (ImportError, AttributeError) as error:
        raise ValueError(f'control_law: got {name!r}: {error}; expected a class in a module that '
                         'Python finds (PYTHONPATH)') from error
    if not (inspect.isclass(law) and issubclass(law, SteeringLaw)):
        raise ValueError(f'control_law: got {name!r}, which is {law!r}, expected a subclass of '
                         'push_control.SteeringLaw')
    missing: list[str] = sorted(getattr(law, '__abstractmethods__', ()))
    if missing:
        raise ValueError(f'control_law: got {name!r} without {", ".join(missing)}, expected a law '
                         'that implements these')
    try:
        inspect.signature(law).bind('robot', 'settings')
    except TypeError as error:
        raise ValueError(f'control_law: got {name!r} with {inspect.signature(law)}, expected a '
                         'class that is made from (robot, settings)') from error
    return law
