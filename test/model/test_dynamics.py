"""Laws of the rolling-contact equation of motion."""

import math

import casadi as ca
from helpers.objects import bin_, box
import numpy as np
from push_model.contact import rolling_constants
from push_model.dynamics import (
    contact_force, derivative, impulse, Input, kinematics, moment_balance, ObjectTerms, State,
    yaw_acceleration)
from push_model.equation_of_motion import equation_of_motion
from push_model.parameters import GRAVITY
from push_model.quasi_static import quasi_static_yaw_rate
import pytest
from scipy.integrate import solve_ivp

pytestmark = pytest.mark.physics
FIXED = (0.0, 0.0)
MID_FACE = (-0.2, 0.0)


def spun_up(obj, speed, angle, duration):
    """Push mid-face with a direction constant in the object frame; return omega over time."""
    motion = equation_of_motion(obj, FIXED)

    def rate(_, x):
        e_x, e_y = math.cos(x[2] + angle), math.sin(x[2] + angle)
        u = (speed * e_x, speed * e_y, -x[3] * speed * e_y, x[3] * speed * e_x, x[3])
        return np.array(motion(x, u)[0]).ravel()

    times = np.linspace(0.0, duration, 50)
    run = solve_ivp(rate, (0.0, duration), [0, 0, 0, 0, 0, *MID_FACE], method='Radau',
                    t_eval=times, rtol=1e-8, atol=1e-10)
    return run.y[3]


@pytest.mark.parametrize('speed, ratio', [(0.05, 0.998), (0.25, 0.957), (0.5, 0.848),
                                          (1.0, 0.575), (2.0, 0.247)])
def test_dynamic_over_quasi_static_yaw_rate(speed, ratio):
    angle = math.radians(20)
    steady = spun_up(box(), speed, angle, 6.0 / speed)[-1]
    slow = quasi_static_yaw_rate(box(), MID_FACE, speed * math.cos(angle), speed * math.sin(angle))
    assert steady / slow == pytest.approx(ratio, abs=6e-4)


def test_mass_and_inertia_change_the_transient_but_not_the_steady_rate():
    runs = [spun_up(obj, 0.5, 0.3, 12.0) for obj in
            (box(), box(mass=0.5), box(mass=2.0, inertia=0.2))]
    assert runs[1][-1] == pytest.approx(runs[0][-1], rel=1e-6)
    assert runs[2][-1] == pytest.approx(runs[0][-1], rel=1e-6)
    assert abs(runs[2][1] - runs[0][1]) > 0.05 * abs(runs[0][-1])


def poles(obj, contact_point, rolling, speed):
    """Return the two poles of theta for a straight push along the normal, no robot spin."""
    motion = equation_of_motion(obj, rolling, 1e-9)
    x = ca.SX.sym('x', 7)
    rate = motion(x, ca.DM([speed, 0, 0, 0, 0]))[0]
    jacobian = ca.Function('J', [x], [ca.jacobian(rate, x)])
    values = np.linalg.eigvals(np.array(jacobian([0, 0, 0, 0, 0, *contact_point])))
    return sorted(values, key=abs)[-2:]


@pytest.mark.parametrize('speed, damping', [(0.5, 1.12), (1.5, 0.37), (2.5, 0.22)])
def test_damping_ratio_of_a_round_robot(speed, damping):
    obj = box(foot=0.4 / math.sqrt(12))
    pair = poles(obj, MID_FACE, rolling_constants(0.3, math.inf), speed)
    natural = math.sqrt(abs(pair[0] * pair[1]))
    assert -(pair[0] + pair[1]).real / (2 * natural) == pytest.approx(damping, abs=5e-3)


@pytest.mark.parametrize('robot, surface', [(0.2, math.inf), (0.5, 0.5 / 1.5), (2.0, 2.0 / 9.0)])
def test_stability_switches_where_the_friction_centre_passes_the_effective_radius(robot, surface):
    rolling = rolling_constants(robot, surface)
    assert rolling.effective_radius == pytest.approx(0.2)
    for factor in (0.99, 1.01):
        obj = box()
        growth = max(p.real for p in poles(obj, (-0.2 * factor, 0.0), rolling, 0.5))
        assert (growth > 0.0) == (factor > 1.0)


def test_growth_rate_of_a_fixed_point():
    obj = box()
    fast = max(p.real for p in poles(obj, MID_FACE, FIXED, 1e4))
    assert fast == pytest.approx(2.97, abs=5e-3)
    slow = max(p.real for p in poles(obj, MID_FACE, FIXED, 1e-3))
    assert slow == pytest.approx(1e-3 / 0.4, rel=1e-3)


def random_motion(seed):
    """Return a random state and input of a random object, with its rolling constants."""
    rng = np.random.default_rng(seed)
    obj = box(friction=rng.uniform(0.1, 0.6, 4), center_of_mass=tuple(rng.uniform(-.05, .05, 2)))
    rolling = rolling_constants(*rng.uniform(0.1, 1.0, 2))
    return obj, State(*rng.normal(size=5), *rng.uniform(-0.2, 0.2, 2)), \
        Input(*rng.normal(size=5)), rolling


@pytest.mark.parametrize('seed', range(5))
def test_work_of_the_contact_is_kinetic_energy_and_friction_loss(seed):
    obj, state, inputs, rolling = random_motion(seed)
    terms = ObjectTerms.of(obj)

    def kinetic(state, v_x, v_y):
        lever = rotated(state.theta, obj.center_of_mass[0] - state.c_x,
                        obj.center_of_mass[1] - state.c_y)
        g_x, g_y = v_x - state.omega * lever[1], v_y + state.omega * lever[0]
        return 0.5 * obj.mass * (g_x ** 2 + g_y ** 2) + 0.5 * obj.inertia * state.omega ** 2

    rate = derivative(terms, state, inputs, rolling)
    h = 1e-6

    def moved(sign):
        return kinetic(State(*(float(a + sign * h * b) for a, b in zip(state, rate))),
                       inputs.v_x + sign * h * inputs.a_x, inputs.v_y + sign * h * inputs.a_y)

    loss = 0.0
    for support, capacity in zip(obj.supports, obj.capacities):
        arm = rotated(state.theta, support.x - state.c_x, support.y - state.c_y)
        loss += capacity * math.hypot(inputs.v_x - state.omega * arm[1],
                                      inputs.v_y + state.omega * arm[0])
    normal, tangent = contact_force(terms, state, inputs, rate.omega, rolling)
    v_n, v_t = rotated(-state.gamma, inputs.v_x, inputs.v_y)
    power = float(normal * v_n + tangent * v_t)
    assert power == pytest.approx((moved(1) - moved(-1)) / (2 * h) + loss, rel=1e-5)


def rotated(angle, x, y):
    """Return the vector rotated by the angle."""
    return (math.cos(angle) * x - math.sin(angle) * y, math.sin(angle) * x + math.cos(angle) * y)


@pytest.mark.parametrize('seed', range(5))
def test_impulse_at_the_contact_keeps_the_angular_momentum_about_it(seed):
    obj, state, _, _ = random_motion(seed)
    terms = ObjectTerms.of(obj)
    dv = (0.3, -0.2)
    d_omega, j_n, j_t = (float(v) for v in impulse(terms, state, *dv))
    lever = rotated(state.theta, obj.center_of_mass[0] - state.c_x,
                    obj.center_of_mass[1] - state.c_y)
    jump = rotated(state.gamma, j_n / obj.mass, j_t / obj.mass)
    spin = obj.inertia * d_omega + obj.mass * (lever[0] * jump[1] - lever[1] * jump[0])
    assert spin == pytest.approx(0.0, abs=1e-12)
    assert jump[0] + d_omega * lever[1] == pytest.approx(dv[0])
    assert jump[1] - d_omega * lever[0] == pytest.approx(dv[1])


@pytest.mark.parametrize('seed', range(5))
def test_isotropy(seed):
    obj, state, inputs, rolling = random_motion(seed)
    angle = 0.7
    rotated_state = state._replace(theta=state.theta + angle, gamma=state.gamma + angle)
    rotated_input = Input(*rotated(angle, inputs.v_x, inputs.v_y),
                          *rotated(angle, inputs.a_x, inputs.a_y), inputs.omega_p)
    terms = ObjectTerms.of(obj)
    one = derivative(terms, state, inputs, rolling)
    two = derivative(terms, rotated_state, rotated_input, rolling)
    assert [two.x, two.y] == pytest.approx(rotated(angle, float(one.x), float(one.y)), abs=1e-9)
    assert [float(v) for v in two[2:]] == pytest.approx([float(v) for v in one[2:]], abs=1e-9)


def test_mirror_symmetry():
    terms = ObjectTerms.of(box())
    state, inputs = State(0, 0, 0.2, 0.4, 0.1, -0.2, 0.05), Input(0.3, 0.1, 0.2, -0.1, 0.6)
    mirrored = State(0, 0, -0.2, -0.4, -0.1, -0.2, -0.05), Input(0.3, -0.1, 0.2, 0.1, -0.6)
    signs = np.array([1, -1, -1, -1, -1, 1, -1])
    rolling = (0.3, 0.15)
    one = np.array([float(v) for v in derivative(terms, state, inputs, rolling)])
    two = np.array([float(v) for v in derivative(terms, *mirrored, rolling)])
    assert two == pytest.approx(signs * one, abs=1e-12)


def test_moment_balance_needs_no_speed_to_divide_by():
    terms, state = ObjectTerms.of(box()), State(0, 0, 0.1, 0.5, 0.2, -0.2, 0.05)
    inputs, rolling, scale = Input(1.0, 0.2, 0.1, 0.3, 0.4), (1.0, 0.17), 1e-6
    slow = state._replace(omega=state.omega * scale)
    crawl = Input(scale, 0.2 * scale, 0.1 * scale ** 2, 0.3 * scale ** 2, 0.4 * scale)
    friction = float(moment_balance(terms, slow, crawl, 0.0, rolling, 1e-5 * scale))
    quasi_static = moment_balance(terms._replace(mass=0.0, inertia=0.0), state, inputs, 0.0,
                                  rolling, 1e-5)
    assert friction == pytest.approx(float(quasi_static), rel=1e-9)


@pytest.mark.parametrize('robot, surface', [(0.17, 0.0), (0.17, math.inf), (0.17, 0.2)])
def test_rolling_differential_drive_conserves_arc_against_heading(robot, surface):
    """The arcs rolled off the robot and off the object stay equal."""
    obj = bin_() if surface == 0.2 else box()
    rolling = rolling_constants(robot, surface)
    motion = equation_of_motion(obj, rolling)
    start = (-0.2, 0.0)

    def rate(time, x):
        spin = 0.4 * math.sin(time)
        return np.append(np.array(motion(x[:7], [0.2, 0.02, 0, 0, spin])[0]).ravel(), spin)

    run = solve_ivp(rate, (0.0, 3.0), [0, 0, 0, 0, 0, *start, 0.0], method='Radau', rtol=1e-9,
                    atol=1e-11)
    theta, gamma, c_x, c_y, heading = run.y[[2, 4, 5, 6, 7], -1]
    assert abs(heading) > 0.3 and abs(theta) > 0.05
    on_robot = robot * (gamma - heading)
    if surface == 0.0:
        assert (c_x, c_y) == pytest.approx(start, abs=1e-12)
        assert on_robot == pytest.approx(0.0, abs=1e-9)
    elif math.isinf(surface):
        assert gamma == pytest.approx(theta, abs=1e-8)
        assert c_y == pytest.approx(robot * (theta - heading), abs=1e-8)
    else:
        angle = math.atan2(c_y, c_x) % (2 * math.pi) - math.pi
        assert math.hypot(c_x, c_y) == pytest.approx(0.2, abs=1e-8)
        assert gamma - theta == pytest.approx(angle, abs=1e-8)
        assert on_robot == pytest.approx(-0.2 * angle, abs=1e-8)


def test_rates_are_consistent_with_the_balance():
    obj, state, inputs, rolling = random_motion(7)
    terms = ObjectTerms.of(obj)
    omega_dot = yaw_acceleration(terms, state, inputs, rolling)
    assert float(moment_balance(terms, state, inputs, omega_dot, rolling)) == pytest.approx(
        0.0, abs=1e-12)
    assert kinematics(state, inputs, omega_dot, rolling) == derivative(terms, state, inputs,
                                                                       rolling)


def test_straight_push_through_the_centre_needs_the_friction_force():
    obj = box()
    state, inputs = State(0, 0, 0, 0, 0, -0.2, 0), Input(0.2, 0, 0.5, 0, 0)
    normal, tangent = contact_force(ObjectTerms.of(obj), state, inputs, 0.0, FIXED, 1e-9)
    assert float(normal) == pytest.approx(obj.mass * (0.3 * GRAVITY + 0.5))
    assert float(tangent) == pytest.approx(0.0, abs=1e-12)
