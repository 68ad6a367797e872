"""Environment of Gymnasium: command a robot's velocity, and bring an object to its goal."""

import dataclasses
import math
from typing import Any

import gymnasium
from gymnasium import spaces
import numpy as np
from numpy.typing import NDArray
from push_model.geometry import distance, Pose, wrap_angle
from push_model.observation import Observation
from push_model.parameters import PushedObject, RoundRobot
from push_model.signals import ObjectPose, Odometry, Twist
from push_scenario.definition.loader import load_scenario
from push_scenario.definition.placement import Placement
from push_scenario.definition.scenario import Scenario, Start
from push_scenario.simulation.loop import first_observation, is_at_rest, make_simulation
from push_sim_node.sensors import SensorSettings

Vector = NDArray[np.float32]
# Reward of an object at rest within the bounds of the scenario, beside that of metres gained;
# chosen: about that of the whole way, so that the end counts as much.
SUCCESS_REWARD = 1.0
# Where goals and robots are drawn: distances from the object [m], rotations [rad]; chosen: what
# one push does, up to what takes some; the robot may have to drive round the object.
GOAL_DISTANCES = 0.2, 1.0
GOAL_ROTATION = math.pi / 2.0
ROBOT_GAPS = 0.1, 0.6
# Positions and velocities are not bounded [m, m/s, rad/s]; sines and cosines are.
UNBOUNDED = float(np.inf)
OBSERVATION_BOUND = np.array([UNBOUNDED, UNBOUNDED, 1.0, 1.0] * 2 + [UNBOUNDED] * 3, np.float32)


class PushTask(gymnasium.Env[Vector, Vector]):
    """
    An object at rest, its goal, and a robot whose velocity is commanded.

    **Action**: velocity of the robot in its own axes, (v_x, omega) of a differential drive, (v_x,
    v_y, omega) of a holonomic base [m/s, rad/s]; it is held for ``period``, and clipped to what
    the robot can.

    **Observation**, shape (11,): the goal of the object in the object frame (x, y, cos, sin), the
    robot in the object frame (x, y, cos, sin) and the velocity of the robot in its own axes (v_x,
    v_y, omega) [m, m/s, rad/s].

    **Reward**: metres by which the support that is farthest from its place at the goal has come
    nearer, and ``SUCCESS_REWARD`` at the end. The rewards of an episode sum up to what was gained.

    **End**: terminated where the object rests within the bounds of the scenario; truncated after
    its time limit.

    ``info`` has ``observation``, the ``push_model.Observation`` as sensors deliver it, and
    ``is_success``.

    :param scenario: with a task on open floor: a ``Scenario``, its name or path.
    :param period: between two actions, rounded up to that of the odometry [s].
    :param is_random: whether goal and robot are drawn at each reset, else as in the scenario.
    :param is_noisy: whether observations are measured by the sensors of the scenario, with noise,
        latency and drift; else they are the truth.
    :param render_mode: ``rgb_array``, or None.
    :raises ValueError: where the scenario has no task.
    """

    metadata = {'render_modes': ['rgb_array'], 'render_fps': 10}

    def __init__(self, scenario: Scenario | str = 'task_approach', *, period: float = 0.1,
                 is_random: bool = True, is_noisy: bool = False,
                 render_mode: str | None = None) -> None:
        if isinstance(scenario, str):
            scenario = load_scenario(scenario)
        if scenario.task is None:
            raise ValueError(f'scenario: got {scenario.name}, a single push, expected a task')
        if render_mode not in (None, 'rgb_array'):
            raise ValueError(f'render_mode: got {render_mode!r}, expected rgb_array or None')
        if not 0.0 < period < scenario.simulation.command_timeout:
            raise ValueError(f'period: got {period!r}, expected above 0 and below command_timeout,'
                             f' {scenario.simulation.command_timeout:g} [s]')
        if not is_noisy:
            scenario = dataclasses.replace(scenario, sensors=SensorSettings(
                pose_rate=scenario.sensors.odometry_rate,
                odometry_rate=scenario.sensors.odometry_rate))
        self.render_mode = render_mode
        self.observation_space = spaces.Box(-OBSERVATION_BOUND, OBSERVATION_BOUND,
                                            dtype=np.float32)
        self._highest = _highest_velocity(scenario.true_robot)
        self.action_space = spaces.Box(-self._highest, self._highest, dtype=np.float32)
        self._origin = scenario
        self._period = period
        self._is_random = is_random
        self._is_noisy = is_noisy
        self._start(scenario)

    @property
    def scenario(self) -> Scenario:
        """The ``Scenario`` of this episode, with what was drawn for it."""
        return self._scenario

    @property
    def goal_distance(self) -> float:
        """Distance of the support that is farthest from its place at the goal [m]."""
        return support_distance(self._scenario.true_object, self._simulation.plant.object_pose,
                                self._scenario.final_goal)

    def reset(self, *, seed: int | None = None,
              options: dict[str, Any] | None = None) -> tuple[Vector, dict[str, Any]]:
        """
        Start an episode.

        :param seed: of what is drawn in this and the next episodes; None to go on drawing.
        :param options: ``object``, ``robot`` and ``goal``: poses (x, y, theta) in place of those
            that are drawn [m, rad].
        :return: observation and info.
        :raises ValueError: where the robot overlaps the object.
        """
        super().reset(seed=seed)
        scenario = self._origin
        if self._is_random:
            scenario = self._drawn(scenario)
        self._start(_with_poses(scenario, options or {}))
        return self._observed(), self._info()

    def step(self, action: Vector) -> tuple[Vector, float, bool, bool, dict[str, Any]]:
        """
        Hold a velocity for a period.

        :param action: as of the class.
        :return: observation, reward, terminated, truncated, info.
        :raises ValueError: where it is not finite, or of another shape.
        """
        self._simulation.command(self._twist(action))
        before, end = self.goal_distance, self._simulation.time + self._period
        while True:
            measurement = self._simulation.next_measurement()
            now, known = self._simulation.time, self._measured
            if isinstance(measurement, ObjectPose):
                self._measured = Observation(now, known.odometry, measurement)
            if not isinstance(measurement, Odometry):
                continue
            self._measured = Observation(now, measurement, known.object_pose)
            # Half a nanosecond: times are whole ones.
            if now > end - 5e-10:
                break
        is_success = self._is_success()
        reward = before - self.goal_distance + SUCCESS_REWARD * is_success
        is_over = self._simulation.time >= self._scenario.time_limit
        return (self._observed(), float(reward), is_success, is_over and not is_success,
                self._info())

    def render(self) -> Any:
        """
        Draw object, goal and robot from above.

        :return: RGB array, shape (400, 400, 3), uint8; None without render mode.
        """
        if self.render_mode is None:
            return None
        # Imported here: a policy that is trained draws nothing.
        from push_scenario.gym.picture import draw
        plant = self._simulation.plant
        return draw(self._scenario, plant.object_pose, plant.robot_pose)

    def _start(self, scenario: Scenario) -> None:
        self._scenario = scenario
        self._simulation = make_simulation(scenario)
        self._measured = first_observation(self._simulation)

    def _drawn(self, scenario: Scenario) -> Scenario:
        """Draw goal, robot and the seed of the sensors about the object of the scenario."""
        random, here = self.np_random, scenario.start.object.pose
        bearing, robot_bearing, heading = random.uniform(-math.pi, math.pi, 3)
        away = random.uniform(*GOAL_DISTANCES)
        goal = Pose(here.x + away * math.cos(bearing), here.y + away * math.sin(bearing),
                    here.theta + random.uniform(-GOAL_ROTATION, GOAL_ROTATION))
        # The size is at least twice the distance of any point of the outline from its middle.
        clear = (scenario.true_object.size + scenario.robot.radius + random.uniform(*ROBOT_GAPS))
        robot = Pose(here.x + clear * math.cos(robot_bearing),
                     here.y + clear * math.sin(robot_bearing), heading)
        return _with_poses(scenario, {'goal': goal, 'robot': robot}).with_seed(
            int(random.integers(2 ** 31)))

    def _twist(self, action: Vector) -> Twist:
        highest = self._highest
        values = np.asarray(action, dtype=np.float64)
        if values.shape != highest.shape or not np.isfinite(values).all():
            raise ValueError(f'action: got {action!r}, expected {len(highest)} finite numbers')
        clipped = np.clip(values, -highest, highest).tolist()
        if len(clipped) == 2:
            return Twist(clipped[0], 0.0, clipped[1])
        return Twist(*clipped)

    def _is_success(self) -> bool:
        scenario, pose = self._scenario, self._simulation.plant.object_pose
        goal, bounds = scenario.final_goal, scenario.final_bounds
        return (distance(pose, goal) <= bounds.position_error
                and abs(wrap_angle(pose.theta - goal.theta)) <= bounds.heading_error
                and is_at_rest(self._simulation.truth))

    def _observed(self) -> Vector:
        """Observe goal and robot from the object, as measured or as they are."""
        truth, measured = self._simulation.truth, self._measured
        object_pose, robot_pose, twist = truth.object_pose, truth.robot_pose, truth.robot_twist
        if self._is_noisy and measured.object_pose is not None:
            object_pose = measured.object_pose.pose
            robot_pose, twist = measured.odometry.pose, measured.odometry.twist
        goal = object_pose.inverse() @ self._scenario.final_goal
        robot = object_pose.inverse() @ robot_pose
        return np.array([goal.x, goal.y, math.cos(goal.theta), math.sin(goal.theta),
                         robot.x, robot.y, math.cos(robot.theta), math.sin(robot.theta),
                         *twist], np.float32)

    def _info(self) -> dict[str, Any]:
        return {'observation': self._measured, 'is_success': self._is_success()}


def support_distance(obj: PushedObject, pose: Pose, goal: Pose) -> float:
    """
    Compute the distance of the support that is farthest from its place at the goal [m].

    :param obj: the ``PushedObject``.
    :param pose: of the object.
    :param goal: goal ``Pose``.
    """
    return max(math.dist(pose.transform((support.x, support.y)),
                         goal.transform((support.x, support.y))) for support in obj.supports)


def _highest_velocity(robot: RoundRobot) -> Vector:
    """Return the highest velocity that a robot can be commanded, by its drive."""
    count = 1 if robot.drive == 'differential' else 2
    return np.array([robot.max_speed] * count + [robot.max_yaw_rate], np.float32)


def _with_poses(scenario: Scenario, poses: dict[str, Any]) -> Scenario:
    """Place object, robot and goal, each where it is named."""
    unknown = sorted(set(poses) - {'object', 'robot', 'goal'})
    if unknown:
        raise ValueError(f'options: got {", ".join(unknown)}, expected object, robot and goal')
    places = {name: Placement(*map(float, pose)) for name, pose in poses.items()}
    start = scenario.start
    start = Start(places.get('object', start.object), places.get('robot', Placement(
        *scenario.robot_start)))
    return dataclasses.replace(scenario, start=start, goal=places.get('goal', scenario.goal))
