"""YAML that is read strictly: safe types only, no key twice, 1e-3 is a number."""

import re

import yaml

EXPONENT_NUMBER = re.compile(r'^[-+]?([0-9]+(\.[0-9]*)?|\.[0-9]+)[eE][-+]?[0-9]+$')


class ScenarioError(ValueError):
    """What is wrong with a file: names the file, the key, what came and what was expected."""


def load(path):
    """
    Read a YAML file whose top level is a mapping.

    :param path: the file, a ``pathlib.Path``.
    :return: the mapping, of plain Python values.
    :raises ScenarioError: where the file is missing, is not YAML, or repeats a key.
    """
    try:
        text = path.read_text(encoding='utf-8')
    except OSError as error:
        raise ScenarioError(f'{path}: {error.strerror}, expected a readable file') from error
    except UnicodeDecodeError as error:
        raise ScenarioError(f'{path}: got bytes that are not UTF-8, expected text') from error
    return parse(text, path)


def parse(text, source):
    """
    Read YAML text whose top level is a mapping.

    :param text: the YAML.
    :param source: what errors call the text, such as its path.
    :raises ScenarioError: where it is not YAML, repeats a key, or is no mapping.
    """
    try:
        data = yaml.load(text, Loader=_Loader)
    except yaml.YAMLError as error:
        mark = getattr(error, 'problem_mark', None)
        line = f':{mark.line + 1}' if mark else ''
        problem = getattr(error, 'problem', None) or str(error)
        raise ScenarioError(f'{source}{line}: {problem}') from error
    if not isinstance(data, dict):
        raise ScenarioError(f'{source}: got {_kind(data)}, expected a mapping of keys to values')
    return data


class _Loader(yaml.SafeLoader):
    """The safe loader, made to refuse repeated keys and to read 1e-3 as a number."""

    def construct_mapping(self, node, deep=False):
        """
        Build a mapping, refusing a key that is there twice.

        :param node: the YAML node.
        :param deep: as in PyYAML.
        """
        seen = set()
        for key, _ in node.value:
            if key.tag == 'tag:yaml.org,2002:merge':
                continue
            if not isinstance(key, yaml.ScalarNode):
                raise yaml.MarkedYAMLError(problem='got a key that is no word, expected a name',
                                           problem_mark=key.start_mark)
            if key.value in seen:
                raise yaml.MarkedYAMLError(problem=f'got the key {key.value!r} twice, expected '
                                           'it once', problem_mark=key.start_mark)
            seen.add(key.value)
        return super().construct_mapping(node, deep)


_Loader.add_implicit_resolver('tag:yaml.org,2002:float', EXPONENT_NUMBER,
                              list('-+.0123456789'))


def _kind(value):
    return 'nothing' if value is None else f'{type(value).__name__} {value!r}'
