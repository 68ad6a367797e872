"""
Names of steering laws: those of the package, and laws of one's own, which are imported by name.

A law is named, not passed: so a name in a scenario file, in a ROS parameter or in a result says
which law it was, and another process finds it. A law of one's own is named ``module:Class``, or by
an entry point of the group ``push_control.laws``.
"""

from importlib import metadata
import inspect

LAWS = 'feedback', 'mpc', 'open_loop'
ENTRY_POINT_GROUP = 'push_control.laws'
OWN_LAW = f'module:Class, or an entry point of the group {ENTRY_POINT_GROUP}'


def check_law_name(name: str) -> None:
    """
    Check that a name can be one of a law; nothing is imported.

    :raises ValueError: where it is neither of the package, nor ``module:Class``, nor that of an
        entry point.
    """
    if name not in LAWS and not _is_reference(name) and name not in _entry_points():
        raise ValueError(f'ControlSettings.control_law: got {name!r}, expected one of '
                         f'{", ".join((*LAWS, OWN_LAW))}')


def law_name(law: type) -> str:
    """
    Name a law of one's own.

    :param law: a subclass of ``SteeringLaw`` at the top level of a module.
    :return: ``module:Class``.
    :raises ValueError: where it is something else.
    """
    if not inspect.isclass(law):
        raise ValueError(f'law: got {law!r}, expected the name of a law, or a subclass of '
                         'SteeringLaw')
    name = f'{law.__module__}:{law.__qualname__}'
    if '<locals>' in name:
        raise ValueError(f'law: got {name}, a class inside of a function, expected one at the top '
                         'level of a module: results and other processes know a law by its name')
    return name


def law_title(name: str) -> str:
    """
    Return what a table calls a law: its class, or the words of its name.

    :param name: such as ``open_loop`` or ``my_laws:Gentle``.
    """
    return name.rpartition(':')[2].replace('_', ' ')


def law_file_name(name: str) -> str:
    """
    Return what files of a law are called.

    :param name: such as ``open_loop`` or ``my_laws:Gentle``.
    """
    return name.replace(':', '.')


def is_own_law(name: str) -> bool:
    """
    Tell whether a law is none of the package.

    :param name: of the law.
    """
    return name not in LAWS


def law_reference(name: str) -> str:
    """
    Look up where a law of one's own is.

    :param name: ``module:Class``, or that of an entry point.
    :return: ``module:Class``.
    """
    return name if _is_reference(name) else _entry_points()[name]


def _is_reference(name: str) -> bool:
    module, colon, attribute = name.partition(':')
    return bool(colon) and all(part.isidentifier() for text in (module, attribute)
                               for part in text.split('.'))


def _entry_points() -> dict[str, str]:
    """Names to ``module:Class`` of the laws that installed packages offer."""
    return {point.name: point.value
            for point in metadata.entry_points(group=ENTRY_POINT_GROUP)}
