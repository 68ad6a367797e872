"""Plans for objects that are pushed above the floor: loads shift, and too high they tip."""

import dataclasses

from helpers.objects import bin_, box
from helpers.push_problems import HOLONOMIC
from push_model.geometry import Pose
from push_model.plan_request import PlanFailure, PlanRequest
from push_navigation.settings import DriveSettings
from push_planner.problem import PlanningFailed, problem_from_placement
from push_planner.settings import PlannerSettings
from push_planner.steered.planner import plan_push
from push_planner.steered.task_push import plan_steered_push
from push_planner.steered.verification.verification import verify
from push_planner.straight.planner import checked_request
import pytest

HIGH = box(contact_height=0.2, center_of_mass_height=0.3)
ORIGIN, BEHIND, GOAL = Pose(0.0, 0.0, 0.0), Pose(-0.37, 0.0, 0.0), Pose(0.8, 0.2, 0.4)


@pytest.mark.slow
def test_plan_knows_that_the_object_turns_more_slowly():
    plans = [plan_push(problem_from_placement(obj, HOLONOMIC, ORIGIN, BEHIND, GOAL))
             for obj in (HIGH, box())]
    for plan in plans:
        assert verify(plan).position_error < 1e-4
    # The plan for floor height, followed by the object as it is, misses its heading.
    assert plans[0].problem.vehicle.wheelbase > 1.1 * plans[1].problem.vehicle.wheelbase
    mistaken = dataclasses.replace(
        plans[1], problem=dataclasses.replace(plans[1].problem, obj=HIGH))
    assert verify(mistaken).heading_error > 0.01


def test_objects_that_would_tip_are_refused_by_every_planner() -> None:
    tall = bin_(contact_height=0.4)
    requests = (
        lambda: plan_push(problem_from_placement(tall, HOLONOMIC, ORIGIN, BEHIND, GOAL)),
        lambda: plan_steered_push(PlanRequest(ORIGIN, BEHIND, GOAL, tall), HOLONOMIC,
                                  PlannerSettings(), DriveSettings()),
        lambda: checked_request(PlanRequest(ORIGIN, BEHIND, GOAL, tall), HOLONOMIC))
    for request in requests:
        with pytest.raises(PlanningFailed, match='contact_height: got 0.4 m') as refused:
            request()
        assert refused.value.code is PlanFailure.TIPS
        height = refused.value.report['contact_height']
        lower, higher = (bin_(contact_height=factor * height) for factor in (0.99, 1.01))
        assert checked_request(PlanRequest(ORIGIN, BEHIND, GOAL, lower), HOLONOMIC)
        with pytest.raises(PlanningFailed):
            checked_request(PlanRequest(ORIGIN, BEHIND, GOAL, higher), HOLONOMIC)
