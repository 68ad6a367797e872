"""The command line: lists studies, runs them, and says what is wrong."""

import sys

import pytest
from studies import __main__ as cli
from studies.framework.runner import StudyRunner


def test_list_shows_studies_and_their_parameters(capsys):
    assert cli.main(['list']) == 0
    assert '2.11   Flat object' in capsys.readouterr().out
    assert cli.main(['list', '2.11']) == 0
    output = capsys.readouterr().out
    assert 'robot_radius = 0.5 m (caption)' in output and '(chosen)' in output


def test_run_prints_findings_and_what_is_up_to_date(tmp_path, capsys):
    words = ['--set', 'robot_radius=0.6', '--out', str(tmp_path)]
    assert cli.main(['run', '2.11', '2.12', *words]) == 0
    output = capsys.readouterr().out
    assert '2.11.png' in output and '0.3 m' in output and 'up to date' not in output
    assert cli.main(['run', '2.11', *words]) == 0
    assert 'up to date' in capsys.readouterr().out


@pytest.mark.parametrize('words', [
    ['run', '2.99'], ['run', '2.11', '--set', 'radius=1'],
    ['run', '2.11', '--set', 'robot_radius=-1']])
def test_misuse_is_explained(words, tmp_path, capsys):
    assert cli.main([*words, '--out', str(tmp_path)]) == 2
    assert 'expected' in capsys.readouterr().err


def test_a_cluster_without_its_extra_is_explained(tmp_path, monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, 'distributed', None)
    address = 'tcp://127.0.0.1:1'
    assert cli.main(['run', '2.11', '--out', str(tmp_path), '--scheduler', address]) == 2
    assert f'got {address}, expected that distributed is installed' in capsys.readouterr().err


def test_number_of_processes_is_at_least_one():
    with pytest.raises(SystemExit):
        cli.main(['run', '2.11', '--jobs', '0'])


def test_interruption_is_reported(tmp_path, monkeypatch, capsys):
    def interrupt(self, study):
        raise KeyboardInterrupt

    monkeypatch.setattr(StudyRunner, 'run', interrupt)
    assert cli.main(['run', '2.11', '--out', str(tmp_path)]) == 130
    assert 'the same command continues' in capsys.readouterr().err
