"""The simulator in MuJoCo: images beside what the own one publishes."""

from typing import Callable

import numpy as np
from push_model.signals import ObjectPose, Odometry
from push_mujoco.appearance import looks_of, Picture
from push_mujoco.engine_plant import engine_plant, EnginePlant
from push_mujoco.rendering import NoRenderer, Renderer
from push_mujoco.ros.images import OPTICAL_FRAME, to_camera_info, to_image_message
from push_mujoco.settings import MujocoSettings
from push_mujoco.simulated_robot import (
    DEFAULT_ROBOTS, read_simulated_robot, SimulatedRobot,
)
from push_ros.node import RateLimiter
from push_sim_node.ros.simulator import SECTIONS as SIM_SECTIONS, Simulator
from push_sim_node.settings import SimulationSettings
from push_sim_node.simulation import Measurement
from std_msgs.msg import Header

SECTIONS = (*SIM_SECTIONS, ('mujoco.', MujocoSettings))
# Number of the random stream of the pixels, beside those of a spawned seed.
PIXEL_STREAM = 3


class EngineSimulator(Simulator):
    """A ``Simulator`` that MuJoCo moves, with a camera."""

    def __init__(self) -> None:
        super().__init__(SECTIONS)
        self._renderer: Renderer | None = None
        if self._mujoco.image_rate > 0.0:
            self._image = self.publisher('image_raw')
            self._camera_info = self.publisher('camera_info')
            self._image_limiter = RateLimiter(self._mujoco.image_rate)

    def make_plant_type(self) -> Callable[..., EnginePlant]:
        """Return what makes plants in MuJoCo, with the tags on the object."""
        _, robot, _, simulation, _, options, mujoco = self.settings
        if options.objects:
            self.refuse_to_start('objects.name: got several objects, expected one in MuJoCo')
        self._mujoco: MujocoSettings = mujoco
        try:
            simulated = read_simulated_robot(mujoco.robot or DEFAULT_ROBOTS[robot.drive])
            pictures = _read_tags(mujoco.tags) if mujoco.tags else ()
        except ValueError as error:
            self.refuse_to_start(f'mujoco: {error}')
        self._set_camera(simulated, simulation)
        return engine_plant(simulated, looks_of(pictures, mujoco.object_height))

    def _set_camera(self, robot: SimulatedRobot, simulation: SimulationSettings) -> None:
        self._camera = self._mujoco.camera_of(robot.camera)
        self._noise = np.random.default_rng((simulation.seed, PIXEL_STREAM))

    def is_published(self, measurement: Measurement) -> bool:
        """Leave out object poses where images are to tell them."""
        return self._mujoco.publish_object_pose or not isinstance(measurement, ObjectPose)

    def on_measured(self, measurement: Measurement) -> None:
        """Publish an image, too, with the odometry at whose time it is due."""
        super().on_measured(measurement)
        if not isinstance(measurement, Odometry):
            return
        plant = self.simulation.plant
        if not isinstance(plant, EnginePlant):
            raise TypeError(f'plant: got {plant!r}, expected one in MuJoCo')
        if self._mujoco.image_rate > 0.0 and self._image_limiter.due(measurement.time):
            self._publish_image(plant)

    def _publish_image(self, plant: EnginePlant) -> None:
        header = Header(stamp=self.now(), frame_id=OPTICAL_FRAME)
        pixels = self._renderer_of(plant).render(plant.engine.data, plant.robot_pose)
        self._camera_info.publish(to_camera_info(self._camera, header))
        self._image.publish(to_image_message(pixels, header))

    def _renderer_of(self, plant: EnginePlant) -> Renderer:
        """Return what draws the plant; a reset makes another one."""
        if self._renderer is not None and self._renderer.model is plant.engine.model:
            return self._renderer
        if self._renderer is not None:
            self._renderer.close()
        try:
            self._renderer = Renderer(plant.engine.model, self._camera, self._noise)
        except NoRenderer as error:
            self.refuse_to_start(f'mujoco.image_rate: {error}')
        return self._renderer

    def close(self) -> None:
        """Write the tape, and give back what graphics hold."""
        super().close()
        if self._renderer is not None:
            self._renderer.close()


def _read_tags(name: str) -> tuple[Picture, ...]:
    """Read the tags on an object, and draw them; without tags nothing of that is needed."""
    from push_mujoco.tags import tag_pictures
    from push_tags.tag_layout import read_tag_layout
    return tag_pictures(read_tag_layout(name))
