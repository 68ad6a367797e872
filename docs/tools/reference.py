"""
Generate the tables of topics, services and parameters in ``docs/reference``.

``python -m docs.tools.reference`` rewrites the pages in place. A page holds hand-written text and
sections ``<!-- name -->`` to ``<!-- end -->``; only the sections are replaced.
"""

from collections.abc import Iterable, Sequence
import math
from pathlib import Path
import re
import sys
from typing import Any

from push_control import controller_node
from push_model.files.flat_values import parameter_specs, ParameterSpec
from push_mujoco.settings import MujocoSettings
from push_planner import planner_node
from push_ros.conversions.plan import FAILURE_CODES
from push_ros.topics import (
    CONTROLLER, interface_name, MOCAP, PLANNER, SERVICES, SIM, TAG_DETECTOR, TIDY, Topic,
    TOPICS, TRACKER,
)
from push_sim_node import sim_node
from push_tags import tag_detector_node
from push_tidy import tidy_node
from push_tracker import mocap_node, tracker_node
from push_view import view_node
from rclpy.qos import DurabilityPolicy, QoSProfile

REFERENCE = Path(__file__).resolve().parents[1] / 'reference'
SECTION = re.compile(r'(<!-- (?P<name>[\w. ]+) -->\n)(?P<body>.*?)(<!-- end -->)', re.DOTALL)
# Parameter groups of each node, as (prefix with its dot, parameter class).
GROUPS: dict[str, Sequence[tuple[str, type]]] = {
    PLANNER: planner_node.SECTIONS,
    CONTROLLER: controller_node.SECTIONS,
    SIM: (*sim_node.SECTIONS, ('mujoco.', MujocoSettings)),
    TRACKER: tracker_node.SECTIONS,
    MOCAP: mocap_node.SECTIONS,
    TAG_DETECTOR: tag_detector_node.SECTIONS,
    TIDY: tidy_node.SECTIONS,
    view_node.NAME: view_node.SECTIONS,
}


def topic_table() -> str:
    """Format the topics as a Markdown table."""
    return markdown_table(('topic', 'type', 'from', 'to', 'QoS', 'content'), [
        (f'`{name}`', f'`{interface_name(topic.type)}`', _nodes(topic.publishers),
         _nodes(topic.subscribers), _qos_text(topic), topic.description)
        for name, topic in TOPICS.items()])


def service_table() -> str:
    """Format the services as a Markdown table."""
    return markdown_table(('service', 'type', 'node', 'effect'), [
        (f'`{name}`', f'`{interface_name(kind)}`', f'`{node}`', description)
        for name, (kind, node, description) in SERVICES.items()])


def failure_table() -> str:
    """Format the codes of plans that there are not as a Markdown table."""
    return markdown_table(('code', 'name', 'meaning'), [
        (str(code), f'`{failure.name}`', failure.value)
        for failure, code in FAILURE_CODES.items()])


def parameter_groups() -> dict[str, tuple[list[str], list[ParameterSpec]]]:
    """
    Collect the parameters of all nodes.

    :return: for each group the names of its nodes, and its parameters. A group is named after its
        prefix, such as ``planner``; parameters without a prefix are ``frames`` where several
        nodes have them, and else named after their node.
    """
    groups: dict[str, tuple[list[str], list[ParameterSpec]]] = {}
    classes = [cls for sections in GROUPS.values() for _, cls in sections]
    common = {cls for cls in classes if classes.count(cls) > 1}
    for node, sections in GROUPS.items():
        for prefix, cls in sections:
            name = prefix.rstrip('.') or ('frames' if cls in common else node)
            nodes, _ = groups.setdefault(name, ([], parameter_specs(cls, prefix)))
            nodes.append(node)
    return groups


def basic_parameter_table() -> str:
    """Format the parameters that a user of another robot or object has to think of."""
    return parameter_table(spec for _, specs in parameter_groups().values() for spec in specs
                           if spec.metadata['is_basic'])


def parameter_table(specs: Iterable[ParameterSpec]) -> str:
    """
    Format parameters as a Markdown table.

    :param specs: the parameters.
    """
    return markdown_table(('parameter', 'range', 'default', 'meaning'), [
        (f'`{spec.name}`', _range_text(spec), default_text(spec), spec.metadata['description'])
        for spec in specs])


def markdown_table(header: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """
    Format a Markdown table.

    :param header: column titles.
    :param rows: cells, one per title in each row.
    """
    lines = [header, ['---'] * len(header), *rows]
    return '\n'.join('| ' + ' | '.join(cell.replace('|', '\\|') for cell in line) + ' |'
                     for line in lines)


def default_text(spec: ParameterSpec) -> str:
    """
    Format the default value of a parameter.

    :param spec: the parameter.
    """
    default: Any = spec.default
    if default is None:
        return '**required**'
    if isinstance(default, bool):
        return f'`{str(default).lower()}`'
    if isinstance(default, tuple):
        return '`[' + ', '.join(map(str, default)) + ']`'
    return '`""`' if default == '' else f'`{default}`'


def tables() -> dict[str, str]:
    """Format all tables, by the name of their section: the basic parameters, and the others."""
    texts = {'topics': topic_table(), 'services': service_table(),
             'plan failures': failure_table(), 'basic parameters': basic_parameter_table()}
    for name, (nodes, specs) in parameter_groups().items():
        table = parameter_table(spec for spec in specs if not spec.metadata['is_basic'])
        texts[f'parameters {name}'] = f'Nodes: {_nodes(nodes)}.\n\n{table}'
    return texts


def fill_sections(text: str) -> str:
    """
    Replace the sections of a page by the tables of the code.

    :param text: Markdown.
    :return: Markdown.
    :raises ValueError: for a section that the code does not know.
    """
    known = tables()
    unknown = sorted(set(section_names(text)) - set(known))
    if unknown:
        raise ValueError(f'sections: got {unknown}, expected some of {sorted(known)}')
    return SECTION.sub(lambda match: f'{match[1]}\n{known[match["name"]]}\n\n{match[4]}', text)


def section_names(text: str) -> list[str]:
    """
    List the sections of a page, in order.

    :param text: Markdown.
    """
    return [match['name'] for match in SECTION.finditer(text)]


def pages() -> list[Path]:
    """List the pages of the reference."""
    return sorted(REFERENCE.glob('*.md'))


def main() -> None:
    """Rewrite the pages of the reference."""
    for path in pages():
        path.write_text(fill_sections(path.read_text(encoding='utf-8')), encoding='utf-8')


def _nodes(names: Iterable[str]) -> str:
    return ', '.join(f'`{name}`' for name in names) or 'user'


def _qos_text(topic: Topic) -> str:
    """Say how nodes of this package publish and subscribe a topic, with the depths."""
    sides: list[str] = []
    if topic.publishers:
        sides.append(f'out {_profile_text(topic.publish_qos)}')
    if topic.subscribers:
        sides.append(f'in {_profile_text(topic.subscribe_qos)}')
    return '; '.join(sides)


def _profile_text(profile: QoSProfile) -> str:
    words = [profile.reliability.name.lower().replace('_', ' ')]
    if profile.durability is DurabilityPolicy.TRANSIENT_LOCAL:
        words.append('latched')
    return ' '.join((*words, str(profile.depth)))


def _range_text(spec: ParameterSpec) -> str:
    """Say which values are allowed, with their unit."""
    if spec.metadata['choices']:
        return ', '.join(filter(None, (*spec.metadata['choices'], spec.metadata['other_words'])))
    low, high, above = (spec.metadata[name] for name in ('low', 'high', 'above'))
    if math.isfinite(low) and math.isfinite(high):
        text = f'{low:g}…{high:g}'
    else:
        limits = (f'>{above:g}' if above is not None else '',
                  f'≥{low:g}' if math.isfinite(low) else '',
                  f'≤{high:g}' if math.isfinite(high) else '')
        text = ' '.join(filter(None, limits))
    return f"{text} {spec.metadata['unit']}".strip()


if __name__ == '__main__':
    sys.exit(main())
