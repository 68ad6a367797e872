"""
Scalar kernels: compiled by numba where it is installed, plain Python elsewhere.

Machine code is kept on disk, in a directory named after the text of all modules that end up in
it (this folder, that of the function, and the modules of what it calls): numba itself notices
changes only in the file of the outermost function. The directory is in the user's cache, so that a
read-only installation works; where it cannot be written to either, or others can write to it,
every process compiles anew.

Neither numba nor machine code is loaded before the first call, so that importing a module costs
nothing. Compiling takes 6 s of CPU time, and loading machine code from disk 0.5 s. Where little
is to be computed, as in a simulator that keeps to the wall clock, ``interpreted`` runs the same
text as plain Python: 13 instead of 2 ms for each simulated second of a push.
"""

import functools
import hashlib
import importlib
from importlib import util
import operator
import os
import pathlib
import sys
import types
from typing import Any, Callable, cast, TypeVar

import numpy as np
from push_dynamics.overload_cache import OverloadCache
from push_dynamics.private_folder import PrivateFolder
from push_dynamics.user_cache import user_cache
from push_model import friction, geometry
from push_model.geometry import FloatArray

# Environment variable that keeps the kernel in plain Python, to debug it.
INTERPRET = 'PUSH_SIM_INTERPRET'


IS_COMPILED = not os.environ.get(INTERPRET) and util.find_spec('numba') is not None

Function = TypeVar('Function', bound=Callable[..., Any])
HERE = pathlib.Path(__file__).parent
# Of a function that only compiled functions call.
INNER_OPTIONS = {'no_cpython_wrapper': True}


def compiled(function: Function) -> Function:
    """
    Compile a scalar function, unless numba is missing or ``PUSH_SIM_INTERPRET`` is set.

    :param function: plain Python on numbers and on sequences of numbers.
    :return: a ``CompiledFunction``, or the function itself.
    """
    return cast(Function, CompiledFunction(function)) if IS_COMPILED else function


class CompiledFunction:
    """
    A function that numba compiles, or whose machine code is loaded, at its first call.

    ``py_func``: the function itself.
    """

    def __init__(self, function: Callable[..., Any]) -> None:
        """
        Do nothing yet.

        :param function: plain Python on numbers and on sequences of numbers.
        """
        functools.update_wrapper(self, function)
        self.py_func = function

    def __reduce__(self) -> str:
        """Pickle it by its name, as a function."""
        return self.py_func.__qualname__

    @functools.cached_property
    def dispatcher(self) -> Any:
        """Numba's dispatcher for calls from Python."""
        return self._make_dispatcher('outer', {})

    @functools.cached_property
    def inner_dispatcher(self) -> Any:
        """
        Numba's dispatcher for calls from other compiled functions.

        Python cannot call what it compiles: the code that converts arguments is left out, which
        for nested tuples of arrays takes as long to compile as all the rest.
        """
        return self._make_dispatcher('inner', INNER_OPTIONS)

    def _make_dispatcher(self, kind: str, special: dict[str, bool]) -> Any:
        numba = importlib.import_module('numba')
        options = {**_options(numba), **special}
        files = _files_of(self.py_func)
        folder = cache_directory(pathlib.Path(self.py_func.__code__.co_filename).parent, files)
        dispatcher = numba.njit(self.py_func, **options)
        if folder is not None:
            parts = [*self.py_func.__module__.split('.'), self.py_func.__qualname__, kind]
            name = '-'.join(parts).replace('.', '-')
            # What ``cache=True`` would make unpickles whatever lies in its folder.
            dispatcher._cache = OverloadCache(numba, self.py_func, folder, name)
            dispatcher.compile = _in_turn(dispatcher.compile, folder, name)
        return dispatcher

    # Calls go straight to the dispatcher: a method here would take as long as some functions do.
    __call__: Any = property(operator.attrgetter('dispatcher'))

    @property
    def is_loaded(self) -> bool:
        """Tell whether there is machine code in memory."""
        return bool(self.dispatcher.overloads)

    @property
    def _numba_type_(self) -> Any:
        # By this numba knows what a compiled function calls. What Python has called already is
        # compiled, and need not be once more.
        called = self.dispatcher if 'dispatcher' in vars(self) else self.inner_dispatcher
        return called._numba_type_


def interpreted(function: Function) -> Function:
    """
    Return the plain Python of a compiled function, in which it calls that of others.

    :param function: a function of a module, as ``compiled`` returned it.
    """
    plain = getattr(function, 'py_func', function)
    return cast(Function, _interpreted_names(plain.__module__)[plain.__name__])


def kernel_array(values: Any, is_compiled: bool = IS_COMPILED) -> Any:
    """
    Lay numbers out as the kernel reads them fastest: an array if compiled, else lists.

    :param values: numbers, or rows of numbers.
    :param is_compiled: whether the kernel that reads them is.
    """
    array = np.array(values, dtype=float)
    return array if is_compiled else array.tolist()


def array_view(array: FloatArray) -> Any:
    """
    View an array whose single numbers Python reads and writes, five times as fast as by numpy.

    :param array: of one dimension.
    :return: ``memoryview`` of it.
    """
    values: Any = array
    return memoryview(values)


def values_of(values: Any) -> list[float]:
    """
    List the numbers of a ``kernel_array`` of one dimension.

    :param values: as ``kernel_array`` made it.
    """
    return [float(value) for value in values] if isinstance(values, list) else values.tolist()


def cache_directory(folder: pathlib.Path = HERE,
                    files: frozenset[str] = frozenset()) -> PrivateFolder | None:
    """
    Return the folder for numba's machine code; see ``user_cache``.

    :param folder: of the compiled function's module.
    :param files: paths of modules elsewhere whose functions it calls.
    """
    outside = frozenset(path for path in files if pathlib.Path(path).parent not in (HERE, folder))
    return user_cache(_source_digest(folder, outside))


def _options(numba: Any) -> dict[str, Any]:
    # The kernel allocates nothing: counting references would only take half of its time. Nothing
    # of C calls it.
    options: dict[str, Any] = {'error_model': 'numpy', 'no_cfunc_wrapper': True}
    if hasattr(numba.core.options.DefaultOptions, '_nrt'):
        options['_nrt'] = False
    return options


@functools.lru_cache(maxsize=None)
def _interpreted_names(module: str) -> dict[str, Any]:
    """Copy the global names of a module, with plain functions in place of compiled ones."""
    names = dict(vars(sys.modules[module]))
    for name, value in vars(sys.modules[module]).items():
        plain = getattr(value, 'py_func', None)
        if plain is None:
            continue
        if plain.__module__ == module:
            names[name] = types.FunctionType(plain.__code__, names, name, plain.__defaults__)
        else:
            names[name] = interpreted(value)
    return names


# Files that this process is about to write, by the recursions of the compiler.
_reserved_here: set[pathlib.Path] = set()


def _in_turn(compile_function: Callable[..., Any], folder: PrivateFolder,
             name: str) -> Callable[..., Any]:
    """
    Let one process compile, and those that started with it wait and load its machine code.

    :param compile_function: of a dispatcher.
    :param folder: of its cache.
    :param name: what is compiled.
    """
    lock = importlib.import_module('numba.core.compiler_lock').global_compiler_lock
    path = folder.path / name

    def compile_in_turn(signature: Any) -> Any:
        # First the lock of the compiler: another thread that has it may want this file.
        with lock:
            if path in _reserved_here:
                return compile_function(signature)
            _reserved_here.add(path)
            try:
                with folder.reserved(name):
                    return compile_function(signature)
            finally:
                _reserved_here.remove(path)
    return compile_in_turn


@functools.lru_cache(maxsize=None)
def _files_of(function: Callable[..., Any]) -> frozenset[str]:
    """Paths of the modules of a function, of those that it calls, and so on."""
    files = {function.__code__.co_filename}
    for name in function.__code__.co_names:
        called = getattr(function.__globals__.get(name), 'py_func', None)
        if called is not None and called is not function:
            files |= _files_of(called)
    return frozenset(files)


# One digest for each folder: some dozen functions ask for it.
@functools.lru_cache(maxsize=None)
def _source_digest(folder: pathlib.Path, files: frozenset[str]) -> str:
    folders = {HERE, folder}
    if folder != HERE:
        folders.add(HERE.parent / 'push_primitives')
    sources = [source for part in sorted(folders) for source in sorted(part.glob('*.py'))]
    digest = hashlib.sha256()
    elsewhere = {geometry.__file__, friction.__file__, *files} - {str(path) for path in sources}
    for source in [*sources, *sorted(elsewhere)]:
        digest.update(pathlib.Path(source).read_bytes())
    return digest.hexdigest()[:16]


friction_weight = compiled(friction.friction_weight)
load_moment = compiled(friction.load_moment)
closest_on_polygon = compiled(geometry.closest_on_polygon)
lowest_vertex = compiled(geometry.lowest_vertex)
wrap_angles = compiled(geometry.wrap_angles)
