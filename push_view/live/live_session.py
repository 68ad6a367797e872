"""A session in real time: simulated time passes as fast as it is asked to, or as it can."""

import asyncio
from collections.abc import Callable
import math
import queue
import threading
from typing import Any, TypeVar

from push_scenario.definition.scenario import Scenario
from push_view.live.session import Session
from push_view.live.setup import Setup
from push_view.server.commands import AddWall, CommandRefused, parse_command
from push_view.server.message_log import MessageLog

# Period of the simulation [s of wall time], and the most that it may compute in it before commands
# have their turn; chosen: a page sees motion, and its user an answer.
TICK = 0.03
MAX_TICK = 0.1
# Period at which the speed that was reached is shown [s].
SPEED_PERIOD = 1.0

Result = TypeVar('Result')


class Worker:
    """
    A thread that does one thing after the other, and is left where it is when the process ends.

    A plan in a map takes seconds, which nobody wants to wait for after Ctrl-C.
    """

    def __init__(self) -> None:
        """Start the thread."""
        self._jobs: queue.SimpleQueue[Callable[[], None]] = queue.SimpleQueue()
        threading.Thread(target=self._work, daemon=True).start()

    async def call(self, function: Callable[[], Result]) -> Result:
        """
        Call a function in the thread.

        :param function: to call.
        :return: what it returns; what it raises is raised here.
        """
        loop = asyncio.get_running_loop()
        future: asyncio.Future[Result] = loop.create_future()

        def settle(method: Callable[[Any], None], value: Any) -> None:
            if not future.done():
                method(value)

        def job() -> None:
            try:
                method, value = future.set_result, function()
            except Exception as error:  # noqa: B902 (raised where it is awaited)
                method, value = future.set_exception, error
            loop.call_soon_threadsafe(settle, method, value)

        self._jobs.put(job)
        return await future

    def _work(self) -> None:
        while True:
            job = self._jobs.get()
            try:
                job()
            except RuntimeError:
                # The loop has been closed: nobody waits any more.
                return


class LiveSession:
    """
    A session that runs in a thread of its own.

    :param scenario: a ``Scenario`` with a task.
    :param clock: function that returns monotonic wall time [s].
    :raises ValueError: where the scenario has no task.
    """

    def __init__(self, scenario: Scenario, clock: Callable[[], float]) -> None:
        self.log = MessageLog()
        self._setup = Setup.of(scenario)
        self._clock = clock
        self._session: Session | None = None
        self._worker = Worker()
        self._is_ready_for_walls = False

    async def run(self) -> None:
        """Prepare the session, then let time pass until this is cancelled."""
        session = await self._prepare('simulation', lambda: Session(self._setup, self.log))
        self._session = session
        before = shown = self._clock()
        shown_time = session.time
        while True:
            await asyncio.sleep(TICK)
            now = self._clock()
            passed, before = min(now - before, MAX_TICK), now
            if session.paused:
                shown, shown_time = now, session.time
                continue
            deadline = now + MAX_TICK
            await self._worker.call(lambda: session.advance(
                session.speed * passed, lambda: self._clock() > deadline))
            if now - shown > SPEED_PERIOD:
                achieved = (session.time - shown_time) / (now - shown)
                session.show_speed(achieved if achieved > 0.0 else math.nan)
                shown, shown_time = now, session.time

    async def handle(self, text: str) -> None:
        """
        Do what the page asks for, between two steps of time.

        :param text: the command.
        :raises CommandRefused: with the reason.
        """
        command = parse_command(text)
        session = self._session
        if session is None:
            raise CommandRefused('the simulation is not ready yet')
        if isinstance(command, AddWall) and not self._is_ready_for_walls:
            self._is_ready_for_walls = True
            await self._prepare('planner for walls', session.prepare_for_walls)
        await self._worker.call(lambda: session.handle(command))

    async def _prepare(self, name: str, function: Callable[[], Result]) -> Result:
        """Show on the page why nothing moves meanwhile."""
        self.log.replace({'type': 'notice', 'text': f'preparing the {name}; at the very first '
                          'time it is compiled, which takes about a minute'})
        result = await self._worker.call(function)
        self.log.replace({'type': 'notice', 'text': ''})
        return result
