"""The plant against an integrator by impulses, on scenes chosen before any was run."""

import dataclasses
import functools
import math
from typing import Callable, NamedTuple

from helpers.planar_integrator import PlanarIntegrator, RoundPusher
from helpers.plant_reference import ramp_robot
from push_model.geometry import Pose, wrap_angle
from push_model.parameters import PushedObject, Support
from push_model.signals import Twist
from push_sim_node.plant import Plant
import pytest

pytestmark = [pytest.mark.physics, pytest.mark.slow]
# Of the integrator, and of the plant [s]: their errors are of first order.
STEP, PLANT_STEP = 1e-3, 5e-4
# Bounds of the difference at the end [m], [rad]; pushes are 0.1 to 0.4 m long.
DISTANCE, ANGLE = 1e-4, math.radians(0.02)
ORIGIN = Pose(0.0, 0.0, 0.0)


def box(length: float, width: float, mass: float, floor: float, grip: float) -> PushedObject:
    """Return a box on four feet, 3 cm inside its corners."""
    x, y = length / 2, width / 2
    return PushedObject(
        mass=mass, inertia=mass * (length ** 2 + width ** 2) / 12,
        supports=tuple(Support(s_x * (x - 0.03), s_y * (y - 0.03), floor)
                       for s_x, s_y in ((-1, -1), (1, -1), (1, 1), (-1, 1))),
        outline=((-x, -y), (x, -y), (x, y), (-x, y)), contact_friction_coefficient=grip)


def tripod(mass: float, floor: float, grip: float) -> PushedObject:
    """Return a box on three feet whose mass centre lies aside, so that loads differ."""
    feet = (-0.2, -0.15), (-0.2, 0.15), (0.2, 0.0)
    return dataclasses.replace(
        box(0.5, 0.4, mass, floor, grip), center_of_mass=(-0.05, 0.03),
        supports=tuple(Support(x, y, floor) for x, y in feet))


def drum(mass: float, floor: float, grip: float) -> PushedObject:
    """Return a round object on four feet."""
    return PushedObject(
        mass=mass, inertia=mass * 0.25 ** 2 / 2, radius=0.25, contact_friction_coefficient=grip,
        supports=tuple(Support(0.18 * math.cos(a), 0.18 * math.sin(a), floor)
                       for a in (0.4, 0.4 + math.pi / 2, 0.4 + math.pi, 0.4 + 1.5 * math.pi)))


class Scene(NamedTuple):
    """One push from rest."""

    name: str
    object: PushedObject
    pusher: RoundPusher
    duration: float


SCENES = (
    Scene('sticking', box(0.5, 0.3, 4.0, 0.3, 0.6), RoundPusher(-0.45, 0.03, 0.2, (0.15, 0.0)),
          1.5),
    Scene('sliding', box(0.5, 0.3, 4.0, 0.3, 0.15), RoundPusher(-0.45, -0.05, 0.2, (0.12, 0.1)),
          0.8),
    Scene('long side, light', box(0.3, 0.7, 1.0, 0.5, 0.5),
          RoundPusher(-0.4, 0.1, 0.25, (0.2, 0.03)), 1.2),
    Scene('fast', box(0.4, 0.4, 6.0, 0.25, 0.4), RoundPusher(-0.35, -0.04, 0.15, (0.9, 0.0)),
          0.7),
    Scene('impact', box(0.4, 0.4, 3.0, 0.3, 0.5), RoundPusher(-0.45, 0.06, 0.15, (0.5, 0.05)),
          1.0),
    Scene('corner', box(0.4, 0.4, 3.0, 0.35, 0.7),
          RoundPusher(-0.2 - 0.2 * math.cos(0.7), -0.2 - 0.2 * math.sin(0.7), 0.2, (0.15, 0.13)),
          1.0),
    Scene('unequal loads', tripod(5.0, 0.3, 0.5), RoundPusher(-0.45, 0.02, 0.2, (0.2, 0.0)), 1.2),
    Scene('unequal loads, sliding', tripod(2.0, 0.4, 0.2),
          RoundPusher(-0.45, 0.1, 0.2, (0.15, -0.12)), 0.8),
    Scene('round', drum(4.0, 0.3, 0.3), RoundPusher(-0.45, 0.0, 0.2, (0.2, 0.01)), 1.0),
)


@functools.cache
def plant_end(scene: Scene) -> Pose:
    """Return the end in the plant."""
    pusher = scene.pusher
    plant = Plant(scene.object, ramp_robot(pusher.radius), ORIGIN, Pose(pusher.x, pusher.y, 0.0),
                  PLANT_STEP)
    plant.advance(scene.duration, Twist(*pusher.velocity, 0.0))
    return plant.object_pose


def impulse_end(scene: Scene) -> Pose:
    """Return the end by impulses."""
    return PlanarIntegrator(scene.object, scene.pusher, STEP).end(scene.duration)


def distance(one: Pose, other: Pose) -> float:
    """Return the distance of two poses [m]."""
    return math.hypot(one.x - other.x, one.y - other.y)


@pytest.mark.parametrize('scene', SCENES, ids=lambda scene: scene.name)
def test_plant_ends_where_impulses_lead(scene: Scene) -> None:
    plant, impulses = plant_end(scene), impulse_end(scene)
    assert distance(plant, ORIGIN) > 0.08
    assert distance(plant, impulses) < DISTANCE
    assert abs(wrap_angle(plant.theta - impulses.theta)) < ANGLE


def slippery_foot(obj: PushedObject) -> PushedObject:
    """Return the object with a tenth less friction under its first foot."""
    first = obj.supports[0]
    weak = dataclasses.replace(first, friction_coefficient=0.9 * first.friction_coefficient)
    return dataclasses.replace(obj, supports=(weak, *obj.supports[1:]))


def smoother(obj: PushedObject) -> PushedObject:
    """Return the object with a tenth less friction at its contact."""
    grip = 0.9 * obj.contact_friction_coefficient
    return dataclasses.replace(obj, contact_friction_coefficient=grip)


@pytest.mark.parametrize('index, change', [(0, slippery_foot), (1, smoother), (3, slippery_foot),
                                           (6, slippery_foot), (7, smoother)])
def test_bounds_tell_a_tenth_of_friction(index: int, change: Callable[..., PushedObject]) -> None:
    scene = SCENES[index]
    other = impulse_end(scene._replace(object=change(scene.object)))
    assert distance(plant_end(scene), other) > 5.0 * DISTANCE
