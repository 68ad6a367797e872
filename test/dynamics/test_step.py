"""One step of the kernel: momentum balance, mass matrix, energies, mirrored worlds."""

import math

from helpers.objects import bin_, box
from helpers.plant_course import UNEVEN
import numpy as np
from push_dynamics import layout
from push_dynamics.compiled import kernel_array
from push_dynamics.contact_law import Velocity
from push_dynamics.encoding import (
    body_values, drive_values, encode_velocities, initial_state, NO_OUTLINE, support_rows,
)
from push_dynamics.floor import floor_rows, FloorPatch, set_local_capacities
from push_dynamics.step import advance, step
from push_dynamics.support_friction import augmented_mass, velocity_of
from push_dynamics.wall_grid import NO_WALLS
from push_model.contact import find_contact
from push_model.geometry import Pose
from push_model.parameters import RoundRobot
from push_model.signals import Twist
import pytest

pytestmark = pytest.mark.physics
ROBOT = RoundRobot(0.17, 'holonomic', max_speed=2.0, max_acceleration=50.0, time_constant=0.0)
OBJECTS = [box(**UNEVEN), bin_(), box(contact_friction_coefficient=0.1, **UNEVEN)]
IDS = ['box', 'bin', 'slippery box']
MIRROR = np.array([1.0, -1.0, -1.0])
NO_FLOOR = np.zeros((0, layout.PATCH_SIZE))
STEP = 2e-3


class Kernel:
    """Arguments of the kernel for an object and a robot beside it."""

    def __init__(self, obj, object_pose, robot_pose, object_twist=Twist(), robot_twist=Twist(),
                 command=Twist(0.3, 0.1, 0.5)):
        state = initial_state(obj, object_pose, robot_pose)
        encode_velocities(state, obj.center_of_mass, object_twist, robot_twist)
        self.state = kernel_array(state)
        self.body = kernel_array(body_values(obj, ROBOT, 1e-5))
        self.supports = kernel_array(support_rows(obj, obj.capacities,
                                                  [1.0] * len(obj.supports)))
        self.outline = kernel_array(obj.outline or NO_OUTLINE)
        self.forces = kernel_array([0.0] * 2 * len(obj.supports))
        self.command = kernel_array(command)

    def world(self, floor=NO_FLOOR):
        """Return what ``step`` and ``advance`` take before the duration."""
        return layout.World(
            self.state, self.body, self.supports, self.outline, kernel_array(floor), self.forces,
            kernel_array(drive_values(ROBOT)), self.command,
            NO_WALLS,
            kernel_array(np.zeros((0, layout.TOUCH_SIZE))))

    def numbers(self, *indices):
        """Return numbers of the state."""
        return np.array([float(self.state[i]) for i in indices])

    @property
    def velocity(self):
        """Velocity of the mass centre."""
        return self.numbers(layout.V_X, layout.V_Y, layout.OMEGA)


def random_kernel(obj, rng):
    """Return a kernel whose object moves and whose robot touches it nearly, from one side."""
    bearing, heading = rng.uniform(-3.0, 3.0, 2)
    object_pose = Pose(*rng.uniform(-1.0, 1.0, 2), rng.uniform(-3.0, 3.0))
    x, y = object_pose.transform((math.cos(bearing), math.sin(bearing)))
    distance = rng.uniform(0.0, 1e-3)
    for _ in range(3):
        _, normal, gap = find_contact(obj, object_pose, (x, y), ROBOT.radius)
        x += (gap - distance) * math.cos(normal)
        y += (gap - distance) * math.sin(normal)
    robot_twist = Twist(*rng.normal(0.0, 0.3, 2), rng.normal())
    return Kernel(obj, object_pose, Pose(x, y, heading), Twist(*rng.normal(0.0, 0.3, 3)),
                  robot_twist, Twist(*rng.normal(0.0, 0.5, 3)))


@pytest.mark.parametrize('obj', OBJECTS, ids=IDS)
def test_mass_matrix_with_friction_weights(obj):
    """Against the matrix written out, solved by elimination."""
    rng = np.random.default_rng(1)
    body = kernel_array(body_values(obj, ROBOT, 1e-5))
    supports = support_rows(obj, obj.capacities, [1.0] * len(obj.supports))
    for _ in range(30):
        theta, velocity = rng.uniform(-3.0, 3.0), rng.normal(size=3)
        matrix = np.diag([obj.mass, obj.mass, obj.inertia])
        for s_x, s_y, capacity, *_ in supports:
            x, y = Pose(0.0, 0.0, theta).rotate((s_x, s_y))
            rows = np.array([[1.0, 0.0, -y], [0.0, 1.0, x]])
            matrix += STEP * capacity / np.hypot(*rows @ velocity) * rows.T @ rows
        momentum = rng.normal(size=3)
        augmented = augmented_mass(body, kernel_array(supports), math.cos(theta), math.sin(theta),
                                   STEP, Velocity(*velocity))
        assert velocity_of(augmented, *momentum) == pytest.approx(
            np.linalg.solve(matrix, momentum), rel=1e-6, abs=1e-9)


@pytest.mark.parametrize('obj', OBJECTS, ids=IDS)
def test_momentum_is_what_contact_and_supports_give(obj):
    """The contact acts in the nearest point, the friction of each support at its place."""
    rng, touched = np.random.default_rng(2), 0
    for _ in range(60):
        kernel = random_kernel(obj, rng)
        before = kernel.velocity
        pose = Pose(*kernel.numbers(layout.X, layout.Y, layout.THETA))
        step(kernel.world(), STEP)
        change = (kernel.velocity - before) * (obj.mass, obj.mass, obj.inertia)
        # Arms are those in the middle of the step.
        rotation = Pose(0.0, 0.0, pose.theta + 0.5 * STEP * before[2])
        total = np.zeros(3)
        for support, force in zip(kernel.supports, np.reshape(kernel.forces, (-1, 2))):
            x, y = rotation.rotate((support[0], support[1]))
            total += STEP * np.array([*force, x * force[1] - y * force[0]])
        contact = change - total
        size = kernel.numbers(layout.NORMAL_FORCE, layout.TANGENTIAL_FORCE) * STEP
        assert np.hypot(*contact[:2]) == pytest.approx(np.hypot(*size), abs=2e-5)
        if size[0] > 1e-6:
            touched += 1
            assert abs(contact[2]) <= 0.35 * np.hypot(*size) + 2e-5
    assert touched > 10


@pytest.mark.parametrize('obj', OBJECTS, ids=IDS)
def test_impulse_is_inside_the_cone_and_no_energy_is_made(obj):
    """Work is kinetic energy plus losses, none of which is negative, in every single step."""
    rng, modes = np.random.default_rng(3), set()
    for _ in range(100):
        kernel = random_kernel(obj, rng)

        def kinetic():
            return 0.5 * kernel.velocity ** 2 @ (obj.mass, obj.mass, obj.inertia)

        before = kinetic()
        step(kernel.world(), STEP)
        normal, tangential = kernel.numbers(layout.NORMAL_FORCE, layout.TANGENTIAL_FORCE)
        assert normal >= 0.0
        assert abs(tangential) <= obj.contact_friction_coefficient * normal * (1.0 + 1e-9)
        work, *losses = kernel.numbers(layout.WORK, layout.SUPPORT_LOSS, layout.CONTACT_LOSS,
                                       layout.IMPACT_LOSS, layout.INTEGRATION_LOSS)
        scale = max(before, abs(work), 1e-3)
        assert min(losses) >= -1e-6 * scale
        assert work == pytest.approx(kinetic() - before + sum(losses), abs=1e-5 * scale)
        modes.add(int(kernel.state[layout.MODE]))
    assert {layout.SEPARATE, layout.STICK} <= modes and len(modes) >= 3


def test_mirrored_world_takes_the_mirrored_step():
    """Box and bin on even supports, reflected in the x axis."""
    rng = np.random.default_rng(4)
    for obj in (box(), bin_(feet=4)):
        for _ in range(30):
            theta, y = rng.uniform(-0.3, 0.3), rng.uniform(-0.1, 0.1)
            twist, command = rng.normal(0.0, 0.2, 3), np.array([0.5, *rng.normal(0.0, 0.3, 2)])
            ends = []
            for side in (np.ones(3), MIRROR):
                kernel = Kernel(obj, Pose(*side * (0.0, 0.0, theta)),
                                Pose(*side * (-0.45, y, 0.2)), Twist(*side * twist), Twist(),
                                Twist(*side * command))
                advance(kernel.world(), 0.3, STEP)
                ends.append(kernel)
            poses = [kernel.numbers(layout.X, layout.Y, layout.THETA) for kernel in ends]
            assert poses[1] == pytest.approx(MIRROR * poses[0], abs=1e-7)
            assert ends[1].velocity == pytest.approx(MIRROR * ends[0].velocity, abs=1e-5)


def test_a_duration_is_divided_into_equal_steps():
    """None longer than the longest; a duration that is a whole number of steps takes as many."""
    for duration, steps in ((STEP, 1), (10 * STEP, 10), (2.5 * STEP, 3), (1e-4, 1)):
        kernel = Kernel(box(), Pose(0.0, 0.0, 0.0), Pose(-1.0, 0.0, 0.0))
        advance(kernel.world(), duration, STEP)
        assert kernel.state[layout.STEPS] == steps
    one, many = (Kernel(box(), Pose(0.0, 0.0, 0.0), Pose(-0.37, 0.02, 0.0)) for _ in range(2))
    advance(one.world(), 4 * STEP, STEP)
    for _ in range(4):
        advance(many.world(), STEP, STEP)
    assert np.array(many.state) == pytest.approx(np.array(one.state), abs=1e-12)


@pytest.mark.parametrize('obj', OBJECTS, ids=IDS)
def test_out_of_reach_the_robot_moves_alone(obj):
    """What is left out where the robot is far off changes nothing, and the touch comes in time."""
    far_patch = floor_rows([FloorPatch(50.0, 50.0, 51.0, 51.0, 0.5)])
    ends = []
    # With a patch of floor anywhere nothing is left out.
    for floor in (NO_FLOOR, far_patch):
        kernel = Kernel(obj, Pose(0.0, 0.0, 0.3), Pose(-1.2, 0.05, 0.2),
                        command=Twist(1.5, -0.3, 0.05))
        advance(kernel.world(floor), 0.7, 10 * STEP)
        ends.append(kernel)
    counts = [layout.ITERATIONS]
    alone, whole = (np.delete(np.array(kernel.state), counts) for kernel in ends)
    assert np.array_equal(alone, whole)
    assert np.array_equal(np.array(ends[0].forces), np.array(ends[1].forces))
    assert np.hypot(*ends[0].numbers(layout.X, layout.Y)) > 0.02


@pytest.mark.parametrize('obj', OBJECTS, ids=IDS)
def test_an_object_that_nobody_pushes_comes_to_rest(obj):
    """Viscous friction near rest alone would leave it a velocity, and every step all its work."""
    twist = Twist(0.1, -0.05, 0.2)
    kernel = Kernel(obj, Pose(0.0, 0.0, 0.3), Pose(-9.0, 0.0, 0.0), twist, command=Twist())
    # It slides on for at most v / (mu g), and slows down from there by a factor in every step.
    friction = sum(obj.capacities) / obj.mass
    advance(kernel.world(), 2.0 * math.hypot(*twist) / friction + 20 * STEP, STEP)
    slid = kernel.numbers(layout.X, layout.Y, layout.THETA)
    assert not kernel.numbers(*range(layout.V_X, layout.A_OMEGA + 1)).any()
    advance(kernel.world(), 1.0, STEP)
    assert np.array_equal(kernel.numbers(layout.X, layout.Y, layout.THETA), slid)


def test_local_capacities_are_those_of_the_floor_under_each_support():
    obj = box()
    supports = kernel_array(support_rows(obj, obj.capacities, [1.0] * 4))
    floor = kernel_array(floor_rows([FloorPatch(1.0, 0.0, 2.0, 4.0, 0.25)]))
    set_local_capacities(floor, supports, 0.0, 0.0, 1.0, 0.0)
    plain = obj.capacities[0]
    assert [row[layout.CAPACITY] for row in supports] == pytest.approx(
        [plain, 0.25 * plain, 0.25 * plain, plain])
    assert [row[layout.PLAIN_CAPACITY] for row in supports] == pytest.approx([plain] * 4)
