"""
A study: one figure or table of the thesis, computed and drawn.

A study module holds functions of two kinds, which follow the protocols ``Compute`` and ``Draw``,
and lists its studies as ``STUDIES``. What is computed goes into tables and findings; the figure
is drawn from those alone, and the two sentences of its caption quote the findings.
"""

import dataclasses
from typing import Any, Callable, Mapping, NamedTuple, Protocol, Sequence

from matplotlib.figure import Figure
from studies.framework.parameters import ChosenValues, Overrides, Parameter, resolve, Values

# Column name with its unit, such as ``rho_rad`` -> values; all columns have one length.
Table = dict[str, Any]
# Column name -> number or text: what one of many jobs returns.
Record = dict[str, Any]
# What numbers begin with that are not those of a chapter -> name of their group: the appendix of
# the thesis, and push primitives. Names without a number are beyond the thesis.
GROUPS = {'C': 'appendix', 'P': 'primitives'}
BEYOND_THESIS = 'beyond'
# Measured: what one job of most studies takes, at most [s].
SHORT_JOB = 5e-3


class Finding(NamedTuple):
    """
    A result of a study as one number.

    :param value: number; 1 or 0 for a yes or no.
    :param unit: SI or a usual multiple, empty for a pure number.
    :param meaning: in words.
    """

    value: float
    unit: str
    meaning: str


class Outcome(NamedTuple):
    """
    Everything that a study computed.

    :param tables: table name -> ``Table``.
    :param findings: name -> ``Finding``.
    :param page_table: table that the gallery shows below the figure, its columns of texts or
        numbers; empty where there is none.
    """

    tables: dict[str, Table]
    findings: dict[str, Finding]
    page_table: Table = {}


class RunJobs(Protocol):
    """Runs a function on many jobs, on all workers and resumably."""

    def __call__(self, function: Callable[[Any], Record], jobs: Sequence[Any], /, *,
                 job_time: float = SHORT_JOB) -> Sequence[Record]:
        """
        Run all jobs.

        :param function: as ``push_scenario.parallel.run_many`` takes it.
        :param jobs: plain values.
        :param job_time: what one takes, roughly [s].
        :return: the record of each job, in their order.
        """
        ...


class Compute(Protocol):
    """Computes a study."""

    def __call__(self, values: Values, run_jobs: RunJobs, /) -> Outcome:
        """
        Compute tables and findings.

        :param values: the parameters of the study as attributes.
        :param run_jobs: for studies with many independent simulations.
        :return: the outcome.
        :raises ValueError: where the values do not describe a push.
        """
        ...


class Draw(Protocol):
    """Draws a study."""

    def __call__(self, figure: Figure, outcome: Outcome, values: Values, /) -> None:
        """
        Draw the outcome.

        :param figure: matplotlib figure without axes.
        :param outcome: of the study's ``compute``.
        :param values: with which it was computed.
        """
        ...


# Text that may depend on what a study was computed with, and on what it found: by the values of
# its parameters, by the values of its findings.
Title = str | Callable[[Values], str]
Sentence = str | Callable[[Mapping[str, float]], str]


@dataclasses.dataclass(frozen=True)
class Study:
    """
    One figure or table.

    :param figure: its number in the thesis, with ``T`` in front for a table; beyond the thesis
        such as ``P.1``, or a name such as ``four-goals``.
    :param title: in a few words; ``{name}`` is replaced by the value of a parameter, a function
        makes it of the values.
    :param parameters: what ``compute`` and ``draw`` find in their ``values``.
    :param compute: computes the outcome.
    :param draw: draws the outcome.
    :param observation: one sentence on what the figure shows; ``{name}`` is replaced by a finding,
        ``{name:.2f}`` formats it; a function makes the sentence of the findings.
    :param explanation: one sentence on why that is so, likewise.
    :param size: width and height of the figure [inch].
    """

    figure: str
    title: Title
    parameters: tuple[Parameter, ...]
    compute: Compute
    draw: Draw
    observation: Sentence
    explanation: Sentence
    size: tuple[float, float] = (6.4, 4.2)

    @property
    def chapter(self) -> str:
        """Chapter of the thesis, such as ``chapter2``; or the name of what is beyond it."""
        part = self.figure.lstrip('T').split('.')[0]
        return f'chapter{part}' if part.isdigit() else GROUPS.get(part, BEYOND_THESIS)

    @property
    def label(self) -> str:
        """Number as a reader knows it, such as ``2.11`` or ``Table 3.1``."""
        return f'Table {self.figure[1:]}' if self.figure.startswith('T') else self.figure

    def values(self, chosen: ChosenValues, overrides: Overrides | None = None) -> Values:
        """
        Find the values of all parameters.

        :param chosen: values of what the captions leave open, as of ``read_chosen_values``.
        :param overrides: parameter name -> value that counts before all others.
        :return: the values.
        :raises ValueError: where no value is chosen, or an override is of another type.
        """
        return resolve(self.figure, self.parameters, chosen, overrides or {})

    def title_of(self, values: Values) -> str:
        """
        Write the title for the values that a study is computed with.

        :param values: of its parameters.
        :return: a few words.
        """
        if callable(self.title):
            return self.title(values)
        return self.title.format(**{value.parameter.name: value.value for value in values})

    def caption(self, findings: Mapping[str, Finding]) -> str:
        """
        Write what the figure shows, and why.

        :param findings: of the outcome.
        :return: two sentences.
        """
        values = {name: finding.value for name, finding in findings.items()}
        return ' '.join((text(values) if callable(text) else text).format(**values)
                        for text in (self.observation, self.explanation))
