"""What the studies of push primitives share: their subjects, and effects seen from the place."""

from typing import Any, NamedTuple

from matplotlib.axes import Axes
import numpy as np
from push_model.files.data import config_file
from push_model.files.parameter_files import read_object, read_robot
from push_model.geometry import FloatArray, IntArray, Pose
from push_model.parameters import PushedObject, RoundRobot
from push_primitives.selection import interpolate_displacements
from push_primitives.store import load_primitives, PushPrimitives
from push_primitives.table import COMMON_SAMPLES, PrimitiveTable
from push_scenario.plots.drawing import outline
from studies.framework.parameters import Parameter

OBJECT = Parameter('object', '', 'pushed object, the name of a file in config/objects')
OBJECTS = Parameter('objects', '', 'pushed objects, names of files in config/objects')
ROBOT = Parameter('robot', '', 'robot, the name of a file in config/robots')
LENGTHS = Parameter('lengths', 'm', 'driven lengths of the pushes')
MILLIMETRES = 1000.0
# Samples of friction that deviations are over, the nominal one included.
COMMON = slice(0, 1 + COMMON_SAMPLES)
# Tilts and curvatures of the table are compared to this [rad, 1/m].
ROUNDING = 1e-6


class Effects(NamedTuple):
    """
    Effects of pushes as seen by the robot at the place; means and standard deviations.

    :param means: along the face (counter-clockwise about the object), ahead along the inward
        normal, and rotation, shape (..., 3) [m, m, rad].
    :param deviations: over the samples of friction, shape (..., 3).
    """

    means: FloatArray
    deviations: FloatArray


def named_object(name: str) -> PushedObject:
    """
    Read an object.

    :param name: of a file in ``config/objects``.
    :return: the object.
    """
    return read_object(config_file(f'objects/{name}.yaml'))


def named_robot(name: str) -> RoundRobot:
    """
    Read a robot.

    :param name: of a file in ``config/robots``.
    :return: the robot.
    """
    return read_robot(config_file(f'robots/{name}.yaml'))


def named_primitives(object_name: str, robot_name: str) -> PushPrimitives:
    """
    Load the primitives of an object and a robot.

    :param object_name: of a file in ``config/objects``.
    :param robot_name: of a file in ``config/robots``.
    :return: the primitives, with their cost-to-go.
    """
    return load_primitives(named_object(object_name), named_robot(robot_name))


def find_primitives(table: PrimitiveTable, angle: float, curvature: float = 0.0) -> IntArray:
    """
    List the primitives of one kind.

    :param table: of primitives.
    :param angle: approach angle [rad].
    :param curvature: [1/m].
    :return: their numbers, place by place, shape (places,).
    :raises ValueError: where the table has none.
    """
    rows = np.flatnonzero((np.abs(table.approach_angles - angle) < ROUNDING)
                          & (np.abs(table.curvatures - curvature) < ROUNDING))
    if not len(rows):
        angles = ', '.join(f'{known:g}' for known in np.unique(table.approach_angles))
        raise ValueError(f'tilt: got {angle:g} rad with {curvature:g} / m, expected one '
                         f'of {angles}')
    return rows


def effects_at(table: PrimitiveTable, rows: IntArray, lengths: FloatArray,
               samples: IntArray | slice = COMMON) -> Effects:
    """
    Compute what primitives do, in axes of the face that they push.

    :param table: of primitives.
    :param rows: of the primitives, shape (m,).
    :param lengths: driven, shape (l,) [m].
    :param samples: of friction, over which mean and deviation are.
    :return: effects of shape (m, l, 3).
    """
    displacements = interpolate_displacements(
        table.lengths, table.displacements[rows][:, samples], np.asarray(lengths, dtype=float))
    normals = np.array([table.face_points[point].normal
                        for point in table.point_indices[rows].tolist()])
    c, s = np.cos(normals)[:, None, None], np.sin(normals)[:, None, None]
    x, y, theta = np.moveaxis(displacements, -1, 0)
    effects = np.stack([s * x - c * y, c * x + s * y, theta], axis=-1)
    return Effects(effects.mean(axis=1), effects.std(axis=1))


def draw_start(axes: Axes, obj: PushedObject, **style: Any) -> None:
    """
    Draw the outline of an object where it starts.

    :param axes: to draw on.
    :param obj: the object.
    :param style: keywords of ``plot``.
    """
    points = outline(obj, Pose(0.0, 0.0, 0.0))
    axes.plot(*np.vstack([points, points[:1]]).T, **style)
