"""An object file with identified friction."""

from typing import Any

from push_control.identification.identification import Identification
from push_model.interval import Interval
from push_model.parameters import PushedObject
import yaml

# Chosen: digits of the numbers in the file.
DIGITS = 6


def object_file(result: Identification, source: str) -> str:
    """
    Write an object file.

    :param result: of a recording.
    :param source: what was recorded, for the comment.
    :return: YAML, as ``read_object`` takes it, the intervals as comments.
    """
    lines = [f'# Identified from {result.pushes} pushes of {source}, 95 % intervals:',
             *(f'# {line}' for line in summary(result))]
    return '\n'.join(lines) + '\n' + yaml.safe_dump(_fields(result.object), sort_keys=False,
                                                    default_flow_style=None)


def summary(result: Identification) -> list[str]:
    """
    State what was identified.

    :param result: of a recording.
    :return: lines.
    """
    return [f'centre of friction x {_text(result.friction_center_x)} m',
            f'centre of friction y {_text(result.friction_center_y)} m',
            f'c^2 over the nominal one {_text(result.c_squared_ratio)}',
            'friction on the floor is ' + ('not ' if result.is_free else '') + 'as statics has it',
            f'contact friction {_text(result.contact_friction)} '
            f'(contact slid in {result.sliding} of {result.pushes} pushes)',
            f'ends of the pushes are off by {1e3 * result.sigma:.1f} mm (standard deviation)']


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
    fields['contact_height'] = obj.contact_height
    fields['center_of_mass_height'] = obj.center_of_mass_height
    return fields
