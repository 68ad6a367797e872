"""Identity of a batch: jobs, function and software that its results belong to."""

from collections.abc import Sequence
import dataclasses
import functools
import hashlib
import json
from pathlib import Path
import sys
import types
from typing import Any
from xml.etree import ElementTree

from push_model.files.data import share_directory

FORMAT = 'push_control batch 1'
# What may compute a record: all packages but ``push_ros``; see ``_is_shell`` for what is left out.
PACKAGES = ('push_model', 'push_dynamics', 'push_primitives', 'push_navigation', 'push_planner',
            'push_control', 'push_sim_node', 'push_scenario', 'push_study')
SHELL_FOLDERS = {'ros', 'dds'}


def header(function: Any, jobs: Sequence[Any]) -> dict[str, Any]:
    """
    Describe a batch.

    :param function: what runs on every job.
    :param jobs: the jobs.
    :return: dict of text and numbers.
    :raises ValueError: where a job is not plain, or the function cannot be told from others.
    """
    manifest = ElementTree.parse(share_directory() / 'package.xml').getroot()
    return {'format': FORMAT, 'function': describe(function), 'jobs': len(jobs),
            'digest': jobs_digest(jobs), 'version': manifest.findtext('version'),
            'software': software_digest(function)}


def describe(function: Any) -> str:
    """
    Name a function so that every process finds the same name for it.

    :param function: function of a module, partial of one, or instance of a dataclass.
    :raises ValueError: for anything else, as other processes could not import it.
    """
    if isinstance(function, functools.partial):
        keywords = sorted(function.keywords.items())
        return f'partial({describe(function.func)}, {function.args!r}, {keywords!r})'
    if isinstance(function, types.FunctionType) and '<' not in function.__qualname__:
        return f'{function.__module__}.{function.__qualname__}'
    if dataclasses.is_dataclass(function) and not isinstance(function, type):
        kind = type(function)
        fields = ', '.join(f'{name}={describe(value) if _is_function(value) else repr(value)}'
                           for name, value in _shown_fields(function))
        return f'{kind.__module__}.{kind.__qualname__}({fields})'
    raise ValueError(f'function: got {function!r}, expected a function defined in a module, a '
                     'partial of one, or an instance of a dataclass')


def jobs_digest(jobs: Sequence[Any]) -> str:
    """
    Compute the digest of all jobs.

    :param jobs: the jobs.
    :raises ValueError: naming the first job that is not made of plain values.
    """
    digest = hashlib.sha256()
    for index, job in enumerate(jobs):
        try:
            text = json.dumps(job, sort_keys=True)
        except TypeError as error:
            raise ValueError(f'jobs[{index}]: got {job!r} ({error}), expected numbers, text, '
                             'lists and dicts of them') from error
        digest.update(text.encode() + b'\n')
    return digest.hexdigest()


def software_digest(function: Any) -> str:
    """
    Compute the digest of the source of a record: the pure modules and that of the function.

    :param function: as in ``header``; of one that calls another one, the source of that counts.
    """
    function = _innermost(function)
    own = getattr(sys.modules[function.__module__], '__file__', None)
    path = None if own is None else Path(own).resolve()
    return _sources_digest(None if path is None or path in _sources() else path)


def _is_function(value: Any) -> bool:
    return isinstance(value, (types.FunctionType, functools.partial))


def _shown_fields(instance: Any) -> list[tuple[str, Any]]:
    """List name and value of the fields of a dataclass that belong to its description."""
    return [(field.name, getattr(instance, field.name))
            for field in dataclasses.fields(instance) if field.repr]


def _innermost(function: Any) -> Any:
    """Find the function that partials and instances of dataclasses call."""
    while True:
        if isinstance(function, functools.partial):
            function = function.func
            continue
        inner = [value for _, value in _shown_fields(function) if _is_function(value)
                 ] if dataclasses.is_dataclass(function) else []
        if not inner:
            return function
        function = inner[0]


@functools.lru_cache(maxsize=1)
def _sources() -> dict[Path, str]:
    """Find the pure modules; each with its name."""
    root = Path(__file__).resolve().parents[2]
    return {path: path.relative_to(root).as_posix() for package in PACKAGES
            for path in (root / package).rglob('*.py') if not _is_shell(path.relative_to(root))}


# A process keeps the modules that it has read first.
@functools.lru_cache(maxsize=16)
def _sources_digest(own: Path | None) -> str:
    """Compute the digest of the pure modules and one more file."""
    sources = dict(_sources())
    if own is not None:
        sources[own] = ''
    digest = hashlib.sha256()
    for path, name in sorted(sources.items(), key=lambda item: item[1]):
        digest.update(name.encode() + b'\n' + path.read_bytes())
    return digest.hexdigest()


def _is_shell(path: Path) -> bool:
    """Tell whether a module only connects the others to ROS."""
    return path.stem.endswith('_node') or not SHELL_FOLDERS.isdisjoint(path.parts)
