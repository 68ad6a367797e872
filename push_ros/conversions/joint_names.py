"""Checks of messages whose joint names say what each of their numbers is."""

from collections.abc import Collection, Sequence

from push_ros.conversions.primitives import MessageRefused


def check_joint_names(names: Sequence[str], required: Collection[str], topic: str,
                      optional: Collection[str] = ()) -> None:
    """
    Refuse unknown names, missing names, and names that come twice.

    :param names: of the message.
    :param required: names that it has to have.
    :param topic: what errors call the message.
    :param optional: names that it may have.
    :raises MessageRefused: naming them.
    """
    unknown = sorted(name for name in names if name not in required and name not in optional)
    if unknown:
        raise MessageRefused(f'{topic}: got the unknown fields {", ".join(unknown)}, expected '
                             + ', '.join((*required, *optional)))
    missing = [name for name in required if name not in names]
    if missing:
        raise MessageRefused(f'{topic}: {", ".join(missing)}: got nothing, expected a number')
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise MessageRefused(f'{topic}: {", ".join(twice)}: got more than one, expected one')
