"""
The command ``push``: it names its subcommands, and starts one with the words that follow.

The modules of the subcommands are imported when they are started: help and version need none.
"""

import argparse
from collections.abc import Sequence
import importlib
import os
from pathlib import Path
import re
import sys
from types import ModuleType
from typing import NamedTuple
from xml.etree import ElementTree

from push_model.files.data import share_directory
from push_model.optional import how_to_install
from push_model.suggestion import did_you_mean

DONE, MISUSE = 0, 2
SHELLS = ('bash', 'zsh')
# argcomplete sets the first of them when a shell asks for completions of the line in the second.
COMPLETION_MARK, COMPLETION_LINE = '_ARGCOMPLETE', 'COMP_LINE'


class Subcommand(NamedTuple):
    """
    A subcommand.

    :param module: with functions ``main`` and ``make_parser``.
    :param summary: what it does.
    """

    module: str
    summary: str


SUBCOMMANDS = {
    'replay': Subcommand('push_scenario.cli', 'run scenarios, evaluate and draw them'),
    'tidy': Subcommand('push_scenario.tidying.cli', 'bring several objects to their goals'),
    'play': Subcommand('push_view.cli', 'open a page on which you play with a simulation'),
    'view': Subcommand('push_view.view_node', 'serve a page that shows your robot'),
    'study': Subcommand('studies.__main__', 'compute the figures of the thesis, in a checkout'),
    'identify': Subcommand('push_scenario.recordings.cli',
                           'estimate the friction of an object from recorded pushes'),
    'calibrate': Subcommand('push_scenario.calibration.cli',
                            'measure a base, and write its parameters'),
    'policy': Subcommand('push_ros.security_policy', 'write what each node may do, for SROS2'),
    'cache': Subcommand('push_dynamics.cli', 'show or clear compiled code and tables'),
}
# What only the command itself answers.
COMPLETION = 'completion'
# Package of the studies, which are not installed.
STUDIES = 'studies'


def main(words: Sequence[str]) -> int:
    """
    Run the command line.

    :param words: behind the name of the command.
    :return: exit status: that of the subcommand, 2 where there is none of that name.
    """
    if COMPLETION_MARK in os.environ:
        return _complete()
    name, *rest = words or ['--help']
    if name in ('-h', '--help'):
        print(usage())
        return DONE
    if name == '--version':
        print(f'push_control {version()}')
        return DONE
    if name == COMPLETION:
        return _print_completion(rest)
    if name not in SUBCOMMANDS:
        return _complain(f'got {name!r}, expected one of {", ".join(SUBCOMMANDS)}'
                         f'{did_you_mean(name, SUBCOMMANDS)}')
    try:
        return _import(name).main(rest)
    except ModuleNotFoundError as error:
        if error.name == STUDIES:
            return _complain('study: got an installation without studies, expected a checkout '
                             'of the repository')
        if not how_to_install(error.name):
            raise
        return _complain(f'{name}: {how_to_install(error.name)}')


def usage() -> str:
    """Return the text of ``--help``."""
    summaries = {**{name: subcommand.summary for name, subcommand in SUBCOMMANDS.items()},
                 COMPLETION: f'print a script that completes words: {" or ".join(SHELLS)}'}
    width = max(map(len, summaries))
    return '\n'.join([
        'usage: push SUBCOMMAND ...', '', 'Push objects: simulate, measure, look on.', '',
        *(f'  {name.ljust(width)}  {summary}' for name, summary in summaries.items()), '',
        'push SUBCOMMAND --help tells more, push --version the version.'])


def version() -> str:
    """Return the version of the package, as its manifest states it."""
    manifest = ElementTree.parse(share_directory() / 'package.xml').getroot()
    return manifest.findtext('version', '')


def _import(name: str) -> ModuleType:
    """Import the module of a subcommand; studies lie beside the packages of a checkout."""
    checkout = Path(__file__).resolve().parents[1]
    if name == 'study' and (checkout / STUDIES).is_dir():
        sys.path.append(str(checkout))
    return importlib.import_module(SUBCOMMANDS[name].module)


def _complain(text: str) -> int:
    print(f'push: {text}', file=sys.stderr)
    return MISUSE


def _print_completion(words: Sequence[str]) -> int:
    if len(words) != 1 or words[0] not in SHELLS:
        return _complain(f'completion: got {" ".join(words)!r}, expected {" or ".join(SHELLS)}')
    try:
        from argcomplete.shell_integration import shellcode
    except ModuleNotFoundError:
        return _complain(f'completion: {how_to_install("argcomplete")}')
    print(shellcode(['push'], shell=words[0]))
    return DONE


def _complete() -> int:
    """Answer a shell; a word behind a subcommand is completed by the parser of that one."""
    import argcomplete
    typed = re.split(r'\s+', os.environ.get(COMPLETION_LINE, ''))
    if len(typed) > 2 and typed[1] in SUBCOMMANDS:
        # The word of the line with which it begins, counted from one.
        os.environ[COMPLETION_MARK] = '2'
        parser = _import(typed[1]).make_parser()
    else:
        parser = argparse.ArgumentParser(prog='push')
        parser.add_argument('--version', action='store_true')
        parser.add_argument('subcommand', choices=[*SUBCOMMANDS, COMPLETION])
    argcomplete.autocomplete(parser)
    return DONE
