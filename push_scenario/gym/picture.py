"""Picture of a push task from above."""

from typing import Any

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
import numpy as np
from push_model.geometry import Pose
from push_scenario.definition.scenario import Scenario
from push_scenario.plots.drawing import draw_goals, draw_map, draw_object, draw_robot, INK

# Pixels per inch and size of the picture [inches].
DPI, SIZE = 100, 4.0
# Free rim about what was there at the start [m]; chosen: some way for the robot.
MARGIN = 0.8


def draw(scenario: Scenario, object_pose: Pose, robot_pose: Pose) -> Any:
    """
    Draw object, goal and robot.

    :param scenario: the ``Scenario``, whose start and goal say what is shown.
    :param object_pose: of the object now.
    :param robot_pose: of the robot now.
    :return: RGB array, shape (400, 400, 3), uint8.
    """
    figure = Figure((SIZE, SIZE), DPI)
    canvas = FigureCanvasAgg(figure)
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set_axis_off()
    places = np.array([scenario.start.object.pose[:2], scenario.robot_start[:2],
                       scenario.final_goal[:2]])
    middle = 0.5 * (places.min(axis=0) + places.max(axis=0))
    extent = 0.5 * float(np.ptp(places, axis=0).max()) + MARGIN
    axes.set_xlim(middle[0] - extent, middle[0] + extent)
    axes.set_ylim(middle[1] - extent, middle[1] + extent)
    draw_map(axes, scenario)
    draw_goals(axes, scenario)
    draw_object(axes, scenario.true_object, object_pose, facecolor='#E9D9BC', edgecolor=INK,
                linewidth=1.6, zorder=4)
    draw_robot(axes, scenario.robot.radius, robot_pose, facecolor='#B9CCE4', edgecolor=INK,
               linewidth=1.6, zorder=6)
    canvas.draw()
    return np.asarray(canvas.buffer_rgba())[..., :3].copy()
