"""What makes a batch the same batch: its jobs, its function and the software that runs it."""

import dataclasses
import functools
import hashlib
import json
from pathlib import Path
import sys
import types
from xml.etree import ElementTree

from push_scenario import data

FORMAT = 'push_control batch 1'
PURE_PACKAGES = ('push_model', 'push_drive', 'push_planner', 'push_control', 'push_sim_node',
                 'push_scenario', 'push_study')


def header(function, jobs):
    """
    Tell a batch from others.

    :param function: what runs on every job.
    :param jobs: the jobs.
    :return: dict of text and numbers.
    :raises ValueError: where a job is not plain, or the function cannot be told from others.
    """
    manifest = ElementTree.parse(data.share_directory() / 'package.xml').getroot()
    return {'format': FORMAT, 'function': describe(function), 'jobs': len(jobs),
            'digest': jobs_digest(jobs), 'version': manifest.findtext('version'),
            'software': software_digest(function)}


def describe(function):
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
        return f'{type(function).__module__}.{function!r}'
    raise ValueError(f'function: got {function!r}, expected a function defined in a module, a '
                     'partial of one, or an instance of a dataclass')


def jobs_digest(jobs):
    """
    Digest of all jobs.

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


def software_digest(function):
    """
    Digest of the source that computes a record: the pure packages and the function's module.

    :param function: as in ``header``.
    """
    while isinstance(function, functools.partial):
        function = function.func
    root = Path(__file__).resolve().parent.parent
    sources = {path.relative_to(root).as_posix(): path for package in PURE_PACKAGES
               for path in (root / package).rglob('*.py') if not path.stem.endswith('_node')}
    own = getattr(sys.modules[function.__module__], '__file__', None)
    if own is not None and Path(own).resolve() not in sources.values():
        sources[''] = Path(own)
    digest = hashlib.sha256()
    for name in sorted(sources):
        digest.update(name.encode() + b'\n' + sources[name].read_bytes())
    return digest.hexdigest()
