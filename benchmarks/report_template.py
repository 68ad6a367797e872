"""Reports of benchmarks: Markdown in which names between at signs stand for what was measured."""

from pathlib import Path
import re

NAME = re.compile('@([A-Z]+)@')


def fill_template(path: Path, **values: object) -> str:
    """
    Fill a template.

    :param path: of the template, in which ``@NAME@`` stands for a value.
    :param values: by name, all those of the template.
    :return: text.
    :raises ValueError: naming what is missing, or is not in the template.
    """
    template = path.read_text(encoding='utf-8')
    expected, given = set(NAME.findall(template)), set(values)
    if given != expected:
        raise ValueError(f'{path.name}: got no {sorted(expected - given)} and unknown '
                         f'{sorted(given - expected)}, expected each name of the template')
    return NAME.sub(lambda found: str(values[found[1]]), template)
