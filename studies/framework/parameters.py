"""Parameters of a study and their values: from the thesis, from studies/values.yaml, or set."""

import enum
import math
from pathlib import Path
from typing import Any, Iterable, Iterator, Mapping, NamedTuple, Sequence

from push_model.files.strict_yaml import load_yaml, parse_yaml

# Section of studies/values.yaml whose values hold for every figure that has none of its own.
SHARED_SECTION = 'all'
VALUES_FILE = Path(__file__).resolve().parents[1] / 'values.yaml'


class Parameter(NamedTuple):
    """
    A parameter of a study.

    :param name: as ``--set`` takes it.
    :param unit: SI, empty for a pure number.
    :param meaning: in words.
    :param captioned: value stated by the caption of the figure in the thesis; None where the
        caption leaves it open, so that ``studies/values.yaml`` chooses one.
    """

    name: str
    unit: str
    meaning: str
    captioned: Any = None


class Source(enum.Enum):
    """Source of the value of a parameter."""

    CAPTION = 'caption'
    CHOSEN = 'chosen'
    OVERRIDE = 'override'


class Value(NamedTuple):
    """
    Value of one parameter.

    :param parameter: whose value it is.
    :param value: number, text or list.
    :param source: where it comes from.
    """

    parameter: Parameter
    value: Any
    source: Source

    def text(self) -> str:
        """Write name, value and unit in one line."""
        unit = f' {self.parameter.unit}' if self.parameter.unit else ''
        return f'{self.parameter.name} = {_text(self.value)}{unit}'


class Values:
    """
    The values of a study's parameters, as attributes.

    :param entries: one per parameter.
    """

    def __init__(self, entries: Iterable[Value]) -> None:
        self._entries = {entry.parameter.name: entry for entry in entries}

    def __getattr__(self, name: str) -> Any:
        """Return the value of a parameter."""
        try:
            return self.__dict__['_entries'][name].value
        except KeyError:
            raise AttributeError(f'{name}: no parameter of this study') from None

    def __iter__(self) -> Iterator[Value]:
        """Iterate over the ``Value`` of each parameter."""
        return iter(self._entries.values())


ChosenValues = Mapping[str, Mapping[str, Any]]
Overrides = Mapping[str, Any]


def read_chosen_values(path: Path | None = None) -> ChosenValues:
    """
    Read the values of what the captions leave open.

    :param path: YAML file; None for the one that comes with the package.
    :return: section (figure number, or ``SHARED_SECTION``) -> parameter name -> value.
    :raises ParameterFileError: where the file is not such a table.
    """
    path = path or VALUES_FILE
    return {str(key): section for key, section in load_yaml(path).items()}


def resolve(figure: str, parameters: Sequence[Parameter], chosen: ChosenValues,
            overrides: Overrides) -> Values:
    """
    Find the value of every parameter: an override, else the caption's, else the chosen one.

    :param figure: number of the figure, the section of ``chosen`` that is looked up first.
    :param parameters: of the study.
    :param chosen: table as returned by ``read_chosen_values``.
    :param overrides: parameter name -> value; names that the study does not have are ignored.
    :return: ``Values`` in the order of the parameters.
    :raises ValueError: where no value is chosen, or an override is of another type.
    """
    entries: list[Value] = []
    for parameter in parameters:
        value, source = parameter.captioned, Source.CAPTION
        if value is None:
            value, source = _chosen_value(figure, parameter, chosen), Source.CHOSEN
        if parameter.name in overrides:
            value = _checked_override(parameter, value, overrides[parameter.name])
            source = Source.OVERRIDE
        entries.append(Value(parameter, value, source))
    return Values(entries)


def read_overrides(words: Iterable[str]) -> dict[str, Any]:
    """
    Read ``NAME=VALUE`` words, with values written as in YAML.

    :param words: arguments of ``--set``.
    :return: parameter name -> value.
    :raises ValueError: for a word of another form.
    """
    overrides: dict[str, Any] = {}
    for word in words:
        name, equals, text = word.partition('=')
        if not (equals and name.isidentifier() and text.strip()):
            raise ValueError(f'--set: got {word!r}, expected NAME=VALUE, such as mass=2.0')
        overrides[name] = parse_yaml(f'value: {text}', f'--set {name}')['value']
    return overrides


def check_known(overrides: Overrides, parameters: Iterable[Parameter]) -> None:
    """
    Refuse overrides of parameters that do not exist.

    :param overrides: parameter name -> value.
    :param parameters: of all studies that are to run.
    :raises ValueError: naming the parameters there are.
    """
    known = sorted({parameter.name for parameter in parameters})
    unknown = sorted(set(overrides) - set(known))
    if unknown:
        raise ValueError(f'--set: got {", ".join(unknown)}, expected some of {", ".join(known)}')


def _chosen_value(figure: str, parameter: Parameter, chosen: ChosenValues) -> Any:
    for section in (figure, SHARED_SECTION):
        if parameter.name in chosen.get(section, {}):
            return chosen[section][parameter.name]
    raise ValueError(f'studies/values.yaml: got no {parameter.name} for {figure}, expected '
                     f'{parameter.meaning} [{parameter.unit or "-"}]')


def _checked_override(parameter: Parameter, old: Any, new: Any) -> Any:
    """Return the new value if it is of the same type as the old one."""
    if _is_finite_number(old):
        fits, expected = _is_finite_number(new), 'a finite number'
    elif isinstance(old, list):
        fits, expected = isinstance(new, list) and bool(new), f'something like {_text(old)}'
    else:
        fits, expected = isinstance(new, type(old)), f'something like {_text(old)}'
    if not fits:
        unit = f' [{parameter.unit}]' if parameter.unit else ''
        raise ValueError(f'--set {parameter.name}: got {new!r}, expected {expected}{unit}')
    return new


def _is_finite_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)


def _text(value: Any) -> str:
    if isinstance(value, (list, tuple)):
        return '[' + ', '.join(map(_text, value)) + ']'
    return f'{value:g}' if isinstance(value, float) else str(value)
