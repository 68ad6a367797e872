"""
Primitives of an object, made once and kept on disk.

They lie in the user's cache, beside the machine code of the dynamics, in a file named after a
digest of everything that they depend on: shape, supports, robot, settings and the source text.
"""

from collections.abc import Callable
import dataclasses
import functools
import hashlib
import io
import pathlib
from typing import Any, TypeVar
import zipfile

import numpy as np
from push_dynamics.compiled import cache_directory
from push_model.geometry import FloatArray
from push_model.parameters import PushedObject, RoundRobot
from push_primitives import (
    cost_settings, cost_to_go as cost_to_go_module, face_points, placement_errors, table as
    table_module, value_iteration,
)
from push_primitives.cost_settings import CostSettings
from push_primitives.cost_to_go import CostToGo
from push_primitives.face_points import FacePoint
from push_primitives.placement_errors import (
    LOCALIZED, PlacementDeviations, UNSURE, with_placement_errors)
from push_primitives.simplification import simplified_object
from push_primitives.slippery_disc import rotated, slippery_disc, SlipperyDisc
from push_primitives.table import (
    build_table, FrictionSamples, PrimitiveTable, sample_learned_friction,
)
from push_primitives.value_iteration import solve_cost_to_go
from push_primitives.weights import FrictionBelief

Stored = TypeVar('Stored')
# Friction of the object that tables are made for: theirs must not depend on what a robot has
# learned of friction so far, lest they be made anew with every push. All supports are alike, and
# the contact is that of rubber bumpers; samples lie about both, and weights choose among them.
REFERENCE_SUPPORT_FRICTION = 0.35
REFERENCE_CONTACT_FRICTION = 0.5
# Mass that tables are made for [kg]; chosen: any will do.
REFERENCE_MASS = 3.0
# Share of the table in the time that table and cost-to-go take together; measured: 0.2 to 0.33.
TABLE_SHARE = 0.3
# Modules whose text decides what is in the files, besides those of the dynamics.
SOURCES = (face_points, table_module, placement_errors, cost_settings, cost_to_go_module,
           value_iteration)
# Arrays of a table that are kept as they are.
ARRAYS = ('point_indices', 'faces', 'approach_angles', 'curvatures', 'starts', 'lengths',
          'displacements')


@dataclasses.dataclass(frozen=True, eq=False)
class PushPrimitives:
    """
    Knowledge of a planner and a controller about the pushes of an object.

    :param table: ``PrimitiveTable``.
    :param cost_to_go: ``CostToGo``.
    :param settings: the ``CostSettings`` of both.
    :param is_learned: whether they are made for friction that was learned.
    """

    table: PrimitiveTable
    cost_to_go: CostToGo
    settings: CostSettings
    is_learned: bool = False

    @functools.cached_property
    def localized_displacements(self) -> FloatArray:
        """Displacements with errors of placement of a localized robot, shape (n, K, L, 3)."""
        return self._with_errors(LOCALIZED)

    @functools.cached_property
    def unsure_displacements(self) -> FloatArray:
        """Displacements by a robot that is not sure of its place, shape (n, K, L, 3)."""
        return self._with_errors(UNSURE)

    def _with_errors(self, deviations: PlacementDeviations) -> FloatArray:
        displacements = np.ascontiguousarray(with_placement_errors(self.table, deviations))
        displacements.setflags(write=False)
        return displacements


def reference_object(obj: PushedObject) -> PushedObject:
    """
    Replace what can be learned of an object by common values, and leave out what hardly matters.

    :param obj: the ``PushedObject``, with its friction as known by now.
    :return: ``PushedObject`` of the same shape, mass centre, radius of gyration and supports; a
        fine outline and many supports are simplified.
    """
    obj = simplified_object(obj)
    # Slow pushes know heights by mu z_C alone.
    ratio = float(f'{sum(obj.capacities) / sum(obj.loads) / REFERENCE_SUPPORT_FRICTION:.6g}')
    supports = tuple(dataclasses.replace(support,
                                         friction_coefficient=REFERENCE_SUPPORT_FRICTION)
                     for support in obj.supports)
    # Slow pushes do not depend on the mass, and rounded the ratio does not either.
    squared_radius = float(f'{obj.inertia / obj.mass:.6g}')
    return dataclasses.replace(obj, supports=supports, mass=REFERENCE_MASS,
                               inertia=REFERENCE_MASS * squared_radius,
                               contact_friction_coefficient=REFERENCE_CONTACT_FRICTION,
                               contact_height=ratio * obj.contact_height,
                               center_of_mass_height=ratio * obj.center_of_mass_height)


def load_primitives(obj: PushedObject, robot: RoundRobot,
                    settings: CostSettings | None = None,
                    belief: FrictionBelief | None = None) -> PushPrimitives:
    """
    Load the primitives of an object, or make them and keep them.

    :param obj: the ``PushedObject``; its friction does not matter.
    :param settings: ``CostSettings``, or None for those of the robot with the usual tolerances.
    :param belief: what was learned of friction: slippery discs have primitives of their own.
    :raises ValueError: where the robot is not round or no face of the object is long enough.
    """
    settings = settings or CostSettings(robot_speed=robot.max_speed, drive=robot.drive)
    reference = reference_object(obj)
    disc = None if belief is None else slippery_disc(reference, belief)
    if disc is None:
        return _load(reference, robot.radius, settings)
    return _load_slippery(disc, robot.radius, settings)


def are_stored(obj: PushedObject, robot: RoundRobot, settings: CostSettings) -> bool:
    """
    Tell whether ``load_primitives`` finds on disk what it needs for an object.

    :param settings: the ``CostSettings``.
    """
    folder = cache_directory()
    reference, radius = reference_object(obj), robot.radius
    names = _table_name(reference, radius), _cost_name(reference, radius, settings, False)
    return folder is not None and all((folder.path / name).exists() for name in names)


def store_primitives(obj: PushedObject, robot: RoundRobot, settings: CostSettings,
                     progress: Callable[[float], None] = lambda part: None) -> None:
    """
    Make the primitives of an object and keep them on disk, unless they are there.

    :param settings: the ``CostSettings``.
    :param progress: called with the part that is done, from 0 to 1.
    :raises ValueError: where the robot is not round or no face of the object is long enough.
    """
    reference = reference_object(obj)
    table = _stored_table(reference, robot.radius, lambda part: progress(TABLE_SHARE * part))
    _stored_cost_to_go(table, _cost_name(reference, robot.radius, settings, False), settings,
                       progress=lambda part: progress(TABLE_SHARE + (1.0 - TABLE_SHARE) * part))


def forget() -> None:
    """Drop what this process keeps in memory; files stay."""
    for cache in (_load, _load_slippery, _table, _cost_to_go):
        cache.cache_clear()


# Tens of megabytes each: a process has few objects at a time.
@functools.lru_cache(maxsize=8)
def _load(obj: PushedObject, radius: float, settings: CostSettings) -> PushPrimitives:
    return PushPrimitives(_table(obj, radius, False), _cost_to_go(obj, radius, settings, False),
                          settings)


@functools.lru_cache(maxsize=8)
def _load_slippery(disc: SlipperyDisc, radius: float, settings: CostSettings) -> PushPrimitives:
    cost_to_go = rotated(_cost_to_go(disc.ring, radius, settings, True), disc.direction)
    return PushPrimitives(_table(disc.obj, radius, True), cost_to_go, settings, is_learned=True)


@functools.lru_cache(maxsize=8)
def _table(obj: PushedObject, radius: float, is_learned: bool) -> PrimitiveTable:
    if is_learned:
        # A fraction of a second, and for the present task alone: not worth a file.
        return build_table(obj, radius, friction_samples=sample_learned_friction(obj))
    return _stored_table(obj, radius)


@functools.lru_cache(maxsize=8)
def _cost_to_go(obj: PushedObject, radius: float, settings: CostSettings,
                is_learned: bool) -> CostToGo:
    return _stored_cost_to_go(_table(obj, radius, is_learned),
                              _cost_name(obj, radius, settings, is_learned), settings, is_learned)


def _stored_table(obj: PushedObject, radius: float,
                  progress: Callable[[float], None] = lambda part: None) -> PrimitiveTable:
    return _stored(_table_name(obj, radius),
                   lambda: _table_arrays(build_table(obj, radius, progress=progress)),
                   _table_from)


def _stored_cost_to_go(table: PrimitiveTable, name: str, settings: CostSettings,
                       is_learned: bool = False,
                       progress: Callable[[float], None] = lambda part: None) -> CostToGo:
    def solve() -> dict[str, Any]:
        cost_to_go = solve_cost_to_go(table, settings, from_above=is_learned, progress=progress)
        return {'values': cost_to_go.values, 'distances': cost_to_go.distances,
                'headings': cost_to_go.headings}
    return _stored(name, solve, lambda arrays: _cost_to_go_from(arrays, table.face_count))


def _table_name(obj: PushedObject, radius: float) -> str:
    return _name('table', obj, radius)


def _cost_name(obj: PushedObject, radius: float, settings: CostSettings, is_learned: bool) -> str:
    return _name('cost', obj, radius, settings, is_learned)


def _table_arrays(table: PrimitiveTable) -> dict[str, Any]:
    points = [(point.face, *point.position, point.normal, point.offset)
              for point in table.face_points]
    return {'face_points': np.array(points), **{name: getattr(table, name) for name in ARRAYS},
            **table.friction_samples._asdict(), 'radius': np.array(table.radius)}


def _table_from(arrays: dict[str, Any]) -> PrimitiveTable:
    points = tuple(FacePoint(int(face), (x, y), normal, offset)
                   for face, x, y, normal, offset in arrays['face_points'].tolist())
    samples = FrictionSamples(*(arrays[name] for name in FrictionSamples._fields))
    kept = {name: arrays[name] for name in ARRAYS}
    count, lengths = kept['point_indices'].size, kept['lengths'].size
    shapes = {**{name: (count,) for name in ARRAYS}, 'starts': (count, 3), 'lengths': (lengths,),
              'displacements': (count, len(samples[0]), lengths, 3)}
    _check_shapes(kept, shapes)
    return PrimitiveTable(points, **kept, friction_samples=samples, radius=float(arrays['radius']))


def _cost_to_go_from(arrays: dict[str, Any], face_count: int) -> CostToGo:
    cost_to_go = CostToGo(**arrays)
    values, distances, headings = cost_to_go.grid
    bearings = values.shape[2] if values.ndim == 4 else 0
    _check_shapes({'values': values},
                  {'values': (face_count, distances.size, bearings, headings.size)})
    return cost_to_go


def _check_shapes(arrays: dict[str, Any], shapes: dict[str, tuple[int, ...]]) -> None:
    """
    Check the shapes of arrays.

    :raises ValueError: naming the one that has another.
    """
    for name, shape in shapes.items():
        if arrays[name].shape != shape:
            raise ValueError(f'{name}: got the shape {arrays[name].shape}, expected {shape}')


def _name(kind: str, *key: object) -> str:
    """Name the file of what depends on a key."""
    digest = hashlib.sha256(repr(key).encode() + _sources())
    return f'{kind}-{digest.hexdigest()[:24]}.npz'


@functools.lru_cache(maxsize=None)
def _sources() -> bytes:
    return b''.join(pathlib.Path(str(module.__file__)).read_bytes() for module in SOURCES)


def _stored(name: str, make: Callable[[], dict[str, Any]],
            use: Callable[[dict[str, Any]], Stored]) -> Stored:
    """
    Use arrays that are read, or that are made and written.

    :param use: raises ``KeyError``, ``TypeError`` or ``ValueError`` where it cannot: what has
        other names or shapes, as of another version, is made anew.
    """
    folder = cache_directory()
    if folder is None:
        return use(make())
    content = folder.read_or_make(name, lambda: _encoded(make()))
    try:
        return use(_decoded(content))
    except (KeyError, TypeError, ValueError, OSError, zipfile.BadZipFile):
        content = _encoded(make())
        folder.write(name, content)
        return use(_decoded(content))


def _decoded(content: bytes) -> dict[str, Any]:
    with np.load(io.BytesIO(content), allow_pickle=False) as data:
        return {name: data[name] for name in data.files}


def _encoded(arrays: dict[str, Any]) -> bytes:
    file = io.BytesIO()
    np.savez(file, **arrays)
    return file.getvalue()
