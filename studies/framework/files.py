"""
Files of a study: a stamp (JSON), tables (CSV) and figures (PNG, SVG).

The stamp states version, source, parameters and findings; it is written last, so that a study
with a matching stamp is complete. Each CSV begins with the same statements as comment lines.
"""

import csv
import json
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

from push_model.files import data
from push_model.files.whole_file import write_whole
from push_scenario.parallel import source_digest
from studies.framework.parameters import Values
from studies.framework.study import Finding, Outcome, Study, Table

Stamp = dict[str, Any]


def stamp_of(study: Study, values: Values) -> Stamp:
    """
    State everything that the outcome of a study depends on.

    :param study: which.
    :param values: of its parameters.
    :return: dict of plain values.
    """
    manifest = ElementTree.parse(data.share_directory() / 'package.xml').getroot()
    parameters = {value.parameter.name: [value.value, value.parameter.unit, value.source.value]
                  for value in values}
    return {'figure': study.figure, 'title': study.title_of(values),
            'version': manifest.findtext('version'), 'software': source_digest(study.compute),
            'parameters': parameters}


class StudyFiles:
    """
    The files of a study.

    :param study: which.
    :param folder: where they are.
    """

    def __init__(self, study: Study, folder: Path) -> None:
        self._folder = Path(folder)
        self._figure = study.figure

    @property
    def png(self) -> Path:
        """Path of the figure."""
        return self._folder / f'{self._figure}.png'

    @property
    def svg(self) -> Path:
        """Path of the figure as vector graphics."""
        return self._folder / f'{self._figure}.svg'

    def table(self, name: str) -> Path:
        """
        Return the path of a table.

        :param name: of the table.
        :return: path of its CSV file.
        """
        return self._folder / f'{self._figure}-{name}.csv'

    def read(self, stamp: Stamp) -> Outcome | None:
        """
        Read what a finished study found, without its tables.

        :param stamp: of ``stamp_of``, which the study must have been computed for.
        :return: findings and page table; None where the study is not complete, or of another
            stamp.
        """
        try:
            stored = json.loads(self._stamp.read_text(encoding='utf-8'))
        except (OSError, ValueError):
            return None
        is_complete = 'files' in stored and all((self._folder / name).is_file()
                                                for name in stored['files'])
        # Through JSON, which turns tuples into lists.
        is_same = {key: stored.get(key) for key in stamp} == json.loads(json.dumps(stamp))
        if not (is_complete and is_same):
            return None
        findings = {name: Finding(*finding) for name, finding in stored['findings'].items()}
        return Outcome({}, findings, stored['page_table'])

    def write(self, stamp: Stamp, outcome: Outcome) -> None:
        """
        Write tables and stamp of a study whose figures are saved.

        :param stamp: of ``stamp_of``.
        :param outcome: what the study computed.
        :raises ValueError: where the columns of a table differ in length.
        """
        head = _head(stamp, outcome)
        for name, table in outcome.tables.items():
            _write_table(self.table(name), head, table)
        files = [path.name for path in (self.png, self.svg, *map(self.table, outcome.tables))]
        content = {**stamp, 'findings': outcome.findings, 'page_table': outcome.page_table,
                   'files': files}
        write_whole(self._stamp, (json.dumps(content, indent=1) + '\n').encode())

    @property
    def unfinished(self) -> Path:
        """Folder for the rows of its jobs, until all of them are there."""
        return self._folder / 'unfinished' / self._figure

    @property
    def _stamp(self) -> Path:
        return self._folder / f'{self._figure}.json'


def _head(stamp: Stamp, outcome: Outcome) -> list[str]:
    """State parameters and findings, one per line; empty units leave no double blanks."""
    head = [f'{key}: {stamp[key]}' for key in ('figure', 'title', 'version', 'software')]
    head += [f'parameter {name} = {value} {unit} ({source})'.replace('  ', ' ')
             for name, (value, unit, source) in stamp['parameters'].items()]
    head += [f'finding {name} = {finding.value!r} {finding.unit} ({finding.meaning})'
             .replace('  ', ' ') for name, finding in outcome.findings.items()]
    return head


def _write_table(path: Path, head: list[str], table: Table) -> None:
    columns = {name: list(column) for name, column in table.items()}
    lengths = {name: len(column) for name, column in columns.items()}
    if len(set(lengths.values())) > 1:
        raise ValueError(f'{path.name}: got columns of {lengths} rows, expected one length')
    with open(path, 'w', encoding='utf-8', newline='') as stream:
        stream.writelines(f'# {line}\n' for line in head)
        writer = csv.writer(stream, lineterminator='\n')
        writer.writerow(columns)
        writer.writerows(zip(*columns.values()))
