"""Integrated slow pushes: against the plant, sticking and sliding, and round objects."""

import dataclasses
import math

from helpers.objects import bin_, box
import numpy as np
from push_model.analysis.slow_push import integrate_slow_pushes, LoadedSupports, Shape
from push_model.geometry import Pose
from push_model.parameters import RoundRobot
from push_model.signals import Twist
from push_sim_node.plant import Plant
import pytest

pytestmark = pytest.mark.physics
SPEED = 0.01
DISTANCE = 0.1
RADIUS = 0.17
ROBOT = RoundRobot(RADIUS, 'holonomic', time_constant=0.0, max_acceleration=100.0)


@pytest.mark.parametrize('obj, reach', [
    (box(), 0.2), (bin_(), bin_().radius),
    (dataclasses.replace(box(), contact_height=0.15, center_of_mass_height=0.1), 0.2)])
def test_pushes_end_where_those_of_the_plant_do(obj, reach):
    """Ahead, beside the middle, and so inclined that the contact slides."""
    obj = dataclasses.replace(obj, contact_friction_coefficient=0.4)
    starts, paths, ends = [], [], []
    for offset, angle in ((0.0, 0.0), (0.06, 0.1), (0.0, 0.8), (-0.05, -0.9)):
        begin = Pose(-reach - RADIUS - 0.004, offset, angle)
        plant = Plant(obj, ROBOT, Pose(0.0, 0.0, 0.0), begin, 5e-3, 1e-6)
        plant.advance(DISTANCE / SPEED, Twist(SPEED))
        travel = np.linspace(0.0, DISTANCE, 201)
        paths.append(np.column_stack([begin.x + travel * math.cos(angle),
                                      begin.y + travel * math.sin(angle),
                                      np.full(len(travel), angle)]))
        starts.append((0.0, 0.0, 0.0))
        ends.append(plant.object_pose)
    found = integrate_slow_pushes(Shape.of(obj), LoadedSupports.of(obj), 0.4, RADIUS,
                                  np.array(starts), np.array(paths))
    assert found.poses[:, -1] == pytest.approx(np.array(ends), abs=1e-3)
    assert (found.slides != 0).any(axis=1).tolist()[2:] == [True, True]
    # The force is that of friction on the floor, where the robot has touched.
    assert np.hypot(*found.forces[0, -1]) == pytest.approx(sum(obj.capacities), rel=1e-3)
    assert not found.forces[:, 1].any()
