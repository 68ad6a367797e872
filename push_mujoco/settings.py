"""Settings of a simulation in MuJoCo with a camera."""

import dataclasses
import math

from push_model.quantity import check, quantity
from push_mujoco.camera import SimulatedCamera


@dataclasses.dataclass(frozen=True)
class MujocoSettings:
    """Robot, object and camera of a simulation in MuJoCo, beyond what the own plant has."""

    robot: str = quantity('file of the robot, or its name in config/mujoco; empty: the one of the '
                          'drive', default='')
    tags: str = quantity('file of the tags on the object, or its name in config/tags; empty: none',
                         default='')
    object_height: float = quantity('height of the object', 'm', above=0.0, high=3.0, default=0.3)
    image_rate: float = quantity('images per second; 0: there is no camera', 'Hz', 0.0, 100.0,
                                 default=10.0)
    image_width: int = quantity('columns of an image', 'px', 16, 4096, default=640)
    image_height: int = quantity('rows of an image', 'px', 16, 4096, default=480)
    room_camera: tuple[float, ...] = quantity(
        'lens in the room (x, y, z, heading, angle below the horizon); empty: on the robot',
        'm, m, m, rad, rad', -100.0, 100.0, default=())
    publish_object_pose: bool = quantity('publish true object poses with the errors of sensors; '
                                         'false: leave them to what detects them in images',
                                         default=True)

    def __post_init__(self) -> None:
        """Validate the fields."""
        check(self)
        if len(self.room_camera) not in (0, 5):
            raise ValueError(f'MujocoSettings.room_camera: got {self.room_camera}, expected five '
                             'numbers or none')
        self.camera_of(SimulatedCamera())

    def camera_of(self, camera: SimulatedCamera) -> SimulatedCamera:
        """
        Choose the camera of the simulation.

        :param camera: that of the robot.
        :raises ValueError: where the lens in the room is below the floor, or turned too far.
        """
        camera = dataclasses.replace(camera, width=self.image_width, height=self.image_height,
                                     rate=self.image_rate or camera.rate)
        if not self.room_camera:
            return camera
        x, y, z, heading, pitch = self.room_camera
        return dataclasses.replace(camera, place='room', x=x, y=y, z=z,
                                   heading=math.remainder(heading, 2.0 * math.pi), pitch=pitch)
