"""
Draw the picture of a push at one contact: ``python -m docs.tools.one_contact``.

Forces and motions are those of the quasi-static model, for a box with an off-centre load. The
picture stands beside the page about the physics.
"""

import math
from pathlib import Path
import sys

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Polygon, Rectangle, Wedge
import numpy as np
from push_model.friction import friction_center
from push_model.geometry import Pose
from push_model.parameters import PushedObject, Support
from push_model.quasi_static import quasi_static_yaw_rate

PICTURE = Path(__file__).resolve().parents[1] / 'concepts' / 'one_contact.png'
HALF_SIZE, ROBOT_RADIUS = 0.2, 0.17
CONTACT_FRICTION = 0.5
CORNERS = ((-0.17, -0.17), (0.17, -0.17), (0.17, 0.17), (-0.17, 0.17))
BOX = PushedObject(
    mass=5.0, inertia=0.13,
    outline=((-0.2, -0.2), (0.2, -0.2), (0.2, 0.2), (-0.2, 0.2)),
    supports=tuple(Support(x, y, 0.3) for x, y in CORNERS),
    # The load stands towards the left rear.
    center_of_mass=(-0.05, 0.04),
    contact_friction_coefficient=CONTACT_FRICTION)
INK, BOX_COLOR, ROBOT_COLOR = '#202020', '#E8D5B0', '#9DB8D9'
FORCE, FRICTION, CENTER = '#C2185B', '#0B3C8C', '#007A5E'
PUSH_LENGTH, STEP = 0.25, 0.001


def draw_box(axes: Axes, pose: Pose, alpha: float = 1.0) -> None:
    """
    Draw the box with its supports, seen from above.

    :param pose: of its middle [m, m, rad].
    :param alpha: opacity.
    """
    cosine, sine = math.cos(pose.theta), math.sin(pose.theta)
    rotation = np.array(((cosine, -sine), (sine, cosine)))
    outline = np.array(BOX.outline) @ rotation.T + (pose.x, pose.y)
    axes.add_patch(Polygon(outline, facecolor=BOX_COLOR, edgecolor=INK, alpha=alpha))
    for corner in np.array(CORNERS) @ rotation.T + (pose.x, pose.y):
        axes.add_patch(Circle(corner, 0.012, color=INK, alpha=alpha))


def draw_robot(axes: Axes, x: float, y: float, alpha: float = 1.0) -> None:
    """
    Draw the robot, heading along x, with its two wheels.

    :param x: of its centre [m].
    :param y: of its centre [m].
    :param alpha: opacity.
    """
    axes.add_patch(Circle((x, y), ROBOT_RADIUS, facecolor=ROBOT_COLOR, edgecolor=INK, alpha=alpha))
    for side in (-1.0, 1.0):
        axes.add_patch(Rectangle((x - 0.04, y + side * 0.12 - 0.012), 0.08, 0.024,
                                 color=INK, alpha=alpha))


def arrow(axes: Axes, start: tuple[float, float], step: tuple[float, float], color: str) -> None:
    """
    Draw an arrow.

    :param start: its tail [m].
    :param step: from tail to head [m].
    :param color: of the arrow.
    """
    axes.annotate('', (start[0] + step[0], start[1] + step[1]), start,
                  arrowprops={'arrowstyle': '-|>', 'color': color, 'linewidth': 2.0,
                              'shrinkA': 0, 'shrinkB': 0, 'mutation_scale': 14})


def push_straight(offset: float, length: float) -> Pose:
    """
    Pose of the box after a slow push straight ahead, during which the contact rolls on the face.

    The robot does not rotate, so that its surface imposes its velocity at the contact, the foot
    of its centre on the face.

    :param offset: of the robot from the middle of the face, at first [m].
    :param length: of the push [m].
    :return: pose of its middle [m, m, rad]; Euler's method in steps of a millimetre.
    """
    x, y, theta = 0.0, 0.0, 0.0
    for step in range(round(length / STEP)):
        cosine, sine = math.cos(theta), math.sin(theta)
        robot_x = step * STEP - HALF_SIZE - ROBOT_RADIUS
        along_face = -sine * (robot_x - x) + cosine * (offset - y)
        yaw_step = STEP * quasi_static_yaw_rate(BOX, (-HALF_SIZE, along_face), cosine, -sine)
        arm_x = -cosine * HALF_SIZE - sine * along_face
        arm_y = -sine * HALF_SIZE + cosine * along_face
        x += STEP + yaw_step * arm_y
        y -= yaw_step * arm_x
        theta += yaw_step
    return Pose(x, y, theta)


def draw_forces(axes: Axes) -> None:
    """Draw the contact with its friction cone, and the friction under the box."""
    offset = -0.06
    contact = (-HALF_SIZE, offset)
    draw_box(axes, Pose(0.0, 0.0, 0.0))
    draw_robot(axes, -HALF_SIZE - ROBOT_RADIUS, offset)
    cone = math.degrees(math.atan(CONTACT_FRICTION))
    axes.add_patch(Wedge(contact, 0.27, -cone, cone, color=FORCE, alpha=0.15))
    omega = quasi_static_yaw_rate(BOX, contact, 1.0, 0.0)
    total = np.zeros(2)
    newton = 0.28 / sum(BOX.capacities)
    for support, capacity in zip(BOX.supports, BOX.capacities):
        slide = np.array((1.0 - omega * (support.y - contact[1]),
                          omega * (support.x - contact[0])))
        force = -capacity * slide / np.linalg.norm(slide)
        total -= force
        arrow(axes, (support.x, support.y), tuple(newton * force), FRICTION)
    arrow(axes, contact, tuple(newton * total), FORCE)
    center = friction_center(BOX)
    axes.plot(*center, marker='X', color=CENTER, markersize=9)
    axes.annotate('F, centre of friction', center, (center[0] - 0.05, center[1] + 0.04),
                  color=CENTER)
    axes.annotate('C, contact', contact, (contact[0] - 0.16, contact[1] + 0.02), color=INK)
    axes.annotate('friction cone', (contact[0] + 0.13, contact[1] - 0.1), color=FORCE)
    axes.annotate('friction under\na support', (-0.19, -0.29), color=FRICTION)
    axes.set_title('The force at C balances the friction below')


def draw_pushes(axes: Axes) -> None:
    """Draw where the box comes to, pushed on three lines."""
    center = friction_center(BOX)
    for row, (offset, text) in enumerate((
            (center[1] + 0.08, 'left of F: it turns to the right'),
            (center[1], 'towards F: it moves straight on'),
            (center[1] - 0.08, 'right of F: it turns to the left'))):
        shift = -0.62 * row
        pose = push_straight(offset, PUSH_LENGTH)
        draw_box(axes, Pose(0.0, shift, 0.0), alpha=0.3)
        draw_robot(axes, -HALF_SIZE - ROBOT_RADIUS, shift + offset, alpha=0.3)
        draw_box(axes, Pose(pose.x, pose.y + shift, pose.theta))
        draw_robot(axes, PUSH_LENGTH - HALF_SIZE - ROBOT_RADIUS, shift + offset)
        cosine, sine = math.cos(pose.theta), math.sin(pose.theta)
        axes.plot(pose.x + cosine * center[0] - sine * center[1],
                  pose.y + shift + sine * center[0] + cosine * center[1],
                  marker='X', color=CENTER, markersize=9)
        turn = abs(math.degrees(pose.theta))
        axes.text(0.6, shift, f'{text}\n{turn:.0f} degrees in {PUSH_LENGTH} m',
                  verticalalignment='center')
    axes.set_xlim(-0.6, 1.4)
    axes.set_title('Where one pushes says how it turns')


def main() -> int:
    """Draw both panels."""
    figure = Figure(figsize=(11.0, 4.8), layout='constrained')
    forces, pushes = figure.subplots(1, 2, width_ratios=(1.0, 1.15))
    draw_forces(forces)
    draw_pushes(pushes)
    for axes in (forces, pushes):
        axes.set_aspect('equal')
        axes.axis('off')
    forces.set_xlim(-0.58, 0.3)
    forces.set_ylim(-0.34, 0.3)
    figure.savefig(PICTURE, dpi=110)
    print(f'written: {PICTURE}')
    return 0


if __name__ == '__main__':
    sys.exit(main())
