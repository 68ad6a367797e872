"""Parameter dataclasses as ROS parameters of a node, with descriptions and ranges."""

import math
from typing import Any, Callable, get_args, Iterable, Mapping, NamedTuple, Sequence

from push_model.files.flat_values import (
    from_parameter_values, parameter_specs, ParameterSpec, to_parameter_values,
)
from push_model.quantity import range_text
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
MAX_INTEGER = 2 ** 63 - 1
# When parameters may be set, as descriptors say it.
DYNAMIC = 'may be set at any time, and is used from the next movement or plan on'
IDLE = 'may be set while the node is idle'
READ_ONLY = 'read-only: the node is built with it; restart the node with another value'
SCALARS = {bool: Parameter.Type.BOOL, int: Parameter.Type.INTEGER, float: Parameter.Type.DOUBLE,
           str: Parameter.Type.STRING}
ARRAYS = {int: Parameter.Type.INTEGER_ARRAY, float: Parameter.Type.DOUBLE_ARRAY,
          str: Parameter.Type.STRING_ARRAY}


class ParameterHooks(NamedTuple):
    """
    Hooks of a node for parameters that are being set.

    :param complete: takes the values by name, and returns further ones that go with them.
    :param refusal: takes all values by name; returns why they cannot be set now, or nothing.
    :param on_change: called when they were set.
    """

    complete: Callable[[Mapping[str, Any]], Mapping[str, Any]]
    refusal: Callable[[Mapping[str, Any]], str]
    on_change: Callable[[], None]


class ParameterSet:
    """
    The parameters of a node: declared, checked, and some of them free to be set.

    A parameter that is none of the node's is refused where it lies in one of its groups
    (``object.masss``), and ignored with a warning elsewhere: a section ``/**`` is for all nodes.

    ``settings``: the dataclass instances, in the order of the sections.
    """

    def __init__(self, node: Node, sections: Sequence[Section],
                 settable: Mapping[str, str] | None = None,
                 hooks: ParameterHooks | None = None) -> None:
        """
        Declare and read them.

        The node must have declared the values that it was given
        (``automatically_declare_parameters_from_overrides``).

        :param node: the node.
        :param sections: (prefix with its dot, dataclass) sequence.
        :param settable: when those may be set that may, by name: ``DYNAMIC`` or ``IDLE``; all
            others are read-only.
        :param hooks: ``ParameterHooks`` for these.
        :raises ValueError: naming every unknown parameter, or the first that is missing or wrong.
        """
        self._node = node
        self._sections = sections
        self._hooks = hooks
        self._settable = settable or {}
        specs = [spec for prefix, cls in sections for spec in parameter_specs(cls, prefix)]
        self._specs = {spec.name: spec for spec in specs}
        overrides = self._override_values()
        self.settings = [from_parameter_values(cls, overrides, prefix) for prefix, cls in sections]
        for spec in specs:
            _declare(node, spec, overrides.get(spec.name, spec.default),
                     self._settable.get(spec.name, READ_ONLY))
        node.add_pre_set_parameters_callback(self._prepare)
        node.add_on_set_parameters_callback(self._check)
        node.add_post_set_parameters_callback(self._use)

    def _override_values(self) -> dict[str, Any]:
        """Return the values that the node was given; refuse or forget those of others."""
        # The stubs of rclpy have values here, where it gives parameters.
        declared: dict[str, Any] = dict(self._node.get_parameters_by_prefix(''))
        overrides = {name: parameter.value for name, parameter in declared.items()
                     if parameter.type_ != Parameter.Type.NOT_SET and not _is_of_rclpy(name)}
        unknown = sorted(set(overrides) - set(self._specs))
        groups = tuple(prefix for prefix, _ in self._sections if prefix)
        refused = [name for name in unknown if name.startswith(groups)]
        if refused:
            raise ValueError(f'{", ".join(refused)}: got a parameter that {self._node.get_name()} '
                             'does not have, expected one of its own (see docs/reference)')
        if unknown:
            self._node.get_logger().warning(f'{", ".join(unknown)}: got parameters that this node '
                                            'does not have; ignored')
        for name in unknown:
            self._node.undeclare_parameter(name)
        return {name: value for name, value in overrides.items() if name in self._specs}

    def assign(self, values: Mapping[str, Any]) -> None:
        """
        Set parameters that are settable, all at once.

        :param values: by name.
        :raises ValueError: with the reason, where they are refused.
        """
        result = self._node.set_parameters_atomically(
            [_parameter(self._specs[name], value) for name, value in values.items()])
        if not result.successful:
            raise ValueError(result.reason)

    def read_only_fault(self, names: Iterable[str]) -> str:
        """
        Find out why parameters can never be set while the node runs.

        :param names: of parameters that are being set.
        :return: one sentence that names those that cannot; empty where all can.
        """
        fixed = [name for name in names if name in self._specs and name not in self._settable]
        return f'{", ".join(fixed)}: {READ_ONLY}' if fixed else ''

    def section_values(self, prefix: str, instance: Any) -> dict[str, Any]:
        """
        List the values of all parameters of a section, empty lists too.

        :param prefix: of the section, with its dot.
        :param instance: of its dataclass.
        """
        values = to_parameter_values(instance, prefix)
        return {name: values.get(name, ()) for name in self._specs if name.startswith(prefix)}

    def _prepare(self, parameters: list[Parameter]) -> list[Parameter]:
        """Let people write 3 for 3.0, and add what goes with the parameters."""
        real = [name for name, spec in self._specs.items() if spec.kind is float]
        prepared = [_as_real(parameter) if parameter.name in real else parameter
                    for parameter in parameters]
        if self._hooks is not None:
            values: dict[str, Any] = {parameter.name: parameter.value for parameter in prepared}
            prepared += [_parameter(self._specs[name], value)
                         for name, value in self._hooks.complete(values).items()]
        return prepared

    def _check(self, parameters: list[Parameter]) -> SetParametersResult:
        """Refuse values that the dataclasses refuse, with their reason."""
        reason = '' if self._hooks is None else self._hooks.refusal(
            {parameter.name: parameter.value for parameter in parameters})
        try:
            self._instances(parameters)
        except ValueError as error:
            reason = reason or str(error)
        return SetParametersResult(successful=not reason, reason=reason)

    def _use(self, parameters: list[Parameter]) -> None:
        names = [parameter.name for parameter in parameters if parameter.name in self._specs]
        if names:
            self.settings = self._instances(parameters)
            self._node.get_logger().info(f'{", ".join(names)}: set')
            if self._hooks is not None:
                self._hooks.on_change()

    def _instances(self, parameters: list[Parameter]) -> list[Any]:
        """Make the dataclasses with other values of some parameters."""
        values: dict[str, Any] = {}
        for (prefix, _), instance in zip(self._sections, self.settings):
            values.update(to_parameter_values(instance, prefix))
        values.update({parameter.name: parameter.value for parameter in parameters
                       if parameter.name in self._specs})
        return [from_parameter_values(cls, values, prefix) for prefix, cls in self._sections]


def dynamic_parameters(sections: Sequence[Section], *prefixes: str) -> list[str]:
    """
    List the parameters of some sections that take effect while the node runs.

    :param sections: (prefix with its dot, dataclass) sequence.
    :param prefixes: of the sections.
    """
    return [spec.name for prefix, cls in sections if prefix in prefixes
            for spec in parameter_specs(cls, prefix) if spec.metadata['is_dynamic']]


def descriptor(spec: ParameterSpec, settable: str = READ_ONLY) -> ParameterDescriptor:
    """
    Make the ROS descriptor of a parameter.

    :param settable: when it may be set: ``DYNAMIC``, ``IDLE`` or ``READ_ONLY``.
    """
    unit = f" [{spec.metadata['unit']}]" if spec.metadata['unit'] else ''
    result = ParameterDescriptor(
        name=spec.name, description=spec.metadata['description'] + unit,
        read_only=settable is READ_ONLY, dynamic_typing=True,
        additional_constraints=f'{spec.expectation}; {settable}')
    low, high, above = (spec.metadata[name] for name in ('low', 'high', 'above'))
    low = low if above is None else above
    if not range_text(spec.metadata):
        return result
    if spec.kind is float:
        result.floating_point_range = [FloatingPointRange(from_value=low, to_value=high)]
    if spec.kind is int:
        low = int(low) if math.isfinite(low) else -MAX_INTEGER
        high = int(high) if math.isfinite(high) else MAX_INTEGER
        result.integer_range = [IntegerRange(from_value=low, to_value=high)]
    return result


def _is_of_rclpy(name: str) -> bool:
    return name in RCLPY_NAMES or name.startswith(RCLPY_PREFIX)


def _declare(node: Node, spec: ParameterSpec, value: Any, settable: str) -> None:
    free = ParameterDescriptor(dynamic_typing=True)
    if node.has_parameter(spec.name):
        node.set_descriptor(spec.name, free)
    else:
        node.declare_parameter(spec.name, False, free)
    # With its type spelled out: rclpy cannot tell that of an empty list.
    result, = node.set_parameters([_parameter(spec, value)])
    if not result.successful:
        raise ValueError(f'{spec.name}: {result.reason}')
    node.set_descriptor(spec.name, descriptor(spec, settable))


def _as_real(parameter: Parameter) -> Parameter:
    value: Any = parameter.value
    if parameter.type_ != Parameter.Type.INTEGER:
        return parameter
    return Parameter(parameter.name, Parameter.Type.DOUBLE, float(value))


def _parameter(spec: ParameterSpec, value: Any) -> Parameter:
    item = (get_args(spec.kind) or (None,))[0]
    if item is not None:
        return Parameter(spec.name, ARRAYS[item], [item(element) for element in value])
    return Parameter(spec.name, SCALARS[spec.kind], spec.kind(value))
