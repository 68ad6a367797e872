"""Measurements as they come: what is news of a bumper."""

from push_control.perception.raw_perception import RawPerception
from push_control.settings import ControlSettings
from push_model.geometry import Pose
from push_model.observation import Observation
from push_model.signals import Odometry, STOP
import pytest

AT_REST = Odometry(0.0, Pose(0.0, 0.0, 0.0), STOP)


@pytest.mark.parametrize('is_pressed, has_bumped', [
    ([True, True], [False, False]), ([False, True, True], [False, True, False]),
    ([None, True, True], [False, True, False]), ([True, False, True], [False, False, True]),
    ([None, None, False], [False, False, False])])
def test_a_bumper_that_closes_after_the_first_measurement_is_news_once(
        is_pressed: list[bool | None], has_bumped: list[bool]) -> None:
    """Also where it was silent before, as a driver is that tells of changes only."""
    perception, news = RawPerception(ControlSettings()), []
    for step, state in enumerate(is_pressed):
        perception.update(Observation(0.1 * step, AT_REST._replace(time=0.1 * step), None,
                                      is_bumper_pressed=state))
        news.append(perception.has_bumped)
    assert news == has_bumped
