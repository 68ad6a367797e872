"""What stands against a plan is shown where it is, in this process and from its report."""

import pickle

from helpers.maps import walled_room
from helpers.objects import box
from push_model.geometry import Pose
from push_model.parameters import RoundRobot
from push_model.plan_request import PlanFailure, PlanRequest
from push_navigation.map_clearance import PositionEllipse
from push_navigation.settings import DriveSettings
from push_planner.problem import PlanningFailed
from push_planner.refusal_marks import FaceMark, NarrowPlace, NO_MARKS, RefusalMarks
from push_planner.settings import PlannerSettings
from push_planner.straight.map_search.planner import plan_push_in_map
import pytest

ROBOT, BOX = RoundRobot(0.17, 'differential'), box()
MARKS = RefusalMarks(
    NarrowPlace(1.25, -0.5, 0.625, 1.5, PositionEllipse(0.25, 0.0625, -2.5)),
    (FaceMark(0.5, -1.0, True), FaceMark(-0.5, 1.5, False)),
    Pose(1.0, 2.0, -0.25), Pose(-3.0, 0.5, 1.5), ((0.0, -0.5), (1.25, -0.5), (2.0, 0.25)))


@pytest.mark.parametrize('marks', [
    MARKS, NO_MARKS, RefusalMarks(NarrowPlace(0.0, -2.0, 0.5)), MARKS._replace(faces=())])
def test_marks_are_read_back_from_the_texts_of_a_report(marks: RefusalMarks) -> None:
    """All that is in them; nothing of what is missing."""
    texts = {name: str(value).lower() if not isinstance(value, Pose)
             else f'{value.x} m, {value.y} m, {value.theta} rad'
             for name, value in marks.report().items()}
    assert RefusalMarks.from_report(texts) == marks
    assert RefusalMarks.from_report(dict.fromkeys(texts, 'none')) == NO_MARKS


def test_marks_go_with_the_exception_through_a_pickle() -> None:
    """Also what the report says besides."""
    failure = PlanningFailed(PlanFailure.BLOCKED, 'a wall', {'expansions': 3}, MARKS)
    copy = pickle.loads(pickle.dumps(failure))
    assert (copy.marks, copy.report) == (MARKS, failure.report)
    assert copy.report['expansions'] == 3 and copy.report['faces_with_room'] == 1


@pytest.mark.slow
def test_faces_that_cannot_be_reached_are_where_the_robot_would_stand() -> None:
    """In a niche: one of four on free floor, the others in the wall."""
    floor = walled_room((-3.0, -0.25, -3.0, -2.0), (0.25, 3.0, -3.0, -2.0))
    here = Pose(0.0, -2.79, 0.0)
    with pytest.raises(PlanningFailed) as refused:
        plan_push_in_map(PlanRequest(here, Pose(0.0, 0.0, 0.0), Pose(1.0, 1.0, 0.0), BOX), ROBOT,
                         PlannerSettings(), DriveSettings(), floor)
    faces = refused.value.marks.faces
    assert [face.has_room for face in faces].count(True) == 1
    for face in faces:
        clearance = float(floor.clearance([(face.x, face.y)])[0])
        assert face.has_room == (clearance > ROBOT.radius)
        # Half a box, the robot, and its standoff.
        assert 0.2 + ROBOT.radius < abs(face.x - here.x) + abs(face.y - here.y) < 0.5
