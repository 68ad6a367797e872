"""Robot and object of an animation, drawn as bodies: wheels, a solid face and a shadow."""

import math
from typing import Any

from matplotlib.axes import Axes
from matplotlib.patches import Circle, Polygon
import numpy as np
from push_model.geometry import Pose
from push_model.parameters import PushedObject, RoundRobot
from push_scenario.plots.drawing import front, INK, outline, PoseLike

CARDBOARD, CARDBOARD_EDGE = '#E2BC85', '#7A5426'
BODY, DECK, WHEEL = '#3F7CAC', '#A9CCE3', '#1E1E1E'
SHADOW: dict[str, Any] = {'facecolor': 'black', 'edgecolor': 'none', 'alpha': 0.16}
# Light comes from the upper left: a shadow lies so far to the right and below [m].
SHADOW_SHIFT = np.array([0.018, -0.018])
# Parts of a robot, over its radius: deck, and a wheel by its place, length and width.
DECK_SIZE, WHEEL_PLACE, WHEEL_LENGTH, WHEEL_WIDTH = 0.62, 0.78, 0.56, 0.2
# A marker of the heading, over the radius: its tip, its tail and half its width.
TIP, TAIL, HALF_WIDTH = 0.5, 0.1, 0.22


class ShadedObject:
    """
    An object with a solid face, its front marked, over a shadow.

    :param axes: matplotlib axes.
    :param obj: the ``PushedObject``.
    :param pose: its first pose.
    :param zorder: of the face.
    """

    def __init__(self, axes: Axes, obj: PushedObject, pose: PoseLike, zorder: float) -> None:
        self._object = obj
        self._shadow = Polygon(outline(obj, pose), zorder=zorder - 0.1, **SHADOW)
        self._face = Polygon(outline(obj, pose), facecolor=CARDBOARD, edgecolor=CARDBOARD_EDGE,
                             linewidth=2.0, alpha=0.85, zorder=zorder)
        for patch in (self._shadow, self._face):
            axes.add_patch(patch)
        self._front, = axes.plot(*front(obj, pose), color=CARDBOARD_EDGE, linewidth=3.0,
                                 zorder=zorder + 0.1)

    def move(self, pose: PoseLike) -> None:
        """
        Move it.

        :param pose: its (x, y, theta).
        """
        vertices = outline(self._object, pose)
        self._face.set_xy(vertices)
        self._shadow.set_xy(vertices + SHADOW_SHIFT)
        self._front.set_data(*front(self._object, pose))


class WheeledRobot:
    """
    A round robot with an arrow along its heading, and the wheels of a differential drive.

    :param axes: matplotlib axes.
    :param robot: the ``RoundRobot``.
    :param zorder: of the body.
    """

    def __init__(self, axes: Axes, robot: RoundRobot, zorder: float) -> None:
        radius = robot.radius
        self._shadow = Circle((0.0, 0.0), radius, zorder=zorder - 0.1, **SHADOW)
        self._discs = (Circle((0.0, 0.0), radius, facecolor=BODY, edgecolor=INK, linewidth=1.4,
                              zorder=zorder),
                       Circle((0.0, 0.0), DECK_SIZE * radius, facecolor=DECK, edgecolor='none',
                              zorder=zorder + 0.2))
        self._shapes = [radius * np.array([(TIP, 0.0), (-TAIL, HALF_WIDTH), (-TAIL, -HALF_WIDTH)])]
        length, width = 0.5 * WHEEL_LENGTH, 0.5 * WHEEL_WIDTH
        for side in (-WHEEL_PLACE, WHEEL_PLACE) if robot.drive == 'differential' else ():
            self._shapes.append(radius * np.array([
                (-length, side - width), (length, side - width), (length, side + width),
                (-length, side + width)]))
        self._polygons = [Polygon(shape, facecolor=WHEEL, edgecolor='none', zorder=zorder + 0.3)
                          for shape in self._shapes]
        for patch in (self._shadow, *self._discs, *self._polygons):
            axes.add_patch(patch)

    def move(self, pose: PoseLike) -> None:
        """
        Move it.

        :param pose: its (x, y, theta).
        """
        x, y, theta = pose
        self._shadow.center = x + SHADOW_SHIFT[0], y + SHADOW_SHIFT[1]
        for disc in self._discs:
            disc.center = x, y
        for shape, polygon in zip(self._shapes, self._polygons):
            polygon.set_xy(np.array([Pose(x, y, math.fmod(theta, math.tau)).transform(point)
                                     for point in shape]))
