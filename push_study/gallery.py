"""The gallery: a page with every figure, what it shows, and why."""

import os
from pathlib import Path
from typing import Sequence

from push_study.framework.runner import StudyResult

BEGIN = '<!-- gallery -->'
END = '<!-- end -->'


def page(results: Sequence[StudyResult], folder: Path) -> str:
    """
    Write the gallery as Markdown.

    :param results: of the studies.
    :param folder: where the page will be, for relative links.
    :return: text.
    """
    lines: list[str] = []
    for result in results:
        study = result.study
        link = os.path.relpath(result.files.png, folder).replace(os.sep, '/')
        lines += [f'### {study.figure} {study.title}', '', f'![{study.title}]({link})', '',
                  study.caption(result.findings), '']
    return '\n'.join(lines).rstrip() + '\n'


def insert(text: str, gallery: str) -> str:
    """
    Insert a gallery between the marks of a page.

    :param text: page with the lines ``BEGIN`` and ``END``.
    :param gallery: of ``page``.
    :return: the page, with the gallery in place of what was between the marks.
    :raises ValueError: where a mark is missing.
    """
    head, begin, rest = text.partition(BEGIN)
    _, end, tail = rest.partition(END)
    if not (begin and end):
        raise ValueError(f'gallery: got a page without the lines {BEGIN} and {END}')
    return f'{head}{BEGIN}\n\n{gallery}\n{END}{tail}'
