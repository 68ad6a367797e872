"""
Cases of a varied push between their columns and the arrays that compiled code runs on.

Every number comes about by the same operations, in the same order, as for a ``Plant`` of its own
(``push_dynamics.encoding``), so that it is the same to the bit; a case is refused exactly where
``VariedPush.run`` raises an error. Sines and cosines are those of Python, as numpy has its own.
"""

import dataclasses
import math
from typing import NamedTuple

import numpy as np
from push_dynamics import layout
from push_dynamics.actuation import limit_command
from push_dynamics.cases import CaseArrays, CaseEnd, write_distances
from push_dynamics.encoding import (
    body_numbers, drive_numbers, MAX_OVERLAP, NO_OUTLINE, resolve_overlap, support_rows,
)
from push_dynamics.floor import floor_rows, FloorPatch
from push_dynamics.step import ROUNDING
from push_model.contact import robot_gap
from push_model.friction import load_gradients, tipping_height
from push_model.geometry import BoolArray, FloatArray, Pose
from push_model.parameters import GRAVITY, plate_inertia, PushedObject, RoundRobot
from push_model.quantity import allowed
from push_model.signals import Twist
from push_scenario.batch.varied_push import (
    CaseColumns, CENTER_OF_MASS, COMMAND_SIZE, FLOOR, FRICTION_FACTORS, OBJECT, OBJECT_POSE,
    PATCH_FIELDS, ROBOT, ROBOT_POSE, SEGMENTS, VariedPush,
)

# Where the numbers of the columns stand in those of a body and a drive.
BODY_PLACES = {'object.mass': layout.MASS, 'object.inertia': layout.INERTIA,
               'object.contact_friction_coefficient': layout.CONTACT_FRICTION,
               'object.contact_height': layout.CONTACT_HEIGHT,
               'object.center_of_mass_height': layout.CENTER_OF_MASS_HEIGHT,
               'robot.radius': layout.ROBOT_RADIUS}
DRIVE_PLACES = {'robot.time_constant': layout.TIME_CONSTANT,
                'robot.max_acceleration': layout.MAX_ACCELERATION,
                'robot.max_yaw_acceleration': layout.MAX_YAW_ACCELERATION}
# Fraction of the greatest speed within which a command may be limited, by rounding.
LIMIT_ROUNDING = 1e-9


class Cases(NamedTuple):
    """
    Cases of a push, ready to run.

    :param arrays: ``CaseArrays``.
    :param centers: mass centres in the object frame, shape (n, 2) [m].
    """

    arrays: CaseArrays
    centers: FloatArray


class _Stand(NamedTuple):
    """
    How objects stand on their supports, for each case or, with one row, for all.

    :param fractions: of the weight, shape (n, k).
    :param gradients: of these by the centre of pressure, shape (n, k, 2) [1/m].
    :param tipping_heights: shape (n,), infinite where no heights are given [m].
    :param stands: whether the supports balance the object, shape (n,).
    """

    fractions: FloatArray
    gradients: FloatArray
    tipping_heights: FloatArray
    stands: BoolArray


class _Segments(NamedTuple):
    """
    Commands of the cases.

    :param durations: shape (n, m) [s].
    :param requested: shape (n, m, 3).
    :param commands: the same within the limits of the drive.
    :param factors: shape (n, m, k).
    """

    durations: FloatArray
    requested: FloatArray
    commands: FloatArray
    factors: FloatArray


class CaseEncoder:
    """
    Makes arrays of columns, and notes which cases are refused.

    :param push: the ``VariedPush``.
    :param columns: as ``VariedPush.columns`` returns them.
    """

    def __init__(self, push: VariedPush, columns: CaseColumns) -> None:
        self._push = push
        self._columns = columns
        self._count = len(next(iter(columns.values())))
        self._is_allowed = np.ones(self._count, dtype=bool)

    def encode(self) -> Cases:
        """Make the arrays of all cases."""
        # What is refused may be infinite or no number at all.
        with np.errstate(invalid='ignore', over='ignore'):
            return self._encode()

    def _encode(self) -> Cases:
        push, count = self._push, self._count
        self._check_fields()
        centers = self._of_push(CENTER_OF_MASS, push.object.center_of_mass)
        bodies = self._bodies(centers)
        supports, capacities = self._supports(bodies, centers)
        segments = self._segments()
        floors = self._floors()
        states = self._states(centers, bodies[:, layout.ROBOT_RADIUS])
        arrays = CaseArrays(
            states=states, bodies=bodies, supports=supports, capacities=capacities,
            outline=np.array(push.object.outline or NO_OUTLINE), floors=floors,
            drives=self._drives(), durations=segments.durations, requested=segments.requested,
            commands=segments.commands, factors=segments.factors,
            ends=np.where(self._is_allowed, CaseEnd.NOT_RUN, CaseEnd.REFUSED).astype(np.uint8),
            times=np.zeros(count))
        return Cases(arrays, centers)

    def _refuse_unless(self, is_allowed: BoolArray) -> None:
        """Note what is allowed of each case; all of what one has must be."""
        self._is_allowed &= is_allowed.reshape(self._count, -1).all(axis=1)

    def _check_fields(self) -> None:
        for name, column in self._columns.items():
            for prefix, kind in ((OBJECT, PushedObject), (ROBOT, RoundRobot)):
                if name.startswith(prefix):
                    self._refuse_unless(allowed(kind, name.removeprefix(prefix), column))

    def _of_push(self, name: str, value: tuple[float, ...]) -> FloatArray:
        """Return a column, or what the push has in every row."""
        if name in self._columns:
            return self._columns[name]
        return np.tile(np.array(value, dtype=float), (self._count, 1))

    def _bodies(self, centers: FloatArray) -> FloatArray:
        push = self._push
        bodies = np.tile(body_numbers(push.object, push.robot, push.smoothing), (self._count, 1))
        bodies[:, [layout.COM_X, layout.COM_Y]] = centers
        for name, place in BODY_PLACES.items():
            if name in self._columns:
                bodies[:, place] = self._columns[name]
        inertia, masses = bodies[:, layout.INERTIA], bodies[:, layout.MASS]
        is_plate = inertia == 0.0
        inertia[is_plate] = [plate_inertia(mass, push.object.outline, push.object.radius)
                             for mass in masses[is_plate].tolist()]
        return bodies

    def _drives(self) -> FloatArray:
        drives = np.tile(drive_numbers(self._push.robot), (self._count, 1))
        for name, place in DRIVE_PLACES.items():
            if name in self._columns:
                drives[:, place] = self._columns[name]
        return drives

    def _supports(self, bodies: FloatArray, centers: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return supports, and their friction capacities under the loads at rest."""
        obj = self._push.object
        factors = self._columns.get(FRICTION_FACTORS)
        supports = np.tile(support_rows(obj, obj.capacities, [1.0] * len(obj.supports)),
                           (self._count, 1, 1))
        stand = self._stand(bodies)
        loads = (bodies[:, layout.MASS] * GRAVITY)[:, None] * stand.fractions
        capacities = np.array([support.friction_coefficient for support in obj.supports]) * loads
        supports[:, :, layout.SUPPORT_X] = np.array([s.x for s in obj.supports]) - centers[:, :1]
        supports[:, :, layout.SUPPORT_Y] = np.array([s.y for s in obj.supports]) - centers[:, 1:]
        plain = capacities
        if factors is not None:
            self._refuse_unless((factors >= 0.0) & np.isfinite(factors))
            plain = factors * capacities
        supports[:, :, layout.CAPACITY] = plain
        supports[:, :, layout.PLAIN_CAPACITY] = plain
        # Added up as Python does it, which numpy does in another order.
        weights = np.array([sum(row) for row in loads.tolist()])
        supports[:, :, layout.LOAD_FRACTION] = loads / weights[:, None]
        supports[:, :, layout.GRADIENT_X:] = stand.gradients
        return supports, capacities

    def _stand(self, bodies: FloatArray) -> _Stand:
        """Find out how the objects stand; refuse those that would tip."""
        obj = self._push.object
        heights = bodies[:, [layout.CONTACT_HEIGHT, layout.CENTER_OF_MASS_HEIGHT]]
        has_any_height = bool(np.any(heights > 0.0))
        objects: list[PushedObject | None] = [obj]
        if CENTER_OF_MASS in self._columns:
            objects = [_with_center(obj, center) for center in
                       self._columns[CENTER_OF_MASS].tolist()]
        stand = _stand_of(objects, len(obj.supports), has_any_height)
        tips = (heights[:, 0] >= stand.tipping_heights) & (heights > 0.0).any(axis=1)
        self._refuse_unless(~tips & stand.stands)
        return stand

    def _segments(self) -> _Segments:
        supports = len(self._push.object.supports)
        rows = self._columns.get(SEGMENTS)
        if rows is None:
            rows = np.tile(self._push.segment_array(), (self._count, 1, 1))
        given = np.full((*rows.shape[:2], COMMAND_SIZE + supports), math.nan)
        given[:, :, :rows.shape[2]] = rows
        durations, requested = given[:, :, 0], given[:, :, 1:COMMAND_SIZE]
        factors = given[:, :, COMMAND_SIZE:]
        is_possible = (durations > 0.0) & np.isfinite(durations)
        is_possible &= np.isfinite(requested).all(axis=2)
        if self._push.robot.drive == 'differential':
            is_possible &= requested[:, :, 1] == 0.0
        is_possible &= (np.isnan(factors).all(axis=2)
                        | ((factors >= 0.0) & np.isfinite(factors)).all(axis=2))
        self._refuse_unless(is_possible | (durations == 0.0))
        return _Segments(np.array(durations), np.array(requested),
                         self._limited(requested, durations), np.array(factors))

    def _limited(self, requested: FloatArray, durations: FloatArray) -> FloatArray:
        """Bring commands within the limits of the drives; few of them need that."""
        robot, columns = self._push.robot, self._columns
        speed = columns.get('robot.max_speed', np.full(self._count, robot.max_speed))
        yaw_rate = columns.get('robot.max_yaw_rate', np.full(self._count, robot.max_yaw_rate))
        squared = requested[:, :, 0] ** 2 + requested[:, :, 1] ** 2
        is_fast = squared > ((1.0 - LIMIT_ROUNDING) * speed[:, None]) ** 2
        is_fast |= np.abs(requested[:, :, 2]) > yaw_rate[:, None]
        is_fast &= self._is_allowed[:, None] & (durations > 0.0)
        commands = np.array(requested)
        for case, segment in zip(*np.nonzero(is_fast)):
            limited = dataclasses.replace(robot, max_speed=speed[case],
                                          max_yaw_rate=yaw_rate[case])
            commands[case, segment] = limit_command(limited, Twist(*requested[case, segment]))
        return commands

    def _floors(self) -> FloatArray:
        if FLOOR not in self._columns:
            rows = np.reshape(floor_rows(self._push.floor), (-1, layout.PATCH_SIZE))
            return np.tile(rows, (self._count, 1, 1))
        patches = self._columns[FLOOR]
        fields = {name: patches[:, :, i] for i, name in enumerate(PATCH_FIELDS)}
        for name, values in fields.items():
            self._refuse_unless(allowed(FloorPatch, name, values))
        cosine, sine = _rotation(fields['theta'])
        return np.stack([fields['x'], fields['y'], cosine, sine, 0.5 * fields['length'],
                         0.5 * fields['width'], fields['factor'], fields['edge']], axis=2)

    def _states(self, centers: FloatArray, radii: FloatArray) -> FloatArray:
        push = self._push
        object_poses = self._of_push(OBJECT_POSE, push.object_pose)
        robot_poses = np.array(self._of_push(ROBOT_POSE, push.robot_pose))
        self._refuse_unless(np.isfinite(object_poses) & np.isfinite(robot_poses))
        gaps = self._gaps(object_poses, robot_poses, radii)
        self._refuse_unless(~(gaps < -MAX_OVERLAP))
        for case in np.flatnonzero((gaps < -ROUNDING) & self._is_allowed):
            robot = dataclasses.replace(push.robot, radius=radii[case])
            robot_poses[case] = resolve_overlap(push.object, robot, _pose(object_poses[case]),
                                                _pose(robot_poses[case]))
        states = np.zeros((self._count, layout.STATE_SIZE))
        states[:, [layout.X, layout.Y]] = object_poses[:, :2] + _rotated(object_poses[:, 2],
                                                                         centers)
        states[:, layout.THETA] = object_poses[:, 2]
        states[:, layout.ROBOT_X:layout.ROBOT_THETA + 1] = robot_poses
        return states

    def _gaps(self, object_poses: FloatArray, robot_poses: FloatArray,
              radii: FloatArray) -> FloatArray:
        """Compute the gaps as ``robot_gap`` does; 0 for cases that are refused already [m]."""
        obj = self._push.object
        gaps = np.zeros(self._count)
        if obj.outline and np.isfinite(radii).all():
            cosine, sine = _rotation(object_poses[:, 2])
            (x, y, _), (robot_x, robot_y, _) = object_poses.T, robot_poses.T
            write_distances(
                np.array(obj.outline),
                (-cosine * x - sine * y) + (cosine * robot_x + sine * robot_y),
                (sine * x - cosine * y) + (-sine * robot_x + cosine * robot_y), gaps)
            return gaps - radii
        for case in np.flatnonzero(self._is_allowed):
            gaps[case] = robot_gap(obj, _pose(object_poses[case]), _pose(robot_poses[case]),
                                   float(radii[case]))
        return gaps


def object_poses_of(states: FloatArray, centers: FloatArray) -> FloatArray:
    """
    Decode the poses of the object frames in the world; angles are not wrapped.

    :param states: shape (n, 28).
    :param centers: mass centres in the object frame, shape (n, 2) [m].
    :return: shape (n, 3) [m, m, rad].
    """
    back = _rotated(states[:, layout.THETA], centers)
    return np.column_stack([states[:, [layout.X, layout.Y]] - back, states[:, layout.THETA]])


def object_twists_of(states: FloatArray, centers: FloatArray) -> FloatArray:
    """
    Decode the velocities of the object frames' origins, world axes, and the yaw rates.

    :param states: shape (n, 28).
    :param centers: mass centres in the object frame, shape (n, 2) [m].
    :return: shape (n, 3) [m/s, m/s, rad/s].
    """
    x, y = _rotated(states[:, layout.THETA], centers).T
    omega = states[:, layout.OMEGA]
    return np.column_stack([states[:, layout.V_X] + omega * y, states[:, layout.V_Y] - omega * x,
                            omega])


def _rotated(angles: FloatArray, vectors: FloatArray) -> FloatArray:
    """Rotate vectors, shape (n, 2)."""
    cosine, sine = _rotation(angles)
    return np.column_stack([cosine * vectors[:, 0] - sine * vectors[:, 1],
                            sine * vectors[:, 0] + cosine * vectors[:, 1]])


def _rotation(angles: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Compute cosine and sine; those of 0 where an angle is not finite."""
    finite = np.where(np.isfinite(angles), angles, 0.0)
    values = finite.ravel().tolist()
    return (np.array(list(map(math.cos, values))).reshape(angles.shape),
            np.array(list(map(math.sin, values))).reshape(angles.shape))


def _pose(row: FloatArray) -> Pose:
    return Pose(*row.tolist())


def _with_center(obj: PushedObject, center: list[float]) -> PushedObject | None:
    """Put the mass centre elsewhere; None where the supports do not balance it."""
    try:
        return dataclasses.replace(obj, center_of_mass=tuple(center))
    except ValueError:
        return None


def _stand_of(objects: list[PushedObject | None], supports: int, has_any_height: bool) -> _Stand:
    """List how objects stand; None, which does not, has numbers too."""
    nothing = [1.0] * supports, [(0.0, 0.0)] * supports, math.inf
    rows = [nothing if obj is None else
            (obj.weight_fractions, load_gradients(obj),
             tipping_height(obj) if has_any_height else math.inf) for obj in objects]
    fractions, gradients, heights = zip(*rows)
    return _Stand(np.array(fractions), np.array(gradients), np.array(heights),
                  np.array([obj is not None for obj in objects]))
