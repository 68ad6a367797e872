"""What a study is: which figure, with which parameters, what it computes, how it is drawn."""

import dataclasses
from typing import Any, Callable, NamedTuple


class Parameter(NamedTuple):
    """
    A parameter of a study.

    :param name: as ``--set`` takes it.
    :param unit: SI, empty for a pure number.
    :param meaning: in words.
    :param caption: value that the figure's caption gives; None where it leaves the value open, so
        that ``config/studies.yaml`` states it.
    """

    name: str
    unit: str
    meaning: str
    caption: Any = None


class Finding(NamedTuple):
    """
    What a study found, as a number.

    :param value: number; 1 or 0 for a yes or no.
    :param unit: SI, empty for a pure number.
    :param meaning: in words.
    """

    value: float
    unit: str
    meaning: str


class Outcome(NamedTuple):
    """
    Numbers that a study computed.

    :param tables: dict of table names to tables; a table is a dict of column names (with their
        unit, such as ``rho_rad``) to arrays of one length.
    :param findings: dict of names to ``Finding``.
    """

    tables: dict
    findings: dict


@dataclasses.dataclass(frozen=True)
class Study:
    """
    One figure.

    :param figure: its number in the thesis, ``T`` before that of a table; or its name.
    :param title: in a few words.
    :param parameters: tuple of ``Parameter``.
    :param compute: function of (values, batch) that returns the ``Outcome``; values has the
        parameters as attributes, ``batch(function, jobs)`` runs a function of a module on plain
        jobs, on all workers and resumably, and returns its records (see
        ``push_scenario.batch.batch.run_batch``).
    :param draw: function of (figure, outcome, values) that draws on a matplotlib figure.
    :param seen: one sentence on what the picture shows; ``{name}`` is a finding, ``{name:.2f}``
        its format.
    :param why: one sentence on why it is so, likewise.
    :param size: width and height of the picture [inch].
    """

    figure: str
    title: str
    parameters: tuple
    compute: Callable
    draw: Callable
    seen: str
    why: str
    size: tuple = (6.4, 4.2)

    @property
    def chapter(self):
        """Chapter of the thesis, such as ``chapter2``."""
        return f'chapter{self.figure.lstrip("T").split(".")[0]}'

    def sentences(self, findings):
        """
        Say what one sees and why.

        :param findings: of the outcome.
        """
        values = {name: finding.value for name, finding in findings.items()}
        return f'{self.seen.format(**values)} {self.why.format(**values)}'
