"""
What casters change: a box on feet and casters, pushed at the middle of its rear face.

A prototype beside the package's model, which knows no casters. The robot is a point that sticks to
the box, so that only the rotation of the box is free; moments about the contact C, as in
docs/physics.md:

    (I + m r^2) omega' = sum (s_i - C) x f_i + sum tau_i - m r x a_C

A caster i has no mass. Its wheel is the trail t behind its swivel axis s_i, against its heading
h, and does not slide. With p to the left of h, v_i the velocity of the axis, and psi the angle of
h in the frame of the box:

    psi' = v_i . p / t - omega
    f_i = -c N sgn(v_i . h) h - (tau / t) sgn(psi') p,    tau_i = tau sgn(psi')

c is the rolling resistance, tau the friction of the swivel; no more than mu N acts across.
``python -m benchmarks.plant.casters`` prints the tables of docs/concepts/physics.md.
"""

import dataclasses
import math
from typing import Callable, Sequence

import numpy as np
from numpy.typing import NDArray
from push_model.parameters import GRAVITY
from scipy.integrate import solve_ivp

FloatArray = NDArray[np.float64]
# State: x, y, theta of the box, omega, pushing angle rho, and the angles psi of four casters.
X, Y, THETA, OMEGA, RHO = range(5)
SWIVELS = slice(5, 9)
# Of time and state, the rate of the pushing angle [rad/s].
AngleRate = Callable[[float, FloatArray], float]

# Chosen: the box of the studies, its feet or casters, and a slow push.
MASS = 3.0
INERTIA = 0.08
SUPPORTS = np.array([[-0.17, -0.17], [0.17, -0.17], [0.17, 0.17], [-0.17, 0.17]])
CONTACT = np.array([-0.2, 0.0])
FRICTION = 0.3
SPEED = 0.15
# Chosen: a light furniture caster.
TRAIL = 0.025
SWIVEL_FRICTION = 0.01
ROLLING_RESISTANCE = 0.03
# Chosen: smoothing of friction in v [m/s] and psi' [rad/s], well below both in a push.
SLIDING_SMOOTHING = 1e-3
ROLLING_SMOOTHING = 3e-3
SWIVEL_SMOOTHING = 0.05
# Chosen: line following: length in which errors fade [m], limit of the angle [rad] and lag [s].
FADING_LENGTH = 0.3
MAX_ANGLE = 0.5
ANGLE_LAG = 0.1
CASTERS = {'none': (), 'rear': (0, 3), 'front': (1, 2), 'all': (0, 1, 2, 3)}
SEEDS = 12
MILLIMETRES = 1000.0


def hold(_: float, __: FloatArray) -> float:
    """Keep the pushing angle."""
    return 0.0


def follow_axis(_: float, state: FloatArray) -> float:
    """Steer the box, as if on four feet, along the x axis; return the rate of the angle."""
    arm = -CONTACT[0]
    wheelbase = arm + float(np.mean(SUPPORTS[:, 0] ** 2)) / arm
    lateral = state[Y] + (wheelbase - arm) * math.sin(state[THETA])
    curvature = -lateral / FADING_LENGTH ** 2 - 2.0 * state[THETA] / FADING_LENGTH
    angle = -math.atan(wheelbase * curvature)
    return (min(MAX_ANGLE, max(-MAX_ANGLE, angle)) - state[RHO]) / ANGLE_LAG


@dataclasses.dataclass(frozen=True)
class Cart:
    """
    A box on four supports, some of them casters.

    :param casters: numbers of the supports that are casters.
    """

    casters: tuple[int, ...]

    def push(self, distance: float, law: AngleRate, start: FloatArray) -> FloatArray:
        """
        Push the box.

        :param distance: of the contact [m].
        :param law: rate of the pushing angle.
        :param start: state, shape (9,).
        :return: states over the distance, shape (9, n).
        """
        solved = solve_ivp(self._rates, (0.0, distance / SPEED), start, 'LSODA', args=(law,),
                           rtol=1e-6, atol=1e-8, max_step=0.05)
        return solved.y

    def _rates(self, time: float, state: FloatArray, law: AngleRate) -> FloatArray:
        omega, rho, theta = state[OMEGA], state[RHO], state[THETA]
        rho_rate = law(time, state)
        velocity = SPEED * _unit(rho)
        moment, swivel_rates = self._moment(velocity, omega, state[SWIVELS])
        bias = (omega + rho_rate) * SPEED * _unit(rho + 0.5 * math.pi)
        arm = -CONTACT
        acceleration = ((moment - MASS * _cross(arm, bias))
                        / (INERTIA + MASS * float(arm @ arm)))
        middle = SPEED * _unit(theta + rho) + omega * (-CONTACT[0]) * _unit(theta + 0.5 * math.pi)
        return np.concatenate([middle, [omega, acceleration, rho_rate], swivel_rates])

    def _moment(self, velocity: FloatArray, omega: float,
                swivels: FloatArray) -> tuple[float, FloatArray]:
        """Sum up the moments about the contact; return the rates of the swivels as well."""
        load = 0.25 * MASS * GRAVITY
        moment, rates = 0.0, np.zeros(len(SUPPORTS))
        for index, arm in enumerate(SUPPORTS - CONTACT):
            moving = velocity + omega * np.array([-arm[1], arm[0]])
            if index not in self.casters:
                speed = math.hypot(*moving, SLIDING_SMOOTHING)
                moment += _cross(arm, -FRICTION * load * moving / speed)
                continue
            heading, across = _unit(swivels[index]), _unit(swivels[index] + 0.5 * math.pi)
            rates[index] = float(moving @ across) / TRAIL - omega
            sense = math.tanh(rates[index] / SWIVEL_SMOOTHING)
            force = min(FRICTION * load, SWIVEL_FRICTION / TRAIL) * sense
            rolling = (ROLLING_RESISTANCE * load
                       * math.tanh(float(moving @ heading) / ROLLING_SMOOTHING))
            moment += _cross(arm, -rolling * heading - force * across) + TRAIL * force
        return moment, rates


def _unit(angle: float) -> FloatArray:
    return np.array([math.cos(angle), math.sin(angle)])


def _cross(a: FloatArray, b: FloatArray) -> float:
    return float(a[0] * b[1] - a[1] * b[0])


def start_state(rho: float = 0.0, y: float = 0.0, theta: float = 0.0,
                swivels: FloatArray | None = None) -> FloatArray:
    """
    Make the state of a box that is about to be pushed.

    :param rho: pushing angle [rad].
    :param y: position aside [m].
    :param theta: heading [rad].
    :param swivels: angles of the casters [rad], shape (4,); None for straight ahead.
    :return: state, shape (9,).
    """
    angles = np.zeros(len(SUPPORTS)) if swivels is None else swivels
    return np.concatenate([[0.0, y, theta, 0.0, rho], angles])


def open_loop_error(name: str, rho: float, swivels: FloatArray | None) -> tuple[float, float]:
    """
    Compare a push of 1 m at a constant angle with that of a box on four feet.

    :param name: of the casters, one of ``CASTERS``.
    :param rho: pushing angle [rad].
    :param swivels: angles of the casters at the start [rad], shape (4,); None for straight ahead.
    :return: distance of the ends [mm], and difference of their headings [deg].
    """
    feet = Cart(()).push(1.0, hold, start_state(rho))[:, -1]
    end = Cart(CASTERS[name]).push(1.0, hold, start_state(rho, swivels=swivels))[:, -1]
    return (MILLIMETRES * float(np.hypot(*(end - feet)[:2])),
            abs(math.degrees(end[THETA] - feet[THETA])))


def feedback_error(name: str, distance: float,
                   swivels: FloatArray | None) -> tuple[float, float]:
    """
    Follow a line from 50 mm and 5 degrees beside it, with the law of a box on four feet.

    :param name: of the casters, one of ``CASTERS``.
    :param distance: of the contact [m].
    :param swivels: angles of the casters at the start [rad], shape (4,); None for straight ahead.
    :return: distance from the line at the end [mm], and heading error [deg].
    """
    start = start_state(0.0, 0.05, math.radians(5.0), swivels)
    end = Cart(CASTERS[name]).push(distance, follow_axis, start)[:, -1]
    return MILLIMETRES * abs(float(end[Y])), abs(math.degrees(end[THETA]))


def table_rows(error: Callable[[str, float, FloatArray | None], tuple[float, float]],
               cases: Sequence[tuple[str, float]], quantity: str) -> list[str]:
    """
    Tabulate errors, with the swivels straight ahead and with any angles.

    :param error: of the casters, a number and the swivels.
    :param cases: name of the casters and the number.
    :param quantity: what the number is.
    :return: rows of Markdown.
    """
    rows = [f'| casters | {quantity} | swivels ahead | any, median | any, greatest |',
            '| --- | --- | --- | --- | --- |']
    for name, friction in cases:
        errors = np.array([error(name, friction, np.random.default_rng(seed).uniform(
            -math.pi, math.pi, len(SUPPORTS))) for seed in range(SEEDS)])
        cells = (error(name, friction, None), np.median(errors, axis=0),
                 errors.max(axis=0))
        rows.append(f'| {name} | {friction:g} | ' + ' | '.join(
            f'{position:.0f} mm, {heading:.1f}°' for position, heading in cells) + ' |')
    return rows


if __name__ == '__main__':
    print('\n'.join(table_rows(open_loop_error, [
        (casters, angle) for casters in ('rear', 'front', 'all') for angle in (0.0, 0.1, 0.2)],
        'pushing angle rad')))
    print('\n'.join(table_rows(feedback_error, [
        ('none', 2.0), ('rear', 2.0), ('front', 2.0), ('front', 4.0), ('all', 2.0)],
        'distance m')))
