"""Walls in the plant: rails, corners, energy, momentum, symmetry, depth, and none far away."""

import math

from helpers.objects import bin_, box
from helpers.plant_course import UNEVEN
import numpy as np
from push_dynamics.walls import Wall, wall_rows
from push_model.geometry import Pose
from push_model.parameters import RoundRobot
from push_model.signals import Twist
from push_sim_node.plant import Plant
from push_sim_node.truth import ContactMode
import pytest

pytestmark = pytest.mark.physics
ROBOT = RoundRobot(0.17, 'holonomic')
FORWARD = Twist(0.2, 0.0, 0.0)
TOP, FRONT = Wall(-5.0, 0.2, 5.0, 0.2), Wall(1.0, 5.0, 1.0, -5.0)
TALL = {'contact_height': 0.1, 'center_of_mass_height': 0.15}
OBJECTS = {'box': box(**UNEVEN), 'bin': bin_(), 'tall box': box(**TALL)}


def truths_of(plant, commands, period=0.1):
    """Return the truth after each command."""
    result = []
    for command in commands:
        plant.advance(period, command)
        result.append(plant.truth(0.0))
    return result


def random_course(obj, rng, frame=Pose(0.0, 0.0, 0.0), mirrored=1.0, step=2e-3):
    """Push an object about in a narrow room; return the truths."""
    def wall(x_0, y_0, x_1, y_1):
        return Wall(*frame.transform((x_0, mirrored * y_0)),
                    *frame.transform((x_1, mirrored * y_1)))

    walls = [wall(-0.7, 0.22, 0.6, 0.22), wall(0.55, 1.0, 0.55, -1.0),
             wall(-0.7, -0.35, 0.1, -0.35), wall(0.1, -0.35, 0.1, -1.0)]
    start = Pose(0.0, 0.0, mirrored * rng.uniform(-0.02, 0.02))
    robot = Pose(-0.45, mirrored * rng.uniform(-0.1, 0.1), 0.0)
    commands = [Twist(*rng.normal((0.25, 0.0, 0.0), (0.1, 0.15, 0.3))) for _ in range(30)]
    plant = Plant(obj, ROBOT, frame @ start, frame @ robot, step, walls=walls)
    return truths_of(plant, [Twist(c.v_x, mirrored * c.v_y, mirrored * c.omega)
                             for c in commands])


@pytest.mark.parametrize('friction', [0.0, 0.3])
def test_a_box_flat_at_a_wall_goes_as_on_rails(friction):
    """The contact is off the middle: the wall takes the moment, and brakes by its friction."""
    plant = Plant(box(), ROBOT, Pose(0.0, 0.0, 0.0), Pose(-0.37, -0.05, 0.0),
                  walls=[TOP], wall_friction=friction)
    *_, last = truths_of(plant, [FORWARD] * 20)
    assert last.object_pose == pytest.approx((last.object_pose.x, 0.0, 0.0), abs=1e-9)
    assert last.object_pose.x > 0.25
    # Balance along and across the wall: the floor brakes against the motion alone.
    x, y = last.walls.force
    weight = sum(box().capacities)
    assert last.force_n + x == pytest.approx(weight, rel=1e-3)
    assert x == pytest.approx(friction * y, abs=1e-6)
    assert last.force_t + y == pytest.approx(0.0, abs=1e-3 * weight)
    assert y < -0.1


@pytest.mark.parametrize('name', OBJECTS)
def test_work_is_kinetic_energy_and_losses_that_never_shrink(name):
    rng, touched = np.random.default_rng(1), 0
    for _ in range(6):
        truths = random_course(OBJECTS[name], rng)
        energies = np.array([truth.energy for truth in truths])
        assert energies[:, 0] == pytest.approx(energies[:, 1:].sum(axis=1), abs=1e-10)
        assert energies[:, 1].min() >= 0.0
        assert np.diff(energies[:, 2:], axis=0).min() >= -1e-4 * energies[-1, 0]
        touched += sum(truth.walls.points > 0 for truth in truths)
        assert max(truth.walls.depth for truth in truths) < 1e-3
    assert touched > 20


@pytest.mark.parametrize('name', OBJECTS)
def test_nothing_is_beyond_a_wall(name):
    """The outline stays in front of the walls, computed without the kernel's touches."""
    obj, rng = OBJECTS[name], np.random.default_rng(2)
    angles = np.linspace(0.0, math.tau, 60)
    rim = np.array(obj.outline) if obj.outline else obj.radius * np.column_stack(
        (np.cos(angles), np.sin(angles)))
    for _ in range(6):
        for truth in random_course(obj, rng):
            points = np.array([truth.object_pose.transform(point) for point in rim])
            assert points[:, 0].max() < 0.55 + 1e-4
            inside = points[points[:, 0] < 0.6]
            assert inside[:, 1].max() < 0.22 + 1e-4
            assert truth.robot_pose.x < 0.55 - ROBOT.radius + 1e-4


@pytest.mark.parametrize('name', ['bin', 'tall box'])
def test_isotropy_and_mirror_symmetry(name):
    obj, frame, mirror = OBJECTS[name], Pose(0.3, -0.7, 2.1), np.array([1.0, -1.0, -1.0])
    if name == 'bin':
        obj = bin_(feet=4)
    one, two, three = (random_course(obj, np.random.default_rng(3), *options)
                       for options in ((), (frame,), (Pose(0.0, 0.0, 0.0), -1.0)))
    assert max(truth.walls.points for truth in one) > 0
    for a, b, c in zip(one, two, three):
        assert b.object_pose == pytest.approx(frame @ a.object_pose, abs=1e-6)
        assert c.object_pose == pytest.approx(mirror * a.object_pose, abs=1e-6)


def test_momentum_is_what_robot_floor_and_walls_give():
    obj, rng, touched = OBJECTS['box'], np.random.default_rng(4), 0
    plant = Plant(obj, ROBOT, Pose(0.0, 0.0, 0.05), Pose(-0.45, -0.08, 0.0), walls=[TOP, FRONT])

    def momentum():
        twist, pose = plant.object_twist, plant.object_pose
        x, y = Pose(0.0, 0.0, pose.theta).rotate(obj.center_of_mass)
        return obj.mass * np.array([twist.v_x - twist.omega * y, twist.v_y + twist.omega * x])

    for _ in range(1500):
        before = momentum()
        plant.advance(2e-3, Twist(0.25, float(rng.normal(0.0, 0.05)), 0.0))
        truth = plant.truth(0.0)
        c, s = math.cos(truth.normal), math.sin(truth.normal)
        robot = np.array([c * truth.force_n - s * truth.force_t,
                          s * truth.force_n + c * truth.force_t])
        total = robot + np.sum(truth.support_forces, axis=0) + truth.walls.force
        # Normals are those in the middle of the step.
        assert momentum() - before == pytest.approx(
            2e-3 * total, abs=2e-5 + 2e-3 * 1e-3 * np.hypot(*robot))
        touched += truth.walls.points > 0
    assert touched > 200


def test_a_box_in_a_corner_stops_and_holds_the_robot():
    plant = Plant(box(), ROBOT, Pose(0.6, 0.0, 0.0), Pose(0.22, -0.05, 0.0), walls=[TOP, FRONT])
    *_, last = truths_of(plant, [FORWARD] * 30)
    assert last.object_pose == pytest.approx((0.8, 0.0, 0.0), abs=1e-6)
    assert last.robot_pose.x == pytest.approx(0.8 - 0.2 - 0.17, abs=1e-6)
    assert last.walls.holds_robot and last.mode is ContactMode.STICK
    assert max(map(abs, last.object_twist)) < 1e-9
    assert last.walls.force[0] == pytest.approx(-last.force_n)
    # It goes back as if nothing had been.
    *_, back = truths_of(plant, [Twist(-0.2, 0.0, 0.0)] * 10)
    assert back.robot_pose.x < 0.35 and not back.walls.holds_robot


def test_depth_vanishes_with_the_step():
    """A vertex that swings along a wall is held on a line; its path is a circle."""
    depths = []
    for step in (8e-3, 4e-3, 2e-3):
        plant = Plant(box(), ROBOT, Pose(0.0, 0.0, 0.0), Pose(-0.45, -0.12, 0.0), step,
                      walls=[Wall(-5.0, 0.24, 5.0, 0.24)])
        truths = truths_of(plant, [Twist(0.5, 0.0, 0.0)] * 60, 0.02)
        assert any(truth.walls.points for truth in truths)
        tops = [max(truth.object_pose.transform(corner)[1] for corner in box().outline)
                for truth in truths]
        depths.append(max(tops) - 0.24)
    assert depths[-1] < 2e-5
    assert depths[0] < 1e-3


@pytest.mark.parametrize('angle', [0.2, 0.7, 1.4])
def test_a_robot_slides_along_a_wall_slower_by_its_friction(angle):
    """u_t - mu u_n, and 0 within the cone of friction."""
    robot = RoundRobot(0.17, 'holonomic', time_constant=0.0, max_acceleration=50.0)
    plant = Plant(box(), robot, Pose(-3.0, -3.0, 0.0), Pose(-0.5, 0.03, angle), walls=[TOP],
                  wall_friction=0.3)
    truths = truths_of(plant, [FORWARD] * 20)
    slid = truths[-1].robot_pose.x - truths[-11].robot_pose.x
    speed = max(0.0, 0.2 * (math.cos(angle) - 0.3 * math.sin(angle)))
    assert slid == pytest.approx(speed, abs=1e-6)
    assert truths[-1].robot_pose.y == pytest.approx(0.2 - ROBOT.radius, abs=1e-9)


@pytest.mark.parametrize('name', OBJECTS)
def test_walls_far_away_change_nothing(name):
    ends = []
    for walls in ((), [Wall(-5.0, 9.0, 5.0, 9.0)]):
        plant = Plant(OBJECTS[name], ROBOT, Pose(0.0, 0.0, 0.1), Pose(-0.5, 0.03, 0.0),
                      walls=walls)
        ends.append(truths_of(plant, [Twist(0.3, 0.02, 0.1)] * 20)[-1])
    assert ends[0] == ends[1]


def test_a_joint_of_walls_is_no_corner():
    """Nothing catches where a wall is drawn in two parts, or another one joins from behind."""
    whole = [TOP]
    parts = [Wall(-5.0, 0.2, 0.3, 0.2), Wall(0.3, 0.2, 5.0, 0.2), Wall(0.2, 0.2, 0.2, 3.0)]
    assert len(wall_rows(parts)) == len(parts) + 3
    ends = []
    for walls in (whole, parts):
        plant = Plant(bin_(), ROBOT, Pose(-0.1, -0.05, 0.0), Pose(-0.6, -0.2, 0.2), walls=walls)
        ends.append(truths_of(plant, [Twist(0.3, 0.0, 0.0)] * 20)[-1].object_pose)
    assert ends[0].x > 0.2
    assert ends[1] == pytest.approx(ends[0], abs=1e-6)


def test_corners_depend_on_the_walls_that_meet_there_only():
    """Rows of walls far from each other are those of each; joints along slanted walls, too."""
    near = [Wall(0.0, 0.0, 0.3, 0.4), Wall(0.3, 0.4, 0.6, 0.8), Wall(0.15, 0.2, 1.0, 0.2)]
    far = [Wall(9.0, 0.0, 9.3, 0.4), Wall(9.3, 0.4, 9.0, 0.4)]
    assert set(wall_rows(near + far)) == {*wall_rows(near), *wall_rows(far)}
    assert len(wall_rows(near)) == len(near) + 3
    assert len(wall_rows(far)) == len(far) + 3


def test_an_edge_rests_at_the_corner_of_a_wall():
    """In front of the middle it stops the box; beside it, the box turns out of its cone."""
    for offset in (0.0, 0.08):
        plant = Plant(box(), ROBOT, Pose(0.0, 0.0, 0.0), Pose(-0.4, 0.0, 0.0),
                      walls=[Wall(0.4, offset, 1.0, offset)], wall_friction=0.1)
        *_, last = truths_of(plant, [FORWARD] * 20)
        if offset == 0.0:
            assert last.object_pose == pytest.approx((0.2, 0.0, 0.0), abs=1e-6)
        else:
            assert last.object_pose.theta > 0.05


def test_a_wall_has_two_ends():
    with pytest.raises(ValueError, match='Wall.end_x'):
        Wall(1.0, 2.0, 1.0, 2.0)
