"""
Variations of one plain push: parameters, friction, start and commands, as columns of numbers.

A case is one variation. What differs from case to case is a column, named as in ``OBJECT_COLUMNS``
and the constants below it; what no column names is that of the push.
"""

from collections.abc import Iterator, Mapping, Sequence
import dataclasses
import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from push_dynamics.floor import FloorPatch
from push_model.geometry import FloatArray, Pose
from push_model.parameters import PushedObject, RoundRobot
from push_model.signals import Twist
from push_sim_node.plant import Plant

OBJECT, ROBOT = 'object.', 'robot.'
# Fields of ``PushedObject`` and ``RoundRobot`` that may differ.
OBJECT_COLUMNS = tuple(OBJECT + name for name in (
    'mass', 'inertia', 'contact_friction_coefficient', 'contact_height', 'center_of_mass_height',
    'center_of_mass'))
ROBOT_COLUMNS = tuple(ROBOT + name for name in (
    'radius', 'max_speed', 'max_yaw_rate', 'max_acceleration', 'max_yaw_acceleration',
    'time_constant'))
CENTER_OF_MASS = OBJECT + 'center_of_mass'
OBJECT_POSE, ROBOT_POSE = 'object_pose', 'robot_pose'
FRICTION_FACTORS, SEGMENTS, FLOOR = 'friction_factors', 'segments', 'floor'
COLUMNS = (*OBJECT_COLUMNS, *ROBOT_COLUMNS, OBJECT_POSE, ROBOT_POSE, FRICTION_FACTORS, SEGMENTS,
           FLOOR)
PATCH_FIELDS = tuple(field.name for field in dataclasses.fields(FloorPatch))
# Numbers of a segment without friction factors: duration and command.
COMMAND_SIZE = 4
# Length of an axis that a column may choose.
ANY = -1

Triple = tuple[float, float, float]
# Numbers of one case by the names of their columns.
CaseValues = Mapping[str, ArrayLike]
# The same of many cases: the first axis counts the cases.
CaseColumns = dict[str, FloatArray]


class Segment(NamedTuple):
    """
    A command that stands for a while.

    :param duration: how long [s].
    :param command: in the robot's own axes.
    :param friction_factors: on each support from now on; none to leave friction as it is.
    """

    duration: float
    command: Twist
    friction_factors: tuple[float, ...]


@dataclasses.dataclass(frozen=True)
class VariedPush:
    """
    A push at given commands, and what a case of it may change.

    Columns are fields of the object (``object.mass``, ...) and the robot (``robot.radius``, ...);
    ``object_pose`` and ``robot_pose``, 3 numbers each; ``friction_factors``, one for each support,
    from the start; ``segments``, of any number; ``floor``, patches of any number with the fields
    of ``FloorPatch``.

    :param object: the ``PushedObject``.
    :param robot: the ``RoundRobot``.
    :param object_pose: (x, y, theta) of the object [m, m, rad].
    :param robot_pose: (x, y, theta) of the robot [m, m, rad].
    :param segments: commands (duration [s], v_x [m/s], v_y [m/s], omega [rad/s]), in the robot's
        own axes, one after the other; further numbers are friction factors, one for each
        support, from then on. A duration of 0 leaves a segment out, factors of nan friction as it
        is.
    :param step: longest step [s].
    :param smoothing: speed below which support friction turns viscous [m/s].
    :param floor: ``FloorPatch`` sequence.
    :param lost_gap: a case ends early once the robot, having touched the object, is farther from
        it than this and the object rests [m]; infinite: never.
    """

    object: PushedObject
    robot: RoundRobot
    object_pose: Triple
    robot_pose: Triple
    segments: tuple[tuple[float, ...], ...]
    step: float = 2e-3
    smoothing: float = 1e-5
    floor: tuple[FloorPatch, ...] = ()
    lost_gap: float = math.inf

    def columns(self, values: CaseValues) -> CaseColumns:
        """
        Bring columns into the shape of arrays, one row for each case; values are not judged.

        :param values: one column at least.
        :raises ValueError: for an unknown column, and for shapes that do not fit.
        """
        unknown = values.keys() - set(COLUMNS)
        if unknown or not values:
            raise ValueError(f'columns: got {sorted(unknown)}, expected some of '
                             + ', '.join(COLUMNS))
        found = {name: _numbers(name, column) for name, column in values.items()}
        count = max(column.shape[0] if column.ndim else 0 for column in found.values())
        for name, column in found.items():
            shapes = [(count, *shape) for shape in self._shapes(name)]
            if not any(_fits(column.shape, shape) for shape in shapes):
                expected = ' or '.join(str(shape).replace(str(ANY), 'any') for shape in shapes)
                raise ValueError(f'{name}: got shape {column.shape}, expected {expected}')
        return found

    def plant(self, values: CaseValues) -> Plant:
        """
        Make the plant of one case, at its start.

        :param values: its numbers by column, without an axis for cases.
        :raises ValueError: where a value does not fit.
        """
        case = self._case(values)
        floor = self.floor
        if FLOOR in case:
            floor = tuple(FloorPatch(*patch) for patch in case[FLOOR].tolist())
        plant = Plant(dataclasses.replace(self.object, **_fields(case, OBJECT)),
                      dataclasses.replace(self.robot, **_fields(case, ROBOT)),
                      Pose(*case.get(OBJECT_POSE, np.array(self.object_pose)).tolist()),
                      Pose(*case.get(ROBOT_POSE, np.array(self.robot_pose)).tolist()),
                      self.step, self.smoothing, floor=floor)
        if FRICTION_FACTORS in case:
            _set_factors(plant, case[FRICTION_FACTORS].tolist())
        return plant

    def driven_segments(self, values: CaseValues) -> Iterator[Segment]:
        """
        Yield the segments of one case that are driven.

        :param values: as for ``plant``.
        """
        case = self._case(values)
        rows = case[SEGMENTS] if SEGMENTS in case else self.segment_array()
        for duration, v_x, v_y, omega, *factors in rows.tolist():
            if duration != 0.0:
                is_same = all(map(math.isnan, factors))
                yield Segment(duration, Twist(v_x, v_y, omega), () if is_same else tuple(factors))

    def run(self, values: CaseValues) -> Plant:
        """
        Run one case to the end of its segments, on a plant of its own.

        :param values: as for ``plant``.
        :return: the ``Plant`` at the end.
        :raises ValueError: where a value does not fit.
        """
        plant = self.plant(values)
        for segment in self.driven_segments(values):
            if segment.friction_factors:
                _set_factors(plant, segment.friction_factors)
            plant.advance(segment.duration, segment.command)
        return plant

    def segment_array(self) -> FloatArray:
        """
        Lay the segments of the push out in rows, shape (m, 4 + number of supports).

        :raises ValueError: where one has another number of friction factors than supports.
        """
        count = len(self.object.supports)
        rows = np.full((len(self.segments), COMMAND_SIZE + count), math.nan)
        for row, segment in zip(rows, self.segments):
            if len(segment) not in (COMMAND_SIZE, len(row)):
                raise ValueError(f'segments: got {len(segment)} numbers, expected {COMMAND_SIZE}, '
                                 f'or {len(row)} with friction factors of {count} supports')
            row[:len(segment)] = segment
        return rows

    def _case(self, values: CaseValues) -> CaseColumns:
        """Bring the values of one case into the shape of arrays."""
        if not values:
            return {}
        columns = self.columns({name: _numbers(name, value)[None]
                                for name, value in values.items()})
        return {name: column[0] for name, column in columns.items()}

    def _shapes(self, name: str) -> list[tuple[int, ...]]:
        """List the shapes that the numbers of one case may have."""
        supports = len(self.object.supports)
        if name == SEGMENTS:
            return [(ANY, COMMAND_SIZE), (ANY, COMMAND_SIZE + supports)]
        return [{CENTER_OF_MASS: (2,), OBJECT_POSE: (3,), ROBOT_POSE: (3,),
                 FRICTION_FACTORS: (supports,), FLOOR: (ANY, len(PATCH_FIELDS))}.get(name, ())]


def _numbers(name: str, values: ArrayLike) -> FloatArray:
    try:
        return np.asarray(values, dtype=float, order='C')
    except (TypeError, ValueError) as error:
        raise ValueError(f'{name}: got {values!r}, expected numbers ({error})') from error


def _fits(shape: tuple[int, ...], expected: tuple[int, ...]) -> bool:
    return len(shape) == len(expected) and all(
        length == size or size == ANY for length, size in zip(shape, expected))


def _fields(case: CaseColumns, prefix: str) -> dict[str, Any]:
    """List the fields of object or robot that a case changes."""
    return {name.removeprefix(prefix): value.tolist() for name, value in case.items()
            if name.startswith(prefix)}


def _set_factors(plant: Plant, factors: Sequence[float]) -> None:
    if not all(0.0 <= factor < math.inf for factor in factors):
        raise ValueError(f'friction_factors: got {factors!r}, expected numbers of at least 0')
    plant.set_friction_factors(factors)
