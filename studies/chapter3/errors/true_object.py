"""Objects and speeds that differ from those of a plan, by one relative error each."""

import dataclasses
from typing import Callable, NamedTuple

from push_model.parameters import PushedObject, Support

MakeTrue = Callable[[PushedObject, float], PushedObject]


class TruePush(NamedTuple):
    """
    True parameters of a push.

    :param obj: the pushed object.
    :param speed_scale: factor on the planned speed.
    """

    obj: PushedObject
    speed_scale: float


def _with_supports(obj: PushedObject, change: Callable[[Support], Support]) -> PushedObject:
    return dataclasses.replace(obj, supports=tuple(map(change, obj.supports)))


def _same(obj: PushedObject, error: float) -> PushedObject:
    return obj


def _mass(obj: PushedObject, error: float) -> PushedObject:
    return dataclasses.replace(obj, mass=(1.0 + error) * obj.mass)


def _load(obj: PushedObject, error: float) -> PushedObject:
    return dataclasses.replace(obj, mass=(1.0 + error) * obj.mass,
                               inertia=(1.0 + error) * obj.inertia)


def _inertia(obj: PushedObject, error: float) -> PushedObject:
    return dataclasses.replace(obj, inertia=(1.0 + error) * obj.inertia)


def _friction(obj: PushedObject, error: float) -> PushedObject:
    return _with_supports(obj, lambda support: dataclasses.replace(
        support, friction_coefficient=(1.0 + error) * support.friction_coefficient))


def _imbalance(obj: PushedObject, error: float) -> PushedObject:
    # Rougher on the left and smoother on the right by as much: only the centre of friction moves.
    return _with_supports(obj, lambda support: dataclasses.replace(
        support, friction_coefficient=(1.0 + (error if support.y > 0.0 else -error))
        * support.friction_coefficient))


def _scaled(obj: PushedObject, error: float) -> PushedObject:
    return _with_supports(obj, lambda support: dataclasses.replace(
        support, x=(1.0 + error) * support.x, y=(1.0 + error) * support.y))


def _forward(obj: PushedObject, error: float) -> PushedObject:
    shift = error * max(support.x for support in obj.supports)
    return _with_supports(obj, lambda support: dataclasses.replace(support, x=support.x + shift))


def _sideways(obj: PushedObject, error: float) -> PushedObject:
    shift = error * max(support.y for support in obj.supports)
    return _with_supports(obj, lambda support: dataclasses.replace(support, y=support.y + shift))


# Kind of the mismatch -> function of (nominal object, relative error).
KINDS: dict[str, MakeTrue] = {
    'speed': _same, 'friction': _friction, 'mass': _mass, 'load': _load, 'inertia': _inertia,
    'supports': _scaled, 'supports_ahead': _forward, 'supports_aside': _sideways,
    'imbalance': _imbalance}


def true_push(obj: PushedObject, kind: str, error: float) -> TruePush:
    """
    Change one property of a nominal push.

    :param obj: the nominal object, about the origin.
    :param kind: one of ``KINDS``: ``speed`` of the push; ``friction`` of all support points;
        ``mass`` alone; ``load``, mass and inertia alike; ``inertia`` alone; ``supports`` further
        apart; ``supports_ahead`` and ``supports_aside``, all moved by a fraction of their distance
        from the middle; ``imbalance`` of friction, more on the left and less on the right.
    :param error: relative to the nominal value.
    :return: the true push.
    """
    return TruePush(KINDS[kind](obj, error), 1.0 + error if kind == 'speed' else 1.0)
