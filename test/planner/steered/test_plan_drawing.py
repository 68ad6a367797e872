"""A drawing of a plan shows object, robot and contact where the plan has them."""

from helpers.push_problems import face_problem
from matplotlib.figure import Figure
import numpy as np
from push_model.geometry import Pose
from push_planner.steered.planner import plan_push
import pytest

pytestmark = pytest.mark.slow


def test_a_drawing_has_the_bodies_at_both_ends_and_their_paths():
    plan = plan_push(face_problem(Pose(1.5, 0.4, 0.5), offset=-0.02))
    axes = Figure().add_subplot()
    plan.plot(axes)
    drawn = {tuple(np.round(point, 9)) for line in axes.lines for point in line.get_xydata()}
    for pose in plan.trajectory.object_poses[[0, -1]]:
        for vertex in plan.problem.obj.outline:
            assert tuple(np.round(Pose(*pose).transform(vertex), 9)) in drawn
    paths = {line.get_label(): line.get_xydata() for line in axes.lines}
    assert np.array_equal(paths['robot'], plan.trajectory.robot_poses[:, :2])
    assert np.array_equal(paths['contact'], plan.trajectory.contact_poses[:, :2])
    assert 'at a face' in repr(plan) and len(repr(plan.trajectory)) < 80
