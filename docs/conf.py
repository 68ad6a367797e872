"""
The documentation as a site with search: ``make docs``, then open ``out/docs/index.html``.

The pages of this folder are shown as they are, and those of the repository's root beside them.
``site/`` lists the Python interface, from docstrings. Files outside this folder that a page links
to are copied beside the site.
"""

import os
from pathlib import Path
import re
import shutil
import sys
from xml.etree import ElementTree

DOCS = Path(__file__).resolve().parent
ROOT = DOCS.parent
sys.path.insert(0, str(ROOT))

_manifest = ElementTree.parse(ROOT / 'package.xml').getroot()
project = _manifest.findtext('name')
author = _manifest.findtext('author')
version = release = _manifest.findtext('version')

extensions = ['myst_parser', 'sphinx.ext.autodoc', 'sphinx.ext.viewcode',
              'sphinxcontrib.mermaid']
exclude_patterns = ['tools']
html_theme = 'furo'
html_title = f'{project} {version}'
myst_heading_anchors = 4
myst_fence_as_directive = ['mermaid']
highlight_language = 'none'
autodoc_member_order = 'bysource'
autodoc_typehints = 'description'


def navigation(caption, *pages):
    """Return a table of contents for the side of the site."""
    return '\n'.join(('', '```{toctree}', ':hidden:', ':glob:', f':caption: {caption}', '',
                      *pages, '```', ''))


NAVIGATION = ''.join((
    navigation('Start', 'site/readme', 'tour', 'faq', 'page', 'scenarios', 'troubleshooting'),
    navigation('Your robot', 'ros2', 'own_object', 'robots/*'),
    navigation('Concepts', 'concepts/how_a_task_goes', 'concepts/*', 'one_push', 'physics',
               'nomenclature'),
    navigation('Research', 'studies', 'running_studies', 'identify', 'batches', '*'),
    navigation('Measured', 'reports/*'),
    navigation('Reference', 'reference/*', 'site/api', 'site/contributing', 'site/changelog')))
LINK = re.compile(r'(?P<mark>!?)\[(?P<label>[^\[\]]*)\]'
                  r'\((?P<path>[^)\s#:]+)(?P<anchor>[^)\s:]*)\)')
# Pages of the root that the site shows, and where.
ROOT_PAGES = {ROOT / 'README.md': DOCS / 'site' / 'readme.md',
              ROOT / 'CONTRIBUTING.md': DOCS / 'site' / 'contributing.md',
              ROOT / 'CHANGELOG.rst': DOCS / 'site' / 'changelog.rst'}
SHOWN_BY = {shown: path for path, shown in ROOT_PAGES.items()}


def rewrite_links(text, folder, page_folder):
    """
    Make the links of a text hold on the site.

    :param text: of a page, in Markdown.
    :param folder: to which the links of the text are relative.
    :param page_folder: folder of the page that shows the text.
    :return: the text, and the files outside ``docs`` that it links to.
    """
    linked = set()

    def rewritten(match):
        target = Path(os.path.normpath(folder / match['path']))
        target = ROOT_PAGES.get(target, target)
        if not target.exists():
            return match.group()
        if target.is_relative_to(DOCS):
            path = os.path.relpath(target, page_folder)
            return f"{match['mark']}[{match['label']}]({path}{match['anchor']})"
        if target.is_dir():
            return match['label']
        linked.add(target)
        path = os.path.relpath(DOCS / 'source' / target.relative_to(ROOT), page_folder)
        return f'<a href="{path}">{match["label"]}</a>'

    return LINK.sub(rewritten, text), linked


def on_page(app, name, source):
    """Rewrite the links of a page; the index gets the navigation."""
    page = Path(app.env.doc2path(name))
    if page.suffix == '.md':
        written = SHOWN_BY.get(page, page)
        source[0], linked = rewrite_links(
            written.read_text(encoding='utf-8'), written.parent, page.parent)
        app.linked_files.update(linked)
    if name == app.config.root_doc:
        source[0] += NAVIGATION


def on_finish(app, error):
    """Copy the files that pages link to beside the site."""
    if error is None:
        for path in app.linked_files:
            copy = Path(app.outdir, 'source', path.relative_to(ROOT))
            copy.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(path, copy)


def setup(app):
    """Connect the above with the steps of Sphinx."""
    app.linked_files = set()
    app.connect('source-read', on_page)
    app.connect('build-finished', on_finish)
