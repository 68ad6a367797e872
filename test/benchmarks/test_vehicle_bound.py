"""Bound on the time of a push from the object seen as a vehicle."""

from benchmarks.planner.vehicle_bound import vehicle_bound
from helpers.push_problems import face_problem
from push_model.geometry import Pose
from push_planner.single_push.bounds import displacement_bound
import pytest


def test_it_is_the_distance_straight_ahead_and_falls_with_the_cone():
    assert vehicle_bound(face_problem(Pose(1.3, 0.0, 0.0))) == pytest.approx(1.3 / 0.15)
    goal = Pose(0.5, 0.6, 0.2)
    times = [vehicle_bound(face_problem(goal, cone_margin=margin)) for margin in (0.4, 0.7, 1.0)]
    assert times[0] > times[1] > times[2] > displacement_bound(face_problem(goal))


def test_it_is_refused_for_a_contact_that_rolls():
    with pytest.raises(ValueError, match="got a contact of kind 'rolling'"):
        vehicle_bound(face_problem(Pose(1.5, 0.05, 0.05), robot_yaw='fixed'))
