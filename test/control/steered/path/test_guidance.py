"""Guidance: when a path is kept, replaced, and approached again."""

import numpy as np
from push_control.settings import ControlSettings
from push_control.steered.path.guidance import Guidance
from push_control.steered.path.path import CurvatureLimits, keeps_path, path_to_goal
from push_model.geometry import Pose
import pytest

SETTINGS = ControlSettings()
WIDE = CurvatureLimits(-1.0, 1.0)


def make_guidance(settings=SETTINGS, length=2.0):
    """Follow a straight path to the goal."""
    return Guidance(path_to_goal(Pose(-length, 0.0, 0.0), WIDE, 0.4), settings)


def draw(pose):
    """Draw a path to the goal, wherever that leads."""
    return path_to_goal(pose, WIDE, SETTINGS.final_straight)


def updated(guidance, pose, travelled=1.0, hard=WIDE, dt=1.0):
    """Project a pose, from wherever the last one was, and update the path."""
    for _ in range(10):
        projection = guidance.project(pose)
    errors = np.array((SETTINGS.replan_lateral_error, SETTINGS.replan_heading_error))
    kept = keeps_path(guidance.rows, guidance.projection, errors, np.array(hard))
    if not guidance.is_due(projection.remaining_distance, kept, travelled, dt):
        return projection
    return guidance.update(pose, projection, draw)


def test_near_the_path_nothing_changes():
    """Errors below those that call for a new path, and limits that the path keeps."""
    guidance = make_guidance()
    found = updated(guidance, Pose(-1.0, 0.02, 0.04))
    assert guidance.path_replans == 0
    assert found.lateral_error == pytest.approx(0.02, abs=1e-6)
    assert found.remaining_distance == pytest.approx(1.0, abs=1e-6)


@pytest.mark.parametrize('pose', [Pose(-1.5, 0.04, 0.0), Pose(-1.5, 0.0, 0.06)])
def test_far_from_the_path_a_new_one_starts_at_the_pose(pose):
    """Lateral or heading error; not before some path length, and not twice within the period."""
    guidance = make_guidance()
    assert updated(guidance, pose, travelled=0.2).lateral_error == pytest.approx(pose.y, abs=1e-3)
    assert guidance.path_replans == 0
    found = updated(guidance, pose)
    assert guidance.path_replans == 1
    assert (found.lateral_error, found.heading_error) == pytest.approx((0.0, 0.0), abs=1e-6)
    updated(guidance, Pose(-1.4, 0.2, 0.0), dt=0.4)
    assert guidance.path_replans == 1


def test_a_new_path_that_is_much_longer_is_not_taken():
    """Beside the goal a new path would have to go round."""
    guidance = make_guidance()
    found = updated(guidance, Pose(-0.3, 0.1, 0.0))
    assert guidance.path_replans == 0 and found.lateral_error == pytest.approx(0.1, abs=1e-3)


def test_a_path_sharper_than_the_hard_limits_is_replaced():
    """As they are known by now, within the next metre."""
    start = Pose(-3.0, 0.5, 0.8)
    guidance = Guidance(path_to_goal(start, CurvatureLimits(-2.0, 2.0), 0.4), SETTINGS)
    assert np.abs(guidance.preview(np.linspace(0.0, 1.0, 11))).max() > 1.0
    updated(guidance, start, hard=CurvatureLimits(-1.1, 1.1))
    assert guidance.path_replans == 1
    assert np.abs(guidance.preview(np.linspace(0.0, 1.0, 11))).max() <= 1.0 + 1e-9


def test_a_push_that_will_miss_approaches_the_goal_again_as_often_as_allowed():
    """Each approach counts, and makes new paths more careful; the planned length stays."""
    guidance = make_guidance(ControlSettings(max_reapproaches=1))
    planned, caution = guidance.planned_length, guidance.cone_fraction(0.0)
    pose = Pose(-0.05, 0.015, 0.0)
    found = updated(guidance, pose)
    assert guidance.reapproaches == 1 and guidance.path_replans == 0
    assert found.remaining_distance > 1.0
    assert guidance.planned_length == planned
    assert guidance.cone_fraction(0.0) < caution
    assert guidance.reapproach(Pose(0.0, 0.05, 0.0), draw) is None
    assert guidance.reapproaches == 1


@pytest.mark.parametrize('pose', [Pose(-1.5, 0.04, 0.0), Pose(-0.05, 0.018, 0.0)])
def test_a_path_that_may_not_be_drawn_is_not_followed(pose):
    """The present one stays, and nothing is counted; it is not drawn again at once."""
    guidance, drawn = make_guidance(), []
    for _ in range(10):
        projection = guidance.project(pose)
    for _ in range(3):
        if guidance.is_due(projection.remaining_distance, False, 1.0, 0.2):
            assert guidance.update(pose, projection, drawn.append) == projection
    assert guidance.reapproach(pose, drawn.append) is None
    assert guidance.path_replans == guidance.reapproaches == 0
    assert len(drawn) == 2


def test_new_paths_use_less_of_the_cone_the_less_is_known():
    """Never more than all, never less than half for where the centre of friction is."""
    guidance = make_guidance()
    fractions = [guidance.cone_fraction(ratio) for ratio in (0.0, 0.2, 0.4, 0.9)]
    assert fractions == pytest.approx([1.0, 0.8, 0.6, 0.5])
