"""
Messages, services and actions, built from their definitions where no ROS installation has them.

The wheels bring rosidl's generators; cmake and g++ come from the distribution. A build takes 10 to
20 s and is kept in ``build/interfaces`` until sources or generators change; its libraries of C++
are empty. In a test:

    @pytest.fixture(scope='module')
    def interfaces():
        with available(ROOT / 'push_control_msgs'):      # a folder with package.xml
            yield

    def test_something(interfaces):
        from push_control_msgs.action import and in processes started here, PushObject  # here

``available_tf2_msgs`` does so for ``tf2_msgs/TFMessage``. Both skip the test, with the reason,
where cmake, g++, the headers of Python or the generators are missing, and do nothing where the
package can be imported anyhow, as on a machine with ROS 2.

For ``colcon build`` of such a package, pass ``cmake_arguments()`` after ``--cmake-args`` and run
it in ``tool_environment()``.
"""

import contextlib
import ctypes
import fcntl
import hashlib
import importlib
import importlib.metadata
import importlib.util
import os
from pathlib import Path
import shutil
import subprocess
import sys
import sysconfig
from xml.etree import ElementTree

from helpers.architecture import ROOT
from helpers.extras import import_extra
import pytest

CACHE = ROOT / 'build' / 'interfaces'
WHEELS = Path(__file__).with_name('wheels.cmake')
# Where Python modules lie in an installation prefix, and the way from there to its libraries.
MODULES = Path('lib', f'python{sys.version_info[0]}.{sys.version_info[1]}', 'site-packages')
LIBRARIES = Path('lib')
RPATH = '$ORIGIN;$ORIGIN/../../..'
MANIFEST = """<?xml version="1.0"?>
<package format="3">
  <name>{name}</name>
  <version>1.0.0</version>
  <description>Built for tests.</description>
  <maintainer email="maintainers@push-control.invalid">push_control contributors</maintainer>
  <license>Apache-2.0</license>
  <buildtool_depend>ament_cmake</buildtool_depend>
  <buildtool_depend>rosidl_default_generators</buildtool_depend>
  <depend>{dependency}</depend>
  <exec_depend>rosidl_default_runtime</exec_depend>
  <member_of_group>rosidl_interface_packages</member_of_group>
  <export>
    <build_type>ament_cmake</build_type>
  </export>
</package>
"""
CMAKE_LISTS = """cmake_minimum_required(VERSION 3.8)
project({name})
find_package(ament_cmake REQUIRED)
find_package({dependency} REQUIRED)
find_package(rosidl_default_generators REQUIRED)
rosidl_generate_interfaces({name} {files} DEPENDENCIES {dependency})
ament_package()
"""


@contextlib.contextmanager
def available(source):
    """
    Make a package of interfaces importable, in this process and in those that it starts.

    :param source: folder with its ``package.xml``, ``CMakeLists.txt`` and definitions.
    :return: context manager; the environment is as before after it.
    """
    name = package_name(source)
    if name not in _built and _is_installed(name):
        yield
        return
    prefix = build(source)
    _load(name, prefix)
    former = {key: os.environ.get(key) for key in ('PYTHONPATH', 'LD_LIBRARY_PATH')}
    for key, folder in (('PYTHONPATH', MODULES), ('LD_LIBRARY_PATH', LIBRARIES)):
        os.environ[key] = os.pathsep.join(filter(None, [str(prefix / folder), former[key]]))
    try:
        yield
    finally:
        for key, value in former.items():
            if value is None:
                del os.environ[key]
            else:
                os.environ[key] = value


@contextlib.contextmanager
def available_tf2_msgs():
    """Make ``tf2_msgs.msg.TFMessage`` importable, with the definition that rosbags knows."""
    if 'tf2_msgs' not in _built and _is_installed('tf2_msgs'):
        yield
        return
    typesys = import_extra('rosbags', 'record', 'rosbags.typesys')
    definition, _ = typesys.get_typestore(typesys.Stores.ROS2_JAZZY).generate_msgdef(
        'tf2_msgs/msg/TFMessage')
    # The definitions of what it consists of follow after a line of equals signs.
    source = write_package(CACHE / 'sources' / 'tf2_msgs',
                           {'msg/TFMessage.msg': definition.partition('=' * 80)[0]},
                           'geometry_msgs')
    with available(source):
        yield


def write_package(folder, definitions, dependency):
    """
    Write a package of interfaces.

    :param folder: where; its name is that of the package.
    :param definitions: dict of file names, as ``msg/Name.msg``, to texts.
    :param dependency: package of interfaces that they refer to.
    :return: the folder.
    """
    values = {'name': folder.name, 'dependency': dependency, 'files': ' '.join(definitions)}
    texts = {'package.xml': MANIFEST.format(**values),
             'CMakeLists.txt': CMAKE_LISTS.format(**values), **definitions}
    for name, text in texts.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        unfinished = path.with_name(f'{path.name}.{os.getpid()}.part')
        unfinished.write_text(text)
        unfinished.rename(path)
    return folder


def build(source):
    """
    Build a package of interfaces, or find it built.

    :param source: folder with its ``package.xml``.
    :return: path of the installation prefix.
    """
    reason = missing_tools()
    if reason:
        pytest.skip(reason)
    CACHE.mkdir(parents=True, exist_ok=True)
    prefix = CACHE / f'{package_name(source)}-{_digest(source)}'
    with open(f'{prefix}.lock', 'w') as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not prefix.is_dir():
            unfinished, work = Path(f'{prefix}.part'), Path(f'{prefix}.work')
            for folder in (unfinished, work):
                shutil.rmtree(folder, ignore_errors=True)
            _run('cmake', '-S', source, '-B', work, f'-DCMAKE_INSTALL_PREFIX={unfinished}',
                 f'-DCMAKE_INSTALL_RPATH={RPATH}', *cmake_arguments())
            _run('cmake', '--build', work, '--target', 'install', '--parallel',
                 os.cpu_count() or 1)
            shutil.rmtree(work)
            unfinished.rename(prefix)
    return prefix


def missing_tools():
    """Return why interfaces cannot be built here; empty where they can."""
    headers = Path(sysconfig.get_path('include'), 'Python.h')
    generators = any(Path(prefix, 'share', 'rosidl_default_generators').is_dir()
                     for prefix in _prefixes())
    needed = {'cmake': shutil.which('cmake'), 'g++': shutil.which('g++'),
              'the headers of Python': headers.is_file(), 'rosidl_default_generators': generators}
    missing = [name for name, found in needed.items() if not found]
    return f'interfaces are built with {", ".join(missing)}: not installed' if missing else ''


def cmake_arguments():
    """List what cmake must be called with to build interfaces with the wheels."""
    return [f'-DCMAKE_PREFIX_PATH={";".join(_prefixes())}',
            f'-DPython3_EXECUTABLE={sys.executable}', f'-DCMAKE_PROJECT_INCLUDE={WHEELS}',
            '-DBUILD_TESTING=OFF']


def tool_environment():
    """Make the environment in which cmake finds the generators of the wheels."""
    return {**os.environ, 'AMENT_PREFIX_PATH': os.pathsep.join(_prefixes()),
            'PATH': os.pathsep.join((str(Path(sys.executable).parent), os.environ['PATH']))}


def package_name(source):
    """Read the name of a package."""
    return ElementTree.parse(source / 'package.xml').findtext('name')


# Names of the packages that were built and loaded here.
_built = set()


def _is_installed(name):
    """Tell a package from a mere folder of the same name, as that of the definitions is."""
    spec = importlib.util.find_spec(name)
    return spec is not None and spec.origin is not None


def _load(name, prefix):
    """Make the modules importable here, where the loader no longer reads its search path."""
    if name in _built:
        return
    for library in sorted((prefix / LIBRARIES).glob('*.so')):
        ctypes.CDLL(str(library))
    sys.path.insert(0, str(prefix / MODULES))
    for module in [module for module in sys.modules if module.split('.')[0] == name]:
        # Imported before, as a mere folder.
        del sys.modules[module]
    importlib.invalidate_caches()
    _built.add(name)


def _prefixes():
    """List the prefixes of the wheels and of a sourced ROS installation."""
    return [sys.prefix, *filter(None, os.environ.get('AMENT_PREFIX_PATH', '').split(os.pathsep))]


def _digest(source):
    """Summarize what a build is made from."""
    digest = hashlib.sha256(sys.version.encode())
    for path in (*sorted(source.rglob('*')), Path(__file__), WHEELS):
        if path.is_file() and not path.name.endswith('.part'):
            digest.update(path.name.encode() + path.read_bytes())
    for version in sorted(f'{distribution.name} {distribution.version}'
                          for distribution in importlib.metadata.distributions()
                          if 'rosidl' in distribution.name):
        digest.update(version.encode())
    return digest.hexdigest()[:16]


def _run(*command):
    done = subprocess.run([str(part) for part in command], env=tool_environment(), text=True,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    assert done.returncode == 0, done.stdout
