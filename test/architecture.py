"""Rules on who may import what, read off the syntax trees; each returns what it found wrong."""

import ast
import graphlib
from pathlib import Path
import re
import subprocess
from typing import NamedTuple

ROOT = Path(__file__).resolve().parent.parent
GENERATED = {'.git', '.venv', '.pytest_cache', '__pycache__', 'build', 'install', 'log', 'out'}
MODEL_USERS = {'push_drive', 'push_planner', 'push_control', 'push_sim_node'}
MAY_IMPORT = {
    'push_model': set(),
    'push_drive': {'push_model'},
    'push_planner': {'push_model', 'push_drive'},
    'push_control': {'push_model', 'push_drive'},
    'push_sim_node': {'push_model'},
    'push_scenario': {'push_model', *MODEL_USERS},
    'push_study': {'push_model', 'push_scenario', *MODEL_USERS},
    'push_ros': {'push_model', 'push_scenario', *MODEL_USERS},
}
ROS = re.compile(r'(rclpy|rosidl_\w+|ament_\w+|tf2_\w+|std_srvs|\w+_msgs|\w+_interfaces)$')
LAUNCH = {'launch', 'launch_ros'}
SEEDED = {'default_rng', 'Generator', 'SeedSequence', 'BitGenerator', 'PCG64', 'Philox'}
NOW = re.compile(r'datetime\.(datetime\.)?(now|utcnow|today)$')
# The command line tells how many times faster than real time a replay ran.
READS_CLOCK = {'push_scenario/replay.py'}
# The command that lists topics and parameters stands on top of the nodes.
KNOWS_NODES = {'push_ros/describe.py'}
MACHINE_PATH = re.compile(r'(?<![\w.])/(root|home|work|Users|mnt|tmp)/\w')
REGISTRY = re.compile(r'https?://\S*(pypi|pythonhosted|/simple\b|artifactory|devpi|nexus)')
LONGEST_MODULE = 200


class Import(NamedTuple):
    """One imported name, and whether it is imported when the module is."""

    name: str
    line: int
    at_load: bool


def modules(root):
    """List the modules of all packages, as paths relative to the root."""
    return sorted(path.relative_to(root) for path in root.glob('push_*/**/*.py'))


def files(root):
    """List what belongs to the source tree: what git tracks, or everything without git."""
    if not (root / '.git').exists():
        return sorted(root.rglob('*'))
    tracked = subprocess.run(['git', 'ls-files', '-z'], cwd=root, check=True, text=True,
                             stdout=subprocess.PIPE).stdout
    return [root / name for name in tracked.split('\0') if name]


def texts(root):
    """Yield every text file of the source tree as (relative path, content)."""
    for path in files(root):
        relative = path.relative_to(root)
        generated = GENERATED.intersection(relative.parts) or '.egg-info' in str(relative)
        if path.is_file() and not generated:
            try:
                yield relative, path.read_text(encoding='utf-8')
            except UnicodeDecodeError:
                continue


def is_shell(module):
    """Tell whether a module may know ROS."""
    return module.parts[0] == 'push_ros' or module.name.endswith('_node.py')


def imports(tree):
    """List all imports below a syntax tree, in functions too."""
    deferred = {id(node) for function in ast.walk(tree)
                if isinstance(function, (ast.FunctionDef, ast.AsyncFunctionDef))
                for node in ast.walk(function)}
    found = []
    for node in ast.walk(tree):
        names = []
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            start = '.' * node.level + (node.module or '')
            names = [f'{start}.{alias.name}' for alias in node.names]
        found += [Import(name, node.lineno, id(node) not in deferred) for name in names]
    return found


def parse(root, module):
    """Parse one module of a source tree."""
    return ast.parse((root / module).read_text(encoding='utf-8'), str(module))


def ros_in_pure_modules(root):
    """Find ROS imported outside ``push_ros`` and ``*_node.py``, at load time or later."""
    return [f'{module}:{found.line} imports {found.name}'
            for module in modules(root) for found in imports(parse(root, module))
            if found.name.split('.')[0] in LAUNCH
            or not is_shell(module) and ROS.match(found.name.split('.')[0])]


def against_the_order(root):
    """Find imports at load time that go against the order of the packages."""
    wrong = []
    for module in modules(root):
        package = module.parts[0]
        if package not in MAY_IMPORT:
            wrong.append(f'{module}: {package} has no place in the order of the packages')
            continue
        allowed = {package} | (MAY_IMPORT['push_ros'] if is_shell(module) else MAY_IMPORT[package])
        if is_shell(module):
            allowed.add('push_ros')
        for found in imports(parse(root, module)):
            target = found.name.split('.')[0]
            node = module.as_posix() not in KNOWS_NODES and any(
                part.endswith('_node') for part in found.name.split('.')[1:])
            lazy = package == 'push_scenario' and not found.at_load and target == 'push_ros'
            inside = target not in MAY_IMPORT or target in allowed and not node
            if not inside and not lazy or target == '':
                wrong.append(f'{module}:{found.line} imports {found.name}')
    return wrong


def cycle(root):
    """Find a cycle among the imports at load time; empty where there is none."""
    dotted = {'.'.join(module.with_suffix('').parts): module for module in modules(root)}
    graph = {}
    for name, module in dotted.items():
        loaded = [found.name for found in imports(parse(root, module)) if found.at_load]
        graph[name] = {target for found in loaded
                       for target in (found, found.rpartition('.')[0]) if target in dotted}
    try:
        graphlib.TopologicalSorter(graph).prepare()
    except graphlib.CycleError as error:
        return list(error.args[1])
    return []


def clocks_and_dice(root):
    """Find pure modules that read a clock, or a random generator that nobody seeded."""
    wrong = []
    for module in modules(root):
        if is_shell(module) or module.as_posix() in READS_CLOCK:
            continue
        tree = parse(root, module)
        wrong += [f'{module}:{found.line} imports {found.name}' for found in imports(tree)
                  if found.name.split('.')[0] in ('time', 'random')]
        for node in ast.walk(tree):
            text = ast.unparse(node) if isinstance(node, (ast.Attribute, ast.Call)) else ''
            drawn = re.match(r'(np|numpy)\.random\.(\w+)$', text)
            if NOW.match(text) or drawn and drawn[2] not in SEEDED or text.endswith('_rng()'):
                wrong.append(f'{module}:{node.lineno} uses {text}')
    return wrong


def long_modules(root):
    """Find modules that hold more than one concept, by their length."""
    lengths = {module: len((root / module).read_text(encoding='utf-8').splitlines())
               for module in modules(root)}
    return [f'{module} has {n} lines' for module, n in lengths.items() if n > LONGEST_MODULE]


def versions_written_again(root, version):
    """Find the version outside ``package.xml``, the changelog and the pins."""
    written = re.compile(rf'(?<![\d.]){re.escape(version)}(?!\.?\d)|__version__\s*=')
    return [str(path) for path, text in texts(root)
            if path.name not in ('package.xml', 'CHANGELOG.rst', 'LICENSE')
            and not path.name.startswith('requirements') and written.search(text)]


def machine_bound(root):
    """Find paths and registries of somebody's machine."""
    return [f'{path}:{number} {line.strip()}' for path, text in texts(root)
            for number, line in enumerate(text.splitlines(), 1)
            if MACHINE_PATH.search(line) or REGISTRY.search(line)]
