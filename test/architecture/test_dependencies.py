"""What is asked for in setup.py, package.xml and requirements agrees, and robots need no more."""

import ast
import os
from pathlib import Path
import re
import subprocess
import sys
from xml.etree import ElementTree

from helpers.architecture import ROOT
from push_model.optional import EXTRAS, how_to_install
import pytest
import yaml

NAME = re.compile(r'[\w.-]+')
# Names of the same things for pip and for rosdep.
ROSDEP_KEYS = {'numpy': 'python3-numpy', 'scipy': 'python3-scipy', 'numba': 'python3-numba',
               'pyyaml': 'python3-yaml', 'setuptools': None}
EXTRA_KEYS = {'casadi-pip', 'python3-aiohttp', 'python3-matplotlib', 'python3-pil',
              'python3-rosbags-pip', 'python3-tqdm', 'python3-mujoco-pip', 'python3-pytest',
              'py_trees', 'rviz2'}
# Modules that the extras bring, some of them through others.
EXTRA_MODULES = ['aiohttp', 'casadi', 'cv2', 'dask', 'distributed', 'gymnasium', 'hypothesis',
                 'matplotlib', 'mcap', 'mujoco', 'pandas', 'PIL', 'py_trees', 'rosbags',
                 'selenium', 'tqdm']
# Names of modules and of what brings them, where they differ.
PROJECTS = {'cv2': 'opencv-python-headless', 'PIL': 'pillow'}
IMPORT_WITHOUT = """
import importlib, sys
modules, absent = (text.split(',') for text in sys.argv[1:])
sys.modules.update(dict.fromkeys(absent))
for module in modules:
    importlib.import_module(module)
print('imported')
"""
RUN_WITHOUT_SOLVER = """
import sys
sys.modules['casadi'] = None
from push_scenario.definition.loader import load_scenario
from push_scenario.simulation.loop import simulate
result = simulate(load_scenario(sys.argv[1]))
print(result.outcome.value, result.reason or '-')
"""


def distribution(requirement):
    """Return the name of what a requirement asks for, as package indices compare names."""
    return re.sub(r'[-_.]+', '-', NAME.match(requirement).group()).lower()


def requested(name):
    """List the lines of a requirements file."""
    lines = (ROOT / name).read_text().splitlines()
    return [line.strip() for line in lines if line.strip() and not line.lstrip().startswith('#')]


def setup_argument(name):
    """Return what setup.py passes to setup."""
    for node in ast.walk(ast.parse((ROOT / 'setup.py').read_text())):
        if isinstance(node, ast.Call) and getattr(node.func, 'id', '') == 'setup':
            return next(ast.literal_eval(word.value) for word in node.keywords if word.arg == name)
    raise ValueError(f'setup.py: got no argument {name} of setup')


def manifest_keys(*tags):
    """Map the keys of dependencies in package.xml to their attributes."""
    manifest = ElementTree.parse(ROOT / 'package.xml').getroot()
    return {item.text: item.attrib for tag in tags for item in manifest.findall(tag)}


def test_what_is_installed_by_pip_is_pinned():
    """Requirements and every extra are asked for, and pinned."""
    asked = {distribution(line): line for name in ('requirements.in', 'requirements-test.in')
             for line in requested(name) if not line.startswith('-r')}
    needed = [*setup_argument('install_requires'),
              *(item for extra in setup_argument('extras_require').values() for item in extra)]
    build = {distribution(line) for line in requested('requirements-build.txt')}
    assert {distribution(item) for item in needed} <= asked.keys() | build
    assert all(asked.get(distribution(item), item) == item for item in needed)
    assert asked.keys() <= {distribution(line) for line in requested('requirements-test.txt')}


def test_who_lacks_a_module_is_told_its_extra():
    """The extra of that name asks for what brings the module."""
    extras = setup_argument('extras_require')
    for module, extra in EXTRAS.items():
        brought = {distribution(item) for item in extras[extra]}
        assert distribution(PROJECTS.get(module, module)) in brought
    assert how_to_install('aiohttp.web') == "no module aiohttp: pip install 'push_control[play]'"
    assert how_to_install('push_model') == how_to_install(None) == ''


def test_the_demo_gets_what_the_tests_get_and_no_solver():
    """Its pins are some of theirs; what only steered pushes and tests need is not among them."""
    demo, tests = (dict(line.partition(' ;')[0].split('==') for line in requested(name))
                   for name in ('requirements.txt', 'requirements-test.txt'))
    assert {distribution(line) for line in requested('requirements.in')} <= demo.keys()
    assert demo.items() <= tests.items()
    assert not demo.keys() & {'casadi', 'mujoco', 'pytest', 'selenium', 'distributed'}


@pytest.mark.parametrize('name', ['requirements.txt', 'requirements-test.txt',
                                  'requirements-build.txt', 'requirements-lint.txt'])
def test_every_requirement_is_pinned(name):
    """Each line names one version."""
    lines = requested(name)
    assert lines and [line for line in lines
                      if not re.match(r'[\w.-]+==\d[\w.]*( ;|$)', line)] == []


def test_ros_machines_install_what_pip_does_and_no_extra():
    """Keys of package.xml are those of install_requires, with the same bounds."""
    keys = manifest_keys('depend', 'exec_depend')
    for item in setup_argument('install_requires'):
        name, _, bound = item.partition('>=')
        key = ROSDEP_KEYS[distribution(name)]
        assert key is None or keys[key].get('version_gte', '') == bound
    assert not keys.keys() & EXTRA_KEYS
    assert manifest_keys('test_depend').keys() >= {'python3-pytest', 'python3-matplotlib'}


def test_the_documentation_builder_finds_its_folder():
    """The file that package.xml names exists, and names a folder that exists."""
    manifest = ElementTree.parse(ROOT / 'package.xml').getroot()
    kind, settings = yaml.safe_load_all((ROOT / manifest.findtext('export/rosdoc2')).read_text())
    assert kind == {'type': 'rosdoc2 config', 'version': 1}
    folder = settings['builders'][0]['sphinx']['user_doc_dir']
    assert (ROOT / folder / 'index.md').is_file()


@pytest.mark.slow
def test_nodes_need_no_extra():
    """Every node is imported although nothing is there that only an extra brings."""
    nodes = ['.'.join(path.relative_to(ROOT).with_suffix('').parts)
             for path in sorted(ROOT.glob('push_*/*_node.py'))]
    assert len(nodes) >= 3
    done = subprocess.run(
        [sys.executable, '-c', IMPORT_WITHOUT, ','.join(nodes), ','.join(EXTRA_MODULES)],
        cwd=ROOT, env={**os.environ, 'PYTHONPATH': os.pathsep.join([str(Path(ROOT)), *sys.path])},
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    assert done.stdout == 'imported\n'


@pytest.mark.slow
@pytest.mark.parametrize('scenario, outcome', [('task_turn', 'done'),
                                               ('straight_push', 'refused')])
def test_tasks_need_no_solver_and_steered_pushes_say_so(scenario, outcome):
    """A task of straight pushes ends at its goal without casadi; a steered one names it."""
    done = subprocess.run([sys.executable, '-c', RUN_WITHOUT_SOLVER, scenario], cwd=ROOT,
                          check=True, capture_output=True, text=True)
    ending, reason = done.stdout.splitlines()[-1].split(maxsplit=1)
    assert ending == outcome
    assert ('casadi' in reason) == (outcome == 'refused')
