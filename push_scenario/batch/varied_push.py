"""Variations of one plain push: parameters, friction, start and commands, as jobs of a batch."""

from collections.abc import Iterable, Sequence
import dataclasses
import math
from typing import Any, TypeVar

from push_dynamics.floor import FloorPatch
from push_model.geometry import Pose
from push_model.parameters import PushedObject, RoundRobot
from push_model.signals import Twist
from push_scenario.batch.chunks import Job, Record
from push_sim_node.plant import Plant

JOB_KEYS = ('object', 'robot', 'object_pose', 'robot_pose', 'friction_factors', 'segments',
            'floor')
# Poses and velocities of a record, in the order of ``Truth``.
POSE_COLUMNS = tuple(f'{name}_{axis}' for name in ('object', 'object_v', 'robot', 'robot_v')
                     for axis in ('x', 'y', 'theta'))
Triple = tuple[float, float, float]
Parameters = TypeVar('Parameters', PushedObject, RoundRobot)


@dataclasses.dataclass(frozen=True)
class VariedPush:
    """
    A push at given commands; called with a job, it returns how that variation of it ends.

    A job is a dict with any of: ``object`` and ``robot``, dicts of fields of ``PushedObject`` and
    ``RoundRobot`` and their values; ``object_pose``, ``robot_pose``, ``segments``, in place of
    those below; ``friction_factors``, one for each support, from the start; ``floor``, a list of
    dicts of fields of ``FloorPatch``. What it does not name stays.

    :param object: the ``PushedObject``.
    :param robot: the ``RoundRobot``.
    :param object_pose: (x, y, theta) of the object [m, m, rad].
    :param robot_pose: (x, y, theta) of the robot [m, m, rad].
    :param segments: commands (duration [s], v_x [m/s], v_y [m/s], omega [rad/s]), in the robot's
        own axes, one after the other; further numbers are friction factors, one for each
        support, from then on.
    :param step: longest step [s].
    :param smoothing: speed below which support friction turns viscous [m/s].
    :param floor: ``FloorPatch`` sequence.
    """

    object: PushedObject
    robot: RoundRobot
    object_pose: Triple
    robot_pose: Triple
    segments: tuple[tuple[float, ...], ...]
    step: float = 2e-3
    smoothing: float = 1e-5
    floor: tuple[FloorPatch, ...] = ()

    def __call__(self, job: Job) -> Record:
        """
        Simulate one variation.

        :param job: the dict.
        :return: poses, velocities, mode, energies and steps at the end, as a flat dict.
        :raises ValueError: where a value does not fit.
        """
        plant = self.plant(job)
        for duration, v_x, v_y, omega, *factors in job.get('segments', self.segments):
            if factors:
                _set_factors(plant, factors)
            plant.advance(duration, Twist(v_x, v_y, omega))
        return _record(plant)

    def plant(self, job: Job) -> Plant:
        """
        Make the plant of one variation, at its start.

        :param job: the dict.
        :return: the ``Plant``.
        :raises ValueError: where a value does not fit.
        """
        unknown = job.keys() - set(JOB_KEYS)
        if unknown:
            raise ValueError(f'job: got {sorted(unknown)}, expected some of '
                             + ', '.join(JOB_KEYS))
        floor = self.floor
        if 'floor' in job:
            _check_names('floor', {name for patch in job['floor'] for name in patch}, FloorPatch)
            floor = tuple(FloorPatch(**patch) for patch in job['floor'])
        plant = Plant(_varied(self.object, 'object', job), _varied(self.robot, 'robot', job),
                      Pose(*job.get('object_pose', self.object_pose)),
                      Pose(*job.get('robot_pose', self.robot_pose)), self.step, self.smoothing,
                      floor=floor)
        if 'friction_factors' in job:
            _set_factors(plant, job['friction_factors'])
        return plant


def _set_factors(plant: Plant, factors: Sequence[float]) -> None:
    count = len(plant.obj.supports)
    if len(factors) != count or not all(0.0 <= factor < math.inf for factor in factors):
        raise ValueError(f'friction_factors: got {factors!r}, expected {count} of at least 0, one '
                         'for each support')
    plant.set_friction_factors(factors)


def _varied(base: Parameters, key: str, job: Job) -> Parameters:
    values: dict[str, Any] | None = job.get(key)
    if not values:
        return base
    _check_names(key, values.keys(), type(base))
    return dataclasses.replace(base, **values)


def _check_names(key: str, names: Iterable[str], kind: Any) -> None:
    unknown = set(names) - {field.name for field in dataclasses.fields(kind)}
    if unknown:
        raise ValueError(f'{key}: got {sorted(unknown)}, expected fields of {kind.__name__}')


def _record(plant: Plant) -> Record:
    truth = plant.truth(0.0)
    return {**dict(zip(POSE_COLUMNS, (*truth.object_pose, *truth.object_twist, *truth.robot_pose,
                                      *truth.robot_twist))),
            **truth.energy._asdict(), 'mode': truth.mode.value, 'steps': plant.steps,
            'unsolved_steps': plant.unsolved_steps}
