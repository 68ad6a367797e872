"""A plan of a steered push, drawn into axes of matplotlib, which is not imported here."""

import math
from typing import Any

import numpy as np
from push_model.geometry import FloatArray, Pose
from push_model.parameters import PushedObject
from push_model.trajectory import PushTrajectory

# Bodies are drawn at the start, at the end, and at so many poses between.
BETWEEN = 3
# Sides with which a disc is drawn; chosen: it looks round.
DISC_SIDES = 60
OBJECT, ROBOT, CONTACT = '#0B3C8C', '#7A7A7A', '#C2185B'


def draw_plan(axes: Any, obj: PushedObject, robot_radius: float,
              trajectory: PushTrajectory) -> None:
    """
    Draw the bodies along a push, and the paths of object, robot and contact [m].

    :param axes: axes of matplotlib.
    :param robot_radius: of the robot [m]; one that is 0 or infinite is not drawn.
    """
    rows = np.linspace(0, len(trajectory.times) - 1, BETWEEN + 2).round().astype(int)
    for row in rows.tolist():
        _draw_outline(axes, obj.outline or _ring(obj.radius), trajectory.object_poses[row],
                      color=OBJECT)
        if 0.0 < robot_radius < math.inf:
            _draw_outline(axes, _ring(robot_radius), trajectory.robot_poses[row], color=ROBOT)
    for poses, color, label in ((trajectory.object_poses, OBJECT, 'object'),
                                (trajectory.robot_poses, ROBOT, 'robot'),
                                (trajectory.contact_poses, CONTACT, 'contact')):
        axes.plot(poses[:, 0], poses[:, 1], color=color, label=label)
    axes.set(aspect='equal', xlabel='x [m]', ylabel='y [m]')
    axes.legend()


def _ring(radius: float) -> list[tuple[float, float]]:
    return [(radius * math.cos(angle), radius * math.sin(angle))
            for angle in np.linspace(0.0, 2.0 * math.pi, DISC_SIDES).tolist()]


def _draw_outline(axes: Any, outline: Any, pose: FloatArray, color: str) -> None:
    vertices = np.array([Pose(*pose).transform(vertex) for vertex in [*outline, outline[0]]])
    axes.plot(vertices[:, 0], vertices[:, 1], color=color, linewidth=0.8, alpha=0.6)
