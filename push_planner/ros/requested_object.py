"""Parameters of the planner that a request overrules, as it brings the object to be pushed."""

import numpy as np
from push_model.parameters import PushedObject

# Fields of an object that nobody learns on the way: those of friction are of the request anyway.
FIELDS = 'mass', 'outline', 'radius', 'center_of_mass', 'contact_height', 'center_of_mass_height'


def overruled_fields(obj: PushedObject, requested: PushedObject) -> tuple[str, ...]:
    """
    List the fields in which the object of a request is another one.

    :param obj: that of the parameters.
    """
    return tuple(name for name in FIELDS
                 if not _agree(getattr(obj, name), getattr(requested, name)))


def _agree(one: object, other: object) -> bool:
    first, second = np.asarray(one, dtype=float), np.asarray(other, dtype=float)
    return first.shape == second.shape and bool(np.allclose(first, second))


class OverruledParameters:
    """Notes once which parameters of the object have no effect, as requests bring another one."""

    def __init__(self, obj: PushedObject) -> None:
        """
        Start without a request.

        :param obj: that of the parameters.
        """
        self._obj = obj
        self._noted: set[tuple[str, ...]] = set()

    def note(self, requested: PushedObject) -> str:
        """
        Take the object of a request.

        :return: one sentence on the parameters that it overrules; empty where there are none, or
            where that was said before.
        """
        names = overruled_fields(self._obj, requested)
        if not names or names in self._noted:
            return ''
        self._noted.add(names)
        parameters = ', '.join(f'object.{name}' for name in names)
        return f'{parameters}: without effect, as the request brings another object'
