"""YAML files read strictly: a repeated key is an error, ``1e-3`` is a number."""

from collections.abc import Hashable
from pathlib import Path
import re
from typing import Any

import yaml

# YAML 1.1, which PyYAML follows, wants a point and a sign: 1.0e-3.
EXPONENT_NUMBER = re.compile(r'^[-+]?([0-9]+(\.[0-9]*)?|\.[0-9]+)[eE][-+]?[0-9]+$')
# Lists and mappings inside each other; chosen: parameters have five, and Python gives up at some
# hundred.
MAX_DEPTH = 50


class ParameterFileError(ValueError):
    """Fault of a file: names the file, the key, what came and what was expected."""


def load_yaml(path: Path) -> dict[str, Any]:
    """
    Read a YAML file whose top level is a mapping.

    :param path: the file.
    :return: the mapping, of plain Python values.
    :raises ParameterFileError: where the file is missing, is not YAML, or repeats a key.
    """
    return parse_yaml(_text(path), path)


def first_value(path: Path, key: str) -> str:
    """
    Read the text with which a YAML file begins, without reading the rest of it.

    :param path: the file, a mapping.
    :param key: of the first entry.
    :return: its text.
    :raises ParameterFileError: where the file cannot be read, or begins with something else.
    """
    text, scalars = _text(path), []
    try:
        for event in yaml.parse(text, Loader=yaml.SafeLoader):
            if isinstance(event, yaml.ScalarEvent):
                scalars.append(str(event.value))
            if len(scalars) == 2:
                break
    except yaml.YAMLError as error:
        raise _not_yaml(error, path) from error
    if len(scalars) < 2 or scalars[0] != key:
        raise ParameterFileError(f'{path}: got {scalars[:1]} as the first key, expected {key!r}')
    return scalars[1]


def parse_yaml(text: str, source: str | Path) -> dict[str, Any]:
    """
    Read YAML text whose top level is a mapping.

    :param text: the YAML.
    :param source: name of the text in errors, such as its path.
    :return: the mapping, of plain Python values.
    :raises ParameterFileError: where it is not YAML, repeats a key, or is no mapping.
    """
    try:
        data = yaml.load(text, Loader=_Loader)
    except yaml.YAMLError as error:
        raise _not_yaml(error, source) from error
    if not isinstance(data, dict):
        content = 'nothing' if data is None else f'{type(data).__name__} {data!r}'
        raise ParameterFileError(f'{source}: got {content}, expected a mapping of keys to values')
    return data


def _text(path: Path) -> str:
    try:
        return path.read_text(encoding='utf-8')
    except OSError as error:
        raise ParameterFileError(f'{path}: {error.strerror}, expected a readable file') from error
    except UnicodeDecodeError as error:
        raise ParameterFileError(f'{path}: got bytes that are not UTF-8, expected text') from error


def _not_yaml(error: yaml.YAMLError, source: str | Path) -> ParameterFileError:
    mark = getattr(error, 'problem_mark', None)
    line = f':{mark.line + 1}' if mark else ''
    problem = getattr(error, 'problem', None) or str(error)
    return ParameterFileError(f'{source}{line}: {problem}')


class _Loader(yaml.SafeLoader):
    """The safe loader, made to refuse repeated keys and depth, and to read 1e-3 as a number."""

    def __init__(self, stream: str) -> None:
        """
        Start at the top level.

        :param stream: the text.
        """
        super().__init__(stream)
        self._depth = 0

    def compose_node(self, parent: yaml.Node | None, index: Any) -> yaml.Node | None:
        """
        Build a node, refusing one that lies too deep.

        :param parent: node that it is in.
        :param index: of the node there.
        """
        if self._depth >= MAX_DEPTH:
            raise yaml.MarkedYAMLError(
                problem=f'got more than {MAX_DEPTH} levels, expected fewer',
                problem_mark=self.get_mark())
        self._depth += 1
        node = super().compose_node(parent, index)
        self._depth -= 1
        return node

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Hashable, Any]:
        """
        Build a mapping, refusing a key that is there twice.

        :param node: the YAML node.
        :param deep: as in PyYAML.
        """
        known: set[str] = set()
        for key, _ in node.value:
            if key.tag == 'tag:yaml.org,2002:merge':
                continue
            if not isinstance(key, yaml.ScalarNode):
                raise yaml.MarkedYAMLError(problem='got a key that is no word, expected a name',
                                           problem_mark=key.start_mark)
            if key.value in known:
                raise yaml.MarkedYAMLError(problem=f'got the key {key.value!r} twice, expected '
                                           'it once', problem_mark=key.start_mark)
            known.add(key.value)
        return super().construct_mapping(node, deep)


_Loader.add_implicit_resolver('tag:yaml.org,2002:float', EXPONENT_NUMBER,
                              list('-+.0123456789'))
