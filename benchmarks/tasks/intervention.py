"""Somebody who shoves or turns the object while the robot is at its task."""

import math

from push_model.geometry import Pose
from push_sim_node.disturbance import ObjectDisplacement

INTERVENTIONS = ('shoved by 0.2 m', 'turned by 45 degrees')
DISPLACEMENT, ROTATION, DIRECTIONS = 0.2, math.radians(45.0), 8


class Intervention:
    """
    Moves the object once, as soon as the robot is not in the way.

    :param move: one of ``INTERVENTIONS``.
    :param moment: when [s].
    :param direction: of the shove, in the object frame [rad]; where the robot is in the way
        another is taken. Its sign is that of the turn.
    """

    def __init__(self, move, moment, direction):
        self._move, self._moment, self._direction = move, moment, direction
        self.displacement, self.state = None, ''

    def __call__(self, simulation, supervisor):
        """
        Look whether it is time.

        :param simulation: the ``Simulation``.
        :param supervisor: the ``Supervisor``.
        """
        if self.displacement is not None or simulation.time < self._moment:
            return
        for move in self._displacements():
            try:
                simulation.plant.set_object_pose(simulation.plant.object_pose @ move)
            except ValueError:
                continue
            self.displacement = ObjectDisplacement(simulation.time, *move)
            self.state = supervisor.status.state.value
            return

    def _displacements(self):
        if self._move == INTERVENTIONS[1]:
            turn = math.copysign(ROTATION, self._direction)
            return [Pose(0.0, 0.0, turn), Pose(0.0, 0.0, -turn)]
        angles = [self._direction + 2.0 * math.pi * number / DIRECTIONS
                  for number in range(DIRECTIONS)]
        return [Pose(DISPLACEMENT * math.cos(angle), DISPLACEMENT * math.sin(angle), 0.0)
                for angle in angles]
