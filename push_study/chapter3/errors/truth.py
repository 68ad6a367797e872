"""Objects and speeds that are not what a plan believed, by one relative error each."""

from dataclasses import replace


def _supports(obj, change):
    return replace(obj, supports=tuple(map(change, obj.supports)))


def _friction(obj, error):
    return _supports(obj, lambda foot: replace(
        foot, friction_coefficient=(1.0 + error) * foot.friction_coefficient))


def _imbalance(obj, error):
    # Rougher on the left and smoother on the right by as much: only the friction centre moves.
    return _supports(obj, lambda foot: replace(foot, friction_coefficient=(
        1.0 + (error if foot.y > 0.0 else -error)) * foot.friction_coefficient))


def _apart(obj, error):
    return _supports(obj, lambda foot: replace(foot, x=(1.0 + error) * foot.x,
                                               y=(1.0 + error) * foot.y))


def _moved(axis):
    def moved(obj, error):
        shift = error * max(getattr(foot, axis) for foot in obj.supports)
        return _supports(obj, lambda foot: replace(foot, **{axis: getattr(foot, axis) + shift}))

    return moved


KINDS = {
    'speed': lambda obj, error: obj,
    'friction': _friction,
    'mass': lambda obj, error: replace(obj, mass=(1.0 + error) * obj.mass),
    'load': lambda obj, error: replace(obj, mass=(1.0 + error) * obj.mass,
                                       inertia=(1.0 + error) * obj.inertia),
    'inertia': lambda obj, error: replace(obj, inertia=(1.0 + error) * obj.inertia),
    'feet': _apart,
    'feet_ahead': _moved('x'),
    'feet_aside': _moved('y'),
    'imbalance': _imbalance}


def truth(obj, kind, error):
    """
    Find what is true where one thing differs from what was believed.

    :param obj: the believed ``PushedObject``, about the origin.
    :param kind: one of ``KINDS``: ``speed`` of the push, ``friction`` of all feet, ``mass`` alone,
        ``load`` (mass and inertia alike), ``inertia`` alone, ``feet`` further apart,
        ``feet_ahead`` and ``feet_aside`` (all moved, by a share of their distance from the
        middle), ``imbalance`` of friction, more on the left and less on the right.
    :param error: by how much, as a share of the believed value.
    :return: (true ``PushedObject``, factor on the speed).
    """
    return KINDS[kind](obj, error), 1.0 + error if kind == 'speed' else 1.0
