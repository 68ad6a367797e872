"""The picture of a plan has its ghosts, that of a refusal the places and widths behind it."""

import dataclasses
from pathlib import Path

from helpers.objects import box
from helpers.tapes import make_result, make_tape, straight_plan
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Ellipse, Polygon
import numpy as np
from PIL import Image
from push_model.geometry import Pose
from push_model.plan_request import PlanFailure
from push_navigation.map_clearance import PositionEllipse
from push_navigation.path import Path as RobotPath
from push_planner.planned_pushes import PlannedPush
from push_planner.problem import PlanningFailed
from push_planner.refusal_marks import FaceMark, NarrowPlace, RefusalMarks
from push_scenario.definition.loader import load_scenario
from push_scenario.first_plan import find_first_plan
from push_scenario.plots.drawing import outline
from push_scenario.plots.figure import _scene
from push_scenario.plots.plan_picture import (
    draw_plan_picture, draw_pushes, draw_refusal, ELLIPSE_SIGMAS, refusal_legend)
from push_scenario.simulation.result import Outcome, TimedRefusal
import pytest

BOX, RADIUS = box(), 0.17
PLACE = NarrowPlace(1.0, -2.0, 0.5, 0.8, PositionEllipse(0.2, 0.05, 0.5))


def test_each_push_has_a_ghost_where_it_ends_and_its_number() -> None:
    """And the robot's way, from where it was to where it touches."""
    poses = [Pose(0.0, 0.0, 0.0), Pose(0.5, 0.1, 0.4), Pose(0.9, 0.6, 1.0)]
    start = Pose(-0.4, 0.0, 0.0)
    pushes = tuple(PlannedPush(before, after, start, RobotPath((Pose(-2.0, 1.0, 0.0), start)))
                   for before, after in zip(poses, poses[1:]))
    axes = Figure().add_subplot()
    draw_pushes(axes, BOX, RADIUS, pushes)
    ghosts = [patch.get_xy()[:-1] for patch in axes.patches if isinstance(patch, Polygon)]
    assert len(ghosts) == 2
    for ghost, pose in zip(ghosts, poses[1:]):
        assert ghost == pytest.approx(outline(BOX, pose))
    assert [(text.get_text(), text.get_position()) for text in axes.texts] == [
        ('1', poses[1][:2]), ('2', poses[2][:2])]
    ways = [line.get_xydata() for line in axes.lines if len(line.get_xydata()) > 2]
    assert len(ways) == 2
    for way in ways:
        assert np.array([way[0], way[-1]]) == pytest.approx(np.array([(-2.0, 1.0), start[:2]]))


def test_a_narrow_place_is_as_wide_as_it_is() -> None:
    """The free floor and the needed one, both in numbers too, and the ellipse."""
    axes = Figure().add_subplot()
    draw_refusal(axes, BOX, RADIUS, RefusalMarks(PLACE))
    circles = [patch for patch in axes.patches if isinstance(patch, Circle)]
    assert sorted(circle.get_radius() for circle in circles) == [0.25, 0.4]
    assert all(circle.get_center() == (1.0, -2.0) for circle in circles)
    ellipse, = (patch for patch in axes.patches if type(patch) is Ellipse)
    assert (ellipse.get_width(), ellipse.get_height()) == pytest.approx(
        (2.0 * ELLIPSE_SIGMAS * 0.2, 2.0 * ELLIPSE_SIGMAS * 0.05))
    text, = axes.texts
    assert '0.50 m' in text.get_text() and '0.80 m' in text.get_text()


def test_the_way_that_is_refused_is_drawn_and_explained() -> None:
    """All of it, and only where there is one."""
    path = (0.0, 0.0), (1.0, -2.0), (2.0, -2.5)
    axes = Figure().add_subplot()
    draw_refusal(axes, BOX, RADIUS, RefusalMarks(PLACE, robot_path=path))
    line, = axes.lines
    assert line.get_xydata() == pytest.approx(np.array(path))
    explained, without = (refusal_legend(RefusalMarks(PLACE, robot_path=points))
                          for points in (path, ()))
    assert len(explained) == len(without) + 1


def test_faces_without_room_are_crossed_out() -> None:
    """Those with room are not; a pose in a wall is drawn where it is."""
    axes = Figure().add_subplot()
    wall = Pose(2.0, 1.0, 0.3)
    draw_refusal(axes, BOX, RADIUS, RefusalMarks(
        faces=(FaceMark(0.0, 1.0, True), FaceMark(1.0, 0.0, False)), overlap=wall))
    crosses = [line.get_xydata().tolist() for line in axes.lines if line.get_marker() == 'x']
    assert crosses == [[[1.0, 0.0]]]
    overlap, = (patch for patch in axes.patches if isinstance(patch, Polygon))
    assert overlap.get_xy()[:-1] == pytest.approx(outline(BOX, wall))


def test_the_figure_of_a_run_that_was_refused_shows_why() -> None:
    """The place is there, as wide as it is; a run that is done all the same has no such mark."""
    refusal = TimedRefusal(0.5, PlanningFailed(PlanFailure.BLOCKED, 'a wall', marks=RefusalMarks(
        NarrowPlace(1.0, 0.3, 0.43, 0.57))))
    run = dataclasses.replace(make_result(make_tape(), straight_plan(), (2.0, 0.0, 0.0)),
                              refusals=(refusal,))
    for outcome, count in ((Outcome.FAILED, 2), (Outcome.DONE, 0)):
        axes = Figure().add_subplot()
        _scene(axes, dataclasses.replace(run, outcome=outcome))
        circles = [patch for patch in axes.patches if isinstance(patch, Circle)
                   and patch.get_center() == (1.0, 0.3)]
        assert len(circles) == count
        assert {circle.get_radius() for circle in circles} <= {0.215, 0.285}


@pytest.mark.slow
def test_the_plan_of_a_scenario_is_that_of_its_robot(tmp_path: Path) -> None:
    """From where it measures the object to the goal, or open floor; it is drawn."""
    scenario = load_scenario('task_map')
    plan = find_first_plan(scenario)
    assert plan.request.object_pose == pytest.approx(scenario.start.object.pose, abs=0.01)
    assert plan.refusal is None and len(plan.pushes) > 1
    draw_plan_picture(scenario, plan, tmp_path / 'plan.png')
    with Image.open(tmp_path / 'plan.png') as picture:
        assert min(picture.size) > 400
    with pytest.raises(ValueError, match='expected a scenario with a task'):
        find_first_plan(load_scenario('straight_push'))
