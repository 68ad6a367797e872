"""ROS node of the planner."""

import sys
from typing import TYPE_CHECKING

from push_model.files.flat_values import parameter_specs
from push_model.parameters import PushedObject, RoundRobot
from push_model.plan_request import PlanFailure
from push_navigation.settings import DriveSettings, MapSettings
from push_planner.ros.parameters import PlannerParameters
from push_planner.settings import PlannerSettings
from push_ros.diagnostics import ERROR, FAILURE
from push_ros.executor import BackgroundGroup, run
from push_ros.lifecycle import ManagedNode
from push_ros.node_settings import Frames, PlannerOptions
from push_ros.parameters import DYNAMIC
from push_ros.topics import PLANNER
from push_ros.transforms.world import WorldFrame

if TYPE_CHECKING:  # What plans is imported as the node is configured, behind the first report.
    from push_planner.ros.active_planner import ActivePlanner

SECTIONS = (('object.', PushedObject), ('robot.', RoundRobot), ('planner.', PlannerSettings),
            ('drive.', DriveSettings), ('map.', MapSettings), ('', Frames),
            ('', PlannerOptions))
DYNAMIC_GROUPS = ('planner.', 'drive.')
SETTABLE = {spec.name: DYNAMIC for prefix, cls in SECTIONS if prefix in DYNAMIC_GROUPS
            for spec in parameter_specs(cls, prefix)}


class PlannerNode(ManagedNode):
    """
    Answers each request with a plan: of a single push, or of the next push of a task.

    A request brings the object that is to be pushed. The object of the parameters is the one for
    which the node prepares itself at its start; for another one that takes a while when its first
    request comes, unless it was done in former runs. Others are answered meanwhile.

    The plan of one push starts from the newest measurements, for which a request waits; while the
    robot pushes it starts from the present motion, at the site where it pushes. With
    ``planner.site`` at ``best`` the plan of a robot at rest starts at the quickest site of the
    object; the diagnostics say where the robot must stand for it, warn where it does not, and list
    all sites. The plan of a task's next push starts from the poses of the request, and keeps
    clear of the obstacles of the ``map``, if there is one; after a map that is refused there is
    no plan until another one comes.

    The answer has the stamp of the request; where there is no plan, or the request is refused, it
    has no points and its only joint name is the code of the reason, which is an error on
    ``/diagnostics`` as well.

    Publishers
        ``push_plan`` (JointTrajectory, latched); ``planned_path`` (Path, latched);
        ``planning_markers`` (MarkerArray, latched); ``/diagnostics`` (DiagnosticArray).

    Subscribers, while active
        ``odom`` (Odometry) and ``object_pose`` (PoseStamped, or PoseWithCovarianceStamped), best
        effort, after the first request of a task from ``planner/replan`` on; ``map``
        (OccupancyGrid, latched); ``push_request`` (JointTrajectory, latched); ``/tf`` and
        ``/tf_static`` (TFMessage) as soon as one of these comes in another frame.

    Services
        ``planner/replan`` (Trigger): plans again to the goal of the last request, from the newest
        measurements, for which it waits a second at most; and those of the lifecycle.

    ROS parameters
        ``object.*`` and ``robot.*``, nominal; ``planner.*``; ``drive.*`` and ``map.*``
        of tasks; ``world_frame``, ``object_frame``, ``base_frame``; and those of
        ``PlannerOptions``. Those of ``DYNAMIC_GROUPS`` may be set at any time.

    Frames
        Object poses and maps are brought to ``world_frame``, maps again where their frame drifts;
        everything else is in it.
    """

    def __init__(self) -> None:
        super().__init__(PLANNER, SECTIONS, SETTABLE)
        *_, frames, self._options = self.settings
        self._frame: str = frames.world_frame
        self._world = WorldFrame(self, frames.world_frame, self._options.transform_timeout)
        self._planner: ActivePlanner | None = None
        # In a group of its own: other services are answered while it waits.
        self.serve_active_trigger('planner/replan', lambda: self.planner.replan(),
                                  BackgroundGroup())

    @property
    def is_autostarted(self) -> bool:
        """Tell whether the node configures and activates itself."""
        return self._options.autostart

    @property
    def planner(self) -> 'ActivePlanner':
        """
        The ``ActivePlanner``.

        :raises RuntimeError: before configuring, and after cleaning up.
        """
        if self._planner is None:
            raise RuntimeError('planner: got none, expected a configured node')
        return self._planner

    def configure(self) -> None:
        """Start to compile what tasks need, and to load what pushes do."""
        from push_planner.ros.active_planner import ActivePlanner
        self._planner = ActivePlanner(self, self._present_parameters, self._options, self._world,
                                      self._frame)

    def activate(self) -> None:
        """Subscribe, and wait for a request."""
        self.planner.activate()

    def deactivate(self) -> None:
        """Forget what was requested."""
        self.planner.deactivate()

    def clean_up(self) -> None:
        """Forget the map."""
        self.planner.destroy()
        self._planner = None

    def on_settings_changed(self) -> None:
        """Plan with other settings from the next request on."""
        if self._planner is not None:
            self._planner.set_parameters(self._present_parameters)

    @property
    def _present_parameters(self) -> PlannerParameters:
        *sections, _, _ = self.settings
        return PlannerParameters(*sections)

    def on_unexpected_error(self, error: Exception) -> None:
        """
        Answer the request that it belongs to, if any, and go on.

        :param error: that a callback has raised.
        """
        super().on_unexpected_error(error)
        if self._planner is not None:
            self._planner.answer_after_error()
        self.reporter.report(ERROR, f'internal error: {error!r:.200}',
                             {FAILURE: PlanFailure.INTERNAL_ERROR.name})


if __name__ == '__main__':
    sys.exit(run(PlannerNode))
