"""Free-body diagram: every force on a pushed object, one by one."""

from collections.abc import Iterable
from typing import Any, NamedTuple

from push_model.dynamics import (
    contact_force, Input, kinematics, ObjectTerms, Rolling, SMOOTHING, State, yaw_acceleration,
)
from push_model.friction import friction_weight
from push_model.geometry import Pose
from push_model.parameters import PushedObject


class FreeBody(NamedTuple):
    """
    Forces on an object in motion, all in world axes.

    :param contact_force: F_C of the robot on the object (x, y) [N].
    :param velocities: of the object at each support (x, y) [m/s].
    :param friction: f_i of the floor at each support (x, y) [N].
    :param yaw_acceleration: of the object [rad/s^2].
    :param acceleration: a_G of the mass centre, ``m a_G = F_C + sum f_i`` (x, y) [m/s^2].
    """

    contact_force: tuple[float, float]
    velocities: tuple[tuple[float, float], ...]
    friction: tuple[tuple[float, float], ...]
    yaw_acceleration: float
    acceleration: tuple[float, float]


def free_body(obj: PushedObject, state: Iterable[Any], inputs: Iterable[Any], rolling: Rolling,
              smoothing: float = SMOOTHING) -> FreeBody:
    """
    Find all forces on an object that is pushed through a rolling or fixed contact.

    :param obj: the ``PushedObject``.
    :param state: ``State``.
    :param inputs: ``Input``.
    :param rolling: (lam, R_e [m]) of ``contact.rolling_constants``.
    :param smoothing: speed below which support friction becomes viscous [m/s].
    :return: ``FreeBody``.
    """
    state, inputs, terms = State(*state), Input(*inputs), ObjectTerms.of(obj)
    omega_dot = float(yaw_acceleration(terms, state, inputs, rolling, smoothing))
    force_x, force_y = map(float, Pose(0.0, 0.0, state.gamma).rotate(
        contact_force(terms, state, inputs, omega_dot, rolling, smoothing)))
    rate = kinematics(state, inputs, omega_dot, rolling)
    velocities: list[tuple[float, float]] = []
    friction: list[tuple[float, float]] = []
    for x, y, capacity in terms.supports:
        arm_x, arm_y = Pose(0.0, 0.0, state.theta).rotate((x, y))
        v_x, v_y = rate.x - state.omega * arm_y, rate.y + state.omega * arm_x
        weight = friction_weight(capacity, v_x, v_y, smoothing)
        velocities.append((v_x, v_y))
        friction.append((-weight * v_x, -weight * v_y))
    total_x = force_x + sum(f_x for f_x, _ in friction)
    total_y = force_y + sum(f_y for _, f_y in friction)
    return FreeBody((force_x, force_y), tuple(velocities), tuple(friction), omega_dot,
                    (total_x / obj.mass, total_y / obj.mass))
