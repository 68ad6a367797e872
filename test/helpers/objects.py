"""Objects that several tests push."""

import math
from typing import Any, Sequence

from push_model.parameters import PushedObject, Support


def square_outline(side: float = 0.4) -> tuple[tuple[float, float], ...]:
    """Return the corners of a square about the origin, counter-clockwise."""
    h = side / 2
    return ((-h, -h), (h, -h), (h, h), (-h, h))


def box(side: float = 0.4, mass: float = 2.0, friction: Sequence[float] = (0.3, 0.3, 0.3, 0.3),
        foot: float | None = None, inertia: float | None = None, **fields: Any) -> PushedObject:
    """Return a square box on four feet at its corners (or at +-foot)."""
    foot = side / 2 if foot is None else foot
    places = ((-foot, -foot), (foot, -foot), (foot, foot), (-foot, foot))
    supports = tuple(Support(x, y, mu) for (x, y), mu in zip(places, friction))
    return PushedObject(mass=mass, inertia=inertia or mass * side ** 2 / 6, supports=supports,
                        outline=square_outline(side), **fields)


def bin_(radius: float = 0.2, mass: float = 3.0, friction: float = 0.3, feet: int = 3,
         **fields: Any) -> PushedObject:
    """Return a round bin on feet near its rim."""
    supports = tuple(Support(0.8 * radius * math.cos(2 * math.pi * i / feet),
                             0.8 * radius * math.sin(2 * math.pi * i / feet), friction)
                     for i in range(feet))
    return PushedObject(mass=mass, inertia=0.5 * mass * radius ** 2, supports=supports,
                        radius=radius, **fields)
