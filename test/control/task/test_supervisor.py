"""The supervisor of a task, on the simulated plant and on measurements made up."""

import dataclasses
import functools
import math
from typing import Any

from helpers.maps import walled_room
from helpers.objects import bin_, box
import numpy as np
from push_control.behaviors.failures import BehaviorFailure
from push_control.behaviors.progress import MAP_TIME_LIMIT, RETRY_TIME
from push_control.events import PerceptionEvent, TaskEvent
from push_control.settings import ControlSettings
from push_control.supervision_settings import SupervisionSettings
from push_control.task.status import TaskState
from push_control.task.supervisor import Supervisor
from push_model.contact import find_contact
from push_model.events import codes, PushEvent
from push_model.geometry import distance, Pose, wrap_angle
from push_model.observation import Observation
from push_model.parameters import PushedObject, RoundRobot
from push_model.plan_request import PlanFailure, PlanRequest
from push_model.signals import ObjectPose, Odometry, STOP
from push_navigation.path import PathFailure
from push_navigation.settings import DriveSettings
from push_planner.settings import PlannerSettings
from push_planner.steered.task_push import plan_steered_push
from push_planner.task_plan import TaskPlan
from push_planner.task_planner import plan_for_request
from push_scenario.definition.scenario import Placement, Scenario, Start
from push_scenario.definition.task import Task
from push_scenario.simulation.loop import simulate
from push_scenario.simulation.result import Outcome
from push_sim_node.sensors import SensorSettings
from push_sim_node.simulation import Simulation, SimulationSettings
import pytest

# Plans and simulated pushes take some seconds each.
pytestmark = pytest.mark.slow

SUPERVISION, DRIVE = SupervisionSettings(), DriveSettings()
SENSORS = SensorSettings(pose_noise=2e-3, pose_heading_noise=math.radians(0.3), pose_latency=0.08,
                         pose_drop_probability=0.05, odometry_scale_noise=0.02,
                         odometry_heading_drift_noise=0.02)
FOLLOWS = {
    TaskState.PLAN: {TaskState.PLAN, TaskState.APPROACH, TaskState.DONE, TaskState.FAILED},
    TaskState.APPROACH: {TaskState.ALIGN, TaskState.PUSH, TaskState.PLAN},
    TaskState.ALIGN: {TaskState.PUSH, TaskState.RETREAT}, TaskState.PUSH: {TaskState.RETREAT},
    TaskState.RETREAT: {TaskState.PLAN, TaskState.RETREAT}}
GOAL = Placement(0.9, 0.3, 0.5)


def task(drive, goal=GOAL, sensors=None, seed=1, wrong=False):
    """Set a task: a box at the origin, the robot beyond the goal."""
    robot = RoundRobot(radius=0.17, drive=drive, max_speed=0.3, max_yaw_rate=1.9,
                       max_acceleration=0.9)
    believed = box(mass=3.0)
    true = box(mass=2.4, friction=(0.2, 0.35, 0.3, 0.25), contact_friction_coefficient=0.4)
    return Scenario(
        name='task', description='a task', object=believed,
        true_object=true if wrong else believed, robot=robot, true_robot=robot,
        start=Start(robot=Placement(1.4, 0.6, 2.0)), goal=goal,
        sensors=sensors or SensorSettings(), simulation=SimulationSettings(seed=seed),
        task=Task(), time_limit=300.0)


@functools.lru_cache(maxsize=None)
def undisturbed(drive):
    """Simulate the task, once."""
    return simulate(task(drive))


def check_reached(result):
    """Check that it says it is done, is done, and that the robot is clear of the object."""
    assert result.outcome is Outcome.DONE, result.reason
    assert result.position_error < SUPERVISION.position_tolerance
    assert abs(result.heading_error) < SUPERVISION.heading_tolerance
    assert result.tape['gap'][-1] > 0.04
    states = [change.state for change in result.status.history]
    assert all(after in FOLLOWS[before] for before, after in zip(states, states[1:]))


@pytest.mark.parametrize('drive', ['differential', 'holonomic'])
def test_a_task_is_done_from_the_wrong_side(drive):
    """The robot goes round the box, brings it to its goal and keeps its limits all the time."""
    result = undisturbed(drive)
    check_reached(result)
    tape, robot = result.tape, result.scenario.robot
    assert np.hypot(tape['command_v_x'], tape['command_v_y']).max() <= robot.max_speed + 1e-9
    assert np.abs(tape['command_omega']).max() <= robot.max_yaw_rate + 1e-9
    alone = np.ones(len(tape), dtype=bool)
    for change, end in zip(result.status.history, result.status.history[1:]):
        if change.state == TaskState.PUSH:
            alone &= (tape['time'] < change.time) | (tape['time'] > end.time + 0.1)
    assert np.hypot(tape['command_v_x'], tape['command_v_y'])[alone].max() <= DRIVE.speed + 1e-9
    assert np.abs(tape['command_omega'])[alone].max() <= DRIVE.yaw_rate + 1e-9


def test_with_any_heading_a_task_is_done_where_the_object_is_at_its_place() -> None:
    """The heading of the goal costs nothing: it is done within the tolerance of position."""
    scenario = task('differential')
    turned = dataclasses.replace(scenario.goal, theta=scenario.goal.theta + 2.5)
    free = dataclasses.replace(scenario.task, supervision=dataclasses.replace(
        scenario.task.supervision, heading_tolerance=math.tau))
    results = [simulate(dataclasses.replace(scenario, goal=goal, task=free))
               for goal in (scenario.goal, turned)]
    for result in results:
        end = result.tape.poses('object')[-1]
        assert result.outcome is Outcome.DONE
        assert math.dist(end[:2], scenario.goal.pose[:2]) < 0.01
    ends = [result.tape.poses('object')[-1] for result in results]
    np.testing.assert_allclose(ends[0], ends[1], atol=1e-9)


@pytest.mark.parametrize('drive, seed', [('differential', 3), ('holonomic', 4)])
def test_a_task_is_done_with_wrong_beliefs_and_poor_sensors(drive, seed):
    """Friction is uneven, poses are late and noisy, odometry drifts by centimetres."""
    result = simulate(task(drive, sensors=SENSORS, seed=seed, wrong=True))
    check_reached(result)
    robot, tape = result.status.robot_pose, result.tape
    # It is done while the robot still rolls away.
    then = int(np.searchsorted(tape['time'], result.duration))
    assert distance(robot, tape.poses('robot')[min(then, len(tape) - 1)]) < 0.03


def test_a_task_is_done_with_headings_as_noisy_as_stated():
    """The robot stands until their average is known, and says what it waits for."""
    noise, seen = math.radians(3.0), set()
    scenario = task(
        'differential', sensors=dataclasses.replace(SENSORS, pose_heading_noise=noise))
    scenario = dataclasses.replace(
        scenario, control=dataclasses.replace(scenario.control, heading_noise=noise))
    result = simulate(scenario, intervene=lambda _, supervisor: seen.update(
        codes(supervisor.cause)))
    check_reached(result)
    assert TaskEvent.AVERAGING in seen and PerceptionEvent.CONTACTS_DO_NOT_FIT not in seen


def test_the_same_task_again_goes_the_same_way():
    """Nothing in it reads a clock or draws unseeded numbers."""
    near = task('holonomic', goal=Placement(0.2, 0.05, 0.1), sensors=SENSORS)
    tapes = [simulate(near).tape.rows for _ in range(2)]
    assert np.array_equal(*tapes, equal_nan=True)


def test_an_object_at_its_goal_is_left_alone():
    """No plan is asked for and the robot does not move."""
    result = simulate(task('differential', goal=Placement()))
    check_reached(result)
    assert result.task_plans == () and result.status.pushes == 0
    assert not result.tape['robot_v_x'].any()


@pytest.mark.parametrize('bias, outcome', [(0.011, Outcome.DONE), (0.03, Outcome.FAILED)])
def test_an_object_whose_poses_are_biased_is_seen_from_other_sides(bias, outcome):
    """It is at its goal, and left alone; whether that can be shown depends on the bias."""
    scenario = task('holonomic', goal=Placement())
    settings = dataclasses.replace(SUPERVISION, position_tolerance=0.02, heading_tolerance=0.035)
    result = simulate(dataclasses.replace(
        scenario, control=ControlSettings(pose_bias=bias),
        task=dataclasses.replace(scenario.task, supervision=settings)))
    assert result.outcome is outcome and result.status.pushes == 0, result.reason
    assert (TaskEvent.GOAL_UNCERTAIN in result.codes) == (outcome is Outcome.FAILED)
    assert abs(result.position_error) < 1e-6
    looks = [change for change in result.status.history if TaskEvent.OBJECT_UNSEEN in change.codes]
    assert len(looks) >= (3 if outcome is Outcome.FAILED else 1)


class Once:
    """Does something when a state is reached for the first time, and some time has passed."""

    def __init__(self, state, act, delay=0.5):
        self.state, self.act, self.delay, self.time = state, act, delay, None

    def __call__(self, simulation, supervisor):
        """Look whether it is time."""
        status = supervisor.status
        if (self.time is None and status.state == self.state
                and simulation.time >= status.since + self.delay):
            self.time = simulation.time
            self.act(simulation, supervisor)


def move_object(simulation, _):
    """Carry the object away from the robot, and turn it."""
    pose, robot = simulation.truth.object_pose, simulation.truth.robot_pose
    ratio = 0.2 / distance(pose, robot)
    simulation.plant.set_object_pose(Pose(pose.x + ratio * (pose.x - robot.x),
                                     pose.y + ratio * (pose.y - robot.y), pose.theta + 0.3))


class SteeredFirst:
    """Plans a steered push at first, and then as ever."""

    def __init__(self) -> None:
        self._is_first = True

    def __call__(self, request: PlanRequest, robot: RoundRobot, settings: PlannerSettings,
                 drive: DriveSettings, *args: Any, **options: Any) -> TaskPlan:
        """Answer a request."""
        if self._is_first:
            self._is_first = False
            return plan_steered_push(request, robot, settings, drive)
        return plan_for_request(request, robot, settings, drive, *args, **options)


@pytest.mark.parametrize('state, make_planner', [
    (TaskState.APPROACH, lambda: plan_for_request), (TaskState.APPROACH, SteeredFirst),
    (TaskState.PUSH, SteeredFirst)], ids=['straight', 'steered', 'steered, pushing'])
def test_a_moved_object_gets_another_plan(state, make_planner):
    """The robot notices, wherever it is, and reaches the goal from there."""
    once = Once(state, move_object, delay=1.5)
    result = simulate(task('holonomic', sensors=SENSORS), intervene=once,
                      plan_push=make_planner())
    check_reached(result)
    assert result.status.recoveries >= 1
    assert any(once.time < change.time < once.time + 3.0 and change.reason
               for change in result.status.history)


def test_an_obstacle_of_a_new_map_on_the_path_is_driven_round() -> None:
    """The path that leads through it is given up at once, and the task is done all the same."""
    place: list[tuple[float, float]] = []

    def show_obstacle(simulation: Simulation, supervisor: Supervisor) -> None:
        pose, twist = simulation.truth.robot_pose, simulation.truth.robot_twist
        x, y = pose.rotate(twist[:2])
        speed = math.hypot(x, y)
        # What the robot covers in some seconds, far from where the object is pushed.
        x, y = pose.x + 0.45 * x / speed, pose.y + 0.45 * y / speed
        place.append((x, y))
        supervisor.set_map(walled_room((x - 0.08, x + 0.08, y - 0.08, y + 0.08)))
    once = Once(TaskState.APPROACH, show_obstacle, delay=1.0)
    result = simulate(task('holonomic'), intervene=once)
    changes = [change for change in result.status.history
               if TaskEvent.MAP_BLOCKS_PATH in change.codes]
    assert len(changes) == 1 and changes[0].time - once.time < 0.1
    assert result.outcome is Outcome.DONE
    robots = np.array(result.tape.poses('robot'))[:, :2]
    assert np.hypot(*(robots - place[0]).T).min() > 0.17 + 0.05


def test_a_push_ends_before_an_obstacle_of_a_new_map() -> None:
    """At once; what is planned next is the planner's, which has a map of its own."""
    place: list[tuple[float, float]] = []

    def show_obstacle(simulation: Simulation, supervisor: Supervisor) -> None:
        truth = simulation.truth
        x, y = truth.robot_pose.rotate(truth.robot_twist[:2])
        speed = math.hypot(x, y)
        # Where the object would be in some seconds.
        x, y = truth.object_pose.x + 0.4 * x / speed, truth.object_pose.y + 0.4 * y / speed
        place.append((x, y))
        supervisor.set_map(walled_room((x - 0.04, x + 0.04, y - 0.04, y + 0.04)))
    once = Once(TaskState.PUSH, show_obstacle, delay=1.0)
    result = simulate(task('holonomic'), intervene=once)
    end = next(change for change in result.status.history
               if TaskEvent.MAP_BLOCKS_PATH in change.codes)
    assert end.time - once.time < 0.1
    following = next(change.time for change in result.status.history
                     if change.time > end.time and change.state is TaskState.PUSH)
    until = result.tape['time'] < following
    objects = np.array(result.tape.poses('object'))[until, :2]
    assert np.hypot(*(objects - place[0]).T).min() > 0.3


def test_a_map_that_is_wrong_for_some_seconds_is_outlasted() -> None:
    """The robot, which stands in an obstacle of it, waits between its attempts to plan."""
    def spoil(simulation: Simulation, supervisor: Supervisor) -> None:
        x, y, _ = simulation.truth.robot_pose
        supervisor.set_map(walled_room((x - 0.3, x + 0.3, y - 0.3, y + 0.3)))
    once = Once(TaskState.APPROACH, spoil, delay=0.5)

    def intervene(simulation: Simulation, supervisor: Supervisor) -> None:
        once(simulation, supervisor)
        if once.time is not None and simulation.time >= once.time + 5.0:
            supervisor.set_map(None)
    result = simulate(task('differential'), intervene=intervene)
    failures = [change.time for change in result.status.history
                if PathFailure.START_IN_OBSTACLE in change.codes]
    assert len(failures) >= 2 and np.diff(failures).min() > RETRY_TIME - 0.05
    check_reached(result)


def test_a_straight_push_follows_an_object_that_is_moved():
    """It is no failure: the push goes on, or the next one is planned from what is seen."""
    once = Once(TaskState.PUSH, move_object, delay=1.5)
    result = simulate(task('holonomic', sensors=SENSORS), intervene=once)
    assert once.time is not None
    check_reached(result)


@pytest.mark.parametrize(
    'state', [TaskState.PLAN, TaskState.APPROACH, TaskState.PUSH, TaskState.RETREAT])
def test_a_new_goal_is_taken_up_in_any_state(state):
    """The robot leaves what it does; the object arrives at the new goal."""
    other = Placement(-0.3, 0.7, -0.2)
    once = Once(state, lambda _, supervisor: supervisor.set_goal(other.pose), delay=0.04)
    result = simulate(task('holonomic'), intervene=once)
    assert once.time is not None and result.outcome is Outcome.DONE
    there = result.tape.poses('object')[-1]
    assert distance(there, other.pose) < SUPERVISION.position_tolerance
    assert abs(wrap_angle(there[2] - other.theta)) < SUPERVISION.heading_tolerance
    assert result.status.history[0].codes == (TaskEvent.NEW_GOAL,)


@pytest.mark.parametrize(
    'state', [TaskState.APPROACH, TaskState.ALIGN, TaskState.PUSH, TaskState.RETREAT])
def test_a_pause_holds_the_robot_in_any_state(state):
    """It stands until it is told to go on, and then does what it was to do."""
    once = Once(state, lambda _, supervisor: supervisor.pause(), delay=0.2)

    def change(simulation, supervisor):
        once(simulation, supervisor)
        if once.time is not None and simulation.time > once.time + 2.0:
            supervisor.resume()

    plan_push = SteeredFirst() if state is TaskState.ALIGN else plan_for_request
    result = simulate(task('holonomic'), intervene=change, plan_push=plan_push)
    assert result.outcome is Outcome.DONE
    time = result.tape['time']
    paused = (time > once.time + 0.05) & (time < once.time + 1.95)
    commands = np.stack([result.tape[f'command_{name}'] for name in ('v_x', 'v_y', 'omega')])
    assert paused.sum() > 50 and not commands[:, paused].any()


def test_lost_poses_are_waited_for():
    """The robot stands while it does not see the object, and goes on when it does."""
    intervals = ((4.0, 6.0), (20.0, 22.0))
    sensors = dataclasses.replace(SENSORS, pose_dropouts=intervals)
    waited = []

    def change(simulation, supervisor):
        if PushEvent.OBJECT_POSE_STALE in supervisor.status.codes:
            waited.append(simulation.time)

    result = simulate(task('holonomic', sensors=sensors), intervene=change)
    check_reached(result)
    time = result.tape['time']
    assert any(4.0 < at < 6.2 for at in waited)
    hidden = (time > 5.0) & (time < 6.0)
    assert not np.hypot(result.tape['command_v_x'], result.tape['command_v_y'])[hidden].any()


SILENCE = TaskEvent.NOBODY_PLANS.report(timeout=1.0, topic='push_request')


class Bench:
    """A supervisor and measurements of a robot and an object that do not move."""

    def __init__(self, robot: Pose = Pose(2.0, 0.0, 0.0),
                 settings: SupervisionSettings = SUPERVISION, obj: PushedObject = box()) -> None:
        self.supervisor = Supervisor(obj, RoundRobot(radius=0.17, max_speed=0.3),
                                     ControlSettings(), DRIVE, settings)
        self.robot, self.time = robot, 0.0

    def run(self, duration):
        """Let time pass; return the commands."""
        commands = []
        for _ in range(round(duration / 0.05)):
            self.time += 0.05
            commands.append(self.supervisor.step(Observation(
                self.time, Odometry(self.time, self.robot, STOP),
                ObjectPose(self.time, Pose(0.0, 0.0, 0.0))), 0.05))
        return commands


def test_a_plan_is_requested_from_what_is_measured():
    """Not before the object was seen at rest for a while; the goal is handed on."""
    bench = Bench()
    assert bench.run(1.0) == [STOP] * 20 and bench.supervisor.plan_request is None
    bench.supervisor.set_goal(GOAL.pose)
    bench.run(0.1)
    request = bench.supervisor.plan_request
    assert request.robot_pose == pytest.approx(bench.robot) and request.goal == GOAL.pose
    assert request.object_pose == pytest.approx((0.0, 0.0, 0.0))


@pytest.mark.parametrize('failures, max_attempts', [
    ([PlanFailure.TIPS] * 2, 2),
    ([PlanFailure.TIPS, PlanFailure.NO_FEASIBLE_SITE], SUPERVISION.max_attempts)])
def test_it_aborts_where_there_is_no_plan(failures, max_attempts):
    """After the same failure twice from the same poses, or after all attempts."""
    bench, refusals = Bench(), 0
    bench.supervisor.set_goal(GOAL.pose)
    while bench.supervisor.status.state == TaskState.PLAN:
        assert set(bench.run(0.1)) == {STOP}
        if bench.supervisor.plan_request is not None:
            bench.supervisor.on_planning_failed(failures[refusals % 2], f'reason {refusals}')
            refusals += 1
    status = bench.supervisor.status
    assert status.state == TaskState.FAILED and f'reason {refusals - 1}' in status.reason
    assert failures[(refusals - 1) % 2] in status.codes
    assert refusals == status.recoveries == max_attempts
    bench.supervisor.set_goal(GOAL.pose)
    assert bench.supervisor.status.state == TaskState.PLAN


def test_a_goal_that_the_planner_calls_reached_is_reached():
    """Pushes are no more accurate than that."""
    bench = Bench()
    bench.supervisor.set_goal(GOAL.pose)
    while bench.supervisor.plan_request is None:
        bench.run(0.1)
    bench.supervisor.on_planning_failed(PlanFailure.AT_GOAL, 'the object is at the goal already')
    assert bench.supervisor.state is TaskState.DONE
    assert bench.supervisor.status.codes == (TaskEvent.NO_PUSH_NEEDED, PlanFailure.AT_GOAL)


def test_a_robot_stands_while_a_map_blocks_the_goal_and_goes_on_with_one_that_does_not():
    """It says so, and waits for longer than its attempts would last."""
    bench = Bench()
    bench.supervisor.set_goal(GOAL.pose)
    while bench.time < 0.8 * MAP_TIME_LIMIT:
        assert set(bench.run(0.5)) == {STOP}
        if bench.supervisor.plan_request is not None:
            bench.supervisor.on_planning_failed(PlanFailure.NOT_FREE, 'the goal is not free')
        assert bench.supervisor.status.state == TaskState.PLAN
        assert PlanFailure.NOT_FREE in bench.supervisor.status.codes
    bench.supervisor.set_map(None)
    bench.run(0.5)
    assert bench.supervisor.plan_request is not None


def test_a_failed_request_is_repeated_where_something_has_changed():
    """The robot was carried off, or there is another map."""
    changes = [lambda bench: setattr(bench, 'robot', Pose(bench.robot.x + 0.2, 0.0, 0.0)),
               lambda bench: bench.supervisor.set_map(None)]
    bench = Bench()
    bench.supervisor.set_goal(GOAL.pose)
    for change in changes * 3:
        bench.run(RETRY_TIME + 0.5)
        bench.supervisor.on_planning_failed(PlanFailure.BLOCKED, 'the goal is behind a wall')
        change(bench)
    bench.run(RETRY_TIME + 0.5)
    assert bench.supervisor.plan_request is not None


def test_a_plan_that_does_not_come_is_requested_again() -> None:
    """Whoever waits for it says so; it counts as an attempt that failed."""
    bench = Bench()
    bench.supervisor.set_goal(GOAL.pose)
    bench.supervisor.on_plan_overdue(SILENCE)
    assert bench.supervisor.status.recoveries == 0
    bench.run(1.0)
    bench.supervisor.on_plan_overdue(SILENCE)
    assert bench.supervisor.plan_request is None
    bench.run(0.1)
    assert bench.supervisor.status.recoveries == 1
    assert bench.supervisor.plan_request is not None


def test_a_plan_that_may_be_lost_is_requested_again_at_once():
    """After a gap, in which an answer may have been lost; that is no failed attempt."""
    bench = Bench()
    bench.supervisor.set_goal(GOAL.pose)
    bench.supervisor.renew_request()
    bench.run(1.0)
    former = bench.supervisor.plan_request
    bench.supervisor.renew_request()
    assert former is not None and bench.supervisor.plan_request is None
    bench.run(0.1)
    assert bench.supervisor.plan_request is not None
    assert bench.supervisor.plan_request is not former
    assert bench.supervisor.status.recoveries == 0


def test_stopped_it_stands_and_forgets_its_goal():
    """Only a new goal brings it back to life."""
    bench = Bench()
    bench.supervisor.set_goal(GOAL.pose)
    bench.run(1.0)
    bench.supervisor.stop(TaskEvent.STOPPED_BY_USER.report())
    bench.supervisor.resume()
    assert set(bench.run(1.0)) == {STOP} and bench.supervisor.plan_request is None
    assert bench.supervisor.status.state == TaskState.IDLE
    assert bench.supervisor.status.codes == (TaskEvent.STOPPED_BY_USER,)


def test_a_task_that_is_cancelled_in_a_push_backs_off_first():
    """The robot leaves the object and stands idle; elsewhere it stands at once."""
    states = []

    def cancel(simulation, supervisor):
        state = supervisor.status.state
        if state is TaskState.PUSH and simulation.time > 0.0:
            supervisor.cancel(TaskEvent.GOAL_CANCELLED.report())
        if not states or states[-1] is not supervisor.status.state:
            states.append(supervisor.status.state)

    result = simulate(dataclasses.replace(task('holonomic'), time_limit=30.0), intervene=cancel)
    assert states[states.index(TaskState.RETREAT):] == [TaskState.RETREAT, TaskState.IDLE]
    assert result.status.pushes == 1 and result.tape['gap'][-1] > 0.02
    bench = Bench()
    bench.supervisor.set_goal(GOAL.pose)
    bench.run(1.0)
    bench.supervisor.cancel(TaskEvent.GOAL_CANCELLED.report())
    assert bench.supervisor.status.state is TaskState.IDLE
    assert bench.supervisor.status.is_requested


def test_settings_may_change_during_a_task():
    """A tolerance that grows to the distance that is left makes the task done."""
    bench = Bench()
    bench.supervisor.set_goal(GOAL.pose)
    bench.run(0.2)
    bench.supervisor.set_settings(ControlSettings(), DRIVE, dataclasses.replace(
        SUPERVISION, position_tolerance=1.0, heading_tolerance=1.0))
    bench.supervisor.set_goal(Pose(0.3, 0.0, 0.2))
    bench.run(5.0)
    assert bench.supervisor.status.state is TaskState.DONE


@pytest.mark.parametrize('obj, is_free, is_done', [
    (bin_(), True, True), (bin_(), False, False), (box(), True, False), (box(), False, False)])
def test_a_round_object_is_at_its_goal_with_any_heading_where_that_is_free(
        obj: PushedObject, is_free: bool, is_done: bool) -> None:
    """A box never is, and whatever stands at its goal with the heading of it always is."""
    settings = dataclasses.replace(SUPERVISION, disc_heading_free=is_free)
    for heading, is_there in ((2.5, is_done), (0.0, True)):
        made, changed = Bench(settings=settings, obj=obj), Bench(
            settings=dataclasses.replace(settings, disc_heading_free=not is_free), obj=obj)
        changed.supervisor.set_settings(ControlSettings(), DRIVE, settings)
        for bench in (made, changed):
            bench.supervisor.set_goal(Pose(0.0, 0.0, heading))
            bench.run(1.0)
            assert (bench.supervisor.state is TaskState.DONE) == is_there
            assert (bench.supervisor.plan_request is None) == is_there


def test_what_cannot_be_is_refused():
    """A goal or a time that is not finite is named."""
    bench = Bench()
    with pytest.raises(ValueError, match='goal'):
        bench.supervisor.set_goal(Pose(math.nan, 0.0, 0.0))
    with pytest.raises(ValueError, match='dt'):
        bench.supervisor.step(Observation(0.0, Odometry(0.0, GOAL.pose, STOP)), -1.0)


def test_a_robot_that_does_not_move_is_noticed():
    """Where the wheels stand still the approach is soon given up."""
    bench = Bench()
    bench.supervisor.set_goal(GOAL.pose)
    bench.run(1.0)
    trajectory = undisturbed('differential').task_plans[0].trajectory
    bench.supervisor.set_plan(trajectory)
    assert bench.supervisor.status.state == TaskState.APPROACH
    commands = bench.run(SUPERVISION.stall_timeout + 0.2)
    assert STOP not in commands[1:-5]
    status = bench.supervisor.status
    assert status.recoveries == 1 and status.state == TaskState.PLAN
    assert BehaviorFailure.STALLED in status.codes


def test_an_overlap_is_an_error_of_odometry():
    """A robot that seems to stand in the object is believed beside it."""
    bench = Bench(robot=Pose(0.3, 0.0, 0.0))
    bench.supervisor.set_goal(GOAL.pose)
    bench.run(1.0)
    bench.supervisor.set_plan(undisturbed('differential').task_plans[0].trajectory)
    bench.run(1.0)
    gap = find_contact(box(), Pose(0.0, 0.0, 0.0), bench.supervisor.status.robot_pose[:2], 0.17)[2]
    assert gap > -0.02
