"""A person who displaces or rotates the object while the robot is at its task."""

from enum import Enum
import math
from typing import Optional

from push_control.task.supervisor import Supervisor
from push_model.geometry import Pose
from push_sim_node.disturbance import ObjectDisplacement
from push_sim_node.simulation import Simulation

# Displacement [m] and rotation [rad]; chosen: far beyond what the supervisor tolerates.
DISPLACEMENT = 0.2
CARRIED = 0.6
ROTATION = math.radians(45.0)
# Number of directions that are tried where the robot stands in the first.
DIRECTIONS = 8


class Disturbance(Enum):
    """What the person does; the values are the texts of records and reports."""

    DISPLACED = 'displaced by 0.2 m'
    ROTATED = 'rotated by 45 degrees'
    # While the robot does not see it.
    CARRIED_AWAY = 'carried away by 0.6 m'


class Intervention:
    """
    Move the object once, as soon as the robot does not stand where it would go.

    :param disturbance: ``Disturbance``.
    :param moment: earliest time [s].
    :param direction: of the displacement, in the object frame [rad]; where the robot stands there
        another is taken. Its sign is that of the rotation.
    """

    def __init__(self, disturbance: Disturbance, moment: float, direction: float) -> None:
        self._disturbance = disturbance
        self._moment = moment
        self._direction = direction
        self.displacement: Optional[ObjectDisplacement] = None
        self.state = ''

    def __call__(self, simulation: Simulation, supervisor: Supervisor) -> None:
        """
        Move the object if it is time; record the displacement and the supervisor's state.

        :param simulation: the ``Simulation``.
        :param supervisor: the ``Supervisor``.
        """
        if self.displacement is not None or simulation.time < self._moment:
            return
        if self._disturbance is Disturbance.CARRIED_AWAY and simulation.is_object_seen:
            return
        for move in self._displacements():
            try:
                simulation.plant.set_object_pose(simulation.plant.object_pose @ move)
            except ValueError:
                continue
            self.displacement = ObjectDisplacement(simulation.time, *move)
            self.state = supervisor.status.state.value
            return

    def _displacements(self) -> list[Pose]:
        if self._disturbance is Disturbance.ROTATED:
            rotation = math.copysign(ROTATION, self._direction)
            return [Pose(0.0, 0.0, rotation), Pose(0.0, 0.0, -rotation)]
        angles = [self._direction + 2.0 * math.pi * number / DIRECTIONS
                  for number in range(DIRECTIONS)]
        far = CARRIED if self._disturbance is Disturbance.CARRIED_AWAY else DISPLACEMENT
        return [Pose(far * math.cos(angle), far * math.sin(angle), 0.0)
                for angle in angles]
