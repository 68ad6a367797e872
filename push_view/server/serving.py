"""The server at an address of this machine, for as long as it is needed."""

from collections.abc import AsyncGenerator
import contextlib

from aiohttp import web
from push_view.server.address import own_address
from push_view.server.message_log import MessageLog
from push_view.server.page_server import Access, Callbacks, PageServer

ANY_ADDRESS = ('0.0.0.0', '::')
# Time that pages have to disconnect [s]; chosen: they need none.
SHUTDOWN_TIME = 0.5
# Time in which a connection has to ask for something until it is closed [s]; chosen: a browser
# asks at once, and each connection takes a file descriptor.
IDLE_TIME = 10.0


@contextlib.asynccontextmanager
async def serve(title: str, log: MessageLog, callbacks: Callbacks, *, host: str, port: int,
                access: Access) -> AsyncGenerator[str, None]:
    """
    Serve the page inside this context.

    :param title: of the page.
    :param log: what is shown.
    :param callbacks: of the session.
    :param host: address to listen at.
    :param port: its port, 0 for any that is free.
    :param access: who may use it.
    :return: the address of the page.
    :raises OSError: where the port is taken.
    """
    server = PageServer(title, log, callbacks, access)
    runner = web.AppRunner(server.application(), access_log=None, shutdown_timeout=SHUTDOWN_TIME,
                           keepalive_timeout=IDLE_TIME)
    await runner.setup()
    try:
        await web.TCPSite(runner, host, port).start()
        bound = runner.addresses[0][1]
        name = own_address() if host in ANY_ADDRESS else host
        query = '' if access.token is None else f'?token={access.token}'
        yield f'{access.origin or f"http://{name}:{bound}"}/{query}'
    finally:
        await runner.cleanup()
