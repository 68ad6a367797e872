"""Rules on who may import what, read off the syntax trees; each returns what it found wrong."""

import ast
import functools
import graphlib
from pathlib import Path
import re
import subprocess
from typing import NamedTuple

ROOT = Path(__file__).resolve().parents[2]
GENERATED = {'.git', '.venv', '.pytest_cache', '__pycache__', 'build', 'install', 'log', 'out'}
PLAIN = ('push_model', 'push_dynamics', 'push_primitives', 'push_navigation', 'push_base',
         'push_localization', 'push_safety', 'push_planner', 'push_control', 'push_sim_node',
         'push_mujoco', 'push_tidy', 'push_scenario')
# What predicts pushes, below planner and controller.
PREDICTION = {'push_model', 'push_dynamics', 'push_primitives', 'push_navigation'}
MAY_IMPORT = {
    'push_model': set(),
    'push_dynamics': {'push_model'},
    'push_primitives': {'push_model', 'push_dynamics'},
    'push_navigation': {'push_model', 'push_dynamics'},
    'push_ros': {'push_model', 'push_navigation'},
    'push_planner': PREDICTION,
    'push_base': {'push_model', 'push_dynamics'},
    'push_localization': {'push_model'},
    'push_safety': {'push_model', 'push_dynamics', 'push_base', 'push_localization'},
    'push_control': PREDICTION | {'push_base', 'push_localization', 'push_safety'},
    'push_sim_node': {'push_model', 'push_dynamics'},
    # Another engine behind the simulation.
    'push_mujoco': {'push_model', 'push_dynamics', 'push_sim_node', 'push_tags'},
    # Moves of several objects, each made by the controller of one.
    'push_tidy': PREDICTION | {'push_planner', 'push_control'},
    'push_tracker': {'push_model'},
    'push_tags': {'push_model'},
    'push_scenario': set(PLAIN) - {'push_scenario'},
    'push_view': set(PLAIN),
    'studies': set(PLAIN),
}
# What commands of the packages below it may import: they stand on top.
FOR_COMMANDS = 'push_view'
ROS = re.compile(r'(rclpy|rosidl_\w+|ament_\w+|tf2_\w+|std_srvs|\w+_msgs|\w+_interfaces)$')
LAUNCH = {'launch', 'launch_ros'}
# Modules that list or re-export what lies below them, and stand on top of it.
TOP_MODULES = {'__init__.py', 'catalogue.py', 'gallery.py'}
# Positional parameters, self aside; what needs more takes keywords or a value that names them.
MAX_POSITIONAL = 6
# Positions of the callbacks of what a node waits for.
CALLBACK_PLACES = {'create_timer': 1, 'create_subscription': 2}
WORD = re.compile(r'[A-Z]?[a-z]+|[A-Z]+(?![a-z])')
WORDED = ('push_*/**/*.py', 'studies/**/*.py', 'benchmarks/**/*.py', 'examples/*.py',
          'docs/tools/*.py', 'config/**/*.yaml')
# Words of a private vocabulary, each of which has a term of the field in its place: see
# docs/nomenclature.md.
OLD_WORDS = {
    'anew', 'astray', 'begins', 'boldness', 'chain', 'chains', 'doubt', 'doubts', 'draws',
    'evidence', 'felt', 'flaw', 'former', 'hazard', 'hear', 'heard', 'hindrance', 'hopeful',
    'hunt', 'judge', 'judged', 'judgement', 'lack', 'learnt', 'leg', 'legs', 'mending',
    'misplaced', 'obey', 'pace', 'polished', 'programme', 'remainder', 'said', 'say', 'shove',
    'shoved', 'shoves', 'shyer', 'shyest', 'sight', 'spell', 'spells', 'spreads', 'stray',
    'strays', 'stretch', 'stretches', 'tell', 'told', 'tries', 'unrest', 'vain', 'wanted',
    'wants', 'way', 'ways'}
SEEDED = {'default_rng', 'Generator', 'SeedSequence', 'BitGenerator', 'PCG64', 'Philox'}
NOW = re.compile(r'datetime\.(datetime\.)?(now|utcnow|today)$')
MACHINE_PATH = re.compile(r'(?<![\w.])/(root|home|work|Users|mnt|tmp)/\w')
REGISTRY = re.compile(r'https?://\S*(pypi|pythonhosted|/simple\b|artifactory|devpi|nexus)')


class Import(NamedTuple):
    """One imported name, and whether it is imported when the module is."""

    name: str
    line: int
    at_load: bool


def modules(root):
    """List the modules of all packages and of the studies, as paths relative to the root."""
    return sorted(path.relative_to(root) for pattern in ('push_*/**/*.py', 'studies/**/*.py')
                  for path in root.glob(pattern))


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
    """Tell whether a module may know ROS and read clocks."""
    return (module.parts[0] == 'push_ros' or bool({'ros', 'dds'}.intersection(module.parts[1:-1]))
            or is_entry_point(module))


def is_entry_point(module):
    """Tell whether a module is a command or a node: it stands on top, and nobody imports it."""
    return module.name.endswith('_node.py') or module.name in ('cli.py', '__main__.py')


def room(module, parents):
    """
    Name the part of the house that a module belongs to.

    That is its folder. Entry points, the public API of a package (its ``__init__.py``), and the
    modules of a folder that has folders below it, stand for themselves: what a wing shares lies
    beside its rooms, and so does what puts them together.
    """
    stands_alone = (is_entry_point(module) or module.name in TOP_MODULES
                    or module.parent in parents)
    return module.as_posix() if stands_alone else module.parent.as_posix()


@functools.lru_cache(maxsize=1024)
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
    return parse_text((root / module).read_text(encoding='utf-8'), str(module))


# Every rule reads the whole source tree, whose modules are some hundred.
@functools.lru_cache(maxsize=1024)
def parse_text(text, name):
    """Parse the text of a module, once."""
    return ast.parse(text, name)


def ros_in_pure_modules(root):
    """Find ROS imported outside the shell, at load time or later."""
    return [f'{module}:{found.line} imports {found.name}'
            for module in modules(root) for found in imports(parse(root, module))
            if found.name.split('.')[0] in LAUNCH
            or not is_shell(module) and ROS.match(found.name.split('.')[0])]


def against_the_order(root):
    """Find imports, at load time or later, that go against the order of the packages."""
    wrong = []
    for module in modules(root):
        package = module.parts[0]
        if package not in MAY_IMPORT:
            wrong.append(f'{module}: {package} has no place in the order of the packages')
            continue
        allowed = {package} | MAY_IMPORT[package]
        if is_shell(module):
            allowed.add('push_ros')
        if module.name == 'cli.py':
            allowed.add(FOR_COMMANDS)
        for found in imports(parse(root, module)):
            target = found.name.split('.')[0]
            if target in MAY_IMPORT and target not in allowed or target == '':
                wrong.append(f'{module}:{found.line} imports {found.name}')
    return wrong


def pure_on_shell(root):
    """Find imports of entry points, and of the shell by pure modules."""
    wrong = []
    dotted = {'.'.join(module.with_suffix('').parts): module for module in modules(root)}
    for module in modules(root):
        for found in imports(parse(root, module)):
            for name in (found.name, found.name.rpartition('.')[0]):
                target = dotted.get(name)
                if target is not None and (is_entry_point(target)
                                           or is_shell(target) and not is_shell(module)):
                    wrong.append(f'{module}:{found.line} imports {name}')
    return wrong


def cycle(root):
    """Find a cycle among the imports of rooms or modules; empty where there is none."""
    dotted = {'.'.join(module.with_suffix('').parts): module for module in modules(root)}
    parents = {folder for module in dotted.values() for folder in module.parent.parents}
    by_module, by_room = {}, {}
    for name, module in dotted.items():
        targets = {target for found in imports(parse(root, module))
                   for target in (found.name, found.name.rpartition('.')[0]) if target in dotted}
        by_module[name] = targets - {name}
        by_room.setdefault(room(module, parents), set()).update(
            room(dotted[target], parents) for target in targets)
    for name, targets in by_room.items():
        targets.discard(name)
    for graph in (by_module, by_room):
        try:
            graphlib.TopologicalSorter(graph).prepare()
        except graphlib.CycleError as error:
            return list(error.args[1])
    return []


def clocks_and_dice(root):
    """Find pure modules that read a clock, or a random generator that nobody seeded."""
    wrong = []
    for module in modules(root):
        if is_shell(module):
            continue
        tree = parse(root, module)
        wrong += [f'{module}:{found.line} imports {found.name}' for found in imports(tree)
                  if found.name.split('.')[0] in ('time', 'random')]
        for node in ast.walk(tree):
            text = dotted_name(node)
            drawn = re.match(r'(np|numpy)\.random\.(\w+)$', text)
            if NOW.match(text) or drawn and drawn[2] not in SEEDED or text.endswith('_rng()'):
                wrong.append(f'{module}:{node.lineno} uses {text}')
    return wrong


def dotted_name(node):
    """Write an attribute, as ``a.b.c``, or a call without arguments; empty for anything else."""
    if isinstance(node, ast.Call) and not node.args and not node.keywords:
        return f'{dotted_name(node.func)}()'
    if isinstance(node, ast.Attribute):
        return f'{dotted_name(node.value)}.{node.attr}'
    return node.id if isinstance(node, ast.Name) else ''


def long_signatures(root):
    """Find functions with more positional parameters than a caller can keep in order."""
    wrong = []
    for module in modules(root):
        for node in ast.walk(parse(root, module)):
            if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)):
                names = [arg.arg for arg in (*node.args.posonlyargs, *node.args.args)]
                count = len(names) - (names[:1] in (['self'], ['cls']))
                if count > MAX_POSITIONAL and not is_kernel(module):
                    wrong.append(f'{module}:{node.lineno} {node.name} has {count}')
    return wrong


def is_kernel(module):
    """Tell whether a module is compiled by numba, to which numbers are passed one by one."""
    return module.parts[0] in ('push_dynamics', 'push_primitives')


def words_of(identifier):
    """Split an identifier into its words, in lower case."""
    return {word.lower() for word in WORD.findall(identifier)}


def identifiers(tree):
    """Yield what a module defines, as (identifier, line): names, attributes, parameters."""
    for node in ast.walk(tree):
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)):
            yield node.name, node.lineno
        elif isinstance(node, ast.arg):
            yield node.arg, node.lineno
        elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            yield node.id, node.lineno
        elif isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Store):
            yield node.attr, node.lineno


def old_words(root):
    """Find words of the former private vocabulary in identifiers, files and configuration keys."""
    wrong = []
    for path in (path.relative_to(root) for folder in WORDED for path in root.glob(folder)):
        wrong += [f'{path}: {word}' for part in path.parts for word in words_of(part) & OLD_WORDS]
        if path.suffix == '.py':
            wrong += [f'{path}:{line} {name}' for name, line in identifiers(parse(root, path))
                      if words_of(name) & OLD_WORDS]
        else:
            keys = re.findall(r'(?m)^[\s-]*(\w+):', (root / path).read_text(encoding='utf-8'))
            wrong += [f'{path}: {key}' for key in keys if words_of(key) & OLD_WORDS]
    return wrong


def unguarded_callbacks(root: Path) -> list[str]:
    """Find timers and subscriptions whose errors would end the node."""
    wrong = []
    for module in filter(is_shell, modules(root)):
        for node in ast.walk(parse(root, module)):
            name = node.func.attr if (isinstance(node, ast.Call)
                                      and isinstance(node.func, ast.Attribute)) else ''
            place = CALLBACK_PLACES.get(name)
            if place is None or len(node.args) <= place:
                continue
            callback = node.args[place]
            called = dotted_name(callback.func) if isinstance(callback, ast.Call) else ''
            if not called.endswith('.guarded') and dotted_name(callback) != '_ignore':
                wrong.append(f'{module}:{node.lineno} {name}: its callback is not guarded')
    return wrong


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
