"""Topics, services and parameters of the nodes as Markdown tables: ``python -m``."""

import math
import sys

from push_control import controller_node
from push_planner import planner_node
from push_ros.parameters import parameter_specs
from push_ros.topics import CONTROLLER, PLANNER, SERVICES, SIM, TOPICS
from push_sim_node import sim_node

SECTIONS = {PLANNER: planner_node.SECTIONS, CONTROLLER: controller_node.SECTIONS,
            SIM: sim_node.SECTIONS}
TOPIC_HEADER = ('topic', 'type', 'from', 'to', 'what')
SERVICE_HEADER = ('service', 'type', 'node', 'what')
PARAMETER_HEADER = ('parameter', 'type', 'unit', 'range', 'default', 'what')


def parameters(node):
    """
    List the parameters of a node.

    :param node: its name.
    :return: ``ParameterSpec`` list.
    """
    return [spec for prefix, cls in SECTIONS[node] for spec in parameter_specs(cls, prefix)]


def topic_table():
    """Write the table of topics."""
    return table(TOPIC_HEADER, [
        (f'`{name}`', f'`{type_name(topic.type)}`', _nodes(topic.publishers),
         _nodes(topic.subscribers), topic.description) for name, topic in TOPICS.items()])


def service_table():
    """Write the table of services."""
    return table(SERVICE_HEADER, [
        (f'`{name}`', f'`{type_name(kind)}`', f'`{node}`', text)
        for name, (kind, node, text) in SERVICES.items()])


def parameter_table(node, without=()):
    """
    Write the table of a node's parameters.

    :param node: its name.
    :param without: prefixes of parameters that are left out.
    """
    return table(PARAMETER_HEADER, [
        (f'`{spec.name}`', kind_name(spec.kind), spec.metadata['unit'], _range(spec),
         default_text(spec), spec.metadata['description'])
        for spec in parameters(node) if not spec.name.startswith(tuple(without))])


def table(header, rows):
    """
    Write a Markdown table.

    :param header: titles.
    :param rows: texts, as many per row as titles.
    """
    lines = [header, tuple('---' for _ in header), *rows]
    return '\n'.join('| ' + ' | '.join(cell.replace('|', '\\|') for cell in line) + ' |'
                     for line in lines)


def type_name(kind):
    """
    Name a message or service type as ``ros2 interface`` does.

    :param kind: the class.
    """
    package, folder = kind.__module__.split('.')[:2]
    return f'{package}/{folder}/{kind.__name__}'


def kind_name(kind):
    """
    Name the type of a parameter.

    :param kind: bool, int, float, str or a list of one of them.
    """
    return kind.__name__ if isinstance(kind, type) and not hasattr(kind, '__args__') else \
        f'list of {kind.__args__[0].__name__}'


def default_text(spec):
    """
    Write the default of a parameter.

    :param spec: ``ParameterSpec``.
    """
    if spec.default is None:
        return '**must be given**'
    if isinstance(spec.default, bool):
        return f'`{str(spec.default).lower()}`'
    if isinstance(spec.default, tuple):
        return '`[' + ', '.join(map(str, spec.default)) + ']`'
    return f'`{spec.default}`' if spec.default != '' else '`""`'


def main():
    """Print all tables."""
    print(f'{topic_table()}\n\n{service_table()}')
    for node in SECTIONS:
        print(f'\n`{node}`\n\n{parameter_table(node)}')


def _nodes(names):
    return ', '.join(f'`{name}`' for name in names) or 'user'


def _range(spec):
    if spec.metadata['choices']:
        return ', '.join(spec.metadata['choices'])
    low, high, above = (spec.metadata[name] for name in ('low', 'high', 'above'))
    start = f'> {above:g}' if above is not None else f'≥ {low:g}' if math.isfinite(low) else ''
    end = f'≤ {high:g}' if math.isfinite(high) else ''
    return ', '.join(filter(None, (start, end)))


if __name__ == '__main__':
    sys.exit(main())
