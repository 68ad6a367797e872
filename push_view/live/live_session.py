"""A session in real time: simulated time passes as fast as it is asked to, or as it can."""

import asyncio
from collections.abc import Callable
import math
import queue
import threading
from typing import Any, TypeVar

from push_scenario.definition.scenario import Scenario
from push_scenario.tidying.room import Room
from push_view.live.paced_session import PacedSession
from push_view.live.preparation import Preparations
from push_view.live.room_session import RoomSession
from push_view.live.session import Session
from push_view.live.setup import Setup
from push_view.server.commands import AddWall, Choose, CommandRefused, OpenLink, parse_command
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

    Time stands, and nothing is computed, while there is no page, and while nothing happens.

    :param scene: a ``Scenario`` with a task, or a ``Room``.
    :param clock: function that returns monotonic wall time [s].
    :raises ValueError: where the scenario has no task.
    """

    def __init__(self, scene: Scenario | Room, clock: Callable[[], float]) -> None:
        self.log = MessageLog()
        self._scene = scene
        self._setups = [Setup.of(scenario) for scenario in (
            scene.scenarios.values() if isinstance(scene, Room) else [scene])]
        self._clock = clock
        self._session: Session | RoomSession | None = None
        self._worker = Worker()
        self._preparations = Preparations(self.log)
        self._choice: asyncio.Task[None] | None = None
        self._is_ready_for_walls = False
        self._page_count = 0
        self._changed = asyncio.Event()

    @property
    def scenario_text(self) -> str:
        """The set-up as a scenario file; empty before there is one."""
        return '' if self._session is None else self._session.scenario_text

    def set_page_count(self, count: int) -> None:
        """
        Take note of how many pages show the session.

        :param count: of pages.
        """
        self._page_count = count
        self._changed.set()

    async def run(self) -> None:
        """Prepare the session, then let time pass until this is cancelled."""
        try:
            session = await self._start()
            if isinstance(session, Session):
                self._preparations.start_background(session.setup)
            while True:
                await self._run_until_idle(session)
                session.show_speed()
                while self._is_idle(session):
                    self._changed.clear()
                    await self._changed.wait()
                session.show_speed()
        finally:
            self._preparations.stop()

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
        if isinstance(session, Session) and isinstance(command, (Choose, OpenLink)):
            setup = session.setup_after(command)
            if self._choice is not None:
                self._choice.cancel()
            # In a task: the page that waits for it can do other things meanwhile.
            self._choice = asyncio.create_task(self._start_over(session, command, setup))
            return
        if (isinstance(session, Session) and isinstance(command, AddWall)
                and not self._is_ready_for_walls):
            self._is_ready_for_walls = True
            await self._announced('planner for walls', session.prepare_for_walls)
        await self._worker.call(lambda: session.handle(command))
        self._changed.set()

    def _is_idle(self, session: PacedSession) -> bool:
        return session.paused or session.is_at_rest or not self._page_count

    async def _run_until_idle(self, session: PacedSession) -> None:
        before = shown = self._clock()
        shown_time = session.time
        while not self._is_idle(session):
            await asyncio.sleep(TICK)
            now = self._clock()
            passed, before = min(now - before, MAX_TICK), now
            deadline = now + MAX_TICK
            await self._worker.call(lambda: session.advance(
                session.speed * passed, lambda: self._clock() > deadline))
            if now - shown > SPEED_PERIOD:
                achieved = (session.time - shown_time) / (now - shown)
                session.show_speed(achieved if achieved > 0.0 else math.nan)
                shown, shown_time = now, session.time

    async def _start(self) -> Session | RoomSession:
        async def make() -> Session | RoomSession:
            session = await self._announced('simulation', self._make_session)
            # What its user asks for from now on is done after the rehearsal.
            self._session = session
            return session

        # Side by side: the first time both are compiled.
        _, session = await asyncio.gather(self._prepare(), make())
        await self._announced('controller', session.rehearse)
        return session

    async def _prepare(self) -> None:
        for setup in self._setups:
            await self._preparations.wait_for(setup)

    def _make_session(self) -> Session | RoomSession:
        scene = self._scene
        return (RoomSession(scene, self.log) if isinstance(scene, Room)
                else Session(self._setups[0], self.log))

    async def _start_over(self, session: Session, command: Choose | OpenLink,
                          setup: Setup) -> None:
        """Prepare what was chosen, while the former run goes on, and start over with it."""
        await self._preparations.wait_for(setup)
        try:
            await self._worker.call(lambda: session.handle(command))
        except CommandRefused as refusal:
            self.log.replace({'type': 'notice', 'text': f'refused: {refusal}',
                              'is_passing': True})
        self._changed.set()
        self._preparations.start_background(session.setup)

    async def _announced(self, name: str, function: Callable[[], Result]) -> Result:
        """Show on the page why nothing moves meanwhile."""
        self.log.replace({'type': 'notice', 'text': f'preparing the {name}; at the very first '
                          'time it is compiled, which takes about a minute'})
        result = await self._worker.call(function)
        self.log.replace({'type': 'notice', 'text': ''})
        return result
