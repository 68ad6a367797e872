"""Parameter dataclasses as ROS parameters of a node, with descriptions and ranges."""

import dataclasses
import math
import typing

from push_model.quantity import expectation, field_types, range_text
from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor
from rclpy.parameter import Parameter


@dataclasses.dataclass(frozen=True)
class ParameterSpec:
    """
    One ROS parameter.

    :param name: with dots.
    :param kind: bool, int, float, str, or a list of one of them, as ``list[float]``.
    :param default: its value where none is given; None where one must be given.
    :param metadata: what ``quantity`` says of the field: description, unit, range.
    """

    name: str
    kind: object
    default: object
    metadata: typing.Mapping

    @property
    def expectation(self):
        """What the parameter accepts, in words."""
        return expectation(self.kind, self.metadata)


def parameter_specs(cls, prefix=''):
    """
    List the parameters of a dataclass.

    :param cls: the dataclass, of fields made with ``quantity``.
    :param prefix: put before the names, with its dot.
    :return: ``ParameterSpec`` list.
    """
    hints = field_types(cls)
    specs = []
    for field in dataclasses.fields(cls):
        kind, name, default = hints[field.name], prefix + field.name, _default(field)
        item = _item(kind)
        if dataclasses.is_dataclass(kind):
            specs += parameter_specs(kind, f'{name}.')
        elif dataclasses.is_dataclass(item):
            optional = default == ()
            for spec in parameter_specs(item, f'{name}.'):
                given = () if optional or spec.default is not None else None
                specs.append(dataclasses.replace(spec, kind=list[spec.kind], default=given))
        elif kind in (bool, int, float, str):
            specs.append(ParameterSpec(name, kind, default, field.metadata))
        else:
            default = default if default is None else tuple(_flat(default))
            specs.append(ParameterSpec(name, list[float], default, field.metadata))
    return specs


def to_parameter_values(instance, prefix=''):
    """
    Flatten a dataclass instance; empty lists are left out.

    :param instance: of a class that ``parameter_specs`` describes.
    :param prefix: put before the names, with its dot.
    :return: dict of names to numbers, texts and lists.
    """
    values = {}
    for field in dataclasses.fields(instance):
        name, value = prefix + field.name, getattr(instance, field.name)
        if dataclasses.is_dataclass(value):
            values.update(to_parameter_values(value, f'{name}.'))
        elif isinstance(value, tuple) and value and dataclasses.is_dataclass(value[0]):
            for part in dataclasses.fields(value[0]):
                values[f'{name}.{part.name}'] = [getattr(item, part.name) for item in value]
        elif isinstance(value, tuple):
            values.update({name: _flat(value)} if value else {})
        else:
            values[name] = value
    return values


def from_parameter_values(cls, values, prefix=''):
    """
    Make a dataclass instance of flat values.

    :param cls: the dataclass.
    :param values: dict of names to values; others than its own are overlooked.
    :param prefix: put before the names, with its dot.
    :raises ValueError: naming the parameter, what came and what was expected.
    """
    hints = field_types(cls)
    arguments = {}
    for field in dataclasses.fields(cls):
        kind, name = hints[field.name], prefix + field.name
        if dataclasses.is_dataclass(kind):
            arguments[field.name] = from_parameter_values(kind, values, f'{name}.')
        elif dataclasses.is_dataclass(_item(kind)):
            arguments[field.name] = _items(_item(kind), values, f'{name}.')
        elif name in values:
            pairs = kind is tuple or typing.get_origin(_item(kind)) is tuple
            arguments[field.name] = _pairs(name, values[name]) if pairs else values[name]
        elif _default(field) is None:
            raise ValueError(f'{name}: got nothing, expected {expectation(kind, field.metadata)}')
    try:
        return cls(**arguments)
    except ValueError as error:
        raise ValueError(_renamed(str(error), cls, prefix)) from error


def _items(cls, values, prefix):
    given = {field.name: values[prefix + field.name] for field in dataclasses.fields(cls)
             if len(values.get(prefix + field.name, ()))}
    counts = {prefix + name: len(column) for name, column in given.items()}
    if len(set(counts.values())) > 1:
        raise ValueError(', '.join(counts) + f': got lists of {list(counts.values())} numbers, '
                         'expected lists of one length')
    rows = [dict(zip(given, row)) for row in zip(*given.values())]
    return tuple(from_parameter_values(cls, {prefix + name: value for name, value in row.items()}, prefix)
                 for row in rows)


def _pairs(name, numbers):
    numbers = list(numbers) if hasattr(numbers, '__iter__') else [numbers]
    if len(numbers) % 2:
        raise ValueError(f'{name}: got {len(numbers)} numbers, expected pairs in a row')
    return tuple(zip(numbers[::2], numbers[1::2]))


def _renamed(text, cls, prefix):
    start = f'{cls.__name__}.'
    return prefix + text[len(start):] if text.startswith(start) else text


def _default(field):
    if field.default_factory is not dataclasses.MISSING:
        return field.default_factory()
    return None if field.default is dataclasses.MISSING else field.default


def _item(kind):
    arguments = typing.get_args(kind)
    is_tuple = typing.get_origin(kind) is tuple
    return arguments[0] if is_tuple and arguments and arguments[-1] is Ellipsis else None


def _flat(value):
    if isinstance(value, tuple):
        return [number for item in value for number in _flat(item)]
    return [value]


# What rclpy itself declares or understands.
OWN_NAMES = ('use_sim_time', 'start_type_description_service')
OWN_PREFIX = 'qos_overrides.'
LARGEST_INTEGER = 2 ** 63 - 1
SCALARS = {bool: Parameter.Type.BOOL, int: Parameter.Type.INTEGER, float: Parameter.Type.DOUBLE,
           str: Parameter.Type.STRING}
ARRAYS = {int: Parameter.Type.INTEGER_ARRAY, float: Parameter.Type.DOUBLE_ARRAY}


def declare_parameters(node, sections):
    """
    Declare the parameters of a node, read-only, and read them.

    The node must have declared the values that it was given
    (``automatically_declare_parameters_from_overrides``).

    :param node: the node.
    :param sections: (prefix with its dot, dataclass) sequence.
    :return: the dataclass instances, in the same order.
    :raises ValueError: naming every unknown parameter, or the first one that is missing or wrong.
    """
    specs = [spec for prefix, cls in sections for spec in parameter_specs(cls, prefix)]
    given = {name: parameter.value for name, parameter in node.get_parameters_by_prefix('').items()
             if parameter.type_ != Parameter.Type.NOT_SET and not _is_own(name)}
    unknown = sorted(set(given) - {spec.name for spec in specs})
    if unknown:
        raise ValueError(f'{", ".join(unknown)}: got a parameter that {node.get_name()} does not '
                         'have, expected one of its own (see README)')
    instances = [from_parameter_values(cls, given, prefix) for prefix, cls in sections]
    for spec in specs:
        _declare(node, spec, given.get(spec.name, spec.default))
    return instances


def descriptor(spec):
    """
    Make the ROS descriptor of a parameter.

    :param spec: the ``ParameterSpec``.
    """
    unit = f" [{spec.metadata['unit']}]" if spec.metadata['unit'] else ''
    result = ParameterDescriptor(
        name=spec.name, description=spec.metadata['description'] + unit, read_only=True,
        dynamic_typing=True, additional_constraints=spec.expectation)
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


def _is_own(name):
    return name in OWN_NAMES or name.startswith(OWN_PREFIX)


def _declare(node, spec, value):
    free = ParameterDescriptor(dynamic_typing=True)
    if node.has_parameter(spec.name):
        node.set_descriptor(spec.name, free)
    else:
        node.declare_parameter(spec.name, False, free)
    # With its type spelled out: rclpy cannot tell that of an empty list.
    result, = node.set_parameters([_parameter(spec, value)])
    if not result.successful:
        raise ValueError(f'{spec.name}: {result.reason}')
    node.set_descriptor(spec.name, descriptor(spec))


def _parameter(spec, value):
    item = (typing.get_args(spec.kind) or (None,))[0]
    if item is not None:
        return Parameter(spec.name, ARRAYS[item], [item(number) for number in value])
    return Parameter(spec.name, SCALARS[spec.kind], spec.kind(value))
