"""Command line ``push play``: a page on which one plays with the simulation of a task."""

import argparse
import asyncio
from collections.abc import Sequence
import contextlib
import errno
import secrets
import signal
import sys
import time
import webbrowser

from push_model.files.parameter_files import named_file
from push_model.optional import how_to_install
from push_scenario.definition.catalogue import find_scenario
from push_scenario.definition.loader import read_scenario
from push_scenario.tidying.room import read_room
from push_view.live.live_session import LiveSession
from push_view.server.address import checked_origin, qr_code

DEMO = 'task_demo'
PORT = 8642  # chosen: not registered for anything
MAX_PORT = 65535
LOCAL = '127.0.0.1'
DONE, MISUSE = 0, 2


def main(arguments: Sequence[str] | None = None) -> int:
    """
    Run the command line.

    :param arguments: words after the command's name; None for those of the process.
    :return: exit status: 0 after Ctrl-C, 2 on an error.
    """
    options = make_parser().parse_args(arguments)
    try:
        asyncio.run(_serve(options))
    except (ValueError, OSError, RuntimeError) as error:
        is_taken = isinstance(error, OSError) and error.errno == errno.EADDRINUSE
        hint = '; name another with --port, or 0 for any that is free' if is_taken else ''
        print(f'push play: {error}{hint}', file=sys.stderr)
        return MISUSE
    return DONE


def make_parser() -> argparse.ArgumentParser:
    """Make the parser of the command line."""
    parser = argparse.ArgumentParser(
        prog='push play', description='Open a page on which you play with the simulation of a '
        'task: drag goal and object, draw walls, change friction and sensors.')
    scene = parser.add_mutually_exclusive_group()
    scene.add_argument('scenario', nargs='?', default=DEMO, metavar='SCENARIO',
                       help='path of a scenario file, or name of a scenario of the package, with '
                       f'a task (default: {DEMO})')
    scene.add_argument('--room', default=None, metavar='ROOM',
                       help='put a room with several objects in order in place of a scenario: '
                       'path of its file, or name of one of config/rooms')
    parser.add_argument('--port', type=_port, default=PORT,
                        help=f'port of the page, 0 for any that is free (default: {PORT})')
    parser.add_argument('--host', default=None,
                        help='serve other machines too, at this address of ours (0.0.0.0 for '
                        'all); they need the token that is printed')
    parser.add_argument('--origin', type=_origin, default=None,
                        help='address of the page behind a proxy, as https://play.example; it '
                        'needs the token too')
    parser.add_argument('--no-browser', action='store_true', help='open no browser')
    return parser


def _port(text: str) -> int:
    if not text.isdecimal() or int(text) > MAX_PORT:
        raise argparse.ArgumentTypeError(
            f'got {text!r}, expected a number from 0 to {MAX_PORT}')
    return int(text)


def _origin(text: str) -> str:
    try:
        return checked_origin(text)
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from error


async def _serve(options: argparse.Namespace) -> None:
    # Imported here, as it comes with an extra.
    try:
        from push_view.server.page_server import Access, Callbacks
        from push_view.server.serving import serve
    except ModuleNotFoundError as error:
        raise RuntimeError(how_to_install(error.name) or str(error)) from error
    scene = (read_scenario(find_scenario(options.scenario)) if options.room is None
             else read_room(named_file('rooms', options.room)))
    session = LiveSession(scene, time.monotonic)
    is_local = options.host is None and options.origin is None
    access = Access(None if is_local else secrets.token_urlsafe(), options.origin)
    callbacks = Callbacks(session.handle, session.set_page_count, lambda: session.scenario_text)
    title = scene.name.replace('_', ' ')
    async with serve(title, session.log, callbacks, host=options.host or LOCAL,
                     port=options.port, access=access) as url:
        print(f'push play: {url} (end with Ctrl-C)', flush=True)
        if not is_local and sys.stdout.isatty():
            print(qr_code(url), end='', flush=True)
        if not options.no_browser:
            webbrowser.open(url)
        running = asyncio.create_task(session.run())
        for signum in (signal.SIGINT, signal.SIGTERM):
            asyncio.get_running_loop().add_signal_handler(signum, running.cancel)
        with contextlib.suppress(asyncio.CancelledError):
            await running


if __name__ == '__main__':
    sys.exit(main())
