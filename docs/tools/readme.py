"""Keeps the tables of the README what the code says: ``python -m docs.tools.readme``."""

from pathlib import Path
import re
import sys

from docs.tools.describe import parameter_table, parameters, service_table, topic_table
from push_ros.topics import CONTROLLER, PLANNER, SIM

SHARED = ('object.', 'robot.', 'world_frame', 'object_frame', 'base_frame')
SECTION = re.compile(r'(<!-- (?P<name>[\w ]+) -->\n)(?P<body>.*?)(<!-- end -->)', re.DOTALL)


def tables():
    """Write all tables, by the name of their section."""
    own = [spec.name for spec in parameters(PLANNER) if not spec.name.startswith(SHARED)]
    found = {'topics': topic_table(), 'services': service_table(),
             'parameters shared': parameter_table(PLANNER, own)}
    for node in (PLANNER, CONTROLLER, SIM):
        found[f'parameters {node}'] = parameter_table(node, SHARED)
    return found


def filled(text):
    """
    Put the tables into their sections, ``<!-- name -->`` to ``<!-- end -->``.

    :param text: Markdown.
    :return: Markdown.
    :raises ValueError: where a section is missing, unknown or there twice.
    """
    known = tables()
    names = [match['name'] for match in SECTION.finditer(text)]
    if sorted(names) != sorted(known):
        raise ValueError(f'sections: got {sorted(names)}, expected {sorted(known)}')
    return SECTION.sub(lambda match: f'{match[1]}\n{known[match["name"]]}\n\n{match[4]}', text)


def main():
    """Rewrite the README of the source tree."""
    path = Path(__file__).resolve().parents[2] / 'README.md'
    path.write_text(filled(path.read_text(encoding='utf-8')), encoding='utf-8')


if __name__ == '__main__':
    sys.exit(main())
