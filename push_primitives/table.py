"""
Table of push primitives: what straight pushes and arcs do to the object, simulated.

A primitive begins at rest in contact at a point of the outline. The robot then drives straight
ahead, or on an arc, without steering; the contact may stick, roll and slide. One simulation for
each primitive and each sample of friction gives the effect of all lengths. Motion at pushing speed
is nearly quasi-static: neither mass nor the level of friction on the floor matter, only how it is
distributed over the supports, and the friction of the contact.
"""

from collections.abc import Callable
import dataclasses
import math
from typing import Any, NamedTuple, Sequence

import numpy as np
from push_dynamics.compiled import compiled
from push_dynamics.encoding import body_values, drive_values, NO_OUTLINE, support_rows
from push_dynamics.layout import (
    COM_X, COM_Y, PATCH_SIZE, ROBOT_OMEGA, ROBOT_THETA, ROBOT_V_X, ROBOT_X, ROBOT_Y, STATE_SIZE,
    THETA, TOUCH_SIZE, World, X, Y,
)
from push_dynamics.step import advance
from push_dynamics.wall_grid import NO_WALLS
from push_model.friction import friction_center
from push_model.geometry import BoolArray, FloatArray, IntArray
from push_model.parameters import PushedObject, RoundRobot
from push_primitives.face_points import face_points, FacePoint
from push_primitives.member_motion import member_world, Worlds

# Angles of straight pushes from the inward normal [rad], chosen: inside the friction cone of a
# rubber bumper, and just outside.
APPROACH_ANGLES = (-0.45, -0.3, -0.15, 0.0, 0.15, 0.3, 0.45)
# Curvatures of arcs that begin along the normal [1/m], chosen: beyond 2 / m contacts slide off.
CURVATURES = (-2.0, -1.0, 1.0, 2.0)
# Driven lengths at which the effect is kept [m], chosen: linear interpolation between them is
# below 1 mm off; a metre is as far as a push stays predictable without steering.
LENGTHS = (0.0, 0.003, 0.006, 0.01, 0.015, 0.022, 0.032, 0.045, 0.065, 0.09, 0.12, 0.16, 0.21,
           0.28, 0.37, 0.48, 0.62, 0.8, 1.0)
# Speed of the simulated robot [m/s]: that of a slow push, so that inertia hardly counts.
SPEED = 0.1
# Longest steps in driven length [m]: up to the first length they are short, as contacts settle
# there, further on longer. Measured against steps of 0.3 mm: see test_table.
FINE_STEP = 1.5e-3
FINE_LENGTH = 0.1
COARSE_STEP = 4e-3
# Speed below which support friction turns viscous [m/s], as in the simulated plant.
SMOOTHING = 1e-5
# Samples of friction, chosen: every support up to 40 % more or less than stated, the contact
# 40 % less to 20 % more.
COMMON_SAMPLES = 15
SUPPORT_VARIATION = 0.4
CONTACT_RANGE = (0.6, 1.2)
# Samples that matter once a slippery contact has been learned: as fractions of the estimated
# contact friction.
SLIPPERY_SAMPLES = 8
SLIPPERY_RANGE = (0.0, 0.6)
# Samples about friction that has been learned, chosen: every support up to 4 % more or less, which
# moves the centre of friction by millimetres, and the contact by so much.
LEARNED_SAMPLES = 8
LEARNED_SUPPORT_VARIATION = 0.04
LEARNED_CONTACT_VARIATION = 0.03


class FrictionSamples(NamedTuple):
    """
    Samples of friction; sample 0 is what the object states, the others are drawn about it.

    :param support_factors: factors on the friction of each support, shape (K, supports).
    :param contact_frictions: coefficients of contact friction, shape (K,).
    :param centers: centres of friction in the object frame, shape (K, 2) [m].
    """

    support_factors: FloatArray
    contact_frictions: FloatArray
    centers: FloatArray


@dataclasses.dataclass(frozen=True, eq=False)
class PrimitiveTable:
    """
    Effect of all primitives of an object; arrays are read-only.

    :param face_points: where pushes may begin, ``FacePoint`` in order.
    :param point_indices: index of the point of each primitive, shape (n,).
    :param faces: face of that point, shape (n,).
    :param approach_angles: from the inward normal to the first direction of motion,
        counter-clockwise, shape (n,) [rad].
    :param curvatures: of the robot's path, left positive, shape (n,) [1/m].
    :param starts: robot centre at the first contact and direction of motion (x, y, phi) in the
        object frame, shape (n, 3).
    :param lengths: driven lengths, increasing from 0, shape (L,) [m].
    :param displacements: pose (x, y, theta) of the object frame after driving each length, in the
        frame at the start, angle unwrapped, shape (n, K, L, 3).
    :param friction_samples: the ``FrictionSamples``.
    :param radius: of a disc, 0 for a polygon [m].
    """

    face_points: tuple[FacePoint, ...]
    point_indices: IntArray
    faces: IntArray
    approach_angles: FloatArray
    curvatures: FloatArray
    starts: FloatArray
    lengths: FloatArray
    displacements: FloatArray
    friction_samples: FrictionSamples
    radius: float

    def __post_init__(self) -> None:
        """Freeze the arrays."""
        arrays = [getattr(self, field.name) for field in dataclasses.fields(self)]
        for array in (*arrays, *self.friction_samples):
            if isinstance(array, np.ndarray):
                array.setflags(write=False)

    @property
    def face_count(self) -> int:
        """Number of faces that are pushed at."""
        return self.face_points[-1].face + 1

    @property
    def is_curved(self) -> BoolArray:
        """Tell whether the outline is curved at each point, shape (points,)."""
        normals: dict[int, set[float]] = {}
        for point in self.face_points:
            normals.setdefault(point.face, set()).add(point.normal)
        return np.array([len(normals[point.face]) > 1 for point in self.face_points])


class PrimitiveKinds(NamedTuple):
    """
    Primitives by point, approach angle and curvature, one after the other.

    :param point_indices: shape (n,).
    :param approach_angles: shape (n,) [rad].
    :param curvatures: shape (n,) [1/m].
    """

    point_indices: IntArray
    approach_angles: FloatArray
    curvatures: FloatArray


def sample_friction(obj: PushedObject, seed: int = 0) -> FrictionSamples:
    """
    Sample friction about what the object states.

    :param seed: of the random numbers.
    """
    rng = np.random.default_rng(seed)
    count = 1 + COMMON_SAMPLES + SLIPPERY_SAMPLES
    factors = 1.0 + SUPPORT_VARIATION * rng.uniform(-1.0, 1.0, (count, len(obj.supports)))
    factors[0] = 1.0
    contact = np.concatenate([[1.0], rng.uniform(*CONTACT_RANGE, COMMON_SAMPLES),
                              np.linspace(*SLIPPERY_RANGE, SLIPPERY_SAMPLES)])
    return _friction_samples(obj, factors, contact * obj.contact_friction_coefficient)


def sample_learned_friction(obj: PushedObject, seed: int = 0) -> FrictionSamples:
    """
    Sample friction close to what the object states, as it has been learned.

    :param seed: of the random numbers.
    """
    rng = np.random.default_rng(seed)
    deviations = rng.uniform(-1.0, 1.0, (1 + LEARNED_SAMPLES, len(obj.supports) + 1))
    deviations[0] = 0.0
    contact = obj.contact_friction_coefficient + LEARNED_CONTACT_VARIATION * deviations[:, -1]
    return _friction_samples(obj, 1.0 + LEARNED_SUPPORT_VARIATION * deviations[:, :-1],
                             np.maximum(0.0, contact))


def _friction_samples(obj: PushedObject, factors: FloatArray,
                      contact: FloatArray) -> FrictionSamples:
    centers = [friction_center(_with_friction(obj, row, obj.contact_friction_coefficient))
               for row in factors]
    return FrictionSamples(factors, contact, np.array(centers))


def build_table(obj: PushedObject, robot_radius: float, *, seed: int = 0,
                lengths: Sequence[float] = LENGTHS,
                friction_samples: FrictionSamples | None = None,
                progress: Callable[[float], None] = lambda part: None) -> PrimitiveTable:
    """
    Simulate all primitives of an object.

    :param robot_radius: radius of the robot [m], finite.
    :param seed: of the samples of friction.
    :param lengths: driven lengths to keep, increasing from 0 [m].
    :param friction_samples: ``FrictionSamples`` in place of those of the seed.
    :param progress: called with the part that is done, from 0 to 1.
    :raises ValueError: where the radius is infinite or no face is long enough.
    """
    if not math.isfinite(robot_radius):
        raise ValueError(f'robot_radius: got {robot_radius}, expected a finite radius [m]')
    points = face_points(obj)
    kinds = _primitive_kinds(obj, len(points))
    point_of = [points[index] for index in kinds.point_indices.tolist()]
    starts = np.array([_start(point, angle, robot_radius)
                       for point, angle in zip(point_of, kinds.approach_angles.tolist())])
    samples = friction_samples or sample_friction(obj, seed)
    robot = RoundRobot(radius=robot_radius, time_constant=0.0)
    bodies = [_with_friction(obj, factors, friction) for factors, friction
              in zip(samples.support_factors, samples.contact_frictions.tolist())]
    displacements = np.zeros((len(starts), len(bodies), len(lengths), 3))
    worlds = Worlds(
        states=np.zeros((len(bodies), STATE_SIZE)),
        bodies=np.array([body_values(body, robot, SMOOTHING) for body in bodies]),
        supports=np.array([support_rows(body, body.capacities, [1.0] * len(body.supports))
                           for body in bodies]),
        outline=np.array(obj.outline or NO_OUTLINE, dtype=float),
        floor=np.zeros((0, PATCH_SIZE)),
        forces=np.zeros(2 * len(obj.supports)),
        drive=np.array(drive_values(robot)),
        command=np.zeros(3),
        walls=NO_WALLS,
        touches=np.zeros((0, TOUCH_SIZE)))
    driven_lengths = np.array(lengths, dtype=float)
    # One by one: a signal is noticed between two calls.
    rows_to_do = zip(starts, kinds.curvatures.tolist(), displacements)
    for count, (start, curvature, rows) in enumerate(rows_to_do, 1):
        _simulate(start, curvature, worlds, driven_lengths, rows)
        progress(count / len(starts))
    return PrimitiveTable(
        points, kinds.point_indices, np.array([point.face for point in point_of]),
        kinds.approach_angles, kinds.curvatures, starts, driven_lengths, displacements, samples,
        obj.radius)


def _primitive_kinds(obj: PushedObject, point_count: int) -> PrimitiveKinds:
    kinds = [(approach_angle, 0.0) for approach_angle in APPROACH_ANGLES]
    if obj.radius == 0.0:
        kinds += [(0.0, curvature) for curvature in CURVATURES]
    rows = [(index, *kind) for index in range(point_count) for kind in kinds]
    point_indices, approach_angles, curvatures = zip(*rows)
    return PrimitiveKinds(np.array(point_indices), np.array(approach_angles), np.array(curvatures))


def _start(point: FacePoint, approach_angle: float, radius: float) -> tuple[float, float, float]:
    """Return the robot centre at the first contact and direction of motion, object frame."""
    (x, y), normal = point.position, point.normal
    return (x - radius * math.cos(normal), y - radius * math.sin(normal),
            math.remainder(normal + approach_angle, 2.0 * math.pi))


def _with_friction(obj: PushedObject, factors: FloatArray, friction: float) -> PushedObject:
    supports = tuple(
        dataclasses.replace(support,
                            friction_coefficient=support.friction_coefficient * float(factor))
        for support, factor in zip(obj.supports, factors))
    return dataclasses.replace(obj, supports=supports, contact_friction_coefficient=friction)


@compiled
def _simulate(start: Any, curvature: float, worlds: Worlds, lengths: Any,
              displacements: Any) -> None:
    """
    Simulate a primitive under every sample of friction.

    :param start: robot centre and direction of motion (x, y, phi), object frame.
    :param curvature: of the robot's path [1/m].
    :param worlds: one for each sample; their states are written.
    :param lengths: driven lengths [m], shape (L,).
    :param displacements: shape (K, L, 3), is written.
    """
    for k in range(worlds.states.shape[0]):
        _simulate_one(start, curvature, member_world(worlds, k, worlds.states[k]), lengths,
                      displacements[k])


@compiled
def _simulate_one(start: Any, curvature: float, world: World, lengths: Any,
                  displacements: Any) -> None:
    state, body, command = world.state, world.body, world.command
    com_x, com_y = body[COM_X], body[COM_Y]
    for i in range(state.shape[0]):
        state[i] = 0.0
    state[X], state[Y] = com_x, com_y
    state[ROBOT_X], state[ROBOT_Y], state[ROBOT_THETA] = start[0], start[1], start[2]
    state[ROBOT_V_X] = SPEED
    command[0], command[1], command[2] = SPEED, 0.0, curvature * SPEED
    state[ROBOT_OMEGA] = command[2]
    driven = 0.0
    for i in range(1, lengths.shape[0]):
        distance = lengths[i] - driven
        longest = FINE_STEP if driven < FINE_LENGTH else COARSE_STEP
        advance(world, distance / SPEED, longest / SPEED)
        driven = lengths[i]
        c, s = math.cos(state[THETA]), math.sin(state[THETA])
        displacements[i, 0] = state[X] - c * com_x + s * com_y
        displacements[i, 1] = state[Y] - s * com_x - c * com_y
        displacements[i, 2] = state[THETA]
