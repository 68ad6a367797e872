"""An object file with identified friction."""

from typing import Any

from push_control.identification.identification import Identification
from push_model.interval import Interval
from push_model.parameters import PushedObject
import yaml

# Chosen: digits of the numbers in the file.
DIGITS = 6


def object_file(found: Identification, source: str) -> str:
    """
    Write an object file.

    :param found: of a recording.
    :param source: what was recorded, for the comment.
    :return: YAML, as ``read_object`` takes it, the intervals as comments.
    """
    lines = [f'# Identified from {found.pushes} pushes of {source}, 95 % intervals:',
             *(f'# {line}' for line in summary(found))]
    return '\n'.join(lines) + '\n' + yaml.safe_dump(_fields(found.object), sort_keys=False,
                                                    default_flow_style=None)


def summary(found: Identification) -> list[str]:
    """
    State what was identified.

    :param found: of a recording.
    :return: lines.
    """
    return [f'centre of friction x {_text(found.friction_center_x)} m',
            f'centre of friction y {_text(found.friction_center_y)} m',
            f'c^2 over the nominal one {_text(found.c_squared_ratio)}',
            f'contact friction {_text(found.contact_friction)} '
            f'(contact slid in {found.sliding} of {found.pushes} pushes)',
            f'ends of the pushes are off by {1e3 * found.sigma:.1f} mm (standard deviation)']


def _text(interval: Interval) -> str:
    return f'{interval.value:.4f} ({interval.low:.4f} to {interval.high:.4f})'


def _fields(obj: PushedObject) -> dict[str, Any]:
    fields: dict[str, Any] = {
        'mass': obj.mass, 'inertia': round(obj.inertia, DIGITS),
        'center_of_mass': [round(value, DIGITS) for value in obj.center_of_mass]}
    if obj.outline:
        fields['outline'] = [[round(x, DIGITS), round(y, DIGITS)] for x, y in obj.outline]
    else:
        fields['radius'] = obj.radius
    fields['supports'] = [
        {'x': round(support.x, DIGITS), 'y': round(support.y, DIGITS),
         'friction_coefficient': round(support.friction_coefficient, DIGITS)}
        for support in obj.supports]
    fields['contact_friction_coefficient'] = round(obj.contact_friction_coefficient, DIGITS)
    return fields
