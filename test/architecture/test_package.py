"""The package as users install it: by colcon and by pip, run from the installed scripts."""

import ast
import os
from pathlib import Path
import shutil
import signal
import subprocess
import sys
import time
from xml.etree import ElementTree

from catkin_pkg.changelog import get_changelog_from_path
from catkin_pkg.package import parse_package
from catkin_pkg.package_version import get_forthcoming_label
from helpers.architecture import GENERATED, ROOT
from push_model.files import data
from push_scenario.dds.private_network import private_domain, private_environment
import pytest
from rcl_interfaces.srv import ListParameters
import rclpy
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.task import Future
import yaml

EXECUTABLES = {'controller': 'push_controller', 'mocap_odometry': 'mocap_odometry',
               'planner': 'push_planner', 'sim': 'push_sim', 'tf_tracker': 'push_tracker',
               'tidy': 'push_tidy'}
# The tracker starts only where tf2_msgs is installed, and with the tags of an object; tidy with
# names of objects.
STARTED = [name for name in EXECUTABLES if name not in ('tf_tracker', 'tidy')]
PATIENCE = 400.0
pytestmark = [pytest.mark.dds, pytest.mark.slow]
SOURCED = 'AMENT_PREFIX_PATH', 'COLCON_PREFIX_PATH', 'PYTHONPATH'


def copy_of_the_sources(target):
    """Copy the repository without anything that was generated in it."""
    shutil.copytree(ROOT, target, ignore=shutil.ignore_patterns(*GENERATED, '*.egg-info'))
    return target


def outside(directory, domain=0):
    """Make an environment that knows nothing of the source tree or of a sourced ROS."""
    environment = {key: value for key, value in private_environment(domain).items()
                   if key not in SOURCED}
    environment.update(HOME=str(directory), ROS_LOG_DIR=str(directory / 'ros_log'))
    # What ros2 run starts takes the first python3 of the path: here that of the tests.
    environment['PATH'] = os.pathsep.join([str(Path(sys.executable).parent), os.environ['PATH']])
    # The same sources need not be compiled again.
    environment.setdefault('XDG_CACHE_HOME', str(Path.home() / '.cache'))
    return environment


def run(command, directory, **options):
    """Run a command to its end and return what it printed."""
    done = subprocess.run([str(part) for part in command], cwd=directory, timeout=900, text=True,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, **options)
    assert done.returncode == 0, done.stdout
    return done.stdout


@pytest.fixture(scope='module')
def workspace(tmp_path_factory):
    """Build a colcon workspace around a copy of the package."""
    workspace = tmp_path_factory.mktemp('workspace')
    copy_of_the_sources(workspace / 'src' / 'push_control')
    # Of the environment of the tests, or of the system as ROS installs it.
    colcon = (shutil.which('colcon', path=str(Path(sys.executable).parent))
              or shutil.which('colcon'))
    if colcon is None:
        pytest.skip('colcon is not installed, which the extra test brings')
    run([colcon, 'build'], workspace, env=outside(workspace))
    return workspace


@pytest.fixture(scope='module')
def domain():
    """Take a ROS domain that nobody else uses."""
    with private_domain() as domain:
        yield domain


@pytest.fixture
def start(workspace, domain):
    """Start commands in the sourced workspace, and leave none of them behind."""
    processes = []

    def start(*command):
        sourced = ['/bin/sh', '-c', '. install/setup.sh && exec "$0" "$@"', *map(str, command)]
        processes.append(subprocess.Popen(
            sourced, cwd=workspace, env=outside(workspace, domain), text=True,
            stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT))
        return processes[-1]

    yield start
    for process in processes:
        process.kill()
        process.communicate()


@pytest.fixture
def probe(domain):
    """Join the private domain of the nodes under test."""
    context = Context()
    rclpy.init(context=context, domain_id=domain)
    node = rclpy.create_node('probe', context=context)
    executor = SingleThreadedExecutor(context=context)
    executor.add_node(node)
    yield node
    executor.shutdown()
    node.destroy_node()
    rclpy.shutdown(context=context)


def script(workspace, name):
    """Return the path under which ``ros2 run push_control NAME`` finds an executable."""
    return workspace / 'install' / 'push_control' / 'lib' / 'push_control' / name


def stop(process):
    """Interrupt a process as Ctrl-C does and return what it had printed."""
    process.send_signal(signal.SIGINT)
    return process.communicate(timeout=PATIENCE)[0]


@pytest.mark.parametrize('name', [*EXECUTABLES, 'calibrate', 'identify', 'play', 'replay',
                                  'view'])
def test_ros2_run_finds_the_executable(workspace, name):
    """It lies in lib/push_control and may be executed."""
    assert os.access(script(workspace, name), os.X_OK)


def test_the_installed_copy_is_what_runs(workspace, start):
    """A sourced workspace imports its own modules and finds its own data."""
    code = 'import push_model; from push_model.files import data; ' \
           'print(push_model.__file__); print(data.share_directory())'
    process = start(sys.executable, '-c', code)
    module, share = process.communicate(timeout=PATIENCE)[0].split()
    prefix = workspace / 'install' / 'push_control'
    assert prefix in Path(module).parents
    assert Path(share) == prefix / 'share' / 'push_control'


def test_all_data_are_installed(workspace):
    """Every file of config and launch is in share, and the ament index knows the package."""
    prefix = workspace / 'install' / 'push_control' / 'share'
    assert (prefix / 'ament_index/resource_index/packages/push_control').is_file()
    for folder in ('config', 'launch'):
        wanted = {path.relative_to(ROOT) for path in (ROOT / folder).rglob('*')
                  if path.is_file() and '__pycache__' not in path.parts}
        assert wanted
        share = prefix / 'push_control'
        assert {path.relative_to(share) for path in (share / folder).rglob('*')
                if path.is_file()} == wanted


@pytest.mark.parametrize('is_on_path', [True, False])
def test_replay_tells_its_usage(workspace, start, is_on_path):
    """In a sourced workspace ``push`` is on the path; the script of ``ros2 run`` answers, too."""
    words = ['push', 'replay'] if is_on_path else [script(workspace, 'replay')]
    process = start(*words, '--help')
    output = process.communicate(timeout=PATIENCE)[0]
    assert process.returncode == 0, output
    assert '--in-process' in output


@pytest.mark.parametrize('name', STARTED)
def test_a_node_starts_answers_and_ends(workspace, start, probe, name):
    """Started as ``ros2 run`` does, it answers a service call and ends cleanly on Ctrl-C."""
    parameters = workspace / 'install/push_control/share/push_control/config/push.yaml'
    process = start(script(workspace, name), '--ros-args', '--params-file', parameters)
    client = probe.create_client(ListParameters, f'{EXECUTABLES[name]}/list_parameters')
    deadline = time.monotonic() + PATIENCE
    while not client.wait_for_service(timeout_sec=0.5):
        assert process.poll() is None and time.monotonic() < deadline, stop(process)
    answer = Future()
    while not answer.done() and time.monotonic() < deadline:
        # Asked anew: a node may answer before it has met the client's reader of answers.
        answer = client.call_async(ListParameters.Request())
        probe.executor.spin_until_future_complete(answer, timeout_sec=2.0)
    output = stop(process)
    assert answer.done(), output
    assert 'use_sim_time' in answer.result().result.names
    assert process.returncode == 0, output
    assert 'Traceback' not in output


def test_manifest_and_changelog_are_what_ros_tools_read():
    """The tools that release ROS packages parse both files and warn of nothing."""
    warnings = []
    manifest = parse_package(str(ROOT), warnings=warnings)
    assert manifest.name == 'push_control' and warnings == []
    assert manifest.get_build_type() == 'ament_python'
    changelog = get_changelog_from_path(str(ROOT / 'CHANGELOG.rst'), manifest.name)
    released = [version for version, _, _ in changelog.foreach_version()]
    assert get_forthcoming_label(changelog.rst) or released[:1] == [manifest.version]


def test_launch_files_name_what_exists():
    """Executables and config files in launch files are those of the package."""
    started, files = set(), set()
    for path in (ROOT / 'launch').glob('*.py'):
        for node in ast.walk(ast.parse(path.read_text())):
            if (isinstance(node, ast.Call) and ast.unparse(node.func) == 'push_node'
                    and isinstance(node.args[0], ast.Constant)):
                started.add(node.args[0].value)
            if isinstance(node, ast.Call) and ast.unparse(node.func) == 'PathJoinSubstitution':
                files.add(ast.unparse(node.args[0].elts[-1]).strip("'"))
    # Which simulator is started is an argument.
    assert started | {'sim'} == set(EXECUTABLES)
    assert {file for file in files if (ROOT / 'config' / file).is_file()} == files - {'config'}
    assert len(files) == 3


def test_pip_installs_code_and_data(tmp_path):
    """Installed by pip into a prefix, the code finds the data of that prefix."""
    sources, prefix = copy_of_the_sources(tmp_path / 'sources'), tmp_path / 'prefix'
    run([sys.executable, '-m', 'pip', 'install', '-qq', '--no-deps', '--no-build-isolation',
         '--no-index', '--ignore-installed', '--prefix', prefix, sources], tmp_path)
    library = next(prefix.glob('lib/python*/site-packages'))
    share = run([sys.executable, '-c', 'from push_model.files import data; '
                 'print(data.config_file("objects/box_04.yaml"))'], tmp_path,
                env={**outside(tmp_path), 'PYTHONPATH': str(library)})
    assert Path(share.strip()) == prefix / 'share/push_control/config/objects/box_04.yaml'
    assert [path.name for path in (prefix / 'bin').iterdir()] == ['push']
    assert os.access(prefix / 'lib' / 'push_control' / 'controller', os.X_OK)
    assert (library / 'push_view' / 'page' / 'index.html').is_file()


def test_data_are_found_through_the_ament_index(tmp_path):
    """Code away from its data asks the ament index, and says where it looked in vain."""
    share = tmp_path / 'prefix' / 'share' / 'push_control'
    (share / 'config').mkdir(parents=True)
    module = tmp_path / 'elsewhere' / 'push_scenario' / 'data.py'
    index = {'AMENT_PREFIX_PATH': os.pathsep.join(['', str(tmp_path / 'prefix')])}
    with pytest.raises(FileNotFoundError, match=str(share)):
        data.share_directory(module, index)
    (share / 'package.xml').touch()
    assert data.share_directory(module, index) == share
    with pytest.raises(FileNotFoundError, match='no_such.yaml'):
        data.config_file('no_such.yaml')


def test_the_citation_names_what_the_manifest_does():
    """Title, licence and authors; what a citation has to have besides."""
    citation = yaml.safe_load((ROOT / 'CITATION.cff').read_text(encoding='utf-8'))
    manifest = ElementTree.parse(ROOT / 'package.xml').getroot()
    assert citation['title'] == manifest.findtext('name')
    assert citation['license'] == manifest.findtext('license').replace(' ', '-')
    assert citation['authors'] == [{'name': manifest.findtext('author')}]
    assert citation.keys() >= {'cff-version', 'message'} and 'version' not in citation
