"""How true statements are: shares of cases beside the levels that were stated."""

from typing import NamedTuple, Sequence

from benchmarks.chances.samples import Ends, Sample
from benchmarks.controller.tables import wilson
from push_model.outlook import LEVELS, Outlook

# Levels that the tables show, and how far a share may be off [%].
SHOWN_LEVELS = (0.5, 0.9, 0.99)
MAX_DIFFERENCE = 3.0
TITLES = {'time': 'time', 'position_error': 'distance', 'heading_error': 'heading'}


class Statement(NamedTuple):
    """
    What was stated of a run, and the ``Sample`` of it.

    :param outlook: ``Outlook`` by a model that was fitted without this run.
    """

    sample: Sample
    outlook: Outlook


class Share(NamedTuple):
    """
    A share of cases.

    :param stated: as stated [%].
    :param hits: number of cases in which it was so.
    :param total: number of cases.
    """

    stated: float
    hits: int
    total: int

    def __str__(self) -> str:
        """Write it with its 95 % interval; bold where it is off by more than is allowed."""
        low, high = wilson(self.hits, self.total)
        share = 100.0 * self.hits / self.total
        text = f'{share:.0f} ({100.0 * low:.0f} to {100.0 * high:.0f})'
        return f'**{text}**' if abs(share - self.stated) > MAX_DIFFERENCE else text


def coverage(statements: Sequence[Statement], quantity: str, level: float) -> Share:
    """
    Count how many runs that were done kept to a quantile.

    :param quantity: a field of ``Ends``.
    :param level: one of ``LEVELS``.
    """
    index = LEVELS.index(level)
    done = [statement for statement in statements if statement.sample.is_done]
    hits = sum(getattr(sample.actual, quantity) <= getattr(outlook, quantity)[index]
               for sample, outlook in done)
    return Share(100.0 * level, hits, len(done))


def quantile_table(groups: dict[str, list[Statement]]) -> str:
    """
    Write the shares of runs that kept to the stated quantiles.

    :param groups: statements by name.
    """
    titles = [f'{TITLES[quantity]} {100.0 * level:.0f} %'
              for quantity in Ends._fields for level in SHOWN_LEVELS]
    return _table(['cases', 'number', *titles], [
        [name, str(sum(statement.sample.is_done for statement in statements)),
         *(str(coverage(statements, quantity, level))
           for quantity in Ends._fields for level in SHOWN_LEVELS)]
        for name, statements in groups.items()
        if any(statement.sample.is_done for statement in statements)])


def chance_table(groups: dict[str, list[Statement]]) -> str:
    """
    Write stated chances beside the shares of runs that ended so.

    :param groups: statements by name.
    """
    rows = [[name, *_chances(statements)] for name, statements in groups.items() if statements]
    return _table(['cases', 'number', 'stated [%]', 'true [%]'], rows)


def _chances(statements: Sequence[Statement]) -> tuple[str, str, str]:
    count = len(statements)
    stated = 100.0 * sum(statement.outlook.chance for statement in statements) / count
    share = Share(stated, sum(statement.sample.is_within for statement in statements), count)
    return str(count), f'{stated:.1f}', str(share)


def _table(titles: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    lines = [titles, ['---'] * len(titles), *rows]
    return '\n'.join('| ' + ' | '.join(line) + ' |' for line in lines)
