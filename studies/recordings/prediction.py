"""Recorded pushes of a block, predicted by the quasi-static model and by the plant."""

import math
from typing import NamedTuple, Sequence

import numpy as np
from push_control.identification.identification import Identification, identify
from push_control.identification.recorded_push import stacked
from push_model.analysis.sliding_contact import SupportArrays
from push_model.analysis.slow_push import integrate_slow_pushes, Shape
from push_model.geometry import FloatArray, Pose, wrap_angles
from push_model.parameters import PushedObject, RoundRobot
from push_model.signals import Twist
from push_sim_node.plant import Plant
from studies.recordings.block import BlockPush, BlockRecording, ROD_RADIUS, SELECTED

# Chosen: points of an integrated path, a fifth of a millimetre apart.
POINTS = 61
IDENTIFIED = ('friction_center_x', 'friction_center_y', 'contact_friction')
# Chosen: step and smoothing of the plant for pushes of 2.5 mm/s [s, m/s].
PLANT_STEP = 5e-3
PLANT_SMOOTHING = 1e-6
QUASI_STATIC = 'quasi-static'
PLANT = 'plant'
UNFITTED = 'nothing fitted'
FITTED = 'identified'


class Errors(NamedTuple):
    """
    Predictions of the pushes of one recording, against what was recorded.

    :param name: of the recording.
    :param model: ``QUASI_STATIC`` or ``PLANT``.
    :param parameters: ``UNFITTED`` or ``FITTED``.
    :param position: errors of the ends, shape (n,) [m].
    :param heading: their magnitudes, shape (n,) [rad].
    :param force_direction: magnitudes, shape (n,) [rad]; empty for the plant.
    :param force_ratio: predicted over recorded force, shape (n,); empty for the plant.
    """

    name: str
    model: str
    parameters: str
    position: FloatArray
    heading: FloatArray
    force_direction: FloatArray
    force_ratio: FloatArray


class RecordingReport(NamedTuple):
    """
    Everything about one recording.

    :param recording: the pushes.
    :param identification: from every ``SELECTED``-th push.
    :param errors: of the other pushes, by both models with both sets of parameters.
    """

    recording: BlockRecording
    identification: Identification
    errors: tuple[Errors, ...]


def report(recording: BlockRecording) -> RecordingReport:
    """
    Identify from some pushes of a recording, and predict the others.

    :param recording: the pushes.
    :return: the report.
    """
    used = [push.motion for push in recording.pushes[::SELECTED]]
    tested = [push for index, push in enumerate(recording.pushes) if index % SELECTED]
    identification = identify(recording.object, ROD_RADIUS, used, IDENTIFIED)
    scale = _force_scale(identification.object, recording.pushes[::SELECTED])
    fitted = {UNFITTED: (recording.object, 1.0), FITTED: (identification.object, scale)}
    errors: list[Errors] = []
    for name, (obj, force_scale) in fitted.items():
        errors.append(_quasi_static(recording.name, name, obj, force_scale, tested))
        errors.append(_by_plant(recording.name, name, obj, tested))
    return RecordingReport(recording, identification, tuple(errors))


def _force_scale(obj: PushedObject, pushes: Sequence[BlockPush]) -> float:
    """Identify how much greater the friction on the floor is than believed."""
    _, forces = _integrated(obj, pushes)
    return float(np.median([np.hypot(*push.force) / np.hypot(*force)
                            for push, force in zip(pushes, forces)]))


def _integrated(obj: PushedObject, pushes: Sequence[BlockPush]) -> tuple[FloatArray, FloatArray]:
    """Return ends (n, 3) and mean forces (n, 2)."""
    starts, _, paths = stacked([push.motion for push in pushes], POINTS)
    integrated = integrate_slow_pushes(Shape.of(obj), SupportArrays.of(obj),
                                       obj.contact_friction_coefficient, ROD_RADIUS, starts, paths)
    presses = np.abs(integrated.forces).sum(axis=2) > 0.0
    counts = np.maximum(presses.sum(axis=1), 1)
    return integrated.poses[:, -1], integrated.forces.sum(axis=1) / counts[:, None]


def _quasi_static(name: str, parameters: str, obj: PushedObject, force_scale: float,
                  pushes: Sequence[BlockPush]) -> Errors:
    ends, forces = _integrated(obj, pushes)
    measured = np.array([push.force for push in pushes])
    angles = np.arctan2(forces[:, 1], forces[:, 0]) - np.arctan2(measured[:, 1], measured[:, 0])
    return Errors(name, QUASI_STATIC, parameters, *_pose_errors(ends, pushes),
                  np.abs(wrap_angles(angles)),
                  force_scale * np.hypot(*forces.T) / np.hypot(*measured.T))


def _by_plant(name: str, parameters: str, obj: PushedObject,
              pushes: Sequence[BlockPush]) -> Errors:
    robot = RoundRobot(ROD_RADIUS, 'holonomic', max_speed=1.0, time_constant=0.0,
                       max_acceleration=100.0)
    ends = np.array([_plant_end(obj, robot, push) for push in pushes])
    return Errors(name, PLANT, parameters, *_pose_errors(ends, pushes), np.empty(0), np.empty(0))


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
