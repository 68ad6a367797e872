"""
Draw a task in MuJoCo as a moving picture: from above, and as the robot's camera sees it.

``python -m docs.tools.mujoco_film`` writes ``docs/mujoco.gif``. It needs the extras ``mujoco``,
``vision`` and ``plot``.
"""

import contextlib
import dataclasses
import math
from pathlib import Path
import sys

import numpy as np
from numpy.typing import NDArray
from PIL import Image
from push_control.task.supervisor import Supervisor
from push_mujoco.appearance import looks_of
from push_mujoco.camera import SimulatedCamera
from push_mujoco.engine_plant import engine_plant, EnginePlant
from push_mujoco.rendering import Renderer
from push_mujoco.simulated_robot import read_simulated_robot
from push_mujoco.tags import tag_pictures
from push_scenario.definition.loader import load_scenario
from push_scenario.simulation.loop import simulate
from push_sim_node.simulation import Simulation
from push_tags.tag_layout import read_tag_layout

OUT = Path(__file__).resolve().parents[1] / 'mujoco.gif'
SCENARIO, TAGS = 'task_own_camera', 'box_04'
# Pixels of either half [px], simulated time from one picture to the next [s], and time that each
# is shown [s]: four times as fast.
WIDTH, HEIGHT = 300, 240
STEP, SHOWN = 0.4, 0.1
# Lens above the middle of the floor that the task needs.
ABOVE = SimulatedCamera(place='room', x=0.3, y=0.3, z=2.7, heading=math.pi / 2,
                        pitch=math.pi / 2, width=WIDTH, height=HEIGHT, view_angle=1.0, noise=0.0)
COLORS = 96


class Film:
    """Pictures of a simulation, as it goes on; to be used as a context."""

    def __init__(self) -> None:
        own = read_simulated_robot('turtlebot4').camera
        self._cameras = ABOVE, dataclasses.replace(own, width=WIDTH, height=HEIGHT)
        self._renderers: list[Renderer] = []
        self._graphics = contextlib.ExitStack()
        self._next = 0.0
        self.pictures: list[NDArray[np.uint8]] = []

    def __enter__(self) -> 'Film':
        """Return itself."""
        return self

    def __exit__(self, *_: object) -> None:
        """Give back what graphics hold."""
        self._graphics.close()

    def look(self, simulation: Simulation, _: Supervisor) -> None:
        """Draw both views where the next picture is due."""
        plant = simulation.plant
        if simulation.time < self._next or not isinstance(plant, EnginePlant):
            return
        self._next += STEP
        if not self._renderers:
            self._renderers = [self._graphics.enter_context(Renderer(plant.engine.model, camera))
                               for camera in self._cameras]
        self.pictures.append(np.hstack([renderer.render(plant.engine.data, plant.robot_pose)
                                        for renderer in self._renderers]))

    def save(self, path: Path) -> None:
        """
        Write them as a GIF.

        :param path: of the file.
        """
        images = [Image.fromarray(picture).quantize(COLORS) for picture in self.pictures]
        images[0].save(path, save_all=True, append_images=images[1:], loop=0,
                       duration=int(1e3 * SHOWN), optimize=True)


def main() -> int:
    """Run the task, and write the film."""
    looks = looks_of(tag_pictures(read_tag_layout(TAGS)))
    with Film() as film:
        result = simulate(load_scenario(SCENARIO), intervene=film.look, planning_time=0.0,
                          plant_type=engine_plant(looks=looks))
    film.save(OUT)
    print(f'{result.outcome.value}; {OUT}: {len(film.pictures)} pictures, '
          f'{OUT.stat().st_size / 1e6:.2f} MB')
    return 0


if __name__ == '__main__':
    sys.exit(main())
