"""A bumper: what is put in the way of a robot whose object poses are late is hardly moved."""

import dataclasses
import math

from push_control.behaviors.failures import BehaviorFailure
from push_control.task.status import TaskState
from push_control.task.supervisor import Supervisor
from push_model.geometry import distance, Pose
from push_scenario.definition.expected_poses import with_sensors
from push_scenario.definition.loader import load_scenario
from push_scenario.definition.scenario import Scenario
from push_scenario.simulation.loop import simulate
from push_sim_node.simulation import Simulation

# Gap in front of the robot at which the object is put [m], and force on the switch [N].
GAP, FORCE = 0.06, 2.0


def late_task() -> Scenario:
    """Return a task whose poses come a second late, at its start."""
    scenario = load_scenario('task_flat')
    late = dataclasses.replace(scenario.sensors, pose_rate=10.0, pose_latency=1.0,
                               bumper_force=FORCE)
    return dataclasses.replace(with_sensors(scenario, late), time_limit=5.0)


class _Obstruction:
    """Puts the object in front of a robot that drives to its push, and sees how far it goes."""

    def __init__(self) -> None:
        self.moved = 0.0
        self.pose: Pose | None = None
        self.speed = 0.0

    def __call__(self, simulation: Simulation, supervisor: Supervisor) -> None:
        """Put it there once, and watch it until the robot has planned anew."""
        plant = simulation.plant
        robot, twist = plant.robot_pose, plant.robot_twist
        speed = math.hypot(twist.v_x, twist.v_y)
        if self.pose is None and supervisor.state is TaskState.APPROACH and speed > 0.2:
            direction = robot.theta + math.atan2(twist.v_y, twist.v_x)
            ahead = simulation.robot.radius + GAP + 0.5 * simulation.obj.size
            self.pose = Pose(robot.x, robot.y, direction) @ Pose(ahead, 0.0, 0.0)
            plant.set_object_pose(self.pose)
        if self.pose is None:
            return
        if supervisor.state in (TaskState.APPROACH, TaskState.PLAN) and supervisor.recoveries < 2:
            self.moved = max(self.moved, distance(plant.object_pose, self.pose))
            self.speed = max(self.speed, speed)


def test_a_robot_that_touches_something_on_its_way_brakes_at_once() -> None:
    """Poses would tell it a second later, and 0.3 m further on."""
    obstruction, scenario = _Obstruction(), late_task()
    result = simulate(scenario, intervene=obstruction)
    braking_distance = obstruction.speed ** 2 / (2.0 * scenario.robot.max_acceleration)
    assert 0.0 < obstruction.moved < braking_distance + 0.02
    assert result.status is not None
    assert [change.codes for change in result.status.history].count(
        (BehaviorFailure.BUMPED,)) == 1
