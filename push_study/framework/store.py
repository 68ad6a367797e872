"""
Files of a study: a stamp (JSON), tables (CSV) and pictures (PNG, SVG).

The stamp tells version, source, parameters and findings; it is written last, so that a study with
a fitting stamp is whole. Each CSV begins with the same as comment lines.
"""

import csv
import hashlib
import json
import os
from pathlib import Path
from xml.etree import ElementTree

from push_scenario.batch.identity import software_digest
from push_scenario.definition import data
from push_study.framework.study import Finding


def stamp_of(study, values):
    """
    Tell what the outcome of a study depends on.

    :param study: the ``Study``.
    :param values: its ``Values``.
    :return: dict of plain values.
    """
    manifest = ElementTree.parse(data.share_directory() / 'package.xml').getroot()
    return {'figure': study.figure, 'title': study.title,
            'version': manifest.findtext('version'), 'software': software_digest(study.compute),
            'parameters': {value.parameter.name: [value.value, value.parameter.unit, value.source]
                           for value in values}}


class StudyFiles:
    """
    Where the files of a study lie.

    :param study: the ``Study``.
    :param folder: where they go, a path.
    """

    def __init__(self, study, folder):
        self._folder, self._figure = Path(folder), study.figure

    @property
    def png(self):
        """Path of the picture."""
        return self._folder / f'{self._figure}.png'

    @property
    def svg(self):
        """Path of the picture as vector graphics."""
        return self._folder / f'{self._figure}.svg'

    def table(self, name):
        """
        Path of a table.

        :param name: of the table.
        """
        return self._folder / f'{self._figure}-{name}.csv'

    def findings(self, stamp):
        """
        Return the findings of a finished study, None where it is not finished.

        :param stamp: of ``stamp_of``.
        """
        try:
            found = json.loads(self._stamp.read_text(encoding='utf-8'))
        except (OSError, ValueError):
            return None
        whole = all((self._folder / name).is_file() for name in found.get('files', ('?',)))
        if not whole or {key: found.get(key) for key in stamp} != json.loads(json.dumps(stamp)):
            return None
        return {name: Finding(*finding) for name, finding in found['findings'].items()}

    def finish(self, stamp, outcome):
        """
        Write tables and stamp of a study whose pictures are there.

        :param stamp: of ``stamp_of``.
        :param outcome: the ``Outcome``.
        """
        head = [f'{key}: {stamp[key]}' for key in ('figure', 'title', 'version', 'software')]
        head += [f'parameter {name} = {value} {unit} ({source})'.replace('  ', ' ')
                 for name, (value, unit, source) in stamp['parameters'].items()]
        head += [f'finding {name} = {found.value!r} {found.unit} ({found.meaning})'
                 .replace('  ', ' ') for name, found in outcome.findings.items()]
        for name, table in outcome.tables.items():
            _write_table(self.table(name), head, table)
        files = [path.name for path in (self.png, self.svg, *map(self.table, outcome.tables))]
        _replace(self._stamp, json.dumps({**stamp, 'findings': outcome.findings, 'files': files},
                                         indent=1) + '\n')

    def jobs(self, stamp, number):
        """
        Path for the records of a batch that a study runs, apart for other parameters or source.

        :param stamp: of ``stamp_of``.
        :param number: of the batch in the study.
        """
        digest = hashlib.sha256(json.dumps(stamp).encode()).hexdigest()[:12]
        return self._folder / 'unfinished' / f'{self._figure}-{digest}-{number}.jsonl'

    @property
    def _stamp(self):
        return self._folder / f'{self._figure}.json'


def _write_table(path, head, table):
    columns = {name: list(column) for name, column in table.items()}
    lengths = {name: len(column) for name, column in columns.items()}
    if len(set(lengths.values())) > 1:
        raise ValueError(f'{path.name}: got columns of {lengths} rows, expected one length')
    with open(path, 'w', encoding='utf-8', newline='') as stream:
        stream.writelines(f'# {line}\n' for line in head)
        writer = csv.writer(stream, lineterminator='\n')
        writer.writerow(columns)
        writer.writerows(zip(*columns.values()))


def _replace(path, text):
    unfinished = path.with_suffix('.part')
    unfinished.write_text(text, encoding='utf-8')
    os.replace(unfinished, path)
