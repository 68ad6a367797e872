"""The gallery: a page with every figure, what it shows, and why."""

import itertools
import os
from pathlib import Path
from typing import Sequence

from studies.framework.runner import StudyResult
from studies.framework.study import Table

START = '<!-- gallery -->'
END = '<!-- end -->'
# Chapter -> heading of its part of the page.
HEADINGS = {
    'chapter2': 'Chapter 2: behaviour of a pushed object', 'chapter3': 'Chapter 3: open-loop '
    'planning', 'chapter4': 'Chapter 4: real-time control', 'appendix': 'Appendix',
    'beyond': 'Beyond the thesis', 'primitives': 'Straight pushes'}


def page(results: Sequence[StudyResult], folder: Path) -> str:
    """
    Write the gallery as Markdown.

    :param results: of the studies, chapter by chapter.
    :param folder: where the page will be, for relative links.
    :return: text.
    """
    lines: list[str] = []
    for chapter, members in itertools.groupby(results, lambda result: result.study.chapter):
        lines += [f'## {HEADINGS[chapter]}', '']
        for result in members:
            lines += _entry(result, folder)
    return '\n'.join(lines).rstrip() + '\n'


def _entry(result: StudyResult, folder: Path) -> list[str]:
    """Write the lines of one study."""
    study = result.study
    link = os.path.relpath(result.files.png, folder).replace(os.sep, '/')
    lines = [f'### {study.label} {result.title}', '', f'![{study.label}]({link})', '',
             study.caption(result.findings), '']
    return lines + _markdown(result.page_table)


def _markdown(table: Table) -> list[str]:
    """Write a table as Markdown, empty where there is none."""
    if not table:
        return []
    rows = [list(table), ['---'] * len(table), *zip(*table.values())]
    return [f'| {" | ".join(map(str, row))} |' for row in rows] + ['']


def insert(text: str, gallery: str) -> str:
    """
    Insert a gallery between the marks of a page.

    :param text: page with the lines ``START`` and ``END``.
    :param gallery: of ``page``.
    :return: the page, with the gallery in place of what was between the marks.
    :raises ValueError: where a mark is missing.
    """
    head, start, after = text.partition(START)
    _, end, tail = after.partition(END)
    if not (start and end):
        raise ValueError(f'gallery: got a page without the lines {START} and {END}')
    return f'{head}{START}\n\n{gallery}\n{END}{tail}'
