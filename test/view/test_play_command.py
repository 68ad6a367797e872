"""The command ``push play`` as one meets it who gets a word wrong."""

import socket

from helpers.extras import import_extra
from push_view.cli import main
from push_view.server.address import qr_code
import pytest

import_extra('aiohttp', 'play')


def test_a_port_that_is_taken_is_named_with_what_to_do(capsys):
    with socket.create_server(('127.0.0.1', 0)) as taken:
        port = taken.getsockname()[1]
        assert main(['--no-browser', '--port', str(port)]) == 2
    printed = capsys.readouterr()
    assert str(port) in printed.err and '--port' in printed.err and not printed.out


@pytest.mark.parametrize('port', ['65536', '-1', 'some'])
def test_what_is_no_port_is_refused(port, capsys):
    with pytest.raises(SystemExit) as exit_:
        main([f'--port={port}'])
    assert exit_.value.code == 2
    assert f"got '{port}', expected a number from 0 to 65535" in capsys.readouterr().err


@pytest.mark.parametrize('origin', ['robot.example', 'ftp://robot.example', 'http://a/path'])
def test_what_is_no_address_of_a_proxy_is_refused(origin, capsys):
    with pytest.raises(SystemExit) as exit_:
        main([f'--origin={origin}'])
    assert exit_.value.code == 2
    assert f"got '{origin}', expected an address without a path" in capsys.readouterr().err


def test_an_address_is_drawn_for_telephones():
    """A square of modules, two rows in each line, with a margin of four round it."""
    import_extra('segno', 'play')
    lines = qr_code('http://192.0.2.1:8642/?token=x').splitlines()
    width, = set(map(len, lines))
    assert width % 4 == 1 and width >= 21 + 8 and len(lines) == (width + 1) // 2


def test_a_scenario_without_a_task_is_refused_before_an_address_is_shown(capsys):
    assert main(['straight_push', '--no-browser', '--port', '0']) == 2
    printed = capsys.readouterr()
    assert 'expected a task' in printed.err and not printed.out
