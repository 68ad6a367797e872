"""A page that is open, without a browser: it reads what it is sent, and sends commands."""

import asyncio
import json
import threading
from typing import Any
from urllib.parse import urlsplit

from helpers.extras import import_extra


class PageReader:
    """
    A page in a thread of its own.

    ``received``: all messages so far.

    :param url: of the page.
    """

    def __init__(self, url: str) -> None:
        self.received: list[dict[str, Any]] = []
        self._url = url
        self._loop = asyncio.new_event_loop()
        self._socket: Any = None
        threading.Thread(target=self._loop.run_until_complete, args=[self._read()],
                         daemon=True).start()

    def send(self, **command: Any) -> None:
        """Send a command, once connected."""
        asyncio.run_coroutine_threadsafe(self._socket.send_json(command), self._loop).result(60)

    def of_kind(self, kind: str) -> list[dict[str, Any]]:
        """List the messages of a kind."""
        return [message for message in self.received if message['type'] == kind]

    async def _read(self) -> None:
        aiohttp = import_extra('aiohttp', 'play')
        async with aiohttp.ClientSession() as session:
            async with session.ws_connect(_socket(self._url),
                                          headers=_headers(self._url)) as self._socket:
                async for message in self._socket:
                    self.received += json.loads(message.data)


def is_refused(url: str, **headers: str) -> bool:
    """Tell whether a page with other headers would be refused."""
    aiohttp = import_extra('aiohttp', 'play')

    async def connect() -> bool:
        async with aiohttp.ClientSession() as session:
            try:
                async with session.ws_connect(_socket(url), headers={**_headers(url), **headers}):
                    return False
            except aiohttp.WSServerHandshakeError as refusal:
                return refusal.status == 403

    return asyncio.run(connect())


def _socket(url: str) -> str:
    """Address of the socket beside a page, with its token."""
    return urlsplit(url)._replace(path='/socket').geturl()


def _headers(url: str) -> dict[str, str]:
    """Say that the page itself asks."""
    return {'Origin': f'http://{urlsplit(url).netloc}'}
