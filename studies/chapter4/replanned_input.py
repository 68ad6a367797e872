"""The optimiser in closed loop: a plan from the measured pose again and again."""

from push_control.steered.contact_model import ContactModel
from push_control.steered.estimation.filter_kernel import LATEST, SIZE
from push_control.steered.estimation.push_motion import MotionState
from push_control.steered.tracking import PushTracker
from push_model.geometry import Pose
from push_model.observation import Observation
from push_model.signals import ObjectPose, Twist
from push_model.trajectory import PushTrajectory
from push_planner.problem import PlanningFailed
from push_planner.steered.plan import Plan
from push_planner.steered.replanning import plan_from_measurements
from push_scenario.definition.scenario import Scenario
from push_scenario.simulation.robot_control import Ending
from push_sim_node.simulation import Simulation
from studies.chapter4.object_frame_input import ObjectFrameInput, travelled_distances

# Chosen: time between plans, as between new paths of feedback at least [s].
PERIOD = 0.5


class ReplannedInput(ObjectFrameInput):
    """
    Plays the plan in the object's frame, and replaces it every ``PERIOD``.

    The planner of the package plans from where the controller's filter sees object and robot, with
    the nominal parameters of the object: what the filter learns of its friction is not used. Where
    there is no plan, or only a detour, as just before the goal, the last one is played on. A plan
    is a detour where feedback would not take a path of its length either.
    """

    def __init__(self, scenario: Scenario, observation: Observation,
                 simulation: Simulation) -> None:
        """Plan the push; see ``ObjectFrameInput``."""
        super().__init__(scenario, observation, simulation)
        if self._plan is None or observation.object_pose is None:
            raise ValueError('observation: got no object pose, expected one')
        model = ContactModel(scenario.object, scenario.robot, scenario.control, self._plan)
        self._tracker = PushTracker(model.motion, scenario.control, model.center,
                                    observation.object_pose, observation.odometry)
        self._planned_at = observation.time
        self._previous: Plan | None = None

    def step(self, observation: Observation, dt: float) -> Twist:
        """Take the measurements in, and play the plan on; see ``RobotControl``."""
        self._tracker.observe(observation)
        return super().step(observation, dt)

    def update_plan(self, observation: Observation) -> Ending | None:
        """Replace the plan where that is due; see ``RobotControl``."""
        if not self._is_finished and observation.time >= self._planned_at + PERIOD:
            self._planned_at = observation.time
            self._replace_plan(observation)
        return super().update_plan(observation)

    def _replace_plan(self, observation: Observation) -> None:
        """Play a new plan, unless there is none, or it is a detour."""
        remaining = self._distances[-1] - self._distance
        try:
            plan = self._plan_again(observation)
        except PlanningFailed:
            return
        if travelled_distances(plan)[-1] <= self._settings.replan_length_ratio * remaining:
            self._play(plan)

    def _plan_again(self, observation: Observation) -> PushTrajectory:
        """Plan from where the filter sees object and robot."""
        tracker, odometry = self._tracker, observation.odometry
        tracker.interval_until(odometry.time)
        state = MotionState(*tracker.filter_memory[LATEST:LATEST + SIZE].tolist())
        robot = Pose(*tracker.site.robot_center(state.pose, state.phi), state.phi)
        choice = plan_from_measurements(
            self._scenario.object, self._scenario.robot, ObjectPose(odometry.time, state.pose),
            odometry._replace(pose=robot), self.goal, self._replan_settings,
            previous=self._previous)
        self._previous = choice.plan
        return choice.plan.trajectory
