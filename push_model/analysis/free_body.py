"""Every force on a pushed object, one by one, as a free-body diagram shows them."""

from typing import NamedTuple

from push_model.dynamics import (
    contact_force, Input, kinematics, ObjectTerms, SMOOTHING, State, yaw_acceleration,
)
from push_model.friction import friction_weight
from push_model.geometry import Pose


class FreeBody(NamedTuple):
    """
    Forces on an object in motion, all in world axes.

    :param contact_force: F_C of the robot on the object (x, y) [N].
    :param velocities: of the object at each support (x, y) [m/s].
    :param friction: f_i of the floor at each support (x, y) [N].
    :param yaw_acceleration: of the object [rad/s^2].
    :param acceleration: a_G of the mass centre, ``m a_G = F_C + sum f_i`` (x, y) [m/s^2].
    """

    contact_force: tuple
    velocities: tuple
    friction: tuple
    yaw_acceleration: float
    acceleration: tuple


def free_body(obj, state, inputs, rolling, smoothing=SMOOTHING):
    """
    Find all forces on an object that is pushed through a rolling or fixed contact.

    :param obj: the ``PushedObject``.
    :param state: ``State``.
    :param inputs: ``Input``.
    :param rolling: (lam, R_e [m]) of ``contact.rolling_constants``.
    :param smoothing: speed below which support friction turns viscous [m/s].
    :return: ``FreeBody``.
    """
    state, inputs, terms = State(*state), Input(*inputs), ObjectTerms.of(obj)
    turning = float(yaw_acceleration(terms, state, inputs, rolling, smoothing))
    force = Pose(0.0, 0.0, state.gamma).rotate(
        contact_force(terms, state, inputs, turning, rolling, smoothing))
    rate = kinematics(state, inputs, turning, rolling)
    velocities, friction = [], []
    for x, y, capacity in terms.supports:
        arm_x, arm_y = Pose(0.0, 0.0, state.theta).rotate((x, y))
        v_x, v_y = rate.x - state.omega * arm_y, rate.y + state.omega * arm_x
        weight = friction_weight(capacity, v_x, v_y, smoothing)
        velocities.append((v_x, v_y))
        friction.append((-weight * v_x, -weight * v_y))
    force = tuple(float(part) for part in force)
    total = [force[axis] + sum(one[axis] for one in friction) for axis in (0, 1)]
    return FreeBody(force, tuple(velocities), tuple(friction), turning,
                    tuple(part / obj.mass for part in total))
