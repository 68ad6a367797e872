"""Values of a study's parameters: from the caption, from config/studies.yaml, or set by hand."""

import math
from typing import Any, NamedTuple

from push_scenario.definition import data
from push_scenario.definition.strict_yaml import load_yaml, parse_yaml

COMMON = 'all'


class Value(NamedTuple):
    """
    Value of one parameter.

    :param parameter: the ``Parameter``.
    :param value: number, text or list.
    :param source: 'caption', 'ours' or 'set'.
    """

    parameter: Any
    value: Any
    source: str

    def text(self):
        """Name, value and unit in one line."""
        unit = f' {self.parameter.unit}' if self.parameter.unit else ''
        return f'{self.parameter.name} = {_text(self.value)}{unit}'


class Values:
    """
    The parameters of a study as attributes.

    :param entries: sequence of ``Value``.
    """

    def __init__(self, entries):
        self._entries = {entry.parameter.name: entry for entry in entries}

    def __getattr__(self, name):
        """Return a parameter's value."""
        try:
            return self.__dict__['_entries'][name].value
        except KeyError:
            raise AttributeError(f'{name}: no parameter of this study') from None

    def __iter__(self):
        """Iterate over the ``Value`` of each parameter."""
        return iter(self._entries.values())


def read_table(path=None):
    """
    Read the table of values that captions leave open.

    :param path: of the YAML file; None for the one that comes with the package.
    :return: dict of figure numbers (and ``'all'``) to dicts of names to values.
    :raises ScenarioError: where the file is not such a table.
    """
    path = path or data.config_file('studies.yaml')
    return {str(key): section for key, section in load_yaml(path).items()}


def values_of(study, table, overrides=()):
    """
    Find the value of every parameter of a study.

    :param study: the ``Study``.
    :param table: of ``read_table``.
    :param overrides: dict of names to values that come before all others; names that the study
        does not have are left out.
    :return: ``Values``.
    :raises ValueError: where the table has no value, or an override is of another kind.
    """
    entries = []
    for parameter in study.parameters:
        value, source = parameter.caption, 'caption'
        if value is None:
            value, source = _ours(study, parameter, table), 'ours'
        if parameter.name in overrides:
            new = overrides[parameter.name]
            value, source = _like(value, new, parameter), 'set'
        entries.append(Value(parameter, value, source))
    return Values(entries)


def read_overrides(words):
    """
    Read ``name=value`` words, values as in YAML.

    :param words: list of text.
    :return: dict.
    :raises ValueError: for a word of another form.
    """
    overrides = {}
    for word in words:
        name, equals, text = word.partition('=')
        if not (equals and name.isidentifier() and text.strip()):
            raise ValueError(f'--set: got {word!r}, expected NAME=VALUE, such as mass=2.0')
        overrides[name] = parse_yaml(f'value: {text}', f'--set {name}')['value']
    return overrides


def refuse_unknown(overrides, studies):
    """
    Refuse overrides that none of the studies has.

    :param overrides: dict of names to values.
    :param studies: the studies.
    :raises ValueError: naming what there is.
    """
    known = sorted({parameter.name for study in studies for parameter in study.parameters})
    unknown = sorted(set(overrides) - set(known))
    if unknown:
        raise ValueError(f'--set: got {", ".join(unknown)}, expected some of {", ".join(known)}')


def _ours(study, parameter, table):
    for section in (study.figure, COMMON):
        if parameter.name in table.get(section, {}):
            return table[section][parameter.name]
    raise ValueError(f'config/studies.yaml: got no {parameter.name} for {study.figure}, expected '
                     f'{parameter.meaning} [{parameter.unit or "-"}]')


def _like(old, new, parameter):
    fits = (_is_number(new) if _is_number(old) else
            isinstance(new, list) and len(new) > 0 if isinstance(old, list) else
            isinstance(new, type(old)))
    if not fits:
        kind = 'a finite number' if _is_number(old) else f'something like {_text(old)}'
        raise ValueError(f'--set {parameter.name}: got {new!r}, expected {kind}'
                         + (f' [{parameter.unit}]' if parameter.unit else ''))
    return new


def _is_number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)


def _text(value):
    if isinstance(value, (list, tuple)):
        return '[' + ', '.join(map(_text, value)) + ']'
    return f'{value:g}' if isinstance(value, float) else str(value)
