"""The page as one HTML file, with its styles and scripts inside."""

import base64
import gzip
import html
import importlib.resources
import json
import re
from typing import Any

from push_view.messages import Message

# What refers to a file beside the page, and is replaced by its content.
STYLE = re.compile(r'<link rel="stylesheet" href="([\w.]+)">')
SCRIPT = re.compile(r'<script src="([\w.]+)"></script>')
TITLE = re.compile(r'<title>.*?</title>')
# Where the recording is put.
RECORDING = '<script type="application/gzip" id="recording"></script>'
CONNECTIONS = {True: "connect-src 'none'", False: "connect-src 'self'"}


def page_html(title: str, document: Message | None = None) -> str:
    """
    Make the page.

    :param title: of the page.
    :param document: for a report ``runs``, a list of mappings with ``name`` and ``messages``, and
        ``table``, the lines of a table; None for a page that asks the server it came from.
    :return: HTML.
    """
    text = page_source('index.html')
    text = STYLE.sub(lambda match: f'<style>\n{page_source(match[1])}</style>', text)
    text = SCRIPT.sub(lambda match: f'<script>\n{page_source(match[1])}</script>', text)
    text = TITLE.sub(lambda _: f'<title>{html.escape(title)}</title>', text, count=1)
    text = text.replace(CONNECTIONS[False], CONNECTIONS[document is not None], 1)
    if document is not None:
        opening, closing = RECORDING.split('><')
        text = text.replace(RECORDING, f'{opening}>{packed(document)}<{closing}', 1)
    return text


def page_source(name: str) -> str:
    """
    Read a file of the page.

    :param name: of the file in the folder ``page``.
    """
    folder = importlib.resources.files('push_view').joinpath('page')
    return folder.joinpath(name).read_text('utf-8')


def packed(document: Any) -> str:
    """
    Compress a document; equal ones give equal text.

    :param document: as JSON has it.
    """
    text = json.dumps(document, separators=(',', ':'), allow_nan=False)
    return base64.b64encode(gzip.compress(text.encode(), mtime=0)).decode('ascii')
