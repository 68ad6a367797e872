"""A supervisor behind the safety layer, with whatever comes in whatever order."""

import functools
import math

from helpers.fuzzing import hypothesis, settings, st, STEPS, STEPS_PER_EXAMPLE
from hypothesis.stateful import initialize, invariant, rule, RuleBasedStateMachine
from push_control.events import TaskEvent
from push_control.task.status import TaskState
from push_control.task.supervisor import Supervisor
from push_model.geometry import Pose, wrap_angle
from push_model.observation import Observation
from push_model.plan_request import PlanFailure
from push_model.signals import ObjectPose, Odometry, STOP, Twist
from push_planner.problem import problem_from_placement
from push_planner.steered.planner import plan_push
from push_safety.layer import SafetyLayer
from push_scenario.definition.loader import load_scenario
import pytest

PERIOD = 0.05
SCENARIO = load_scenario('straight_push')
NO_MAP = TaskEvent.NO_USABLE_MAP.report(map_fault='no map')
TASK = load_scenario('task_tap').task
ROBOT = SCENARIO.robot
# As messages are read, and what is not finite.
NUMBERS = st.one_of(st.floats(-3.0, 3.0), st.floats(-1e7, 1e7),
                    st.sampled_from([math.nan, math.inf, -math.inf]))
POSES = st.builds(Pose, NUMBERS, NUMBERS, NUMBERS)
SPEEDS = st.one_of(st.floats(-3.0, 3.0), st.floats(-1e3, 1e3),
                   st.sampled_from([math.nan, math.inf]))
TWISTS = st.builds(Twist, SPEEDS, SPEEDS, SPEEDS)


@functools.lru_cache(maxsize=None)
def trajectory():
    """Plan the push of the scenario, once."""
    return plan_push(problem_from_placement(
        SCENARIO.object, ROBOT, SCENARIO.start.object.pose, SCENARIO.robot_start,
        SCENARIO.goal.pose, SCENARIO.planner)).trajectory


class Machine(RuleBasedStateMachine):
    """Everything that a supervisor and a safety layer can be told."""

    @initialize()
    def begin(self):
        """Make both, and a robot that stands behind the object."""
        self.supervisor = Supervisor(SCENARIO.object, ROBOT, SCENARIO.control, TASK.drive,
                                     TASK.supervision)
        self.layer = SafetyLayer(ROBOT, SCENARIO.object)
        self.time, self.sent = 0.0, STOP
        self.object_pose = ObjectPose(0.0, SCENARIO.start.object.pose)
        self.odometry = Odometry(0.0, SCENARIO.robot_start, STOP)
        self.supervisor.set_goal(SCENARIO.goal.pose)

    def step(self, odometry=None, object_pose=None):
        """Let the robot answer what has come last."""
        self.odometry = odometry or self.odometry
        self.object_pose = object_pose or self.object_pose
        self.sent = self.layer.guard(Observation(self.time, self.odometry, self.object_pose),
                                     self.supervisor,
                                     lambda believed: self.supervisor.step(believed, PERIOD))

    @rule(count=st.integers(1, 12), ratio=st.sampled_from([1.0, 1.0, 1.0, 0.0, -1.0, 3.0]))
    def drive(self, count, ratio):
        """Drive as commanded, or otherwise; both sensors measure that."""
        for _ in range(count):
            self.time += PERIOD
            pose, sent = self.odometry.pose, Twist(*(ratio * value for value in self.sent))
            if not pose.is_finite():
                pose = SCENARIO.robot_start
            place = pose.transform((PERIOD * sent.v_x, PERIOD * sent.v_y))
            heading = wrap_angle(pose.theta + PERIOD * sent.omega)
            self.step(Odometry(self.time, Pose(*place, heading), sent),
                      ObjectPose(self.time, SCENARIO.start.object.pose))

    @rule(pose=POSES, twist=TWISTS, shift=st.sampled_from([PERIOD, 0.0, -1.0, 0.6]))
    def spoil_odometry(self, pose, twist, shift):
        """Measure something else."""
        self.time += PERIOD
        self.step(odometry=Odometry(self.time - PERIOD + shift, pose, twist))

    @rule(pose=POSES, count=st.integers(1, 4))
    def spoil_poses(self, pose, count):
        """Measure the object elsewhere, perhaps again and again."""
        for _ in range(count):
            self.time += PERIOD
            self.step(object_pose=ObjectPose(self.time, pose))

    @rule(duration=st.sampled_from([0.3, 3.0, 30.0]))
    def wait(self, duration):
        """Let time pass, in which nothing else comes."""
        self.time += duration
        self.step()

    @rule(is_there=st.booleans())
    def plan(self, is_there):
        """Answer a request, or nobody's."""
        if is_there:
            self.supervisor.set_plan(trajectory())
        else:
            self.supervisor.on_planning_failed(PlanFailure.NOT_CONVERGED, 'there is none')

    @rule(goal=st.one_of(st.just(SCENARIO.goal.pose), POSES))
    def set_goal(self, goal):
        """Set a goal; one that is not finite is refused."""
        if goal.is_finite():
            self.supervisor.set_goal(goal)
        else:
            with pytest.raises(ValueError, match='goal'):
                self.supervisor.set_goal(goal)

    @rule(name=st.sampled_from(['pause', 'resume', 'stop', 'cancel', 'interrupt', 'hold', 'free']))
    def interfere(self, name):
        """Call a service."""
        if name in ('pause', 'resume'):
            getattr(self.supervisor, name)()
        elif name in ('hold', 'free'):
            self.supervisor.hold(NO_MAP if name == 'hold' else None)
        else:
            getattr(self.supervisor, name)(TaskEvent.STOPPED_BY_USER.report())

    @rule()
    def go_back(self):
        """Begin anew, as where time went back."""
        self.layer.reset()

    @invariant()
    def what_is_sent_is_possible(self):
        """Finite, within the limits, and zero where anything says so."""
        if not hasattr(self, 'sent'):
            return
        assert all(map(math.isfinite, self.sent))
        assert math.hypot(self.sent.v_x, self.sent.v_y) <= ROBOT.max_speed * 1.000001
        assert abs(self.sent.omega) <= ROBOT.max_yaw_rate * 1.000001
        assert self.layer.report is None or self.sent == STOP and str(self.layer.report)

    @invariant()
    def what_has_failed_says_why(self):
        """And nothing else has a failure."""
        if not hasattr(self, 'supervisor'):
            return
        status = self.supervisor.status
        assert status.state is not TaskState.FAILED or status.reason and status.codes
        assert status.failure is None or status.state is TaskState.FAILED


@pytest.mark.slow
def test_whatever_comes_the_robot_is_safe():
    """No order of events raises, or lets it drive where it must stand."""
    hypothesis.stateful.run_state_machine_as_test(Machine, settings=settings(
        max(1, 4 * STEPS // STEPS_PER_EXAMPLE), stateful_step_count=STEPS_PER_EXAMPLE))
