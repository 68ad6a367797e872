"""The log of messages: every reader gets all that still holds, once and in order."""

import json

from push_view.server.message_log import MessageLog


def rows(*times):
    """Make a message with a row per time."""
    return {'type': 'rows', 'rows': [[time] for time in times]}


def read(log, cursor=0):
    """Return messages and the next cursor."""
    texts, cursor = log.since(cursor)
    return [json.loads(text) for text in texts], cursor


def test_readers_get_everything_once():
    """One from the beginning, one that comes later too."""
    log = MessageLog()
    log.add(rows(0.0))
    first, cursor = read(log)
    log.add(rows(1.0))
    assert (first, read(log, cursor)[0]) == ([rows(0.0)], [rows(1.0)])
    assert read(log)[0] == [rows(0.0), rows(1.0)]
    assert read(log, read(log)[1])[0] == []


def test_what_is_replaced_is_sent_once():
    """In its newest form, to those who come late; all forms to those who listen."""
    log = MessageLog()
    log.replace({'type': 'run', 'paused': False})
    _, cursor = read(log)
    log.add(rows(0.0))
    log.replace({'type': 'run', 'paused': True})
    assert read(log)[0] == [rows(0.0), {'type': 'run', 'paused': True}]
    assert read(log, cursor)[0] == [rows(0.0), {'type': 'run', 'paused': True}]


def test_a_new_run_drops_the_former_one():
    """What was replaced stays; nobody misses or repeats anything."""
    log = MessageLog()
    log.replace({'type': 'run', 'paused': False})
    log.add(rows(0.0))
    _, cursor = read(log)
    log.add(rows(1.0))
    log.clear()
    log.add({'type': 'scene'})
    expected = [{'type': 'run', 'paused': False}, {'type': 'scene'}]
    assert read(log, cursor)[0] == read(log)[0] == expected


def test_a_long_run_drops_its_oldest_rows_alone():
    """Events stay, so that their number does not change."""
    log = MessageLog(max_rows=10)
    log.add({'type': 'scene'})
    for number in range(20):
        log.add(rows(2.0 * number, 2.0 * number + 1.0))
        log.add({'type': 'goal', 'time': number})
    messages, _ = read(log)
    kept = [row[0] for message in messages for row in message.get('rows', [])]
    assert kept == [float(time) for time in range(30, 40)]
    assert [m['time'] for m in messages if m['type'] == 'goal'] == list(range(20))
