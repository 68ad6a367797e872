"""The progress line, in a terminal and in a log."""

import fcntl
import io
import os
import struct
import termios
import threading

from push_scenario.progress_line import ProgressLine
from push_scenario.simulation.loop import Progress
from push_scenario.ticker import Ticker
import pytest


class Terminal(io.StringIO):
    """Text stream that says it is a terminal."""

    def isatty(self):
        return True


def play(stream):
    """Show a run of 20 s that takes 10 s on the clock, 100 calls a second."""
    now = [0.0]
    line = ProgressLine(stream, lambda: now[0], 'case')
    line(Progress('planning', 0.0, 2.0))
    for call in range(1, 1001):
        now[0] = call / 100
        line(Progress('pushing', call / 50, 2.0 - call / 500))
    line.end('done')
    return stream.getvalue()


def test_terminal_shows_one_line_that_is_written_over():
    text = play(Terminal())
    assert text.count('\n') == 1 and text.endswith('\n')
    shown = text.strip('\r\n').split('\r')
    assert 90 < len(shown) < 110
    assert shown[-1].startswith('case: done, 10.0 s')
    assert all(len(after) >= len(before.rstrip()) for before, after in zip(shown, shown[1:]))


def rows_of(text, columns):
    """Count the lines of a window that a text takes, as a terminal wraps it."""
    rows, column = 1, 0
    for character in text:
        if character == '\r':
            column = 0
        elif character == '\n':
            rows, column = rows + 1, 0
        else:
            column += 1
            if column > columns:
                rows, column = rows + 1, 1
    return rows


def set_columns(stream, columns):
    """Give the window of a pseudo terminal a width."""
    fcntl.ioctl(stream, termios.TIOCSWINSZ, struct.pack('HHHH', 24, columns, 0, 0))


@pytest.mark.parametrize('widths', [(80, 80), (40, 40), (80, 40), (40, 80)])
def test_the_line_fits_into_the_window(widths):
    """Also when that changes: nothing wraps before the last line, so that all is written over."""
    master, slave = os.openpty()
    received = []

    def read():
        while data := os.read(master, 4096):
            received.append(data)
            if b'the end' in b''.join(received):
                break

    reader = threading.Thread(target=read)
    reader.start()
    now = [0.0]
    with os.fdopen(slave, 'w') as stream:
        line = ProgressLine(stream, lambda: now[0], 'corner_push_mismatch, open_loop')
        for call in range(180):
            set_columns(stream, widths[call >= 90])
            now[0] = 0.2 * call
            line(Progress('pushing', 0.4 * call, 2.0 - call / 500))
        line.end('the end')
        reader.join()
    os.close(master)
    text = b''.join(received).decode()
    progress, last = text.rsplit('\r', 1) if text.endswith('the end') else (
        text[:text.index('the end')].rsplit('\r', 1))
    shown = progress.split('\r')[1:]
    assert len(shown) == 180 and last.startswith('corner_push_mismatch')
    for half, columns in ((shown[:90], widths[0]), (shown[90:], widths[1])):
        assert rows_of('\r'.join(half), columns) == 1
        assert all('corner_push_mismatch, open_loop' in one for one in half)


def test_log_gets_a_line_now_and_then():
    lines = play(io.StringIO()).splitlines()
    assert lines[0] == 'case: planning, 0.0 s, 2.000 m to the goal'
    assert lines[-1] == 'case: done, 10.0 s'
    assert 3 <= len(lines) <= 6
    assert not any('\r' in line for line in lines)


def test_speed_is_simulated_over_wall_time():
    assert 'at 2.0 x real time' in play(io.StringIO())


def test_time_until_a_task_runs_is_no_part_of_the_speed():
    now = [0.0]
    stream = io.StringIO()
    line = ProgressLine(stream, lambda: now[0], 'task')
    for call in range(20):
        now[0] = float(call)
        line(Progress('idle', 0.0, 1.0))
    assert not any('real time' in text for text in stream.getvalue().splitlines())
    for call in range(1, 1001):
        now[0] = 20.0 + call / 100
        line(Progress('approach', call / 50, 1.0))
    assert stream.getvalue().splitlines()[-1].startswith('task: approach')
    assert 'at 2.0 x real time' in stream.getvalue().splitlines()[-1]


def test_what_is_made_for_the_first_time_is_shown_while_time_stands_still():
    """As soon as there is something; then the figures of the run take its place."""
    now, made = [0.0], ['']
    stream = Terminal()
    line = ProgressLine(stream, lambda: now[0], 'task_demo, feedback', lambda: made[0])
    line(Progress('plan', 0.0, 1.0))
    now[0] = 1.0
    line.refresh()
    before = stream.getvalue()
    assert 'compiling' not in before and before.count('\r') == 1
    now[0], made[0] = 2.0, 'compiling 37 of about 125'
    line.refresh()
    line.refresh()
    shown = stream.getvalue()[len(before):].split('\r')[1:]
    assert [text.strip() for text in shown] == [
        'task_demo, feedback: plan, compiling 37 of about 125']
    now[0] = 3.0
    line(Progress('push', 0.5, 1.0))
    assert 'compiling' not in stream.getvalue().split('\r')[-1]


def test_a_ticker_calls_until_its_block_ends():
    """From a thread of its own, whatever the main one is busy with."""
    called = threading.Event()
    calls = []

    def call():
        calls.append(threading.current_thread())
        called.set()

    with Ticker(call, 0.001):
        assert called.wait(60.0)
    count = len(calls)
    assert threading.current_thread() not in calls
    assert not any(thread.is_alive() for thread in calls) and len(calls) == count
