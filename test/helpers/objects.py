"""Objects that several tests push."""

import math

from push_model.parameters import PushedObject, Support


def square_outline(side=0.4):
    """Return the corners of a square about the origin, counter-clockwise."""
    h = side / 2
    return ((-h, -h), (h, -h), (h, h), (-h, h))


def box(side=0.4, mass=2.0, friction=(0.3, 0.3, 0.3, 0.3), foot=None, inertia=None, **fields):
    """Return a square box on four feet at its corners (or at +-foot)."""
    foot = side / 2 if foot is None else foot
    places = ((-foot, -foot), (foot, -foot), (foot, foot), (-foot, foot))
    supports = [Support(x, y, mu) for (x, y), mu in zip(places, friction)]
    return PushedObject(mass=mass, inertia=inertia or mass * side ** 2 / 6, supports=supports,
                        outline=square_outline(side), **fields)


def bin_(radius=0.2, mass=3.0, friction=0.3, feet=3, **fields):
    """Return a round bin on feet near its rim."""
    supports = [Support(0.8 * radius * math.cos(2 * math.pi * i / feet),
                        0.8 * radius * math.sin(2 * math.pi * i / feet), friction)
                for i in range(feet)]
    return PushedObject(mass=mass, inertia=0.5 * mass * radius ** 2, supports=supports,
                        radius=radius, **fields)
