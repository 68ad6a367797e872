"""Public names of a package that are imported at their first use (PEP 562)."""

from collections.abc import Callable, Mapping, Sequence
import importlib
import sys


def lazy_names(package: str, modules: Mapping[str, Sequence[str]],
               ) -> tuple[Callable[[str], object], Callable[[], list[str]]]:
    """
    Make ``__getattr__`` and ``__dir__`` of a package, so that importing it imports nothing else.

    :param package: its name.
    :param modules: names that the package offers, by the module that defines them.
    :return: the two functions.
    """
    module_of = {name: module for module, names in modules.items() for name in names}

    def get_attribute(name: str) -> object:
        if name not in module_of:
            raise AttributeError(f'module {package!r} has no attribute {name!r}')
        value = getattr(importlib.import_module(module_of[name]), name)
        setattr(sys.modules[package], name, value)
        return value

    def list_names() -> list[str]:
        return sorted({*vars(sys.modules[package]), *module_of})

    return get_attribute, list_names
