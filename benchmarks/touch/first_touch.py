"""
Force and energy of the first touch of an object that is at rest.

Robot and object meet with a speed v. Of their masses the reduced one counts, which is that of the
object where the robot is much heavier: ``m = m_robot m_object / (m_robot + m_object)``. Until both
move alike a bumper of the stiffness k takes up the energy E, and presses with F at most:

    E = m v^2 / 2,    F = v sqrt(k m)

This holds for a touch towards the centre of mass; beside it less mass has to be moved. Friction of
the floor comes on top of F.
"""

import math
from typing import NamedTuple


class FirstTouch(NamedTuple):
    """
    A touch.

    :param mass: reduced mass [kg].
    :param stiffness: of the bumper [N/m].
    """

    mass: float
    stiffness: float

    def energy(self, speed: float) -> float:
        """
        Compute the energy that the bumper takes up [J].

        :param speed: at the touch [m/s].
        """
        return 0.5 * self.mass * speed ** 2

    def force(self, speed: float) -> float:
        """
        Compute the greatest force [N].

        :param speed: at the touch [m/s].
        """
        return speed * math.sqrt(self.stiffness * self.mass)

    def speed_limit(self, force: float, energy: float) -> float:
        """
        Compute the greatest speed that keeps both below limits [m/s].

        :param force: limit of the force [N].
        :param energy: limit of the energy [J].
        """
        return min(force / math.sqrt(self.stiffness * self.mass),
                   math.sqrt(2.0 * energy / self.mass))


def reduced_mass(robot: float, obj: float) -> float:
    """
    Compute the mass that counts [kg].

    :param robot: mass of the robot [kg]; may be infinite.
    :param obj: mass of the object [kg].
    """
    return obj if math.isinf(robot) else robot * obj / (robot + obj)
