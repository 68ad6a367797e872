"""Lidar in MuJoCo: beams that end at what the engine has, walls or the body of the object."""

import math
from typing import Any, Sequence

import mujoco
import numpy as np
from push_dynamics.walls import Wall
from push_model.geometry import FloatArray, Pose
from push_model.parameters import PushedObject
from push_mujoco.scene import BODY_GROUP
from push_mujoco.wheeled_robot import WheeledPlant
from push_sim_node.lidar import Lidar, LidarSensorSettings

# MuJoCo defines these in an extension module without type stubs.
_mujoco: Any = mujoco
# Beams that leave from one place, and see the object in one; chosen: what moves on meanwhile, goes
# a millimetre or two.
BEAMS_AT_ONCE = 10
GROUPS = 6


class EngineLidar(Lidar):
    """
    A lidar whose beams MuJoCo traces in the plane in which it turns.

    :param settings: as of ``Lidar``.
    :param obj: as of ``Lidar``.
    :param plant: ``WheeledPlant``, in which the lidar stands.
    :param walls: as of ``Lidar``; the engine has them already.
    :param noise: as of ``Lidar``.
    """

    def __init__(self, settings: LidarSensorSettings, obj: PushedObject, plant: WheeledPlant,
                 walls: Sequence[Wall], noise: np.random.Generator) -> None:
        super().__init__(settings, obj, walls, noise)
        self._plant = plant
        # The state of another time, in which the beams of that time are traced.
        self._data = _mujoco.MjData(plant.model)
        self._groups = np.zeros(GROUPS, dtype=np.uint8)
        self._groups[[0, BODY_GROUP] if settings.sees_object else [0]] = 1

    def _distances(self, lenses: FloatArray, rays: FloatArray,
                   objects: FloatArray) -> FloatArray:
        """Trace beams, some at once."""
        return np.concatenate([
            self._trace(lenses[first:first + BEAMS_AT_ONCE], rays[first:first + BEAMS_AT_ONCE],
                        Pose(*objects[first + len(objects[first:first + BEAMS_AT_ONCE]) // 2]))
            for first in range(0, len(lenses), BEAMS_AT_ONCE)])

    def _trace(self, lenses: FloatArray, rays: FloatArray, object_pose: Pose) -> FloatArray:
        plant, data, count = self._plant, self._data, len(rays)
        data.qpos[:] = plant.data.qpos
        plant.place_object(data, object_pose)
        _mujoco.mj_kinematics(plant.model, data)
        start = np.append(lenses[count // 2], plant.robot.lidar_height)
        directions = np.column_stack((rays, np.zeros(count)))
        geoms, ranges = np.zeros(count, dtype=np.int32), np.zeros(count)
        _mujoco.mj_multiRay(plant.model, data, start, directions.ravel(), self._groups, True,
                            plant.model.body('robot').id, geoms, ranges, None, count,
                            self._settings.range_max)
        return np.where(ranges >= 0.0, ranges, math.inf)
