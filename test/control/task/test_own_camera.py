"""Tasks of a robot with one camera of its own, and of robots in maps that jump."""

import dataclasses
import math

from helpers.objects import box
from push_control.events import TaskEvent
from push_control.supervision_settings import SupervisionSettings
from push_control.task.status import TaskState
from push_model.parameters import RoundRobot
from push_scenario.definition.expected_poses import with_sensors
from push_scenario.definition.scenario import Placement, Scenario, Start
from push_scenario.definition.task import Task
from push_scenario.simulation.loop import simulate
from push_scenario.simulation.result import Outcome
from push_sim_node.camera import Camera, CameraSettings
from push_sim_node.sensors import SensorSettings
from push_sim_node.simulation import SimulationSettings
import pytest

# Simulated tasks take some seconds each.
pytestmark = pytest.mark.slow

TOLERANCE, HEADING_TOLERANCE = 0.02, math.radians(2.0)
OWN_CAMERA = {
    'pose_rate': 10.0, 'pose_latency': 0.15, 'pose_noise': 2e-3,
    'pose_heading_noise': math.radians(0.5), 'camera': CameraSettings(
        place='robot', reference='robot', mount_x=0.1, half_angle=math.radians(34.5),
        nearest=0.25, is_blind_in_contact=True, noise_per_distance=0.005,
        heading_noise_per_distance=math.radians(1.0))}
ROOM_CAMERA = {'pose_noise': 2e-3, 'pose_heading_noise': 5e-3, 'pose_latency': 0.08,
               'camera': CameraSettings(place='room', mount_y=-5.0)}
LOCALIZED = {'odometry_reference': 'absolute', 'odometry_position_noise': 1e-3,
             'odometry_heading_noise': 2e-3}
DRIFTING = {'odometry_scale_noise': 0.02, 'odometry_heading_drift_noise': 0.02}
JUMPS = {'odometry_jump': 0.07, 'odometry_heading_jump': math.radians(2.0),
         'odometry_jump_period': 6.0}
GROUPS = {'localized': LOCALIZED, 'drifting': DRIFTING, 'jumps': JUMPS}


class LastLooks:
    """Notes for how long the object has not been in view as each push begins [s]: ``ages``."""

    def __init__(self):
        """Start before the first measurement."""
        self.ages = []
        self._seen_at, self._state = -math.inf, None

    def __call__(self, simulation, supervisor):
        """Look, before a measurement."""
        truth = simulation.truth
        camera = Camera(simulation.sensors.camera, simulation.obj, simulation.robot.radius)
        if camera.sees(truth.object_pose, truth.robot_pose):
            self._seen_at = simulation.time
        if supervisor.state is not self._state and supervisor.state is TaskState.PUSH:
            self.ages.append(simulation.time - self._seen_at)
        self._state = supervisor.state


def pushed(drive, is_own, *more, intervene=None):
    """Simulate a task with a camera on the robot or in the room."""
    robot = RoundRobot(radius=0.17, drive=drive, max_speed=0.3, max_yaw_rate=1.9,
                       max_acceleration=0.9)
    true = box(mass=2.4, friction=(0.2, 0.35, 0.3, 0.25), contact_friction_coefficient=0.4)
    supervision = SupervisionSettings(position_tolerance=TOLERANCE,
                                      heading_tolerance=HEADING_TOLERANCE)
    task = Scenario(
        name='look', description='a task', object=box(mass=3.0), true_object=true, robot=robot,
        true_robot=robot, start=Start(robot=Placement(1.2, 0.4, math.pi)),
        goal=Placement(0.5, 0.3, 0.5), simulation=SimulationSettings(seed=2),
        task=Task(supervision=supervision), time_limit=200.0)
    fields = {**(OWN_CAMERA if is_own else ROOM_CAMERA), **{
        name: value for group in more for name, value in GROUPS[group].items()}}
    return simulate(with_sensors(task, dataclasses.replace(SensorSettings(), **fields)),
                    intervene=intervene)


def test_a_robot_whose_place_is_measured_is_done_within_its_tolerances():
    """With poses that are relative to it; nothing remains to be stated."""
    result = pushed('differential', True, 'localized')
    assert result.outcome is Outcome.DONE, result.reason
    assert abs(result.position_error) < TOLERANCE and abs(result.heading_error) < HEADING_TOLERANCE
    assert result.status.goal_deviation is None
    assert not result.status.codes


@pytest.mark.parametrize('drive', ['differential', 'holonomic'])
def test_done_by_odometry_alone_states_a_deviation_that_is_true(drive):
    """Poses relative to the robot tell no drift of the goal; it looks until just before a push."""
    looks = LastLooks()
    result = pushed(drive, True, 'drifting', intervene=looks)
    assert looks.ages and max(looks.ages) < 1.5
    assert result.outcome is Outcome.DONE, result.reason
    assert TaskEvent.DONE_BY_ODOMETRY in result.status.codes
    stated = result.status.goal_deviation
    assert stated is not None and stated.position > 0.0 and stated.heading > 0.0
    assert abs(result.position_error) < TOLERANCE + 2.0 * stated.position
    assert abs(result.heading_error) < HEADING_TOLERANCE + 2.0 * stated.heading
    assert TaskState.LOOK in [change.state for change in result.history]


def test_a_map_that_jumps_does_not_keep_an_object_in_the_room_from_its_goal():
    """Contacts tell the place of the robot, and corrections of the map do not move it."""
    result = pushed('differential', False, 'localized', 'jumps')
    assert result.outcome is Outcome.DONE, result.reason
    assert abs(result.position_error) < TOLERANCE and abs(result.heading_error) < HEADING_TOLERANCE
