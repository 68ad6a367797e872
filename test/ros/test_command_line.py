"""The command ``push``: its subcommands, and what it answers by itself."""

import importlib
import os
import subprocess
import sys
from xml.etree import ElementTree

from helpers.architecture import ROOT
from helpers.extras import import_extra
from push_ros import command_line
from push_ros.command_line import COMPLETION, main, SHELLS, SUBCOMMANDS
import pytest


@pytest.mark.parametrize('words', [['--help'], []])
def test_help_names_every_subcommand_in_a_line_of_80_columns(capsys, words):
    assert main(words) == 0
    lines = capsys.readouterr().out.splitlines()
    for name in [*SUBCOMMANDS, COMPLETION]:
        assert any(line.split()[:1] == [name] for line in lines)
    assert max(map(len, lines)) <= 80


def test_the_version_is_that_of_the_manifest(capsys):
    assert main(['--version']) == 0
    version = ElementTree.parse(ROOT / 'package.xml').getroot().findtext('version')
    assert capsys.readouterr().out == f'push_control {version}\n'


@pytest.mark.parametrize('word, meant', [('replya', 'replay'), ('calibarte', 'calibrate')])
def test_a_mistyped_subcommand_is_guessed(capsys, word, meant):
    assert main([word]) == 2
    printed = capsys.readouterr()
    assert f'did you mean {meant!r}?' in printed.err and not printed.out


def test_a_mistyped_scenario_is_guessed(capsys):
    assert main(['replay', 'task_dmo']) == 2
    assert "did you mean 'task_demo'?" in capsys.readouterr().err


@pytest.mark.parametrize('name', SUBCOMMANDS)
def test_a_subcommand_tells_its_usage_by_its_name(capsys, name):
    """As people type it, wherever it was started."""
    if name in ('view', 'study'):
        import_extra({'view': 'rclpy', 'study': 'tqdm'}[name], 'plot')
    importlib.import_module(SUBCOMMANDS[name].module).make_parser().print_help()
    assert capsys.readouterr().out.startswith(f'usage: push {name} ')


def test_studies_need_a_checkout(capsys, monkeypatch, tmp_path):
    monkeypatch.setattr(command_line, '__file__', str(tmp_path / 'push_ros' / 'command_line.py'))
    monkeypatch.setattr(command_line.sys, 'path', [])
    monkeypatch.delitem(command_line.sys.modules, 'studies.__main__', raising=False)
    monkeypatch.delitem(command_line.sys.modules, 'studies', raising=False)
    assert main(['study', 'list']) == 2
    assert 'expected a checkout' in capsys.readouterr().err


@pytest.mark.parametrize('line, completions', [
    ('push re', {'replay'}), ('push replay --li', {'--list'}), ('push play --po', {'--port'}),
    ('push replay task_d', {'task_demo'})])
def test_a_shell_gets_completions(tmp_path, line, completions):
    """As the script asks for them, which argcomplete makes: by variables, into a file."""
    import_extra('argcomplete', 'completion')
    question = {'_ARGCOMPLETE': '1', '_ARGCOMPLETE_IFS': '\n', 'COMP_LINE': line,
                'COMP_POINT': str(len(line)), '_ARGCOMPLETE_STDOUT_FILENAME': 'answer'}
    code = f'import sys; sys.path[:0] = [{str(ROOT)!r}]; from push_ros import start; start.push()'
    subprocess.run([sys.executable, '-c', code], cwd=tmp_path, env={**os.environ, **question},
                   check=True)
    answer = (tmp_path / 'answer').read_text().split('\n')
    assert {word.strip() for word in answer} >= completions


@pytest.mark.parametrize('shell', SHELLS)
def test_a_script_for_each_shell(capsys, shell):
    import_extra('argcomplete', 'completion')
    assert main([COMPLETION, shell]) == 0
    assert 'push' in capsys.readouterr().out
    assert main([COMPLETION, 'tcl']) == 2
