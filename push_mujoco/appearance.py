"""What cameras see of a scene besides its bodies: pictures on the object, floor, lights."""

from typing import NamedTuple, Sequence

import numpy as np
from numpy.typing import NDArray
from push_model.rigid_transform import RigidTransform
from push_mujoco.scene import Part, xml
from push_mujoco.wheeled_robot import Looks, OBJECT_HEIGHT

# Pixels of a picture in its texture, at least along an edge [px]; chosen: the edges of its cells
# are sharper than in any image.
TEXTURE_EDGE = 240
# How far a picture stands off its face, and its thickness [m]; chosen: nothing shows through.
OFFSET, THICKNESS = 2e-4, 1e-4
# Colours (red, green, blue), chosen: tags stand out from them.
SKY_COLOR = '0.75 0.78 0.8'
FLOOR_COLORS = '0.5 0.5 0.52', '0.58 0.58 0.6'
# Attributes of a floor with the pattern of ``_room_part``.
FLOOR = ' material="floor"'


class Picture(NamedTuple):
    """
    A square picture on the object, as of a tag with its white margin.

    :param name: no two have the same.
    :param edge: its length [m].
    :param pose: ``RigidTransform`` in the frame of the object: from its middle x goes to the right
        of who looks at it, y up, z towards him.
    :param pixels: grey values, the upper row first, shape (n, n).
    """

    name: str
    edge: float
    pose: RigidTransform
    pixels: NDArray[np.uint8]


def looks_of(pictures: Sequence[Picture] = (), height: float = OBJECT_HEIGHT) -> Looks:
    """
    Describe what a camera sees besides the robot.

    :param pictures: on the object.
    :param height: of the object [m].
    """
    parts = [_picture_part(picture) for picture in pictures]
    return Looks(height, Part(''.join(part.bodies for part in parts),
                              assets=''.join(part.assets for part in parts)),
                 _room_part(), FLOOR,
                 {_file(picture): _texture(picture.pixels) for picture in pictures})


def _texture(pixels: NDArray[np.uint8]) -> bytes:
    """Write a picture as the file of a texture, enlarged without a blur."""
    # Imported here: scenes without pictures do without it.
    import cv2
    cell = np.ones(2 * (max(1, -(-TEXTURE_EDGE // len(pixels))),), dtype=np.uint8)
    return bytes(cv2.imencode('.png', np.kron(pixels, cell))[1])


def _picture_part(picture: Picture) -> Part:
    """Write a picture: a thin plate, which has it in front."""
    name, half, pose = picture.name, 0.5 * picture.edge, picture.pose
    square = ((-half, -half), (half, -half), (half, half), (-half, half))
    vertices = [coordinate for z in (OFFSET, OFFSET - THICKNESS)
                for x, y in square for coordinate in (x, y, z)]
    axes = xml(*pose.rotate((1.0, 0.0, 0.0)), *pose.rotate((0.0, 1.0, 0.0)))
    assets = (
        f'<texture name="{name}" type="2d" file="{_file(picture)}"/>'
        f'<material name="{name}" texture="{name}" specular="0" shininess="0"/>'
        f'<mesh name="{name}" vertex="{xml(*vertices)}" '
        f'texcoord="{xml(*2 * (0, 1, 1, 1, 1, 0, 0, 0))}" '
        'face="0 1 2 0 2 3 4 6 5 4 7 6 0 4 5 0 5 1 1 5 6 1 6 2 2 6 7 2 7 3 3 7 4 3 4 0"/>')
    return Part(f'<geom name="{name}" type="mesh" mesh="{name}" material="{name}" '
                f'pos="{xml(pose.x, pose.y, pose.z)}" xyaxes="{axes}" group="1"/>', assets=assets)


def _file(picture: Picture) -> str:
    return f'{picture.name}.png'


def _room_part() -> Part:
    """Write lights, the sky, and the pattern of the floor."""
    light, dark = FLOOR_COLORS
    return Part(
        '<light directional="true" pos="0 0 4" dir="0.3 0.2 -1" diffuse="0.35 0.35 0.35" '
        'specular="0 0 0" castshadow="false"/>',
        assets=f'<texture type="skybox" builtin="gradient" rgb1="{SKY_COLOR}" '
        f'rgb2="{SKY_COLOR}" width="32" height="192"/>'
        f'<texture name="floor" type="2d" builtin="checker" rgb1="{light}" rgb2="{dark}" '
        'width="256" height="256"/><material name="floor" texture="floor" texrepeat="9 9" '
        'specular="0" shininess="0"/>')
