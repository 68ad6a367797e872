"""
The controller's node between a simulation and a planner that this program plays, in lockstep.

Goal, map, plan and the clock of all stamps come to a node as messages. Each is spoilt there, on
its way over DDS: the node lives in this process, but nothing reaches it otherwise.
"""

from collections.abc import Callable, Generator
import contextlib
import dataclasses
import math
from pathlib import Path
import tempfile
import time
from typing import Any, NamedTuple

from benchmarks.faults.expectations import Notice, notices
from benchmarks.faults.injection import Fault, GAP, Input, OFFSET, PERIOD, SentCommand, Word
from benchmarks.faults.row import Ending
from geometry_msgs.msg import PoseStamped
import numpy as np
from push_control.controller_node import ControllerNode
from push_model.geometry import Pose
from push_model.signals import LidarScan, ObjectPose, Odometry, STOP
from push_model.trajectory import PushTrajectory
from push_navigation.occupancy_map import OccupancyMap
from push_navigation.settings import MapSettings
from push_planner.problem import PlanningFailed
from push_planner.ros.parameters import PlannerParameters
from push_planner.ros.task_requests import TaskRequestHandler
from push_ros.conversions.map import to_map_message
from push_ros.conversions.measurements import to_object_pose_message, to_odometry_message
from push_ros.conversions.plan import no_plan_message, to_plan_message
from push_ros.conversions.primitives import (
    from_twist_message, nanoseconds, to_pose_message, to_stamp,
)
from push_ros.diagnostics import ERROR, status_values
from push_ros.executor import take_message
from push_ros.topics import CONTROLLER, TOPICS
from push_scenario.dds.parameter_files import write_parameter_files
from push_scenario.dds.private_network import private_domain
from push_scenario.definition.scenario import Scenario
from push_scenario.simulation.loop import make_simulation
from push_scenario.simulation.start import place_robot
import rclpy
from rclpy.executors import SingleThreadedExecutor

FRAME = 'odom'
# Beginning of the clock [s]: stamps of a computer, which count from 1970, and not of a simulator.
EPOCH = 1.8e9
# Endings by state of the task, and time after one in which the robot comes to rest [s].
ENDINGS = {'done': Ending.DONE, 'failed': Ending.FAILED}
SETTLE_TIME = 1.0
# When the goal is set, and the map before it [s].
GOAL_TIME, MAP_TIME = 0.1, 0.0
# Planning time [s]; as in one process.
PLANNING_TIME = 0.1
# Period at which a source repeats what should come once, or alternates [s], and the delays of slow
# and of late messages [s].
REPETITION_PERIOD = 0.1
ALTERNATION_PERIOD = 1.0
DELAYS = {Word.SLOW: 5.0, Word.DELAYED: 0.5}
# A goal beyond any floor [m], and by how much a wrong clock is off [s].
FAR = 1e6
CLOCK_OFFSET = 30.0
# Side and resolution of the map [m].
MAP_SIZE, RESOLUTION = 8.0, 0.1
# Time on the wall in which an answer has to come, and for which one is looked for that may be
# withheld [s].
ANSWER_TIME = 60.0
WITHHELD_TIME = 0.003


class Report(NamedTuple):
    """
    What the node has reported: a state and its reason.

    :param text: one sentence.
    :param state: of the task, as of ``TaskState``; empty where the report is of something else.
    :param codes: names of the codes of the reason.
    """

    text: str
    is_error: bool = False
    state: str = ''
    codes: tuple[str, ...] = ()


# A node that was never asked for anything.
NO_GOAL = Report(Notice.NO_GOAL.value, codes=(str(Notice.NO_GOAL),))


class NodeRun(NamedTuple):
    """
    A run of the node.

    :param simulation: the ``Simulation`` with its tape.
    :param plans: every ``PushTrajectory`` that was sent in truth.
    :param sent: each ``SentCommand``.
    :param reports: each ``Report`` that differs from the one before.
    :param end_time: when it was over [s]; what comes after that shows whether the robot stands.
    """

    simulation: Any
    plans: list[PushTrajectory]
    sent: list[SentCommand]
    reports: list[Report]
    end_time: float

    @property
    def ending(self) -> Ending:
        """The ``Ending``."""
        return ENDINGS.get(self.reports[-1].state, Ending.WAITS)


def run_node(scenario: Scenario, fault: Fault, time_limit: float, seed: int = 0) -> NodeRun:
    """
    Do a task with the controller's node.

    :param scenario: the ``Scenario``, with a task.
    :param fault: done to the goal, the map, the plan or the clock.
    :param time_limit: simulated time [s].
    :param seed: of garbage.
    """
    scenario = place_robot(scenario)
    with private_domain() as domain, tempfile.TemporaryDirectory() as folder:
        parameters = write_parameter_files(Path(folder), scenario, scenario.control,
                                           Path(folder) / 'tape', real_time=False, stamped=True)
        with _controller(parameters[CONTROLLER], domain) as controller:
            rig = _Rig(scenario, fault, controller, np.random.default_rng(seed))
            end_time = rig.run(time_limit)
            return NodeRun(rig.simulation, rig.plans, rig.sent, rig.reports, end_time)


@contextlib.contextmanager
def _controller(parameters: Path, domain: int) -> Generator[ControllerNode, None, None]:
    rclpy.init(args=['--ros-args', '--params-file', str(parameters), '--log-level', 'FATAL',
                     '-p', 'wait_for_start:=false', '-p', 'use_sim_time:=false'],
               domain_id=domain)
    controller = ControllerNode()
    try:
        controller.start()
        yield controller
    finally:
        controller.destroy_node()
        rclpy.shutdown()


class _Rig:
    """Simulation, planner, and whoever sets goals and maps."""

    def __init__(self, scenario: Scenario, fault: Fault, controller: ControllerNode,
                 rng: np.random.Generator) -> None:
        self.simulation = make_simulation(scenario)
        self.plans: list[PushTrajectory] = []
        self.sent: list[SentCommand] = []
        self.reports: list[Report] = []
        self._scenario = scenario
        self._fault = fault
        self._rng = rng
        self._controller = controller
        task = scenario.task
        if task is None:
            raise ValueError(f'{scenario.name}: got no task, expected one')
        self._planner = TaskRequestHandler(PlannerParameters(
            scenario.object, scenario.robot, scenario.planner, task.drive, MapSettings()),
            FRAME)
        self._node = rclpy.create_node('faults')
        self._executor = SingleThreadedExecutor()
        self._executor.add_node(controller)
        self._publishers = {
            topic: self._node.create_publisher(
                PoseStamped if topic == 'object_pose' else TOPICS[topic].message_type(), topic,
                TOPICS[topic].publish_qos)
            for topic in ('odom', 'object_pose', 'goal_pose', 'map', 'push_plan')}
        self._inputs = {topic: self._node.create_subscription(
            TOPICS[topic].message_type(),
            f'/{topic}' if TOPICS[topic].is_global else topic, _ignore,
            TOPICS[topic].publish_qos)
            for topic in ('cmd_vel', 'push_request', 'diagnostics')}
        # What is to be published, by simulated time, and when the source does it next [s].
        self._due: list[tuple[float, str, Any]] = []
        self._spoils_at = fault.start
        self._withheld = False
        self._frozen_stamp = 0.0
        self._wait(lambda: all(publisher.get_subscription_count()
                               for publisher in self._publishers.values()))
        self._due.append((GOAL_TIME, 'goal_pose', self._goal(scenario.goal.pose)))
        if fault.input is Input.MAP:
            self._due.append((MAP_TIME, 'map', self._map()))

    def run(self, time_limit: float) -> float:
        """
        Go on until the task has ended, or time is up, and the robot has come to rest.

        :return: when it has ended [s]; the limit where it has not, or something came after that.
        """
        simulation, end = self.simulation, time_limit
        while simulation.time < end + SETTLE_TIME:
            measured = simulation.next_measurement()
            self._spoil()
            self._publish_due()
            if not isinstance(measured, LidarScan):
                self._answer(measured)
            end = end_of_run(end, simulation.time, time_limit, has_ended=self._has_ended)
        self._node.destroy_node()
        self._executor.shutdown()
        return end

    @property
    def _has_ended(self) -> bool:
        """Whether the newest report is of an ending, after all that is done to the inputs."""
        is_over = not self._is_active and self.simulation.time > self._last_change
        return is_over and bool(self.reports) and self.reports[-1].state in ENDINGS

    @property
    def _last_change(self) -> float:
        """After which time nothing is done to the inputs any more [s]."""
        fault = self._fault
        return max(GOAL_TIME, fault.end if fault.is_temporary else fault.start) + 1.0

    @property
    def _is_active(self) -> bool:
        return (self._fault.start <= self.simulation.time < self._fault.end
                and self._fault.is_temporary)

    def _is_spoilt(self, kind: Input) -> bool:
        fault = self._fault
        return fault.input is kind and fault.start <= self.simulation.time < fault.end

    def _answer(self, measured: Odometry | ObjectPose) -> None:
        """Publish a measurement, and hand the command that answers it to the robot."""
        measured = measured._replace(time=self._stamp(measured.time))
        if isinstance(measured, Odometry):
            topic, message = 'odom', to_odometry_message(measured, FRAME, 'base_link')
        else:
            topic, message = 'object_pose', to_object_pose_message(measured, FRAME)
        self._publishers[topic].publish(message)
        stamp, commands = nanoseconds(message.header.stamp), []

        def is_answered() -> bool:
            command = take_message(self._inputs['cmd_vel'])
            if command is not None and nanoseconds(command.header.stamp) == stamp:
                commands.append(from_twist_message(command.twist))
            return bool(commands)
        self._wait(is_answered, WITHHELD_TIME if self._withheld else ANSWER_TIME)
        # What can wait: goals, maps and plans.
        self._executor.spin_once(timeout_sec=0.0)
        twist = commands[0] if commands else STOP
        self.sent.append(SentCommand(self.simulation.time, twist))
        self.simulation.command(twist)

    def _stamp(self, true: float) -> float:
        """Stamp a measurement by the clock, as it is."""
        fault, now = self._fault, self.simulation.time
        if not self._is_spoilt(Input.CLOCK):
            self._frozen_stamp = true
            return EPOCH + true
        word, since = fault.word, true - fault.start
        stopped = word is Word.STUCK or word is Word.INTERMITTENT and now % PERIOD < GAP
        if word is Word.OFF:
            return true
        if stopped:
            return EPOCH + self._frozen_stamp
        return EPOCH + {Word.GARBAGE: true + float(self._rng.uniform(-1e3, 1e3)),
                        Word.WRONG: true - CLOCK_OFFSET,
                        Word.SLOW: fault.start + 0.1 * since,
                        Word.DELAYED: true - DELAYS[Word.DELAYED]}.get(word, true)

    def _wait(self, condition: Callable[[], bool], limit: float = ANSWER_TIME) -> None:
        """Let the node run until a condition holds, and answer its requests meanwhile."""
        end = time.monotonic() + limit
        while not condition():
            if time.monotonic() > end:
                if limit >= ANSWER_TIME:
                    raise TimeoutError('the controller does not answer')
                return
            self._controller.poll()
            self._executor.spin_once(timeout_sec=0.0)
            self._look()
            if self._withheld:
                limit = min(limit, WITHHELD_TIME)
                end = min(end, time.monotonic() + WITHHELD_TIME)

    def _look(self) -> None:
        """Take requests and reports."""
        message = take_message(self._inputs['diagnostics'])
        while message is not None:
            for status in message.status:
                values = status_values(status)
                report = Report(status.message, status.level == ERROR, values.get('state', ''),
                                (*values.get('codes', '').split(), *notices(status.message)))
                if report != (self.reports[-1] if self.reports else None):
                    self.reports.append(report)
            message = take_message(self._inputs['diagnostics'])
        request = take_message(self._inputs['push_request'])
        if request is not None:
            self._plan(request)

    def _plan(self, message: Any) -> None:
        """Plan, and publish the plan after the planning time, or spoil it."""
        stamp, now = message.header.stamp, self.simulation.time
        try:
            plan = self._planner.plan(self._planner.read(message))
        except PlanningFailed as failure:
            self._publishers['push_plan'].publish(no_plan_message(failure.code, stamp, FRAME))
            return
        trajectory = plan.trajectory
        answer = to_plan_message(trajectory, stamp, FRAME)
        if not self._is_spoilt(Input.PLAN):
            self._withheld = False
            self.plans.append(trajectory)
            self._publishers['push_plan'].publish(answer)
            return
        spoilt = self._spoilt_plan(trajectory, stamp)
        delay = DELAYS.get(self._fault.word, 0.0)
        if self._fault.word in DELAYS:
            self.plans.append(trajectory)
            spoilt = answer
        if delay or spoilt is None:
            self._withheld = True
        if spoilt is not None:
            self._due.append((now + delay, 'push_plan', spoilt))
        if not delay:
            self._publish_due()

    def _spoilt_plan(self, trajectory: PushTrajectory, stamp: Any) -> Any:
        """Return the message that comes in place of a plan; None where none does."""
        word = self._fault.word
        if word is Word.OFF or word is Word.INTERMITTENT:
            return None
        if word is Word.STUCK and self.plans:
            return to_plan_message(self.plans[0], stamp, FRAME)
        if word is Word.WRONG:
            return to_plan_message(_moved(trajectory, OFFSET), stamp, FRAME)
        message = to_plan_message(trajectory, stamp, FRAME)
        if word is Word.GARBAGE:
            column = list(message.joint_names).index('object.x')
            for point in message.points:
                point.positions[column] = float(self._rng.uniform(-1e9, 1e9))
                point.velocities[column] = math.nan
        return message

    def _publish_due(self) -> None:
        now, remaining = self.simulation.time, []
        for at, topic, message in self._due:
            if at > now:
                remaining.append((at, topic, message))
                continue
            if topic == 'push_plan':
                self._withheld = False
            if not (self._fault.word is Word.OFF and self._is_spoilt(
                    {'goal_pose': Input.GOAL, 'map': Input.MAP}.get(topic, Input.PLAN))):
                self._publishers[topic].publish(message)
        self._due = remaining

    def _spoil(self) -> None:
        """Let the source of goals or maps do what the fault is."""
        fault, now = self._fault, self.simulation.time
        is_of_source = fault.input in (Input.GOAL, Input.MAP)
        if not is_of_source or now < max(fault.start, self._spoils_at):
            return
        topic, make = (('goal_pose', self._spoilt_goal) if fault.input is Input.GOAL
                       else ('map', self._spoilt_map))
        if now >= fault.end:
            self._spoils_at = math.inf
            right = (self._goal(self._scenario.goal.pose) if topic == 'goal_pose'
                     else self._map())
            self._due.append((now, topic, right))
            return
        self._spoils_at = now + (REPETITION_PERIOD if fault.word in (Word.STUCK, Word.GARBAGE)
                                 else ALTERNATION_PERIOD)
        message = make(fault.word, round(now / ALTERNATION_PERIOD))
        if message is not None:
            self._due.append((now, topic, message))

    def _goal(self, pose: Pose) -> PoseStamped:
        message = PoseStamped(pose=to_pose_message(pose))
        message.header.frame_id, message.header.stamp = FRAME, to_stamp(EPOCH)
        return message

    def _spoilt_goal(self, word: Word, index: int) -> PoseStamped | None:
        goal = self._scenario.goal.pose
        message = self._goal(goal)
        if word is Word.GARBAGE:
            message.pose.position.x = float(self._rng.choice([math.nan, math.inf, 1e300, 0.0]))
            message.header.frame_id = str(self._rng.choice(['', 'elsewhere', 'x' * 10000]))
        elif word is Word.WRONG:
            message.pose.position.x = FAR
        elif word is Word.DELAYED:
            message.header.stamp = to_stamp(EPOCH - 100.0)
        elif word is Word.SLOW and index % 2:
            return self._goal(goal @ OFFSET)
        elif word is Word.OFF or word is Word.INTERMITTENT and index % 2:
            return None
        return message

    def _map(self, is_occupied: bool = False) -> Any:
        cells = np.full((round(MAP_SIZE / RESOLUTION),) * 2, is_occupied)
        corner = Pose(-0.5 * MAP_SIZE, -0.5 * MAP_SIZE, 0.0)
        return to_map_message(OccupancyMap(RESOLUTION, corner, cells), to_stamp(EPOCH), FRAME)

    def _spoilt_map(self, word: Word, index: int) -> Any:
        message = self._map(is_occupied=word is Word.WRONG)
        if word is Word.GARBAGE:
            message.info.resolution = float(self._rng.choice([0.0, -1.0, math.nan]))
        elif word is Word.DELAYED:
            message.header.stamp = to_stamp(EPOCH - 100.0)
        elif word is Word.OFF or word is Word.INTERMITTENT and index % 2:
            return None
        return message


def end_of_run(end: float, now: float, time_limit: float, *, has_ended: bool) -> float:
    """
    Find when a run ends: what has ended, and then begins again or waits, has not ended.

    :param end: as it seemed until now [s].
    :param now: simulated time [s].
    :param time_limit: of the run [s].
    :param has_ended: whether it has ended for now.
    :return: since when it has ended without a break [s]; else its limit.
    """
    return min(end, now) if has_ended else time_limit


def _moved(trajectory: PushTrajectory, offset: Pose) -> PushTrajectory:
    """Return a plan for an object that stands elsewhere."""
    def moved(poses: Any) -> Any:
        return np.array([offset @ Pose(*pose) for pose in poses.tolist()])
    return dataclasses.replace(
        trajectory, object_poses=moved(trajectory.object_poses),
        contact_poses=moved(trajectory.contact_poses), robot_poses=moved(trajectory.robot_poses))


def final_report(reports: list[Report]) -> Report:
    """
    Find why a run is as it is.

    :param reports: of the run.
    :return: ``Report`` of the reason behind the state, or the last error; what it says of the
        state is left out.
    """
    tasks = [report for report in reports if report.state]
    others = [report for report in reports if not report.state]
    reasons = [report._replace(text=report.text.partition(', ')[2]) for report in tasks]
    errors = [report for report in others if report.is_error]
    candidates = [*reasons[-1:], *errors[-1:], *others[-1:], *reasons[::-1]]
    return next((report for report in candidates if report.text), NO_GOAL)


def _ignore(_: Any) -> None:
    """Leave a message to ``take_message``."""
