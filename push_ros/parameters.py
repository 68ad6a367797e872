"""Parameter dataclasses as ROS parameters of a node, with descriptions and ranges."""

import math
import typing

from push_model.quantity import range_text
from push_ros.parameter_layout import from_values, layout
from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor
from rclpy.parameter import Parameter

# What rclpy itself declares or understands.
OWN_NAMES = ('use_sim_time', 'start_type_description_service')
OWN_PREFIX = 'qos_overrides.'
LARGEST_INTEGER = 2 ** 63 - 1
SCALARS = {bool: Parameter.Type.BOOL, int: Parameter.Type.INTEGER, float: Parameter.Type.DOUBLE,
           str: Parameter.Type.STRING}
ARRAYS = {int: Parameter.Type.INTEGER_ARRAY, float: Parameter.Type.DOUBLE_ARRAY}


def declare(node, sections):
    """
    Declare the parameters of a node, read-only, and read them.

    The node must have declared the values that it was given
    (``automatically_declare_parameters_from_overrides``).

    :param node: the node.
    :param sections: (prefix with its dot, dataclass) sequence.
    :return: the dataclass instances, in the same order.
    :raises ValueError: naming every unknown parameter, or the first one that is missing or wrong.
    """
    specs = [spec for prefix, cls in sections for spec in layout(cls, prefix)]
    given = {name: parameter.value for name, parameter in node.get_parameters_by_prefix('').items()
             if parameter.type_ != Parameter.Type.NOT_SET and not _is_own(name)}
    unknown = sorted(set(given) - {spec.name for spec in specs})
    if unknown:
        raise ValueError(f'{", ".join(unknown)}: got a parameter that {node.get_name()} does not '
                         'have, expected one of its own (see README)')
    instances = [from_values(cls, given, prefix) for prefix, cls in sections]
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
