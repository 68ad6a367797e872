"""
Server of the page: for those on this machine, or for those who have the token.

A page of another site cannot use it: its requests name that site as their origin, and under
another name of this machine they name another host. Both are refused.
"""

import asyncio
from collections.abc import Awaitable, Callable
import hmac
import json
from typing import NamedTuple

from aiohttp import web, WSCloseCode, WSMsgType
from push_view.page_file import page_html
from push_view.server.commands import CommandRefused
from push_view.server.message_log import MessageLog

LOCAL_NAMES = {'localhost', '127.0.0.1', '[::1]'}
# Time between two looks for messages [s]; chosen: a page shows 60 pictures a second, and is some
# messages late by itself.
SEND_PERIOD = 0.03
# Longest command [bytes]; chosen: several times what any has.
MAX_COMMAND = 2048
# Commands that are refused before a page is disconnected; chosen: more than a user's mistakes.
MAX_REFUSALS = 100
HEADERS = {'Cache-Control': 'no-store', 'Referrer-Policy': 'no-referrer',
           'X-Content-Type-Options': 'nosniff', 'X-Frame-Options': 'DENY'}

Handler = Callable[[str], Awaitable[None]]


class Access(NamedTuple):
    """
    Who may use the page.

    :param token: that must be in the address, or None where only this machine is served.
    :param origin: of the page behind a proxy, as ``https://robot.example``; None without one.
    """

    token: str | None = None
    origin: str | None = None

    def fault(self, request: web.Request, needs_origin: bool) -> str:
        """
        Tell why a request is refused.

        :param request: the request.
        :param needs_origin: whether it must state that it comes from this page.
        :return: one sentence, empty where it is allowed.
        """
        host = request.headers.get('Host', '')
        if self.token is None and host.rpartition(':')[0] not in LOCAL_NAMES:
            return 'This page is for this machine only.'
        if self.token is not None and not hmac.compare_digest(
                request.query.get('token', '').encode(), self.token.encode()):
            return 'The token is missing or wrong; the server has printed the whole address.'
        origins = {f'http://{host}', self.origin or f'http://{host}'}
        if needs_origin and request.headers.get('Origin') not in origins:
            return 'Commands are for the page of this server only.'
        return ''


class Callbacks(NamedTuple):
    """
    What the server asks of a session.

    :param handle: called with the text of each command; raises ``CommandRefused``.
    :param on_page_count: called with the number of pages that are open, where it changes.
    :param scenario_text: returns the scenario file to download; None where there is none.
    """

    handle: Handler
    on_page_count: Callable[[int], None] = lambda count: None
    scenario_text: Callable[[], str] | None = None


class PageServer:
    """
    Serves the page, sends it what is logged, and takes its commands.

    :param title: of the page.
    :param log: what is shown.
    :param callbacks: of the session.
    :param access: who may use it.
    """

    def __init__(self, title: str, log: MessageLog, callbacks: Callbacks,
                 access: Access = Access()) -> None:
        self.refused = 0
        self._title = title
        self._log = log
        self._callbacks = callbacks
        self._access = access
        self._sockets: set[web.WebSocketResponse] = set()

    def application(self) -> web.Application:
        """Make the application that answers requests."""
        application = web.Application()
        application.add_routes([web.get('/', self._page), web.get('/socket', self._socket),
                                web.get('/scenario.yaml', self._scenario)])
        application.on_shutdown.append(self._close)
        return application

    async def _page(self, request: web.Request) -> web.Response:
        fault = self._access.fault(request, needs_origin=False)
        if fault:
            return web.Response(status=403, text=fault, headers=HEADERS)
        return web.Response(text=page_html(self._title), content_type='text/html',
                            headers=HEADERS)

    async def _scenario(self, request: web.Request) -> web.Response:
        fault = self._access.fault(request, needs_origin=False)
        if fault:
            return web.Response(status=403, text=fault, headers=HEADERS)
        if self._callbacks.scenario_text is None:
            return web.Response(status=404, text='There is no simulation.', headers=HEADERS)
        return web.Response(
            text=self._callbacks.scenario_text(), content_type='application/yaml',
            headers={**HEADERS, 'Content-Disposition': 'attachment; filename="scenario.yaml"'})

    async def _socket(self, request: web.Request) -> web.StreamResponse:
        fault = self._access.fault(request, needs_origin=True)
        if fault:
            return web.Response(status=403, text=fault, headers=HEADERS)
        socket = web.WebSocketResponse(max_msg_size=MAX_COMMAND, heartbeat=30.0)
        await socket.prepare(request)
        self._sockets.add(socket)
        self._callbacks.on_page_count(len(self._sockets))
        sender = asyncio.create_task(self._send(socket))
        try:
            await self._receive(socket)
        finally:
            sender.cancel()
            self._sockets.discard(socket)
            self._callbacks.on_page_count(len(self._sockets))
        return socket

    async def _send(self, socket: web.WebSocketResponse) -> None:
        cursor = 0
        while not socket.closed:
            texts, cursor = self._log.since(cursor)
            if texts:
                await socket.send_str('[' + ','.join(texts) + ']')
            await asyncio.sleep(SEND_PERIOD)

    async def _receive(self, socket: web.WebSocketResponse) -> None:
        refusals = 0
        async for message in socket:
            try:
                if message.type is not WSMsgType.TEXT:
                    raise CommandRefused('message: got bytes, expected text')
                await self._callbacks.handle(message.data)
            except CommandRefused as refusal:
                refusals += 1
                self.refused += 1
                await socket.send_str(json.dumps([{
                    'type': 'refused', 'text': str(refusal), 'count': self.refused}]))
                if refusals >= MAX_REFUSALS:
                    await socket.close(code=WSCloseCode.POLICY_VIOLATION)

    async def _close(self, application: web.Application) -> None:
        for socket in set(self._sockets):
            await socket.close(code=WSCloseCode.GOING_AWAY)
