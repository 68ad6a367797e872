"""Addresses of the page: where others find it."""

import importlib
import io
import re
import socket

# An address that no machine has (RFC 5737), towards which that of this machine is looked up.
DOCUMENTATION_ADDRESS = '192.0.2.1'
ORIGIN = re.compile(r'https?://[\w.:\[\]-]+')


def checked_origin(text: str) -> str:
    """
    Check the address of a page behind a proxy.

    :param text: as ``https://robot.example``; a slash at its end is left out.
    :raises ValueError: where it is none.
    """
    origin = text.rstrip('/')
    if not ORIGIN.fullmatch(origin):
        raise ValueError(f'origin: got {text!r}, expected an address without a path, as '
                         'https://robot.example')
    return origin


def own_address() -> str:
    """Return the address of this machine in its network; ``localhost`` where it has none."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            # Nothing is sent: the system only chooses from where it would be.
            probe.connect((DOCUMENTATION_ADDRESS, 9))
        except OSError:
            return 'localhost'
        return str(probe.getsockname()[0])


def qr_code(url: str) -> str:
    """Draw an address in characters, for telephones; empty where segno is not installed."""
    # Imported here, as it comes with an extra.
    try:
        segno = importlib.import_module('segno')
    except ModuleNotFoundError:
        return ''
    text = io.StringIO()
    segno.make(url, error='l').terminal(out=text, compact=True)
    return text.getvalue()
