"""
Images of a scene, drawn without a window: by EGL, or in software by OSMesa.

``MUJOCO_GL`` names one of the two; otherwise the first is taken that is there.
"""

import importlib
import os
from types import TracebackType
from typing import Any, NamedTuple, Sequence
import weakref

import mujoco
import numpy as np
from numpy.typing import NDArray
from push_dynamics.walls import Wall
from push_model.geometry import Pose
from push_model.parameters import PushedObject
from push_mujoco.appearance import looks_of, Picture
from push_mujoco.camera import SimulatedCamera
from push_mujoco.scene import Room
from push_mujoco.simulated_robot import SimulatedRobot
from push_mujoco.wheeled_robot import OBJECT_HEIGHT, WheeledPlant

# MuJoCo defines these in an extension module without type stubs.
_mujoco: Any = mujoco
BACKENDS = 'egl', 'osmesa'
# Shapes of a scene that are drawn at most; chosen: those of a flat.
MAX_SHAPES = 5000


class TaggedScene(NamedTuple):
    """
    Robot and object, as cameras see them.

    :param robot: ``SimulatedRobot``.
    :param object: the ``PushedObject``.
    :param pictures: on it.
    :param height: of it [m].
    """

    robot: SimulatedRobot
    object: PushedObject
    pictures: tuple[Picture, ...] = ()
    height: float = OBJECT_HEIGHT


class NoRenderer(RuntimeError):
    """Nothing on this machine draws images."""


class Renderer:
    """
    Draws what a camera sees; to be closed, or used as a context.

    ``model``: that of MuJoCo. ``camera``: the ``SimulatedCamera``.

    :param model: of MuJoCo.
    :param camera: ``SimulatedCamera``.
    :param noise: ``numpy.random.Generator`` of the noise of its pixels; None for none.
    :raises NoRenderer: where there is neither EGL nor OSMesa.
    """

    def __init__(self, model: Any, camera: SimulatedCamera,
                 noise: np.random.Generator | None = None) -> None:
        self.camera = camera
        self.model = model
        self._noise = noise
        self._gl = _make_gl_context(camera.width, camera.height)
        self._gl.make_current()
        self._context = _mujoco.MjrContext(model, _mujoco.mjtFontScale.mjFONTSCALE_100)
        _mujoco.mjr_resizeOffscreen(camera.width, camera.height, self._context)
        _mujoco.mjr_setBuffer(_mujoco.mjtFramebuffer.mjFB_OFFSCREEN, self._context)
        self._scene = _mujoco.MjvScene(model, MAX_SHAPES)
        self._scene.flags[_mujoco.mjtRndFlag.mjRND_SHADOW] = False
        self._scene.flags[_mujoco.mjtRndFlag.mjRND_REFLECTION] = False
        # Where it is not closed, as soon as nobody has it; at the end of the process in time.
        self._release = weakref.finalize(self, _release, self._gl, self._context)
        self._option = _mujoco.MjvOption()
        self._view = _mujoco.MjvCamera()

    def __enter__(self) -> 'Renderer':
        """Return itself."""
        return self

    def __exit__(self, _: type[BaseException] | None, __: BaseException | None,
                 ___: TracebackType | None) -> None:
        """Close it."""
        self.close()

    def close(self) -> None:
        """Give back what graphics hold."""
        self._release()

    def render(self, data: Any, robot_pose: Pose) -> NDArray[np.uint8]:
        """
        Draw the scene as it is now.

        :param data: of MuJoCo.
        :param robot_pose: ``Pose`` of the robot in the world, which the camera may be on.
        :return: red, green and blue, shape (height, width, 3).
        """
        camera = self.camera
        self._gl.make_current()
        _mujoco.mjv_updateScene(self.model, data, self._option, None, self._view,
                                _mujoco.mjtCatBit.mjCAT_ALL, self._scene)
        self._look(robot_pose)
        image = np.empty((camera.height, camera.width, 3), dtype=np.uint8)
        area = _mujoco.MjrRect(0, 0, camera.width, camera.height)
        _mujoco.mjr_render(area, self._scene, self._context)
        _mujoco.mjr_readPixels(image, None, area, self._context)
        # Rows come from below.
        return self._with_noise(image[::-1])

    def _look(self, robot_pose: Pose) -> None:
        """Put both eyes of the scene where the lens is."""
        lens, camera = self.camera.lens(robot_pose), self.camera
        for eye in self._scene.camera:
            eye.pos[:] = lens.position
            eye.forward[:] = lens.rotation[:, 2]
            eye.up[:] = -lens.rotation[:, 1]
            half = 0.5 * camera.height / camera.focal_length * eye.frustum_near
            eye.frustum_bottom, eye.frustum_top = -half, half
            eye.frustum_center = 0.0
            eye.frustum_width = half * camera.width / camera.height

    def _with_noise(self, image: NDArray[np.uint8]) -> NDArray[np.uint8]:
        if self._noise is None or self.camera.noise == 0.0:
            return np.ascontiguousarray(image)
        noise = self._noise.normal(0.0, self.camera.noise, image.shape).astype(np.float32)
        return np.clip(np.rint(image + noise), 0.0, 255.0).astype(np.uint8)


def render_camera(scene: TaggedScene, camera: SimulatedCamera, object_pose: Pose,
                  robot_pose: Pose, *, walls: Sequence[Wall] = (),
                  noise: np.random.Generator | None = None) -> NDArray[np.uint8]:
    """
    Draw one image; who draws many of a scene keeps a ``Renderer``.

    :param scene: ``TaggedScene``.
    :param camera: ``SimulatedCamera``.
    :param object_pose: ``Pose`` of the object in the world.
    :param robot_pose: ``Pose`` of the robot in the world.
    :param walls: ``Wall`` sequence.
    :param noise: as of ``Renderer``.
    :return: red, green and blue, shape (height, width, 3).
    :raises NoRenderer: as of ``Renderer``.
    """
    plant = WheeledPlant(scene.robot, Room(tuple(walls)), scene.object, object_pose, robot_pose,
                         looks_of(scene.pictures, scene.height))
    with Renderer(plant.model, camera, noise) as renderer:
        return renderer.render(plant.data, robot_pose)


def _release(gl: Any, context: Any) -> None:
    gl.make_current()
    context.free()
    gl.free()


def check_graphics() -> None:
    """
    Check that images can be drawn here.

    :raises NoRenderer: where there is neither EGL nor OSMesa.
    """
    _make_gl_context(16, 16).free()


def _make_gl_context(width: int, height: int) -> Any:
    """Make what draws off the screen."""
    chosen = os.environ.get('MUJOCO_GL', '')
    reasons: list[str] = []
    for backend in (chosen,) if chosen in BACKENDS else BACKENDS:
        try:
            return importlib.import_module(f'mujoco.{backend}').GLContext(width, height)
        # PyOpenGL and both libraries each fail in ways of their own.
        except Exception as error:  # noqa: B902 (named)
            reasons.append(f'{backend}: {type(error).__name__}: {error}')
    raise NoRenderer('no images: neither EGL nor OSMesa is there: ' + '; '.join(reasons))
