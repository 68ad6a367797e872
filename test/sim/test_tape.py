"""Tapes: nothing is lost on the way to a file and back."""

import math

from helpers.disk import full_disk
import numpy as np
from push_sim_node.tape import read_tape, Tape
import pytest


def sample():
    """Numbers that a careless format would round or break."""
    rows = np.array([[0.0, 0.1, -0.0], [1 / 3, 1e-300, math.nan], [math.pi, -1e22, 5e-324]])
    return Tape(('time', 'a', 'b'), rows)


def test_file_keeps_every_bit(tmp_path):
    tape = sample()
    tape.save(tmp_path / 'tape.csv')
    again = read_tape(tmp_path / 'tape.csv')
    assert again.columns == tape.columns
    assert again.rows.shape == (3, 3)
    assert again.rows.tobytes() == tape.rows.tobytes()


def test_a_full_disk_leaves_no_half_of_a_tape(tmp_path):
    """And the one before as it was."""
    path = tmp_path / 'tape.csv'
    sample().save(path)
    before = path.read_bytes()
    with full_disk(10), pytest.raises(OSError, match=str(path)):
        sample().save(path)
    assert path.read_bytes() == before and list(tmp_path.iterdir()) == [path]


def test_equal_tapes_give_equal_bytes_and_others_do_not(tmp_path):
    sample().save(tmp_path / 'one.csv')
    sample().save(tmp_path / 'two.csv')
    assert (tmp_path / 'one.csv').read_bytes() == (tmp_path / 'two.csv').read_bytes()
    rows = sample().rows.copy()
    rows[1, 1] = np.nextafter(rows[1, 1], 1.0)
    assert Tape(sample().columns, rows).to_bytes() != sample().to_bytes()


def test_numbers_cannot_be_changed():
    with pytest.raises(ValueError, match='read-only'):
        sample()['a'][0] = 1.0


def test_source_array_stays_independent():
    rows = np.array([[0.0, 1.0]])
    tape = Tape(('time', 'a'), rows)
    rows[0, 1] = 2.0
    assert tape['a'][0] == 1.0


@pytest.mark.parametrize('columns, rows, words', [
    (('a', 'time'), [[0.0, 1.0]], 'Tape.columns'),
    (('time', 'a', 'a'), [[0.0, 1.0, 2.0]], 'Tape.columns'),
    (('time', 'a'), [], 'Tape.rows'),
    (('time', 'a'), [[0.0, 1.0, 2.0]], 'Tape.rows'),
    (('time', 'a'), [[1.0, 1.0], [1.0, 1.0]], 'do not increase'),
])
def test_what_does_not_fit_is_refused(columns, rows, words):
    with pytest.raises(ValueError, match=words):
        Tape(columns, rows)


def test_unknown_column_is_told():
    with pytest.raises(KeyError, match='c: expected one of time, a, b'):
        sample()['c']


@pytest.mark.parametrize('text, words', [
    ('time,a\n0.0,1.0\n0.1,x\n', ':3: .*expected numbers'),
    ('time,a\n0.0\n', ':2: got 1 numbers, expected 2'),
    ('time,a\n', 'got 1 lines'),
])
def test_broken_file_is_told_by_line(tmp_path, text, words):
    path = tmp_path / 'tape.csv'
    path.write_text(text)
    with pytest.raises(ValueError, match=words):
        read_tape(path)
