"""What was learned of an object by pushing it, kept from one task to the next."""

import dataclasses
import hashlib
import json
import math
from typing import Any, Mapping

from push_model.parameters import PushedObject
from push_model.quantity import check, quantity

# Hexadecimal digits of a key; chosen: enough for objects in one file to differ for certain.
KEY_DIGITS = 16


@dataclasses.dataclass(frozen=True)
class ObjectKnowledge:
    """
    Friction of an object as identified, with standard deviations.

    :raises ValueError: naming the field that is wrong.
    """

    friction_center: tuple[float, float] = quantity(
        'centre of friction (x, y) in the object frame', 'm')
    center_deviation: float = quantity(
        'standard deviation of the centre of friction, along each axis', 'm', 0.0)
    contact_friction: float = quantity('Coulomb friction between outline and robot', '', 0.0, 10.0)
    contact_friction_deviation: float = quantity('standard deviation of the contact friction', '',
                                                 0.0)
    age: float = quantity('time since it was learned', 's', 0.0, default=0.0)

    def __post_init__(self) -> None:
        """Validate the fields."""
        check(self)
        if len(self.friction_center) != 2:
            raise ValueError(f'ObjectKnowledge.friction_center: got {self.friction_center!r}, '
                             'expected two numbers (x, y) [m]')

    def aged(self, dt: float, center_walk: float,
             contact_friction_walk: float) -> 'ObjectKnowledge':
        """
        Let time pass: floor and surfaces change, as random walks.

        The variances grow by ``walk^2 dt``, so that two spans of time give the same as their sum.

        :param dt: time that has passed [s], at least 0.
        :param center_walk: random walk of the centre of friction along each axis [m/sqrt(s)].
        :param contact_friction_walk: random walk of the contact friction [1/sqrt(s)].
        :return: the same knowledge, older and less certain.
        """
        root = math.sqrt(dt)
        return dataclasses.replace(
            self, age=self.age + dt,
            center_deviation=math.hypot(self.center_deviation, center_walk * root),
            contact_friction_deviation=math.hypot(self.contact_friction_deviation,
                                                  contact_friction_walk * root))

    def to_mapping(self) -> dict[str, Any]:
        """Turn it into plain numbers and lists, as ``from_mapping`` reads them."""
        values = {field.name: getattr(self, field.name) for field in dataclasses.fields(self)}
        return {**values, 'friction_center': list(self.friction_center)}

    @classmethod
    def from_mapping(cls, values: Mapping[str, Any]) -> 'ObjectKnowledge':
        """
        Make it of plain numbers and lists.

        :param values: fields by name; all but ``age`` are required.
        :raises ValueError: naming the field that is missing, unknown or wrong.
        """
        fields = {field.name: field for field in dataclasses.fields(cls)}
        unknown = sorted(set(values) - set(fields))
        if unknown:
            raise ValueError(f'ObjectKnowledge.{unknown[0]}: got an unknown field, expected one '
                             'of ' + ', '.join(fields))
        for name, field in fields.items():
            if name not in values and field.default is dataclasses.MISSING:
                raise ValueError(f'ObjectKnowledge.{name}: got nothing, expected the '
                                 + field.metadata['description'])
        return cls(**values)


def object_key(obj: PushedObject) -> str:
    """
    Name an object by its nominal parameters, the same in every process.

    What was learned belongs to these: for an object that was measured again it does not hold.

    :return: ``object_`` and hexadecimal digits.
    """
    text = json.dumps(dataclasses.asdict(obj), sort_keys=True)
    return 'object_' + hashlib.sha256(text.encode()).hexdigest()[:KEY_DIGITS]
