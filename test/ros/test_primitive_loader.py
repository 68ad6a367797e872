"""Primitives of a new object are made beside the node, those of one request after the other."""

import threading
from typing import Iterator

from helpers.objects import bin_
from push_model.geometry import Pose
from push_model.parameters import RoundRobot
from push_model.plan_request import PlanFailure, PlanRequest
from push_navigation.settings import DriveSettings
from push_planner.problem import PlanningFailed
from push_planner.ros import primitive_loader
from push_planner.ros.primitive_loader import PrimitiveLoader, THREAD_NAME
import pytest

ROBOT, DRIVE = RoundRobot(radius=0.17), DriveSettings()
# No measure of speed: it only keeps a suite from hanging [s].
TIMEOUT = 400.0


class Making:
    """Stands for what takes long: each request goes on until it is told to end."""

    def __init__(self) -> None:
        self.is_failing = False
        self.goals: list[float] = []
        self.ends: dict[float, threading.Event] = {}

    def end(self, goal: float) -> None:
        """Let the making for a goal end."""
        self.ends.setdefault(goal, threading.Event()).set()

    def __call__(self, request: PlanRequest, robot: RoundRobot, drive: DriveSettings) -> None:
        self.goals.append(request.goal.x)
        assert self.ends.setdefault(request.goal.x, threading.Event()).wait(TIMEOUT)
        if self.is_failing:
            raise PlanningFailed(PlanFailure.NO_FEASIBLE_SITE, 'no face is long enough')


@pytest.fixture
def making(monkeypatch: pytest.MonkeyPatch) -> Iterator[Making]:
    """Make primitives under control of the test."""
    making = Making()
    monkeypatch.setattr(primitive_loader, 'primitives_for', making)
    yield making
    for end in making.ends.values():
        end.set()


def request(x: float) -> PlanRequest:
    """Make a request with a goal."""
    return PlanRequest(Pose(0.0, 0.0, 0.0), Pose(-1.0, 0.0, 0.0), Pose(x, 0.0, 0.0), bin_(feet=4))


def loads_after_a_while(loader: PrimitiveLoader, wanted: PlanRequest) -> bool:
    """Wait until nothing is made any more, and ask then."""
    for thread in threading.enumerate():
        if thread.name == THREAD_NAME:
            thread.join(TIMEOUT)
    return loader.loads(wanted, ROBOT, DRIVE)


@pytest.mark.parametrize('is_failing', [False, True])
def test_a_request_waits_until_its_primitives_are_there(making, is_failing):
    """And no longer where there cannot be any: then the plan says why; it is tried once."""
    making.is_failing = is_failing
    loader, wanted = PrimitiveLoader(), request(1.0)
    assert loader.loads(wanted, ROBOT, DRIVE) and loader.loads(wanted, ROBOT, DRIVE)
    making.end(1.0)
    assert not loads_after_a_while(loader, wanted)
    assert making.goals == [1.0]


def test_a_newer_request_waits_for_the_former_and_then_for_itself(making):
    """They would only take time from each other."""
    loader, former, newer = PrimitiveLoader(), request(1.0), request(2.0)
    assert loader.loads(former, ROBOT, DRIVE) and loader.loads(newer, ROBOT, DRIVE)
    assert making.goals == [1.0]
    making.end(1.0)
    assert loads_after_a_while(loader, newer)
    making.end(2.0)
    assert not loads_after_a_while(loader, newer)
    assert making.goals == [1.0, 2.0]


def test_a_loader_is_busy_as_long_as_it_prepares():
    """Until then a planner does not say that it waits for a request."""
    loader, end = PrimitiveLoader(), threading.Event()
    assert not loader.is_busy
    loader.prepare(end.wait)
    assert loader.is_busy
    end.set()
    for thread in threading.enumerate():
        if thread.name == THREAD_NAME:
            thread.join(TIMEOUT)
    assert not loader.is_busy
