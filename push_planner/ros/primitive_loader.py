"""Loading of what pushes do to an object, which is made first where the object is new."""

from collections.abc import Callable

from push_model.parameters import RoundRobot
from push_model.plan_request import PlanRequest
from push_navigation.settings import DriveSettings
from push_planner.straight.planner import checked_request, primitives_for
from push_ros.background import Background

# Time that loading may take before the node goes on meanwhile [s]; chosen: a file takes some tens
# of milliseconds, what is in memory far less, and a new object seconds.
LOADING_TIME = 0.1
THREAD_NAME = 'primitives'


class PrimitiveLoader:
    """
    Prepares the planner, and loads the primitives of the object of a request, on threads.

    One thing is done after the other. Making primitives takes some hundred calls of compiled
    functions, between which others can run.
    """

    def __init__(self) -> None:
        """Start without a request."""
        self._request: PlanRequest | None = None
        self._background = Background(THREAD_NAME)

    def prepare(self, action: Callable[[], None]) -> None:
        """
        Do what a first request would wait for, behind what is under way.

        :param action: that compiles or loads; where it fails, so will the request, and says so.
        """
        self._background.start(action)

    @property
    def is_busy(self) -> bool:
        """Tell whether something is being prepared or loaded."""
        return self._background.is_busy

    def loads(self, request: PlanRequest, robot: RoundRobot, drive: DriveSettings) -> bool:
        """
        Start to load, unless that was done, and tell whether it goes on; one after the other.

        :param request: ``PlanRequest``, the same one each time.
        """
        if request is not self._request:
            if self.is_busy:
                return True
            self._request = request
            self.prepare(lambda: _load(request, robot, drive))
            self._background.wait(LOADING_TIME)
        return self.is_busy


def _load(request: PlanRequest, robot: RoundRobot, drive: DriveSettings) -> None:
    primitives_for(checked_request(request, robot), robot, drive)
