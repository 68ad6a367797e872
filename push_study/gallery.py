"""The gallery: a page with every picture, what one sees on it, and why."""

import os


def page(done, folder):
    """
    Write the gallery as Markdown.

    :param done: list of ``push_study.framework.run.Done``.
    :param folder: in which the page will lie, for the links.
    :return: text.
    """
    lines = []
    for one in done:
        study = one.study
        link = os.path.relpath(one.files.png, folder).replace(os.sep, '/')
        lines += [f'### {study.figure} {study.title}', '', f'![{study.title}]({link})', '',
                  study.sentences(one.findings), '']
    return '\n'.join(lines).rstrip() + '\n'


def fill(text, gallery):
    """
    Put a gallery between the marks of a page.

    :param text: page with the lines ``<!-- gallery -->`` and ``<!-- end -->``.
    :param gallery: of ``page``.
    :return: the page with what stood between the marks replaced.
    :raises ValueError: where the marks are missing.
    """
    begin, end = '<!-- gallery -->', '<!-- end -->'
    head, found, rest = text.partition(begin)
    _, closed, tail = rest.partition(end)
    if not (found and closed):
        raise ValueError(f'gallery: got a page without the lines {begin} and {end}')
    return f'{head}{begin}\n\n{gallery}\n{end}{tail}'
