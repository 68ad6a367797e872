"""The command ``push replay`` as a user meets it, in process."""

from importlib import util
import json
import os
from pathlib import Path
import re
import signal
import subprocess
import sys
from xml.etree import ElementTree

from docs.tools.pictures import pictured
from PIL import Image
from push_scenario.cli import main
from push_scenario.definition.catalogue import find_scenario, scenario_names
from push_scenario.definition.loader import read_scenario, scenario_text
from push_scenario.interrupts import Interrupts
from push_sim_node.tape import read_tape
from push_view import report
import pytest

ROOT = Path(__file__).parents[2]


class MissingExtra:
    """Module that needs one which is not installed."""

    def __init__(self, name):
        self._name = name

    def __getattr__(self, _):
        raise ModuleNotFoundError(f'No module named {self._name!r}', name=self._name)


def replay(tmp_path, *words):
    """Call the command in this process, without ROS."""
    return main([*words, '--in-process', '--out', str(tmp_path / 'out')])


def write(tmp_path, name, **changes):
    """Write a scenario with some lines at its top level changed."""
    lines = scenario_text(read_scenario(find_scenario('straight_push'))).splitlines()
    for key, value in changes.items():
        lines = [f'{key}: {value}' if line.startswith(f'{key}:') else line for line in lines]
    path = tmp_path / f'{name}.yaml'
    path.write_text('\n'.join(lines))
    return path


def test_list_names_every_scenario_with_its_description(capsys):
    assert main(['--list']) == 0
    listed = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in listed] == scenario_names()
    assert all(len(line.split()) > 5 for line in listed)


def test_a_folder_that_cannot_be_written_is_named(tmp_path, capsys):
    """A file lies where the folder should be."""
    (tmp_path / 'out').write_text('')
    assert replay(tmp_path, 'straight_push') == 2
    assert f'--out: got {tmp_path / "out"}: ' in capsys.readouterr().err


@pytest.mark.slow
def test_a_run_that_arrives_ends_with_status_0_and_leaves_its_tape(tmp_path, capsys):
    """The same one when it is run again."""
    assert replay(tmp_path, 'straight_push', '--no-pictures') == 0
    printed = capsys.readouterr()
    assert 'final position error' in printed.out
    assert 'straight_push, feedback: done' in printed.err
    out = tmp_path / 'out'
    assert {path.name for path in out.iterdir()} == {'straight_push.yaml',
                                                     'straight_push_feedback.csv'}
    tape = read_tape(out / 'straight_push_feedback.csv')
    assert tape['object_x'][-1] == pytest.approx(1.0, abs=0.01)
    assert read_scenario(out / 'straight_push.yaml') == read_scenario(
        find_scenario('straight_push'))
    assert replay(tmp_path / 'again', 'straight_push', '--no-pictures') == 0
    one, two = ((folder / 'out' / 'straight_push_feedback.csv').read_bytes()
                for folder in (tmp_path, tmp_path / 'again'))
    assert one == two


def test_refusal_is_success_where_it_is_expected(tmp_path, capsys):
    assert replay(tmp_path, 'unreachable_goal') == 0
    assert 'at most 3 m is accepted' in capsys.readouterr().out
    assert not list((tmp_path / 'out').glob('*.png'))


def test_several_scenarios_leave_results_for_other_programs(tmp_path, capsys):
    """One that cannot be run is an error of its own, and the next one is run."""
    (tmp_path / 'out').mkdir()
    (tmp_path / 'out' / 'blocked.yaml').mkdir()
    blocked = write(tmp_path, 'blocked')
    junit = tmp_path / 'junit.xml'
    assert replay(tmp_path, str(blocked), 'unreachable_goal', '--json', '--junit',
                  str(junit)) == 2
    printed = capsys.readouterr()
    error, row = json.loads(printed.out)
    assert error['scenario'] == 'blocked' and error['error'] in printed.err
    assert (row['scenario'], row['outcome'], row['law'], row['is_as_expected']) == (
        'unreachable_goal', 'refused', 'feedback', True)
    suite = ElementTree.parse(junit).getroot()
    assert (suite.get('tests'), suite.get('errors'), suite.get('failures')) == ('2', '1', '0')
    assert [case.get('name') for case in suite] == ['blocked', 'unreachable_goal']
    assert suite[0].find('error').get('message') == error['error']


def test_refusal_is_failure_where_it_is_not_expected(tmp_path):
    path = tmp_path / 'case.yaml'
    text = scenario_text(read_scenario(find_scenario('unreachable_goal')))
    path.write_text(text.replace('expected: refused', 'expected: reached'))
    assert replay(tmp_path, str(path), '--no-pictures') == 1


def test_a_run_that_misses_its_bounds_ends_with_status_1(tmp_path):
    path = write(tmp_path, 'hasty', time_limit=2.0)
    assert replay(tmp_path, str(path), '--no-pictures') == 1


@pytest.mark.slow
def test_closed_loops_decide_where_laws_are_compared(tmp_path, capsys):
    laws = ('--law', 'mpc', '--law', 'feedback', '--law', 'open_loop')
    assert replay(tmp_path, 'corner_push_mismatch', *laws, '--no-pictures') == 0
    headlines, table = capsys.readouterr().out.split('\n\n')[:2]
    assert table.splitlines()[0].split() == ['corner_push_mismatch', 'mpc', 'feedback', 'open',
                                             'loop', 'bound']
    for law in ('mpc', 'feedback', 'open_loop'):
        assert pictured('corner_push_mismatch', law) in ' '.join(headlines.split())


@pytest.mark.slow
def test_a_task_is_reported_and_drawn(tmp_path, capsys):
    assert replay(tmp_path, 'task_tap') == 0
    printed = capsys.readouterr().out
    assert 'pushes' in printed and 'time of a correcting push' not in printed
    for suffix in ('png', 'html'):
        assert (tmp_path / 'out' / f'task_tap.{suffix}').is_file()
    assert not (tmp_path / 'out' / 'task_tap.gif').exists()


@pytest.mark.slow
def test_a_task_that_is_not_done_in_time_ends_with_status_1(tmp_path, capsys):
    text = scenario_text(read_scenario(find_scenario('task_approach')))
    path = tmp_path / 'hasty.yaml'
    path.write_text(text.replace('time_limit: 180', 'time_limit: 3'))
    laws = ('--law', 'feedback', '--law', 'mpc')
    assert replay(tmp_path, str(path), '--no-pictures', *laws) == 1
    lines = capsys.readouterr().out.splitlines()
    assert any(line.split()[-3:] == ['feedback', 'mpc', 'bound'] for line in lines)
    assert any(line.split() == ['outcome', 'time_limit', 'time_limit'] for line in lines)
    assert {item.name for item in (tmp_path / 'out').iterdir()} == {
        'hasty.yaml', 'hasty_feedback.csv', 'hasty_mpc.csv'}


def test_open_loop_alone_is_judged(tmp_path):
    path = write(tmp_path, 'hasty', time_limit=1.0)
    assert replay(tmp_path, str(path), '--law', 'open_loop', '--no-pictures') == 1


@pytest.mark.parametrize('missing', ['feedback', 'mpc'])
def test_every_closed_loop_must_arrive(tmp_path, monkeypatch, missing):
    """Who judges is replaced, so that the start of each run is enough."""
    def judge(result):
        return result.control_law != missing

    monkeypatch.setattr('push_scenario.is_as_expected', judge)
    path = write(tmp_path, 'hasty', time_limit=1.0)
    laws = ('--law', 'feedback', '--law', 'mpc')
    assert replay(tmp_path, str(path), *laws, '--no-pictures') == 1


def test_what_cannot_be_drawn_hides_no_result(tmp_path, capsys, monkeypatch):
    """Neither a defect of a drawing nor a missing extra changes table and status."""
    path = write(tmp_path, 'hasty', time_limit=1.0)
    assert replay(tmp_path, str(path), '--law', 'open_loop', '--no-pictures') == 1
    table = capsys.readouterr().out
    monkeypatch.setattr(report, 'write_report', lambda *_: [][0])
    monkeypatch.setitem(sys.modules, 'push_scenario.plots.figure', None)
    monkeypatch.setitem(sys.modules, 'push_scenario.plots.animation', MissingExtra('matplotlib'))
    assert replay(tmp_path, str(path), '--law', 'open_loop', '--gif') == 1
    printed = capsys.readouterr()
    assert printed.out == table
    assert 'no hasty.html: IndexError: ' in printed.err
    assert 'no hasty.png: ModuleNotFoundError: ' in printed.err
    assert ("no hasty.gif: no module matplotlib: pip install 'push_control[plot]'"
            in printed.err)


def test_without_ros_a_replay_runs_in_one_process_and_says_so(tmp_path, capsys, monkeypatch):
    find_spec = util.find_spec
    monkeypatch.setattr(util, 'find_spec',
                        lambda name: None if name == 'rclpy' else find_spec(name))
    assert main(['unreachable_goal', '--out', str(tmp_path)]) == 0
    printed = capsys.readouterr()
    assert 'one process' in printed.err and 'REFUSED, as expected' in printed.out


@pytest.mark.slow
def test_demo_takes_several_pushes_and_leaves_page_picture_and_animation(tmp_path, capsys):
    assert replay(tmp_path, '--demo', '--gif') == 0
    table = capsys.readouterr().out
    assert ' '.join(table.split()).startswith(pictured('task_demo', 'feedback'))
    assert int(re.search(r'^pushes +(\d+)', table, re.MULTILINE)[1]) >= 2
    with Image.open(tmp_path / 'out' / 'demo.png') as picture:
        assert picture.format == 'PNG' and min(picture.size) > 700
        assert len(picture.convert('RGB').getcolors(1 << 24)) > 100
    with Image.open(tmp_path / 'out' / 'demo.gif') as animation:
        assert animation.format == 'GIF' and animation.n_frames > 60
    assert (tmp_path / 'out' / 'demo.gif').stat().st_size < 1.5e6
    assert (tmp_path / 'out' / 'demo.html').stat().st_size < 0.5e6


@pytest.mark.parametrize('words, message', [
    (('nowhere',), 'nowhere: got no such scenario, expected a path or one of'),
    (('nowhere.yaml',), 'nowhere.yaml: No such file'),
    (('straight_push', '--real-time'), '--real-time: got --in-process too'),
    (('straight_push', '--law', 'hope'), "control_law: got 'hope', expected one of"),
])
def test_misuse_ends_with_status_2_and_a_message(tmp_path, capsys, words, message):
    assert replay(tmp_path, *words) == 2
    printed = capsys.readouterr()
    assert message in printed.err and not printed.out


def test_a_wrong_scenario_names_file_and_key(tmp_path, capsys):
    path = write(tmp_path, 'wrong', time_limit='-3')
    assert replay(tmp_path, str(path)) == 2
    assert f'{path}: time_limit: got -3, expected' in capsys.readouterr().err


def test_wrong_words_show_the_usage(capsys):
    with pytest.raises(SystemExit) as error:
        main(())
    assert error.value.code == 2
    assert 'usage: push replay' in capsys.readouterr().err


def test_an_interrupt_that_a_compiled_library_hides_is_still_one():
    with pytest.raises(KeyboardInterrupt), Interrupts():
        try:
            signal.raise_signal(signal.SIGINT)
        except KeyboardInterrupt as hidden:
            raise SystemError('a result with an exception set') from hidden
    with pytest.raises(SystemError), Interrupts():
        raise SystemError('nobody pressed Ctrl-C')


@pytest.mark.slow
def test_interrupt_ends_with_status_130_and_keeps_what_is_done(tmp_path):
    path = write(tmp_path, 'short', time_limit=1.0)
    command = [sys.executable, '-m', 'push_scenario.cli', str(path), '--law', 'open_loop',
               '--law', 'feedback', '--in-process', '--out', str(tmp_path / 'out')]
    with subprocess.Popen(command, stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
                          env={**os.environ, 'PYTHONPATH': str(ROOT)}) as process:
        for line in process.stderr:
            if 'feedback: planning' in line:
                process.send_signal(signal.SIGINT)
                break
        printed, errors = process.communicate(timeout=300)
    assert process.returncode == 130, errors
    assert 'interrupted' in errors and 'open loop' in printed
    assert (tmp_path / 'out' / 'short_open_loop.csv').is_file()
