"""
Parameters that stay the same along a push, and the contact that they place on the object.

With T and Phi the rotations of object and robot since the start, the angle of the normal n in the
object frame and the contact point are

    delta = delta_0 + (lam - 1) (T - Phi)
    C = base + R_face (T - Phi) t - R_disc n

with t the tangent, lam the normal ratio of the rolling contact, R_face the robot's radius where
the contact travels along a face and R_disc the object's radius where it travels round a disc.
"""

from collections.abc import Sequence
from typing import Any, Literal, NamedTuple

import numpy as np
from push_model.dynamics import ObjectTerms
from push_model.friction import LoadTransfer, SupportTransfer
from push_model.geometry import FloatArray
from push_model.trigonometry import cos_and_sin

# How the contact moves with the robot: held in place on the object by a robot that rotates with
# it, rolling on a robot that does not rotate, or held by a differential drive, which steers.
PushKind = Literal['held', 'rolling', 'differential']
# Distance that plans keep between the normal at a vertex and those of its two faces [rad]. Chosen:
# about 1 degree, the accuracy of measured headings.
VERTEX_MARGIN = 0.02
# Stands for no limit at all in the inequalities of the nonlinear program: large against every
# angle, force and speed there, and yet small enough to keep it well scaled.
UNLIMITED = 1e3
# Scalars of ``PushParameters`` besides those of the supports: 4 of the object and 9 more.
PARAMETER_COUNT = 13


class SupportLayout(NamedTuple):
    """
    Layout on which the number of parameters depends.

    :param support_count: k, number of supports.
    :param transfers_loads: whether a push shifts loads, which takes two heights and three more
        numbers for each support.
    """

    support_count: int
    transfers_loads: bool = False

    @property
    def column_size(self) -> int:
        """Number of parameters: 13 + 3 k, or 15 + 6 k with heights."""
        heights = 2 + 3 * self.support_count if self.transfers_loads else 0
        return PARAMETER_COUNT + 3 * self.support_count + heights


class ContactFrame(NamedTuple):
    """
    Contact point and normal in the object frame: numbers, arrays or casadi symbols.

    :param delta: angle of the normal n [rad].
    :param c_x: contact point, x [m].
    :param c_y: contact point, y [m].
    """

    delta: Any
    c_x: Any
    c_y: Any


class PushParameters(NamedTuple):
    """
    Parameters of a push: numbers, or casadi symbols.

    :param terms: ``ObjectTerms``.
    :param base_x: part of the contact point that is fixed in the object frame, x [m].
    :param base_y: the same, y [m].
    :param delta: delta_0, angle of the normal in the object frame at the start [rad].
    :param normal_ratio: lam of ``push_model.contact.RollingConstants``.
    :param effective_radius: R_e of the same [m].
    :param face_radius: R_p where the contact travels along a face, else 0 [m].
    :param disc_radius: R_s where the contact travels round a disc, else 0 [m].
    :param radius: R_p, radius of the robot [m].
    :param heading_offset: D = gamma - phi at the start [rad].
    """

    terms: ObjectTerms
    base_x: Any
    base_y: Any
    delta: Any
    normal_ratio: Any
    effective_radius: Any
    face_radius: Any
    disc_radius: Any
    radius: Any
    heading_offset: Any

    @classmethod
    def symbols(cls, supports: SupportLayout) -> tuple['PushParameters', Any]:
        """
        Make symbols for an object on a number of supports.

        :return: (``PushParameters`` of symbols, the same as one column).
        """
        # Imported here: numbers need no casadi.
        import casadi as ca
        column = ca.SX.sym('parameters', supports.column_size)
        scalars = ca.vertsplit(column)
        end = PARAMETER_COUNT + 3 * supports.support_count
        of_supports = _triples(scalars[PARAMETER_COUNT:end])
        transfer = None
        if supports.transfers_loads:
            transfer = LoadTransfer(scalars[end], scalars[end + 1], tuple(
                SupportTransfer(*triple) for triple in _triples(scalars[end + 2:])))
        mass, inertia, com_x, com_y = scalars[:4]
        terms = ObjectTerms(mass, inertia, com_x, com_y, of_supports, transfer)
        return cls(terms, *scalars[4:PARAMETER_COUNT]), column

    @property
    def supports(self) -> SupportLayout:
        """Layout of the supports."""
        return SupportLayout(len(self.terms.supports), self.terms.transfer is not None)

    def column(self) -> FloatArray:
        """Return the numbers in the order of ``symbols``."""
        of_supports = [value for support in self.terms.supports for value in support]
        transfer: list[Any] = []
        if self.terms.transfer is not None:
            transfer = [*self.terms.transfer[:2], *(
                value for support in self.terms.transfer.supports for value in support)]
        return np.array([*self.terms[:4], *self[1:], *of_supports, *transfer])


def contact_frame(parameters: PushParameters, theta: Any, phi: Any) -> ContactFrame:
    """
    Find the contact in the object frame; see the formulas of this module.

    :param theta: T, rotation of the object since the start [rad].
    :param phi: Phi, rotation of the robot since the start [rad].
    """
    relative = theta - phi
    delta = parameters.delta + (parameters.normal_ratio - 1.0) * relative
    n_x, n_y = cos_and_sin(delta)
    travel = parameters.face_radius * relative
    return ContactFrame(delta,
                        parameters.base_x - travel * n_y - parameters.disc_radius * n_x,
                        parameters.base_y + travel * n_x - parameters.disc_radius * n_y)


def contact_frames(parameters: PushParameters, theta: FloatArray, phi: FloatArray) -> ContactFrame:
    """
    Find the contact at many rotations; as ``contact_frame``, with arrays of shape (n,).

    :param theta: T, rotations of the object since the start [rad].
    :param phi: Phi, rotations of the robot since the start [rad].
    """
    frame = contact_frame(parameters, theta, phi)
    # What does not depend on the rotations is a number: spread it over all of them.
    return ContactFrame(*(value + 0.0 * theta for value in frame))


def _triples(values: Sequence[Any]) -> tuple[tuple[Any, Any, Any], ...]:
    return tuple((values[i], values[i + 1], values[i + 2]) for i in range(0, len(values), 3))
