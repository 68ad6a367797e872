"""The server at an address of this machine, for as long as it is needed."""

from collections.abc import AsyncGenerator
import contextlib

from aiohttp import web
from push_view.server.message_log import MessageLog
from push_view.server.page_server import Access, Handler, PageServer

ANY_ADDRESS = ('0.0.0.0', '::')
# Time that pages have to disconnect [s]; chosen: they need none.
SHUTDOWN_TIME = 0.5


@contextlib.asynccontextmanager
async def serve(title: str, log: MessageLog, handle: Handler, *, host: str, port: int,
                token: str | None) -> AsyncGenerator[str, None]:
    """
    Serve the page inside this context.

    :param title: of the page.
    :param log: what is shown.
    :param handle: called with the text of each command; raises ``CommandRefused``.
    :param host: address to listen at.
    :param port: its port, 0 for any that is free.
    :param token: that others need, None for this machine alone.
    :return: the address of the page.
    :raises OSError: where the port is taken.
    """
    server = PageServer(title, log, handle, Access(token))
    runner = web.AppRunner(server.application(), access_log=None, shutdown_timeout=SHUTDOWN_TIME)
    await runner.setup()
    try:
        await web.TCPSite(runner, host, port).start()
        bound = runner.addresses[0][1]
        name = 'localhost' if host in ANY_ADDRESS else host
        query = '' if token is None else f'?token={token}'
        yield f'http://{name}:{bound}/{query}'
    finally:
        await runner.cleanup()
