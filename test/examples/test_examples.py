"""The examples run, end as they say, and the notebook has the outputs of its code."""

import importlib.util
import itertools
import json
from pathlib import Path
import sys

from helpers.architecture import ROOT
from helpers.extras import import_extra
import matplotlib
import numpy as np
import pytest

EXAMPLES = ROOT / 'examples'
# What a run prints, and the files that it leaves in out/.
SCRIPTS = {
    '01_plan_a_push': ('push of 1.61 m in 11.1 s', ['push.npz']),
    '02_simulate': ('within bounds                                 no       yes',
                    ['two_laws.png']),
    '03_task': ('first plan: a straight push', ['task.png']),
    '04_vary_a_parameter': ('true 0.30: failed', []),
    '07_own_law': ('within bounds                                  yes       yes', []),
    '08_monte_carlo': ('1 of 1 pushes within bounds', ['monte_carlo']),
    '10_own_planner': ('pushes                                   4         3', []),
}
# Constants that a test makes smaller.
SMALLER = {'08_monte_carlo': {'RUNS': 1}}
# Run beside the nodes that it needs, by test/ros/test_commander.py.
WITH_NODES = ['05_commander', '06_mission']
OF_A_RECORDING = '09_read_a_recording'
NOTEBOOK = json.loads((EXAMPLES / 'plan_a_push.ipynb').read_text(encoding='utf-8'))
CODE_CELLS = [cell for cell in NOTEBOOK['cells'] if cell['cell_type'] == 'code']


def is_as_stored(printed, stored):
    """
    Compare two words; numbers may differ by a fraction of themselves, or in the last digit.

    The notebook's open-loop push diverges, and its noisy closed loop sticks and slips: both
    enlarge the rounding errors in which one processor differs from another.
    """
    decimals = len(stored.partition('.')[2])
    try:
        tolerance = max(0.05, 1.5 * 10.0 ** -decimals) if decimals else 0.0
        return float(printed) == pytest.approx(float(stored), rel=0.01, abs=tolerance)
    except ValueError:
        return printed == stored


def load(name):
    """Import a script, whose name is no identifier."""
    spec = importlib.util.spec_from_file_location(f'example_{name}', EXAMPLES / f'{name}.py')
    module = importlib.util.module_from_spec(spec)
    # As classes and functions of an example are known by the name of their module.
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


def test_every_script_is_run():
    """No example is left out."""
    names = [*SCRIPTS, *WITH_NODES, OF_A_RECORDING]
    assert sorted(names) == sorted(path.stem for path in EXAMPLES.glob('*.py'))


@pytest.mark.parametrize('name', [*SCRIPTS, *WITH_NODES, OF_A_RECORDING])
def test_examples_are_short(name):
    """What an example shows takes ten lines or so, docstrings and blank lines aside."""
    body = (EXAMPLES / f'{name}.py').read_text(encoding='utf-8').partition('def main')[2]
    lines = [line for line in body.partition('if __name__')[0].splitlines()[2:] if line.strip()]
    assert len(lines) <= 15


@pytest.mark.slow
@pytest.mark.parametrize('name', SCRIPTS)
def test_a_script_runs(name, tmp_path, monkeypatch, capsys):
    """It prints what is expected, and writes below the current directory alone."""
    monkeypatch.chdir(tmp_path)
    example = load(name)
    for constant, value in SMALLER.get(name, {}).items():
        monkeypatch.setattr(example, constant, value)
    example.main()
    printed, written = SCRIPTS[name]
    assert printed in capsys.readouterr().out
    assert sorted(path.name for path in tmp_path.glob('out/*')) == written


def test_a_recording_is_read(tmp_path, capsys):
    """The way of the object is that of the poses."""
    write_bag = import_extra('rosbags', 'record', 'helpers.bags').write_bag
    times = np.arange(11)
    poses = np.stack([0.3 * times, 0.4 * times, 0.1 * times], axis=1)
    write_bag(tmp_path / 'bag', [(times, 0.0 * poses), (times, poses)],
              import_extra('rosbags', 'record', 'rosbags.rosbag2').StoragePlugin.MCAP)
    load(OF_A_RECORDING).main(tmp_path / 'bag')
    assert 'object in odom: 5.00 m from its start, turned by +57.3' in capsys.readouterr().out


@pytest.mark.slow
def test_the_notebook_runs(tmp_path, monkeypatch, capsys):
    """Its code cells run in order, and draw as many figures as it shows."""
    matplotlib.use('Agg')
    import matplotlib.pyplot as plt
    monkeypatch.chdir(tmp_path)
    plt.close('all')
    names = {}
    for number, cell in enumerate(CODE_CELLS):
        exec(compile(''.join(cell['source']), f'plan_a_push.ipynb, cell {number}', 'exec'), names)
    figures, printed = len(plt.get_fignums()), capsys.readouterr().out
    plt.close('all')
    assert figures == sum('image/png' in output.get('data', {})
                          for cell in CODE_CELLS for output in cell['outputs'])
    stored = ''.join(''.join(output['text']) for cell in CODE_CELLS for output in cell['outputs']
                     if output['output_type'] == 'stream')
    words = list(itertools.zip_longest(printed.split(), stored.split(), fillvalue=''))
    assert [pair for pair in words if not is_as_stored(*pair)] == []


def test_the_notebook_is_stored_with_its_outputs():
    """It was run from top to bottom, without errors and without what a machine adds."""
    assert [cell['execution_count'] for cell in CODE_CELLS] == list(
        range(1, len(CODE_CELLS) + 1))
    kinds = {output['output_type'] for cell in CODE_CELLS for output in cell['outputs']}
    assert kinds == {'execute_result', 'stream', 'display_data'}
    assert {output['name'] for cell in CODE_CELLS for output in cell['outputs']
            if output['output_type'] == 'stream'} == {'stdout'}


def test_links_of_the_notebook_lead_somewhere():
    """Its relative links lead to files."""
    text = ''.join(''.join(cell['source']) for cell in NOTEBOOK['cells']
                   if cell['cell_type'] == 'markdown')
    targets = [part.partition(')')[0] for part in text.split('](')[1:]]
    assert targets and all((Path(EXAMPLES) / target).exists() for target in targets)
