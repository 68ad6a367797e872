"""
What stays the same along a push, and where the contact is.

In the object frame, with T and Phi the turns of object and robot since the start:
``gamma - theta = delta_0 + (lam - 1)(T - Phi)`` and, at n and t of that normal,
``C = base + roll (T - Phi) t - R_s n``.
"""

from typing import Any, NamedTuple

import casadi as ca
import numpy as np
from push_model.dynamics import ObjectTerms
from push_model.geometry import wrap_angle

PUSH_KINDS = ('held', 'rolling', 'differential')
VERTEX_MARGIN = 0.02
UNLIMITED = 1e3
# Numbers of the constants besides those of the supports.
PARAMETER_COUNT = 13


class PushParameters(NamedTuple):
    """
    Constants of a push; numbers or casadi symbols.

    :param terms: ``ObjectTerms``.
    :param base_x: part of the contact that is fixed in the object [m].
    :param base_y: the same, y.
    :param delta: normal in the object frame at the start [rad].
    :param share: lam.
    :param effective: R_e [m].
    :param roll: R_p where the contact travels along a face, else 0 [m].
    :param round: R_s where it travels round a disc, else 0 [m].
    :param radius: R_p [m].
    :param heading_offset: D = gamma - phi at the start [rad].
    """

    terms: ObjectTerms
    base_x: Any
    base_y: Any
    delta: Any
    share: Any
    effective: Any
    roll: Any
    round: Any
    radius: Any
    heading_offset: Any

    @classmethod
    def of(cls, problem):
        """
        Take the constants from a problem.

        :param problem: the ``PushProblem``.
        """
        share, effective = problem.rolling
        base, roll, bend = problem.contact_point, 0.0, 0.0
        if problem.kind == 'rolling' and problem.contact.kind == 'face':
            roll = problem.robot.radius
        if problem.kind == 'rolling' and problem.contact.kind == 'round':
            base, bend = (0.0, 0.0), problem.obj.radius
        # Where contact and object turn as one, R_e plays no part.
        return cls(ObjectTerms.of(problem.obj), *base,
                   wrap_angle(problem.normal - problem.start.theta), share,
                   effective if problem.kind == 'rolling' else 0.0, roll, bend,
                   problem.robot.radius, problem.heading_offset)

    @classmethod
    def symbols(cls, supports):
        """
        Make symbols for an object on a number of supports.

        :param supports: number of supports.
        :return: (``PushParameters`` of symbols, the same as one column).
        """
        flat = ca.SX.sym('constants', PARAMETER_COUNT + 3 * supports)
        parts = ca.vertsplit(flat)
        feet = tuple(tuple(parts[PARAMETER_COUNT + 3 * i:PARAMETER_COUNT + 3 + 3 * i]) for i in range(supports))
        return cls(ObjectTerms(*parts[:4], feet), *parts[4:PARAMETER_COUNT]), flat

    def column(self):
        """Return the numbers in the order of ``symbols``, shape (13 + 3 k,)."""
        feet = [value for support in self.terms.supports for value in support]
        return np.array([*self.terms[:4], *self[1:], *feet])


def place(push_parameters, theta, phi):
    """
    Find the contact in the object frame.

    :param push_parameters: ``PushParameters``.
    :param theta: turn of the object since the start [rad].
    :param phi: turn of the robot since the start [rad].
    :return: (angle of n [rad], c_x, c_y [m]).
    """
    apart = theta - phi
    delta = push_parameters.delta + (push_parameters.share - 1.0) * apart
    # casadi would take arrays apart.
    trig = np if isinstance(delta, np.ndarray) else ca
    n_x, n_y = trig.cos(delta), trig.sin(delta)
    along = push_parameters.roll * apart
    return (delta, push_parameters.base_x - along * n_y - push_parameters.round * n_x,
            push_parameters.base_y + along * n_x - push_parameters.round * n_y)


def places(push_parameters, theta, phi):
    """Find the contact at many turns; as ``place``, with arrays of shape (n,)."""
    return tuple(value + 0.0 * theta for value in place(push_parameters, theta, phi))
