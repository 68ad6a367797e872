"""Reports of benchmarks: Markdown in which names between at signs stand for what was measured."""

from collections.abc import Callable
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
    expected, passed = set(NAME.findall(template)), set(values)
    if passed != expected:
        raise ValueError(f'{path.name}: got no {sorted(expected - passed)} and unknown '
                         f'{sorted(passed - expected)}, expected each name of the template')
    return NAME.sub(lambda match: str(values[match[1]]), template)


def updated_page(path: Path, page: str, previous: str,
                 is_kept: Callable[[str, str], bool]) -> str:
    """
    Put values of a previous page in place of those of a page.

    :param path: of the template of both.
    :param page: text of ``fill_template``.
    :param previous: an earlier one; where it does not fit the template, nothing is kept of it.
    :param is_kept: tells by name and value in ``page`` whether the previous value stays.
    :return: text.
    """
    parts = NAME.split(path.read_text(encoding='utf-8'))
    pattern = ''.join(f'(?P<{part}>.*?)' if index % 2 else re.escape(part)
                      for index, part in enumerate(parts))
    new, old = (re.fullmatch(pattern, text, re.DOTALL) for text in (page, previous))
    if new is None or old is None:
        return page
    for index in range(1, len(parts), 2):
        name = parts[index]
        parts[index] = (old if is_kept(name, new[name]) else new)[name]
    return ''.join(parts)
