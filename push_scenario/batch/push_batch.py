"""
Batches of any number of pushes: blocks of cases, simulated by all cores, straight to disk.

A block is drawn, simulated and written by one worker, so that no process ever holds more than a
few blocks, and none hands results to another one. The rows of all cases are one ``.npy`` file that
is as long as it will be from the start; beside it a file of JSON lines notes the blocks that are
done, each with the checksum of its rows.
"""

from collections.abc import Callable
from concurrent import futures
import dataclasses
from os import PathLike
from pathlib import Path
from typing import Any
import zlib

import numpy as np
from numpy.typing import NDArray
from push_dynamics.cases import CaseEnd
from push_scenario.batch.batch import BatchProgress, run_batch
from push_scenario.batch.chunks import Record
from push_scenario.batch.push_cases import (
    case_values, CaseRows, refusal, row_type, simulate_cases,
)
from push_scenario.batch.varied_push import CaseValues, VariedPush
from push_sim_node.plant import Plant

# Draws the columns of some cases: (generator, their number) -> columns.
Draw = Callable[[np.random.Generator, int], CaseValues]
# Cases that are drawn and simulated at a time; chosen: some 0.1 s of work and 0.3 MB of rows.
BLOCK = 1000
# Of the file of rows, and of that of blocks that are done.
SUFFIX, NOTES_SUFFIX = '.npy', '.jsonl'


@dataclasses.dataclass(frozen=True)
class PushBatchResult:
    """
    Cases of a batch, read from its file as they are asked for.

    :param push: the ``VariedPush``.
    :param rows: see ``simulate_cases``, shape (number of cases,).
    """

    push: VariedPush
    rows: CaseRows

    def column(self, name: str) -> NDArray[Any]:
        """
        Gather one column or result of all cases.

        :param name: such as ``object.mass`` or ``object_x``.
        :return: first axis: the cases. Results of cases that were refused are nan.
        :raises ValueError: where the rows have no such field.
        """
        names = self.rows.dtype.names or ()
        if name not in names:
            raise ValueError(f'column: got {name!r}, expected one of ' + ', '.join(names))
        return np.array(self.rows[name])

    def plant(self, case: int) -> Plant:
        """
        Make the plant of one case, at its start.

        :param case: its number.
        :raises ValueError: where it was refused, with the reason.
        """
        return self.push.plant(case_values(self.rows[case]))

    def run(self, case: int) -> Plant:
        """
        Run one case on a plant of its own, to the end of its segments.

        :param case: its number.
        :raises ValueError: where it was refused, with the reason.
        """
        return self.push.run(case_values(self.rows[case]))

    def refusals(self) -> dict[int, str]:
        """List the cases that were refused: number and reason."""
        refused: list[int] = np.flatnonzero(self.rows['end'] == CaseEnd.REFUSED).tolist()
        return {case: refusal(self.push, self.rows[case]) for case in refused}


@dataclasses.dataclass(frozen=True)
class PushBlocks:
    """
    What runs on every block of a batch, and identifies it.

    :param push: the ``VariedPush``.
    :param draw: function of a module, see ``run_pushes``.
    :param count: number of cases.
    :param seed: of the draws.
    :param block: cases in a block.
    :param path: file of the rows.
    """

    push: VariedPush
    draw: Draw
    count: int
    seed: int
    block: int
    path: str = dataclasses.field(repr=False)

    def columns(self, block: int) -> CaseValues:
        """
        Draw the columns of a whole block, which do not depend on how many cases there are.

        :param block: its number.
        """
        seed = np.random.SeedSequence(self.seed, spawn_key=(block,))
        return self.draw(np.random.default_rng(seed), self.block)

    def create_file(self) -> None:
        """
        Make the file of all rows, not yet run, unless it is there.

        :raises ValueError: where the file that is there has other rows, or rows of nothing known.
        """
        path = Path(self.path)
        kind = row_type(self.push.columns(self.columns(0)))
        if path.exists():
            rows = np.load(path, mmap_mode='r')
            if rows.dtype != kind or rows.shape != (self.count,):
                raise ValueError(f'{path}: got {rows.shape} rows of {rows.dtype}, expected '
                                 f'{(self.count,)} of {kind}; give another file or remove it')
            if not path.with_suffix(NOTES_SUFFIX).exists() and rows['end'].any():
                raise ValueError(f'{path}: got rows without {path.stem}{NOTES_SUFFIX} beside them,'
                                 ' expected it, or no file; give another file or remove it')
            return
        path.parent.mkdir(parents=True, exist_ok=True)
        np.lib.format.open_memmap(path, 'w+', kind, (self.count,))

    def is_written(self, block: int, record: Record) -> bool:
        """
        Tell whether the rows of a block are those that its record was made for.

        :param block: its number.
        :param record: as the call returned it.
        """
        rows = np.load(self.path, mmap_mode='r')[self._first(block):self._first(block + 1)]
        return record.get('checksum') == zlib.crc32(rows.tobytes())

    def __call__(self, block: int) -> Record:
        """
        Draw, simulate and write a block.

        :param block: its number.
        :return: number of its cases by their ends, and the checksum of their rows.
        """
        first, count = self._first(block), self._first(block + 1) - self._first(block)
        drawn = self.push.columns(self.columns(block))
        rows = simulate_cases(self.push, {name: column[:count] for name, column in drawn.items()})
        found = np.load(self.path, mmap_mode='r')
        if rows.dtype != found.dtype:
            raise ValueError(f'draw: got rows of {rows.dtype}, expected {found.dtype} as in the '
                             'first block')
        data = rows.tobytes()
        # Not through the map, whose pages would count as memory of this process.
        with open(self.path, 'r+b') as stream:
            stream.seek(found.offset + first * rows.itemsize)
            stream.write(data)
        ends = {end.name.lower(): int(np.count_nonzero(rows['end'] == end))
                for end in (CaseEnd.COMPLETED, CaseEnd.LOST, CaseEnd.REFUSED)}
        return {**ends, 'checksum': zlib.crc32(data)}

    def _first(self, block: int) -> int:
        return min(block * self.block, self.count)


def run_pushes(push: VariedPush, draw: Draw, count: int, out: str | PathLike[str], *,
               seed: int = 0, block: int = BLOCK, workers: int | None = None,
               executor: futures.Executor | None = None, progress: BatchProgress | None = None,
               any_software: bool = False) -> PushBatchResult:
    """
    Simulate any number of cases of a push; continue where an earlier call was interrupted.

    Memory does not grow with the number of cases. The rows are the same to the bit however they
    are run, and each as its ``Plant`` would end. After an interrupt or a kill the same call does
    what is missing; interrupts wait for the blocks that are under way.

    :param push: the ``VariedPush``.
    :param draw: function of a module; called with a generator of its own for every block and the
        number of cases, it returns columns of as many rows.
    :param count: number of cases.
    :param out: file of rows to write, ``.npy``, which numpy and others read; blocks that are done
        are noted beside it, ``.jsonl``.
    :param seed: of the draws.
    :param block: cases that are drawn and simulated at a time; part of what is drawn.
    :param workers: as for ``run_batch``.
    :param executor: as for ``run_batch``; its workers must see the same files.
    :param progress: called with (finished cases, all cases).
    :param any_software: continue also with rows that other software has made.
    :return: the ``PushBatchResult``.
    :raises ValueError: where ``out`` holds another batch, or columns do not fit.
    :raises RuntimeError: where a block failed, with its error.
    """
    path = Path(out)
    for name, value in (('count', count), ('block', block)):
        if value < 1:
            raise ValueError(f'{name}: got {value!r}, expected at least 1')
    if path.suffix != SUFFIX:
        raise ValueError(f'out: got {str(path)!r}, expected a name that ends in {SUFFIX}')
    blocks = PushBlocks(push, draw, count, seed, block, str(path))
    blocks.create_file()

    def report(done: int, _: int) -> None:
        if progress is not None:
            progress(min(done * block, count), count)

    result = run_batch(blocks, range(-(-count // block)), path.with_suffix(NOTES_SUFFIX),
                       workers=workers, executor=executor, progress=report,
                       any_software=any_software, is_valid=blocks.is_written, table=False)
    if result.errors:
        number, error = next(iter(result.errors.items()))
        raise RuntimeError(f'{len(result.errors)} blocks failed, the first of them {number}: '
                           f'{error}')
    return PushBatchResult(push, np.load(path, mmap_mode='r'))
