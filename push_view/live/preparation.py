"""
Preparation of objects: tables of pushes, and machine code, which are made before they are needed.

Both lie on disk once they are made. A process of its own makes them, so that a session goes on
meanwhile; it ends with this one.
"""

import asyncio
from collections.abc import Callable, Sequence
import contextlib
import multiprocessing
import os
import signal
from typing import Any, NamedTuple

from push_control.task.repeated_pushes import cost_settings
from push_dynamics.compiled import cache_directory
from push_model.parameters import PushedObject, RoundRobot
from push_navigation.settings import DriveSettings
from push_planner.straight.map_search.planner import warm_up
from push_primitives.cost_settings import CostSettings
from push_primitives.store import are_stored, store_primitives
from push_view.live.setup import Setup
from push_view.server.message_log import MessageLog

# Priority of what nobody waits for: the least there is.
BACKGROUND_NICENESS = 19

# Called with the name of what is prepared, and the part of it that is done, from 0 to 1.
Progress = Callable[[str, float], None]


class Job(NamedTuple):
    """
    What is prepared for one object.

    :param name: what it is called on the page.
    :param drive: ``DriveSettings``, for a plan in a map, which compiles the search; None for none.
    """

    name: str
    obj: PushedObject
    robot: RoundRobot
    costs: CostSettings
    drive: DriveSettings | None = None

    @classmethod
    def of(cls, setup: Setup) -> 'Job':
        """State what a session needs."""
        scenario, task = setup.scenario, setup.task
        supervision = task.supervision.for_object(scenario.object)
        costs = cost_settings(scenario.control, supervision, task.drive, scenario.robot)
        return cls(setup.choices['object'].replace('_', ' '), scenario.object, scenario.robot,
                   costs)

    @property
    def is_done(self) -> bool:
        """Tell whether it needs no preparation, or none is possible: then nothing is kept."""
        return cache_directory() is None or are_stored(self.obj, self.robot, self.costs)


async def prepare(jobs: Sequence[Job], progress: Progress, niceness: int = 0) -> None:
    """
    Prepare objects one after the other; cancelling this ends it at once.

    What cannot be prepared is left out: the session that needs it says why.

    :param progress: called as it goes on.
    :param niceness: by how much the priority of the process is reduced.
    """
    if not jobs:
        return
    # A fork would copy the threads' locks.
    context = multiprocessing.get_context('spawn')
    ours, theirs = context.Pipe(duplex=False)
    process = context.Process(target=_work, args=(theirs, list(jobs), niceness), daemon=True)
    process.start()
    theirs.close()
    try:
        await _follow(ours, jobs, progress)
    finally:
        process.terminate()
        ours.close()


async def _follow(connection: Any, jobs: Sequence[Job], progress: Progress) -> None:
    """Report what a process sends through a ``Connection``, until it ends."""
    loop = asyncio.get_running_loop()
    ended: asyncio.Future[None] = loop.create_future()

    def receive() -> None:
        try:
            index, part = connection.recv()
        except EOFError:
            loop.remove_reader(connection.fileno())
            if not ended.done():
                ended.set_result(None)
            return
        progress(jobs[index].name, part)

    loop.add_reader(connection.fileno(), receive)
    try:
        await ended
    finally:
        loop.remove_reader(connection.fileno())


def _work(connection: Any, jobs: Sequence[Job], niceness: int) -> None:
    """Prepare, in a process of its own."""
    # Ctrl-C in a terminal reaches this process too.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    os.nice(niceness)
    with contextlib.suppress(BrokenPipeError):
        for index, job in enumerate(jobs):
            report = _Percents(connection, index)
            report(0.0)
            # An object without a face that is long enough has no primitives.
            with contextlib.suppress(ValueError):
                store_primitives(job.obj, job.robot, job.costs, report)
                if job.drive is not None:
                    warm_up(job.obj, job.robot, job.drive)


class _Percents:
    """Sends every hundredth of a job's progress once."""

    def __init__(self, connection: Any, index: int) -> None:
        self._connection = connection
        self._index = index
        self._percent = -1

    def __call__(self, part: float) -> None:
        if int(100.0 * part) > self._percent:
            self._percent = int(100.0 * part)
            self._connection.send((self._index, part))


class Preparations:
    """
    Prepares what a session waits for, and, while nobody waits, all objects of the package.

    :param log: where the page is shown how far it is.
    """

    def __init__(self, log: MessageLog) -> None:
        self._log = log
        self._background: asyncio.Task[None] | None = None

    async def wait_for(self, setup: Setup) -> None:
        """Prepare what a session needs; the page shows a bar. The background ends."""
        job = Job.of(setup)
        if job.is_done:
            return
        self.stop()
        self._show(job.name, 0.0, is_awaited=True)
        try:
            await prepare([job], lambda name, part: self._show(name, part, is_awaited=True))
        finally:
            self._show('', 0.0)

    def start_background(self, setup: Setup) -> None:
        """Prepare all objects for the robot of a session, and the search in maps, at leisure."""
        self.stop()
        jobs: list[Job] = []
        for name in setup.object_names:
            # There may be no room for it where the robot starts.
            with contextlib.suppress(ValueError):
                jobs.append(Job.of(setup.with_choices({'object': name})))
        own = Job.of(setup)._replace(name='walls', drive=setup.task.drive)
        self._background = asyncio.create_task(
            self._prepare_at_leisure([*(job for job in jobs if not job.is_done), own]))

    def stop(self) -> None:
        """End what goes on in the background, at once."""
        if self._background is not None:
            self._background.cancel()

    async def _prepare_at_leisure(self, jobs: Sequence[Job]) -> None:
        try:
            await prepare(jobs, self._show, BACKGROUND_NICENESS)
        finally:
            self._show('', 0.0)

    def _show(self, name: str, part: float, is_awaited: bool = False) -> None:
        self._log.replace({'type': 'preparation', 'name': name, 'part': round(part, 2),
                           'is_awaited': is_awaited})
