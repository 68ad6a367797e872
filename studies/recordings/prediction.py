"""Recorded pushes of a block, predicted by quasi-static model, plant and two plain models."""

import enum
import itertools
import math
from typing import NamedTuple, Sequence

import numpy as np
from push_control.identification.identification import (
    Identification, identify_together, PushedRecording,
)
from push_control.identification.recorded_push import stacked
from push_model.analysis.slow_push import integrate_slow_pushes, LoadedSupports, Shape
from push_model.friction import ellipsoid_c_squared, friction_center
from push_model.geometry import FloatArray, Pose, wrap_angles
from push_model.parameters import PushedObject, RoundRobot
from push_model.signals import Twist
from push_sim_node.plant import Plant
from studies.recordings.block import BlockPush, BlockRecording, ROD_RADIUS, with_contact_friction
from studies.recordings.ellipsoid import Ellipsoid, integrate
from studies.recordings.nearest_push import nearest_ends

# Chosen: points of an integrated path, a fifth of a millimetre apart.
POINTS = 61
# Chosen: step and smoothing of the plant for pushes of 2.5 mm/s [s, m/s].
PLANT_STEP = 5e-3
PLANT_SMOOTHING = 1e-6
# Candidates for the two parameters of the ellipsoid: mu_c, and c^2 over that of statics. Chosen.
ELLIPSOID_FRICTION = np.arange(0.2, 0.81, 0.05)
ELLIPSOID_RATIOS = np.geomspace(0.5, 2.0, 13)


class Method(enum.Enum):
    """What predicts a push."""

    UNFITTED = 'quasi-static, nothing fitted'
    IDENTIFIED = 'quasi-static, identified'
    PLANT = 'plant, identified'
    ELLIPSOID = 'ellipsoid'
    NEAREST = 'nearest other push'


class Errors(NamedTuple):
    """
    Predictions of the pushes of one recording, against what was recorded.

    :param position: errors of the ends, shape (n,) [m].
    :param heading: their magnitudes, shape (n,) [rad].
    """

    position: FloatArray
    heading: FloatArray


class ForceErrors(NamedTuple):
    """
    Predicted contact forces of one recording, against the recorded ones.

    :param direction: magnitudes, shape (n,) [rad].
    :param ratio: predicted over recorded size, shape (n,).
    """

    direction: FloatArray
    ratio: FloatArray


class RecordingReport(NamedTuple):
    """
    Everything about one recording.

    :param recording: the pushes.
    :param object: the block as identified; where the set identifies nothing of its own, with the
        contact friction of the others.
    :param identification: where the set identifies, None else.
    :param errors: of the tested pushes.
    :param forces: of the tested pushes, with nothing fitted and identified.
    """

    recording: BlockRecording
    object: PushedObject
    identification: Identification | None
    errors: dict[Method, Errors]
    forces: dict[Method, ForceErrors]


def reports(recordings: Sequence[BlockRecording]) -> list[RecordingReport]:
    """
    Identify from some pushes of some recordings, and predict the others.

    :param recordings: all sets; those that are held back identify nothing.
    :return: of each recording.
    """
    identifying = [one for one in recordings if one.identifying]
    results = identify_together(
        [PushedRecording(one.object, [push.motion for push in one.identifying])
         for one in identifying], ROD_RADIUS)
    by_name = {one.name: result for one, result in zip(identifying, results)}
    friction = results[0].contact_friction.value
    ellipsoid = _fitted_ellipsoid(identifying)
    return [_report(one, by_name.get(one.name), friction, ellipsoid) for one in recordings]


def _report(recording: BlockRecording, identification: Identification | None, friction: float,
            ellipsoid: tuple[float, float]) -> RecordingReport:
    tested = recording.tested
    obj = (identification.object if identification
           else with_contact_friction(recording.object, friction))
    unfitted, identified = _integrated(recording.object, tested), _integrated(obj, tested)
    nearest = nearest_ends(Shape.of(obj), tested)
    ends = {Method.UNFITTED: unfitted.ends, Method.IDENTIFIED: identified.ends,
            Method.PLANT: _plant_ends(obj, tested),
            Method.ELLIPSOID: _ellipsoid_ends(recording.object, tested, *ellipsoid),
            Method.NEAREST: nearest}
    scale = _force_scale(obj, recording.identifying)
    forces = {Method.UNFITTED: _force_errors(unfitted.forces, tested),
              Method.IDENTIFIED: _force_errors(scale * identified.forces, tested)}
    return RecordingReport(recording, obj, identification, {
        method: Errors(*_pose_errors(values, tested)) for method, values in ends.items()}, forces)


class _Integrated(NamedTuple):
    """Poses in the end (n, 3) and mean forces (n, 2)."""

    ends: FloatArray
    forces: FloatArray


def _force_scale(obj: PushedObject, pushes: Sequence[BlockPush]) -> float:
    """Identify how much greater the friction on the floor is than nominally; 1 without pushes."""
    if not pushes:
        return 1.0
    forces = _integrated(obj, pushes).forces
    return float(np.median([np.hypot(*push.force) / np.hypot(*force)
                            for push, force in zip(pushes, forces)]))


def _integrated(obj: PushedObject, pushes: Sequence[BlockPush]) -> _Integrated:
    starts, _, paths = stacked([push.motion for push in pushes], POINTS)
    integrated = integrate_slow_pushes(Shape.of(obj), LoadedSupports.of(obj),
                                       obj.contact_friction_coefficient, ROD_RADIUS, starts, paths)
    presses = np.abs(integrated.forces).sum(axis=2) > 0.0
    counts = np.maximum(presses.sum(axis=1), 1)
    return _Integrated(integrated.poses[:, -1], integrated.forces.sum(axis=1) / counts[:, None])


def _force_errors(forces: FloatArray, pushes: Sequence[BlockPush]) -> ForceErrors:
    measured = np.array([push.force for push in pushes])
    angles = np.arctan2(forces[:, 1], forces[:, 0]) - np.arctan2(measured[:, 1], measured[:, 0])
    return ForceErrors(np.abs(wrap_angles(angles)), np.hypot(*forces.T) / np.hypot(*measured.T))


def _fitted_ellipsoid(recordings: Sequence[BlockRecording]) -> tuple[float, float]:
    """Choose mu_c, and the ratio of c^2 to that of statics, with the least mean error."""
    def cost(friction: float, ratio: float) -> float:
        total = 0.0
        for one in recordings:
            position, heading = _pose_errors(
                _ellipsoid_ends(one.object, one.identifying, friction, ratio), one.identifying)
            length = math.sqrt(ellipsoid_c_squared(one.object))
            total += float(np.hypot(position, length * heading).sum())
        return total

    costs = [(cost(friction, ratio), friction, ratio) for friction, ratio in itertools.product(
        ELLIPSOID_FRICTION.tolist(), ELLIPSOID_RATIOS.tolist())]
    _, friction, ratio = min(costs)
    return friction, ratio


def _ellipsoid_ends(obj: PushedObject, pushes: Sequence[BlockPush], friction: float,
                    ratio: float) -> FloatArray:
    starts, _, paths = stacked([push.motion for push in pushes], POINTS)
    model = Ellipsoid(np.array(friction_center(obj)), ratio * ellipsoid_c_squared(obj), friction)
    return integrate(Shape.of(obj), model, ROD_RADIUS, starts, paths)


def _plant_ends(obj: PushedObject, pushes: Sequence[BlockPush]) -> FloatArray:
    robot = RoundRobot(ROD_RADIUS, 'holonomic', max_speed=1.0, time_constant=0.0,
                       max_acceleration=100.0)
    return np.array([_plant_end(obj, robot, push) for push in pushes])


def _plant_end(obj: PushedObject, robot: RoundRobot, push: BlockPush) -> Pose:
    """Push along the straight line from the first touch to the end, as the recorded arm did."""
    (x_0, y_0, _), (x_1, y_1, _) = push.motion.path[0], push.motion.path[-1]
    heading = math.atan2(y_1 - y_0, x_1 - x_0)
    speed = math.hypot(x_1 - x_0, y_1 - y_0) / push.duration
    plant = Plant(obj, robot, Pose(*push.motion.start), Pose(x_0, y_0, heading), PLANT_STEP,
                  PLANT_SMOOTHING)
    plant.advance(push.duration, Twist(speed))
    return plant.object_pose


def _pose_errors(ends: FloatArray, pushes: Sequence[BlockPush]) -> tuple[FloatArray, FloatArray]:
    off = ends - np.array([push.motion.end for push in pushes])
    return np.hypot(off[:, 0], off[:, 1]), np.abs(wrap_angles(off[:, 2]))
