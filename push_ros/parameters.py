"""
Parameter dataclasses as ROS parameters of a node, with descriptions and ranges.

Nested dataclasses become dotted names, tuples of dataclasses one list for each of their fields,
and tuples of numbers flat lists:

    PushedObject.mass                   object.mass                     3.0
    PushedObject.supports[i].x          object.supports.x               [-0.1, 0.1]
    PushedObject.outline[i] = (x, y)    object.outline                  [x_0, y_0, x_1, y_1, ...]
"""

import dataclasses
import math
from typing import Any, Callable, Collection, get_args, get_origin, Mapping, Sequence

from push_model.quantity import expectation, field_types, range_text
from rcl_interfaces.msg import (
    FloatingPointRange, IntegerRange, ParameterDescriptor, SetParametersResult,
)
from rclpy.node import Node
from rclpy.parameter import Parameter

# Prefix of the names, with its dot, and the dataclass.
Section = tuple[str, type[Any]]
# What rclpy itself declares or understands.
RCLPY_NAMES = ('use_sim_time', 'start_type_description_service')
RCLPY_PREFIX = 'qos_overrides.'
# That of int64, the type of ROS integers.
LARGEST_INTEGER = 2 ** 63 - 1
# What descriptors say of parameters that may be set at any time, and of all others.
DYNAMIC = 'may be set at any time, and is used from the next movement or plan on'
READ_ONLY = 'read-only: the node is built with it; restart the node with another value'
SCALARS = {bool: Parameter.Type.BOOL, int: Parameter.Type.INTEGER, float: Parameter.Type.DOUBLE,
           str: Parameter.Type.STRING}
ARRAYS = {int: Parameter.Type.INTEGER_ARRAY, float: Parameter.Type.DOUBLE_ARRAY,
          str: Parameter.Type.STRING_ARRAY}


@dataclasses.dataclass(frozen=True)
class ParameterSpec:
    """
    One ROS parameter.

    :param name: with dots.
    :param kind: bool, int, float, str, or a list of one of them, as ``list[float]``.
    :param default: its value where none is given; None where one must be given.
    :param metadata: of ``quantity``: description, unit, range.
    """

    name: str
    kind: Any
    default: Any
    metadata: Mapping[str, Any]

    @property
    def expectation(self) -> str:
        """What the parameter accepts, in words."""
        return expectation(self.kind, self.metadata)


def parameter_specs(cls: Any, prefix: str = '') -> list[ParameterSpec]:
    """
    List the parameters of a dataclass.

    :param cls: the dataclass, of fields made with ``quantity``.
    :param prefix: put before the names, with its dot.
    :return: ``ParameterSpec`` list.
    """
    hints = field_types(cls)
    specs: list[ParameterSpec] = []
    for field in dataclasses.fields(cls):
        kind, name, default = hints[field.name], prefix + field.name, _default(field)
        item = _item_type(kind)
        if dataclasses.is_dataclass(kind):
            specs += parameter_specs(kind, f'{name}.')
        elif item is not None and dataclasses.is_dataclass(item):
            specs += [_as_list(spec, is_optional=default == ())
                      for spec in parameter_specs(item, f'{name}.')]
        elif kind in SCALARS:
            specs.append(ParameterSpec(name, kind, default, field.metadata))
        else:
            numbers = None if default is None else tuple(_flattened(default))
            specs.append(ParameterSpec(name, list[float], numbers, field.metadata))
    return specs


def to_parameter_values(instance: Any, prefix: str = '') -> dict[str, Any]:
    """
    Flatten a dataclass instance; empty lists are left out.

    :param instance: of a class that ``parameter_specs`` describes.
    :param prefix: put before the names, with its dot.
    :return: dict of names to numbers, texts and lists.
    """
    values: dict[str, Any] = {}
    for field in dataclasses.fields(instance):
        name, value = prefix + field.name, getattr(instance, field.name)
        if dataclasses.is_dataclass(value):
            values.update(to_parameter_values(value, f'{name}.'))
        elif not isinstance(value, tuple):
            values[name] = value
        elif value and dataclasses.is_dataclass(value[0]):
            for part in dataclasses.fields(value[0]):
                values[f'{name}.{part.name}'] = [getattr(item, part.name) for item in value]
        elif value:
            values[name] = _flattened(value)
    return values


def from_parameter_values(cls: Any, values: Mapping[str, Any], prefix: str = '') -> Any:
    """
    Make a dataclass instance of flat values.

    :param cls: the dataclass.
    :param values: names to values; others than its own are ignored.
    :param prefix: put before the names, with its dot.
    :raises ValueError: naming the parameter, what came and what was expected.
    """
    hints = field_types(cls)
    arguments: dict[str, Any] = {}
    for field in dataclasses.fields(cls):
        kind, name = hints[field.name], prefix + field.name
        item = _item_type(kind)
        if dataclasses.is_dataclass(kind):
            arguments[field.name] = from_parameter_values(kind, values, f'{name}.')
        elif item is not None and dataclasses.is_dataclass(item):
            arguments[field.name] = _items(item, values, f'{name}.')
        elif name in values:
            holds_pairs = kind is tuple or get_origin(item) is tuple
            arguments[field.name] = _pairs(name, values[name]) if holds_pairs else values[name]
        elif _default(field) is None:
            raise ValueError(f'{name}: got nothing, expected {expectation(kind, field.metadata)}')
    try:
        return cls(**arguments)
    except ValueError as error:
        raise ValueError(_with_parameter_name(str(error), cls, prefix)) from error


class ParameterSet:
    """
    The parameters of a node: declared, checked, and some of them free to be set at any time.

    A parameter that is none of the node's is refused where it lies in one of its groups
    (``object.masss``), and ignored with a warning elsewhere: a section ``/**`` is for all nodes.

    ``settings``: the dataclass instances, in the order of the sections.
    """

    def __init__(self, node: Node, sections: Sequence[Section], dynamic: Collection[str] = (),
                 on_change: Callable[[], None] | None = None) -> None:
        """
        Declare and read them.

        The node must have declared the values that it was given
        (``automatically_declare_parameters_from_overrides``).

        :param node: the node.
        :param sections: (prefix with its dot, dataclass) sequence.
        :param dynamic: names of those that may be set at any time; all others are read-only.
        :param on_change: called when some were set.
        :raises ValueError: naming every unknown parameter, or the first that is missing or wrong.
        """
        self._node = node
        self._sections = sections
        self._on_change = on_change
        specs = [spec for prefix, cls in sections for spec in parameter_specs(cls, prefix)]
        self._specs = {spec.name: spec for spec in specs}
        given = self._given_values()
        self.settings = [from_parameter_values(cls, given, prefix) for prefix, cls in sections]
        for spec in specs:
            _declare(node, spec, given.get(spec.name, spec.default),
                     is_dynamic=spec.name in dynamic)
        node.add_pre_set_parameters_callback(self._with_whole_numbers_as_real)
        node.add_on_set_parameters_callback(self._check)
        node.add_post_set_parameters_callback(self._use)

    def _given_values(self) -> dict[str, Any]:
        """Return the values that the node was given; refuse or forget those of others."""
        # The stubs of rclpy have values here, where it gives parameters.
        declared: dict[str, Any] = dict(self._node.get_parameters_by_prefix(''))
        given = {name: parameter.value for name, parameter in declared.items()
                 if parameter.type_ != Parameter.Type.NOT_SET and not _is_of_rclpy(name)}
        unknown = sorted(set(given) - set(self._specs))
        groups = tuple(prefix for prefix, _ in self._sections if prefix)
        refused = [name for name in unknown if name.startswith(groups)]
        if refused:
            raise ValueError(f'{", ".join(refused)}: got a parameter that {self._node.get_name()} '
                             'does not have, expected one of its own (see docs/reference)')
        for name in unknown:
            self._node.get_logger().warning(f'{name}: got a parameter that this node does not '
                                            'have; ignored')
            self._node.undeclare_parameter(name)
        return {name: value for name, value in given.items() if name in self._specs}

    def _with_whole_numbers_as_real(self, parameters: list[Parameter]) -> list[Parameter]:
        """Let people write 3 for 3.0."""
        real = [name for name, spec in self._specs.items() if spec.kind is float]
        return [_as_real(parameter) if parameter.name in real else parameter
                for parameter in parameters]

    def _check(self, parameters: list[Parameter]) -> SetParametersResult:
        """Refuse values that the dataclasses refuse, with their reason."""
        try:
            self._instances(parameters)
        except ValueError as error:
            return SetParametersResult(successful=False, reason=str(error))
        return SetParametersResult(successful=True)

    def _use(self, parameters: list[Parameter]) -> None:
        names = [parameter.name for parameter in parameters if parameter.name in self._specs]
        if names:
            self.settings = self._instances(parameters)
            self._node.get_logger().info(f'{", ".join(names)}: set')
            if self._on_change is not None:
                self._on_change()

    def _instances(self, parameters: list[Parameter]) -> list[Any]:
        """Make the dataclasses with other values of some parameters."""
        values: dict[str, Any] = {}
        for (prefix, _), instance in zip(self._sections, self.settings):
            values.update(to_parameter_values(instance, prefix))
        values.update({parameter.name: parameter.value for parameter in parameters
                       if parameter.name in self._specs})
        return [from_parameter_values(cls, values, prefix) for prefix, cls in self._sections]


def descriptor(spec: ParameterSpec, *, is_dynamic: bool = False) -> ParameterDescriptor:
    """
    Make the ROS descriptor of a parameter.

    :param spec: the ``ParameterSpec``.
    :param is_dynamic: whether it may be set at any time.
    """
    unit = f" [{spec.metadata['unit']}]" if spec.metadata['unit'] else ''
    result = ParameterDescriptor(
        name=spec.name, description=spec.metadata['description'] + unit,
        read_only=not is_dynamic, dynamic_typing=True,
        additional_constraints=f'{spec.expectation}; {DYNAMIC if is_dynamic else READ_ONLY}')
    low, high, above = (spec.metadata[name] for name in ('low', 'high', 'above'))
    low = low if above is None else above
    if not range_text(spec.metadata):
        return result
    if spec.kind is float:
        result.floating_point_range = [FloatingPointRange(from_value=low, to_value=high)]
    if spec.kind is int:
        low = int(low) if math.isfinite(low) else -LARGEST_INTEGER
        high = int(high) if math.isfinite(high) else LARGEST_INTEGER
        result.integer_range = [IntegerRange(from_value=low, to_value=high)]
    return result


def _as_list(spec: ParameterSpec, is_optional: bool) -> ParameterSpec:
    """Turn the parameter of one item into that of all; without a default one must be given."""
    default = () if is_optional or spec.default is not None else None
    return dataclasses.replace(spec, kind=list[spec.kind], default=default)


def _items(cls: Any, values: Mapping[str, Any], prefix: str) -> tuple[Any, ...]:
    """Make a tuple of dataclass instances of lists, one list for each field."""
    columns = {field.name: values[prefix + field.name] for field in dataclasses.fields(cls)
               if len(values.get(prefix + field.name, ()))}
    counts = {prefix + name: len(column) for name, column in columns.items()}
    if len(set(counts.values())) > 1:
        raise ValueError(', '.join(counts) + f': got lists of {list(counts.values())} numbers, '
                         'expected lists of one length')
    rows = [dict(zip(columns, row)) for row in zip(*columns.values())]
    return tuple(
        from_parameter_values(cls, {prefix + name: value for name, value in row.items()}, prefix)
        for row in rows)


def _pairs(name: str, numbers: Any) -> tuple[tuple[float, float], ...]:
    numbers = list(numbers) if hasattr(numbers, '__iter__') else [numbers]
    if len(numbers) % 2:
        raise ValueError(f'{name}: got {len(numbers)} numbers, expected pairs in a row')
    return tuple(zip(numbers[::2], numbers[1::2]))


def _with_parameter_name(text: str, cls: type[Any], prefix: str) -> str:
    """Put the prefix of the parameters in place of the name of the dataclass in an error."""
    start = f'{cls.__name__}.'
    return prefix + text[len(start):] if text.startswith(start) else text


def _default(field: 'dataclasses.Field[Any]') -> Any:
    """Return the default of a field; None where there is none."""
    if field.default_factory is not dataclasses.MISSING:
        return field.default_factory()
    return None if field.default is dataclasses.MISSING else field.default


def _item_type(kind: Any) -> Any:
    """Return T of ``tuple[T, ...]``; None for all other types."""
    arguments = get_args(kind)
    if get_origin(kind) is tuple and arguments and arguments[-1] is Ellipsis:
        return arguments[0]
    return None


def _flattened(value: Any) -> list[Any]:
    if isinstance(value, tuple):
        return [number for item in value for number in _flattened(item)]
    return [value]


def _is_of_rclpy(name: str) -> bool:
    return name in RCLPY_NAMES or name.startswith(RCLPY_PREFIX)


def _declare(node: Node, spec: ParameterSpec, value: Any, *, is_dynamic: bool) -> None:
    free = ParameterDescriptor(dynamic_typing=True)
    if node.has_parameter(spec.name):
        node.set_descriptor(spec.name, free)
    else:
        node.declare_parameter(spec.name, False, free)
    # With its type spelled out: rclpy cannot tell that of an empty list.
    result, = node.set_parameters([_parameter(spec, value)])
    if not result.successful:
        raise ValueError(f'{spec.name}: {result.reason}')
    node.set_descriptor(spec.name, descriptor(spec, is_dynamic=is_dynamic))


def _as_real(parameter: Parameter) -> Parameter:
    value: Any = parameter.value
    if parameter.type_ != Parameter.Type.INTEGER:
        return parameter
    return Parameter(parameter.name, Parameter.Type.DOUBLE, float(value))


def _parameter(spec: ParameterSpec, value: Any) -> Parameter:
    item = (get_args(spec.kind) or (None,))[0]
    if item is not None:
        return Parameter(spec.name, ARRAYS[item], [item(number) for number in value])
    return Parameter(spec.name, SCALARS[spec.kind], spec.kind(value))
