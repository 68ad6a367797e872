"""Several objects in one simulation: who moves, who stands, and what goes on."""

import math

from helpers.objects import bin_, box
import numpy as np
from push_dynamics.walls import Wall
from push_model.geometry import distance, Pose
from push_model.parameters import PushedObject, RoundRobot
from push_model.signals import Odometry, Twist
from push_planner.rearrangement.footprints import object_gap
from push_sim_node.bumped_object import PlacedObject
from push_sim_node.room_simulation import outline_walls, RoomSimulation
from push_sim_node.sensors import SensorSettings
from push_sim_node.settings import SimulationSettings
from push_sim_node.simulation import Simulation
import pytest

AHEAD = Pose(0.5, 0.02, 0.0)
OBJECTS = {'bin': PlacedObject(bin_(), Pose(0.0, 1.0, 2.5)), 'box': PlacedObject(box(), AHEAD)}
DRIFTING = SensorSettings(odometry_scale_noise=0.05, odometry_heading_drift_noise=0.05)
ROBOT, START = RoundRobot(0.17), Pose(0.0, 0.0, 0.0)


def room(objects: dict[str, PlacedObject] = OBJECTS) -> RoomSimulation:
    """Return a robot in front of the box; the bin is pushed at first."""
    return RoomSimulation(objects, ROBOT, START, sensors=DRIFTING)


def drive(simulation: Simulation, until: float, twist: Twist = Twist(0.2, 0.0, 0.0),
          turning: RoomSimulation | None = None) -> list[Odometry]:
    """Drive on, and return odometry."""
    odometry: list[Odometry] = []
    while simulation.time < until:
        simulation.command(twist)
        measured = simulation.next_measurement()
        if isinstance(measured, Odometry):
            odometry.append(measured)
        if turning is not None:
            turning.turn_to_nearest()
    return odometry


def test_the_robot_moves_what_it_bumps_into() -> None:
    """The box comes to be the one that is pushed, and goes where it would go alone."""
    several = room()
    assert several.pushed == 'bin'
    drive(several.simulation, 2.0, turning=several)
    alone = Simulation(box(), ROBOT, AHEAD, START, sensors=DRIFTING)
    drive(alone, 2.0)
    assert several.pushed == 'box' and several.poses['box'].x > AHEAD.x + 0.2
    assert several.poses['box'] == pytest.approx(alone.plant.object_pose, abs=1e-6)
    assert several.poses['bin'] == pytest.approx(OBJECTS['bin'].pose)


def test_odometry_goes_on_as_another_object_is_pushed() -> None:
    """Its drift is kept, as is time: nothing jumps."""
    several, turned = room(), room()
    drive(several.simulation, 0.5)
    drive(turned.simulation, 0.5)
    turned.turn_to('box')
    before, after = (drive(item.simulation, 0.7) for item in (several, turned))
    assert [item.time for item in after] == [item.time for item in before]
    assert np.array([item.pose for item in after]) == pytest.approx(
        np.array([item.pose for item in before]), abs=1e-9)
    assert distance(after[-1].pose, turned.robot_pose) > 1e-3


def test_what_a_pushed_object_bumps_into_gives_way() -> None:
    """It is pushed ahead, and touches all the time; what nothing touches stays."""
    several = room({'box': OBJECTS['box'], 'crate': PlacedObject(box(), Pose(1.2, 0.02, 0.0)),
                    'bin': OBJECTS['bin']})
    drive(several.simulation, 2.0)
    assert several.poses['crate'] == Pose(1.2, 0.02, 0.0)
    drive(several.simulation, 4.0)
    pushed, crate = several.poses['box'], several.poses['crate']
    assert crate.x > 1.4 and several.poses['bin'] == pytest.approx(OBJECTS['bin'].pose)
    assert object_gap(box(), crate, box(), pushed) == pytest.approx(0.0, abs=2e-3)


def test_what_the_robot_bumps_into_gives_way_while_another_is_pushed() -> None:
    """It ends where the robot's front is."""
    several = room()
    drive(several.simulation, 2.0)
    assert several.poses['box'].x == pytest.approx(several.robot_pose.x + 0.37, abs=1e-3)


@pytest.mark.parametrize('slope', [0.0, 0.3])
@pytest.mark.parametrize('obj', [box(), bin_()])
def test_a_wall_holds_what_the_robot_bumps_into(obj: PushedObject, slope: float) -> None:
    """It gets no farther than the wall; one at a slope it slides along. The bumper feels both."""
    walls = Wall(0.9 - 2.0 * slope, -2.0, 0.9 + 2.0 * slope, 2.0),
    several = RoomSimulation(
        {'bin': OBJECTS['bin'], 'other': PlacedObject(obj, Pose(0.5, 0.0, 0.0))}, ROBOT, START,
        SimulationSettings(walls=walls), SensorSettings(bumper_force=2.0))
    drive(several.simulation, 2.5)
    assert several.simulation.is_bumper_pressed
    assert several.pushed == 'bin'
    pose = several.poses['other']
    corners = obj.outline or [(obj.radius * math.cos(angle), obj.radius * math.sin(angle))
                              for angle in np.linspace(0.0, 2.0 * math.pi, 90)]
    gaps = [(0.9 + slope * y - x) / math.hypot(1.0, slope)
            for x, y in map(pose.transform, corners)]
    assert min(gaps) == pytest.approx(0.0, abs=1e-3)
    assert pose.y == pytest.approx(0.0, abs=1e-3) if slope == 0.0 else abs(pose.y) > 0.02


def test_a_bumper_feels_objects_that_stand() -> None:
    """While it moves them, and not before or after."""
    several = RoomSimulation(OBJECTS, ROBOT, START, sensors=SensorSettings(bumper_force=2.0))
    pressed: list[bool | None] = []
    for until, speed in ((0.4, 0.2), (1.5, 0.2), (1.8, -0.2)):
        drive(several.simulation, until, Twist(speed, 0.0, 0.0))
        pressed.append(several.simulation.is_bumper_pressed)
    assert several.pushed == 'bin' and pressed == [False, True, False]


def test_an_object_that_is_pushed_stays_so_until_the_robot_leaves_it() -> None:
    """The bin is nearer to the robot's middle at the end, but the robot touches the box."""
    several = room({'box': OBJECTS['box'], 'bin': PlacedObject(bin_(), Pose(0.7, 0.45, 0.0))})
    drive(several.simulation, 1.5, turning=several)
    assert several.pushed == 'box'
    drive(several.simulation, 3.5, Twist(-0.2, 0.0, 0.0), turning=several)
    several.simulation.next_measurement()
    drive(several.simulation, 4.0, Twist(0.0, 0.0, 0.0), turning=several)
    assert several.poses['bin'] == pytest.approx((0.7, 0.45, 0.0))


def test_all_objects_are_measured() -> None:
    """Those that stand with the noise of the sensors, the pushed one not among them."""
    several = RoomSimulation(OBJECTS, ROBOT, START, sensors=SensorSettings(pose_noise=2e-3))
    errors = [distance(several.measure_standing(0.0)['box'].pose, AHEAD) for _ in range(200)]
    assert set(several.measure_standing(0.0)) == {'box'}
    # Mean of a Rayleigh distribution.
    assert sum(errors) / 200 == pytest.approx(2e-3 * math.sqrt(math.pi / 2.0), rel=0.1)


@pytest.mark.parametrize('item', OBJECTS.values())
def test_walls_are_on_the_outline(item: PlacedObject) -> None:
    """They close a ring whose points are at the distance of the outline."""
    walls = outline_walls(item)
    assert all((wall.end_x, wall.end_y) == pytest.approx((following.start_x, following.start_y))
               for wall, following in zip(walls, walls[1:] + walls[:1]))
    radius = item.obj.radius or 0.2 * math.sqrt(2.0)
    assert all(distance((wall.start_x, wall.start_y), item.pose) == pytest.approx(radius)
               for wall in walls)
