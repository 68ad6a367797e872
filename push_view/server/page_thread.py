"""The server of the page in a thread of its own, beside a node."""

import asyncio
from collections.abc import Coroutine
import threading
from typing import Any, TypeVar

from push_view.server.message_log import MessageLog
from push_view.server.page_server import Access, Callbacks
from push_view.server.serving import serve

# Longest wait for start or end of the server [s]; chosen: both take milliseconds.
TIMEOUT = 30.0

Result = TypeVar('Result')


class PageThread:
    """Serves the page from ``start`` to ``stop``."""

    def __init__(self) -> None:
        """Start the thread, in which nothing happens yet."""
        self._loop = asyncio.new_event_loop()
        threading.Thread(target=self._loop.run_forever, daemon=True).start()

    def start(self, title: str, log: MessageLog, callbacks: Callbacks, *, host: str, port: int,
              access: Access) -> str:
        """
        Serve the page.

        :param title: of the page.
        :param log: what is shown.
        :param callbacks: called in the thread.
        :param host: address to listen at.
        :param port: its port, 0 for any that is free.
        :param access: who may use it.
        :return: the address of the page.
        :raises OSError: where the port is taken.
        """
        self._server = serve(title, log, callbacks, host=host, port=port, access=access)
        return self._wait_for(self._server.__aenter__())

    def stop(self) -> None:
        """Disconnect all pages and end the thread."""
        self._wait_for(self._server.__aexit__(None, None, None))
        self._loop.call_soon_threadsafe(self._loop.stop)

    def _wait_for(self, coroutine: Coroutine[Any, Any, Result]) -> Result:
        return asyncio.run_coroutine_threadsafe(coroutine, self._loop).result(TIMEOUT)
