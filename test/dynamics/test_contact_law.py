"""Contact law of the kernel: the closed form against iteration, and what holds for any impulse."""

import math

from helpers.objects import box
import numpy as np
from push_dynamics.compiled import kernel_array
from push_dynamics.contact_law import (
    contact_impulse, ContactEquations, ContactImpulse, ContactPoint, law_violation,
    nearest_points, surface_velocity, Velocity,
)
from push_dynamics.encoding import NO_OUTLINE
from push_dynamics.layout import ANY_MODE, SEPARATE, SLIDE_LEFT, SLIDE_RIGHT, STICK
from push_model.geometry import Pose
import pytest

MIRRORED = {SEPARATE: SEPARATE, STICK: STICK, SLIDE_LEFT: SLIDE_RIGHT, SLIDE_RIGHT: SLIDE_LEFT}
MODES = list(MIRRORED)
OUTLINE = box(0.4).outline


def cases(count=2000, seed=1, largest_friction=3.0):
    """Draw ``ContactEquations`` and a friction coefficient."""
    rng = np.random.default_rng(seed)
    for _ in range(count):
        root = rng.normal(size=(2, 2))
        w = root @ root.T + 0.05 * np.eye(2)
        need_n, need_t = rng.normal(size=2)
        yield (ContactEquations(w[0, 0], w[0, 1], w[1, 1], need_n, need_t),
               rng.uniform(0.0, largest_friction))


def mirrored(equations):
    """Return the equations as seen in a mirror along the normal."""
    return equations._replace(w_nt=-equations.w_nt, need_t=-equations.need_t)


def violation_of(case, impulse):
    """Return how far an impulse is from the law, for an object of 1 kg."""
    (w_nn, w_nt, w_tt, need_n, need_t), friction = case
    missing = need_n - w_nn * impulse.normal - w_nt * impulse.tangential
    slip = w_nt * impulse.normal + w_tt * impulse.tangential - need_t
    return law_violation(impulse, missing, slip, friction, 1.0)


def iterated(case, sweeps=3000):
    """Return (normal, tangential) impulse by projected Gauss-Seidel iteration."""
    (w_nn, w_nt, w_tt, need_n, need_t), friction = case
    normal = tangential = 0.0
    for _ in range(sweeps):
        normal = max(0.0, (need_n - w_nt * tangential) / w_nn)
        free = (need_t - w_nt * normal) / w_tt
        tangential = min(friction * normal, max(-friction * normal, free))
    return normal, tangential


def test_impulse_keeps_to_the_law_and_to_its_cone():
    """All modes occur; the robot never pulls, and friction stays within the cone."""
    met = set()
    for case in cases():
        impulse = contact_impulse(*case, ANY_MODE)
        met.add(impulse.mode)
        assert impulse.normal >= 0.0
        assert abs(impulse.tangential) <= case[-1] * impulse.normal * (1.0 + 1e-12)
        assert violation_of(case, impulse) < 1e-9
    assert met == set(MODES)


def test_closed_form_is_what_iteration_finds():
    """Where coupling and friction are weak enough for one solution."""
    compared = 0
    for case in cases(400, seed=2, largest_friction=0.8):
        (w_nn, w_nt, w_tt, need_n, _), friction = case
        if need_n <= 0.0 or friction * abs(w_nt) > 0.5 * w_nn or w_nt ** 2 > 0.5 * w_nn * w_tt:
            continue
        impulse = contact_impulse(*case, ANY_MODE)
        assert (impulse.normal, impulse.tangential) == pytest.approx(iterated(case), abs=1e-9)
        compared += 1
    assert compared > 50


def test_imposed_modes_include_the_one_that_the_law_selects():
    """Imposing each in turn and taking the one that keeps to the law gives the same impulse."""
    for case in cases(500, seed=3):
        selected = contact_impulse(*case, ANY_MODE)
        imposed = contact_impulse(*case, selected.mode)
        assert imposed == selected
        for mode in MODES:
            assert contact_impulse(*case, mode).mode == mode


def test_mirrored_world_has_the_mirrored_impulse():
    for equations, friction in cases(500, seed=4):
        one = contact_impulse(equations, friction, ANY_MODE)
        two = contact_impulse(mirrored(equations), friction, ANY_MODE)
        assert two.mode == MIRRORED[one.mode]
        assert two.normal == one.normal and two.tangential == -one.tangential


def test_a_robot_at_rest_makes_no_energy():
    """The kinetic energy changes by l.u + l.W l / 2, u being the velocity before the impulse."""
    for case in cases(seed=5):
        (w_nn, w_nt, w_tt, need_n, need_t), _ = case
        normal, tangential, _ = contact_impulse(*case, ANY_MODE)
        change = (-need_n * normal - need_t * tangential
                  + 0.5 * (w_nn * normal ** 2 + w_tt * tangential ** 2)
                  + w_nt * normal * tangential)
        assert change <= 1e-9


def test_a_contact_that_creeps_slips_in_proportion_to_its_force():
    """``slip = creep l_t / (mu_c l_n)`` inside the cone; at its edge the surfaces slide."""
    met, rng = set(), np.random.default_rng(8)
    for case in cases(seed=8):
        (w_nn, w_nt, w_tt, need_n, need_t), friction = case
        creep = rng.uniform(0.01, 0.5)
        normal, tangential, mode = contact_impulse(*case, ANY_MODE, creep)
        slip = need_t - w_nt * normal - w_tt * tangential
        met.add(mode)
        assert normal >= 0.0 and abs(tangential) <= friction * normal * (1.0 + 1e-9)
        if mode == SEPARATE:
            assert need_n <= 0.0
            continue
        assert w_nn * normal + w_nt * tangential == pytest.approx(need_n, abs=1e-9)
        if mode == STICK:
            expected = creep * tangential / (friction * normal)
            assert slip == pytest.approx(expected, rel=1e-6, abs=1e-9)
        else:
            side = 1.0 if mode == SLIDE_LEFT else -1.0
            assert tangential == pytest.approx(side * friction * normal)
            assert side * slip >= creep * (1.0 - 1e-9)
            assert law_violation(ContactImpulse(normal, tangential, mode), 0.0, -slip, friction,
                                 1.0, creep) < 1e-9
    assert met == set(MODES)


def test_little_creep_is_nearly_none():
    """The impulse tends to that of Coulomb's law with the creep."""
    for case in cases(500, 9):
        coulomb = np.array(contact_impulse(*case, ANY_MODE)[:2])
        for creep in (1e-6, 1e-12):
            found = np.array(contact_impulse(*case, ANY_MODE, creep)[:2])
            assert np.abs(found - coulomb).max() <= 1e3 * creep + 1e-9


def test_creep_is_the_same_in_a_mirror():
    for equations, friction in cases(500, 10):
        one = contact_impulse(equations, friction, ANY_MODE, 0.1)
        two = contact_impulse(mirrored(equations), friction, ANY_MODE, 0.1)
        assert (two.normal, two.tangential) == pytest.approx((one.normal, -one.tangential))
        assert two.mode == MIRRORED[one.mode]


def test_violation_is_that_of_the_mode():
    """Of unilaterality in any mode, of the cone where it sticks, of the side where it slides."""
    assert law_violation(ContactImpulse(0.0, 0.0, SEPARATE), 0.2, 1.0, 0.5, 2.0) == 0.2
    assert law_violation(ContactImpulse(-1.0, 0.0, SEPARATE), -0.2, 1.0, 0.5, 2.0) == 0.5
    assert law_violation(ContactImpulse(1.0, -0.9, STICK), 0.0, 1.0, 0.5, 2.0) == (
        pytest.approx(0.2))
    assert law_violation(ContactImpulse(1.0, 0.5, SLIDE_LEFT), 0.0, -0.3, 0.5, 2.0) == 0.0
    assert law_violation(ContactImpulse(1.0, 0.5, SLIDE_LEFT), 0.0, 0.3, 0.5, 2.0) == 0.3
    assert law_violation(ContactImpulse(1.0, -0.5, SLIDE_RIGHT), 0.0, -0.3, 0.5, 2.0) == 0.3


@pytest.mark.parametrize('outline, disc_radius', [(OUTLINE, 0.0), (NO_OUTLINE, 0.2)])
@pytest.mark.parametrize('robot_radius', [0.0, 0.17, math.inf])
def test_nearest_points_are_the_nearest_of_a_sampled_outline(outline, disc_radius, robot_radius):
    rng = np.random.default_rng(6)
    fractions = np.linspace(0.0, 1.0, 2001)[:, None]
    if disc_radius:
        angles = 2.0 * math.pi * fractions[:, 0]
        local = disc_radius * np.column_stack([np.cos(angles), np.sin(angles)])
    else:
        corners = np.array(outline)
        local = np.concatenate([a + fractions * (b - a)
                                for a, b in zip(corners, np.roll(corners, -1, axis=0))])
    for _ in range(50):
        pose = Pose(*rng.uniform(-1.0, 1.0, 2), rng.uniform(-3.0, 3.0))
        heading, bearing = rng.uniform(-3.0, 3.0, 2)
        robot = Pose(pose.x + 0.6 * math.cos(bearing), pose.y + 0.6 * math.sin(bearing), heading)
        found = nearest_points(kernel_array(outline), disc_radius, robot_radius, pose, robot)
        points = np.column_stack(pose.transform(local.T))
        normal = np.array([found.n_x, found.n_y])
        assert np.hypot(*normal) == pytest.approx(1.0)
        away = points - robot[:2]
        # A flat pusher is the line through its position across its heading.
        distances = away @ normal if math.isinf(robot_radius) else (
            np.hypot(*away.T) - robot_radius)
        assert found.gap == pytest.approx(distances.min(), abs=4e-4)
        assert np.hypot(*(points - (found.x, found.y)).T).min() < 4e-4
        if math.isinf(robot_radius):
            assert normal == pytest.approx((math.cos(heading), math.sin(heading)))
        else:
            touch = np.array(robot[:2]) + (found.gap + robot_radius) * normal
            assert touch == pytest.approx((found.x, found.y), abs=1e-12)


@pytest.mark.parametrize('robot_radius', [0.0, 0.17, math.inf])
def test_surface_velocity_is_that_of_the_material_of_the_robot(robot_radius):
    """By moving the robot a little, the point of its surface fixed in it."""
    rng = np.random.default_rng(7)
    for _ in range(20):
        robot = Pose(*rng.uniform(-1.0, 1.0, 2), rng.uniform(-3.0, 3.0))
        v_x, v_y, omega = rng.normal(size=3)
        if math.isinf(robot_radius):
            normal, along = robot.theta, rng.uniform(-1.0, 1.0)
            arm = -along * math.sin(normal), along * math.cos(normal)
        else:
            normal = rng.uniform(-3.0, 3.0)
            arm = robot_radius * math.cos(normal), robot_radius * math.sin(normal)
        n_x, n_y = math.cos(normal), math.sin(normal)
        time = 1e-6
        moved = Pose(robot.x + time * v_x, robot.y + time * v_y, robot.theta + time * omega)
        local = Pose(0.0, 0.0, -robot.theta).rotate(arm)
        change = (np.array(moved.transform(local)) - robot[:2] - arm) / time
        found = surface_velocity(
            robot_radius, ContactPoint(n_x, n_y, robot.x + arm[0], robot.y + arm[1], 0.0), robot,
            Velocity(v_x, v_y, omega))
        assert found == pytest.approx((change @ (n_x, n_y), change @ (-n_y, n_x)), abs=1e-5)
