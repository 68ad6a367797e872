"""Bases that are not ideal: what comes of commands, in both plants."""

import dataclasses
import math

from helpers.extras import import_extra
from helpers.objects import box
import numpy as np
from push_model.geometry import Pose
from push_model.parameters import RoundRobot
from push_model.signals import STOP, Twist
from push_sim_node.drive_imperfections import DriveImperfections, SpeedFactor
from push_sim_node.imperfect_drive import ImperfectDrive
from push_sim_node.plant import Plant
from push_sim_node.settings import SimulationSettings
from push_sim_node.simulation import Simulation
import pytest

PERIOD = 0.02
FAR = Pose(3.0, 0.0, 0.0)
DRIVES = 'differential', 'holonomic'
# A drive without lag, to which commands are steps.
PROMPT = {'time_constant': 0.0, 'max_acceleration': 100.0, 'max_yaw_acceleration': 1000.0}


def plants():
    """List both plants."""
    return pytest.mark.parametrize('make', [
        Plant, pytest.param('spatial', id='SpatialPlant')])


def make_plant(make, robot, faults=DriveImperfections(), **options):
    """Return a plant whose robot is far from the object, unless told otherwise."""
    if make == 'spatial':
        make = import_extra('mujoco', 'mujoco', 'benchmarks.tasks.spatial_plant').SpatialPlant
    obj = options.get('obj') or box()
    return make(obj, robot, options.get('object_pose', FAR), Pose(0.0, 0.0, 0.0),
                imperfections=faults)


def driven(plant, command, seconds=1.0):
    """Return the twists of the robot, one each period, shape (n, 3)."""
    twists = []
    for k in range(round(seconds / PERIOD)):
        plant.advance(PERIOD, command(k * PERIOD) if callable(command) else command)
        twists.append(plant.robot_twist)
    return np.array(twists)


def robot_of(drive, **fields):
    """Return a robot that may drive at 1 m/s and 4 rad/s."""
    return RoundRobot(0.17, drive=drive, max_speed=1.0, max_yaw_rate=4.0, **fields)


@pytest.mark.parametrize('drive', DRIVES)
def test_no_imperfection_is_the_same_run_to_the_bit(drive):
    """Values of 0 change nothing, and a base that is far from its limits follows as well."""
    def command(t):
        return Twist(0.2 * math.sin(t), 0.0, math.cos(3.0 * t))

    plain = driven(Plant(box(), robot_of(drive), FAR, Pose(0.0, 0.0, 0.0)), command)
    same = driven(make_plant(Plant, robot_of(drive), DriveImperfections()), command)
    assert same.tobytes() == plain.tobytes()
    strong = driven(make_plant(Plant, robot_of(drive, max_push_force=1e6)), command)
    assert np.abs(strong - plain).max() < 0.01


@plants()
@pytest.mark.parametrize('drive', DRIVES)
def test_a_command_above_the_band_is_followed_exactly_and_one_below_never_moves(make, drive):
    """On both sides of the least speed, ahead and back, in translation and rotation."""
    robot = robot_of(drive, min_speed=0.05, min_yaw_rate=0.3, track=0.2, **PROMPT)
    for sign in (1.0, -1.0):
        above = Twist(sign * 0.051, 0.0, 0.0), Twist(0.0, 0.0, sign * 0.51)
        for command in above:
            twists = driven(make_plant(make, robot), command)
            assert twists[-1] == pytest.approx(command, abs=1e-9)
        for command in (Twist(sign * 0.049, 0.0, 0.0), Twist(0.0, 0.0, sign * 0.29)):
            assert not driven(make_plant(make, robot), command).any()


def test_a_differential_drive_sticks_wheel_by_wheel():
    """A wheel that is asked for too little rests, and the robot turns about it."""
    robot = robot_of('differential', min_speed=0.05, track=0.2, **PROMPT)
    twists = driven(make_plant(Plant, robot), Twist(0.05, 0.0, 0.2))
    assert twists[-1] == pytest.approx((0.035, 0.0, 0.35), abs=1e-9)


@pytest.mark.parametrize('drive', DRIVES)
def test_a_mirrored_command_gives_the_mirrored_motion(drive):
    """All that treats both wheels alike keeps the symmetry of the base."""
    robot = robot_of(drive, dead_time=0.1, min_speed=0.04, min_yaw_rate=0.2, speed_step=0.01)
    faults = DriveImperfections(smoother_acceleration=0.3, smoother_yaw_acceleration=2.0,
                                start_ratio=1.3, sag=0.2, output_min_speed=0.02,
                                speed_factors=(SpeedFactor(0.2, 0.5, 0.5),))
    sides = [driven(make_plant(Plant, robot, faults), lambda t, side=side: Twist(
        0.1 + 0.1 * math.sin(5.0 * t), 0.0, side * math.cos(3.0 * t)), 2.0)
        for side in (1.0, -1.0)]
    assert sides[0] * (1.0, -1.0, -1.0) == pytest.approx(sides[1], abs=1e-12)
    assert np.ptp(sides[0], axis=0)[[0, 2]].min() > 0.05


@plants()
def test_the_dead_time_shifts_the_response(make):
    """The response is that of the same base without dead time, so much later."""
    late, robot = 0.2, robot_of('differential', min_speed=0.01)

    def command(t):
        return Twist(0.3 * math.sin(4.0 * t), 0.0, 1.0)

    prompt = driven(make_plant(make, robot), command, 2.0)
    delayed = driven(make_plant(make, dataclasses.replace(robot, dead_time=late)), command, 2.0)
    shift = round(late / PERIOD)
    assert not delayed[:shift].any()
    assert delayed[shift:] == pytest.approx(prompt[:-shift], abs=1e-6)


def test_a_least_speed_behind_the_lag_lets_a_short_pulse_go():
    """A pulse that ends before the drive has that speed moves nothing; a longer one does."""
    robot = robot_of('differential', max_acceleration=0.9)
    faults = DriveImperfections(output_min_speed=0.05)
    for seconds, moves in ((0.04, False), (0.2, True)):
        twists = driven(make_plant(Plant, robot, faults),
                        lambda t, end=seconds: Twist(0.08, 0.0, 0.0) if t < end else STOP)
        assert twists.any() == moves


def test_wheels_at_rest_need_more_to_start():
    """Between the two speeds a wheel that turns goes on, and one at rest stays so."""
    robot = robot_of('differential', min_speed=0.05, **PROMPT)
    faults = DriveImperfections(start_ratio=1.3)
    assert not driven(make_plant(Plant, robot, faults), Twist(0.06, 0.0, 0.0)).any()
    twists = driven(make_plant(Plant, robot, faults),
                    lambda t: Twist(0.07 if t < 0.1 else 0.06, 0.0, 0.0))
    assert twists[-1, 0] == pytest.approx(0.06)


@pytest.mark.parametrize('faults, fields, expected', [
    (DriveImperfections(speed_factors=(SpeedFactor(0.5, 2.0, 0.5),)), {}, (0.1, 0.0, 0.25)),
    (DriveImperfections(sag=0.2, sag_time=0.5), {}, (0.16, 0.0, 0.4)),
    (DriveImperfections(left_wheel_factor=0.9), {'track': 0.2}, (0.1925, 0.0, 0.575)),
    (DriveImperfections(), {'speed_step': 0.03, 'track': 0.2}, (0.195, 0.0, 0.45))])
def test_what_becomes_of_a_steady_command(faults, fields, expected):
    """Scaled, sagging, with an uneven wheel, rounded: computed by hand for wheels of a base."""
    robot = robot_of('differential', **fields, **PROMPT)
    assert driven(make_plant(Plant, robot, faults), Twist(0.2, 0.0, 0.5))[-1] == pytest.approx(
        expected, abs=1e-9)


def test_a_smoother_limits_the_acceleration():
    faults = DriveImperfections(smoother_acceleration=0.3)
    twists = driven(make_plant(Plant, robot_of('holonomic', **PROMPT), faults),
                    Twist(0.2, 0.2, 0.0), 0.5)
    rates = np.diff(np.hypot(*twists[:, :2].T)) / PERIOD
    assert rates == pytest.approx(np.full(len(rates), 0.3), rel=1e-6)


@plants()
def test_wheels_spin_where_the_object_needs_more_force(make):
    """Above the force the object hardly moves, and odometry counts wheels; below all move."""
    obj = box(mass=5.0)
    needed = 0.3 * 5.0 * 9.81
    distances = {}
    for ratio in (0.7, 1.5):
        plant = make_plant(make, robot_of('differential', max_push_force=ratio * needed), obj=obj,
                           object_pose=Pose(0.38, 0.0, 0.0))
        driven(plant, Twist(0.2, 0.0, 0.0), 2.0)
        distances[ratio] = plant.object_pose.x - 0.38, plant.odometry_pose.x
        assert plant.odometry_twist.v_x == pytest.approx(0.2, abs=1e-3)
    assert distances[0.7][1] == pytest.approx(distances[1.5][1])
    assert distances[0.7][0] < 0.1 * distances[0.7][1]
    assert distances[1.5][0] > 0.9 * distances[1.5][1]


@plants()
def test_wheels_stand_still_where_the_motors_are_too_weak(make):
    """Above the force robot and object stop, and odometry says so; below all move."""
    obj = box(mass=5.0)
    needed = 0.3 * 5.0 * 9.81
    for ratio, is_stalled in ((0.7, True), (1.5, False)):
        plant = make_plant(make, robot_of('differential'),
                           DriveImperfections(stall_force=ratio * needed), obj=obj,
                           object_pose=Pose(0.38, 0.0, 0.0))
        driven(plant, Twist(0.2, 0.0, 0.0), 2.0)
        assert plant.odometry_pose.x == pytest.approx(plant.robot_pose.x, abs=1e-3)
        assert (plant.odometry_pose.x < 0.1) == is_stalled
        assert (plant.odometry_twist.v_x < 0.02) == is_stalled


@plants()
def test_wheels_creep_by_the_force(make):
    """Robot and object lag behind the wheels by the stated part for each newton."""
    obj = box(mass=5.0)
    plant = make_plant(make, robot_of('differential'), DriveImperfections(wheel_creep=0.005),
                       obj=obj, object_pose=Pose(0.371, 0.0, 0.0))
    driven(plant, Twist(0.2, 0.0, 0.0), 2.0)
    expected = 0.2 * (1.0 - 0.005 * 0.3 * 5.0 * 9.81)
    assert np.mean(driven(plant, Twist(0.2, 0.0, 0.0), 0.2)[:, 0]) == pytest.approx(
        expected, rel=0.02)


def moved(base, command, seconds, moment=0.0):
    """Return the mean twist of a base alone over steps of 2 ms, times the seconds."""
    base.command(command)
    steps = round(seconds / 0.002)
    return 0.002 * np.sum([base.step(0.002, (0.0, 0.0), moment) for _ in range(steps)], axis=0)


def base_of(drive, **faults):
    """Return a prompt base alone, whose wheels are 0.2 m apart."""
    return ImperfectDrive(robot_of(drive, track=0.2, **PROMPT), DriveImperfections(**faults),
                          Pose(0.0, 0.0, 0.0), 1.0)


@pytest.mark.parametrize('drive', DRIVES)
def test_a_constant_moment_deflects_the_robot_as_a_spring(drive):
    """By moment over stiffness, at rest or driving; it comes back; odometry does not see it."""
    base, ideal = base_of(drive, yaw_stiffness=50.0), base_of(drive)
    for command in (STOP, Twist(0.2, 0.0, 0.3)):
        for moment, deflection in ((2.0, 0.04), (0.0, -0.04)):
            expected = moved(ideal, command, 1.0) + (0.0, 0.0, deflection)
            assert moved(base, command, 1.0, moment) == pytest.approx(expected, abs=1e-6)
    assert base.odometry_pose == ideal.odometry_pose


@plants()
@pytest.mark.parametrize('faults', [{'yaw_stiffness': math.inf}, {'play': 0.0}])
def test_infinite_stiffness_and_no_play_are_ideal_to_the_bit(make, faults):
    """Beside another imperfection, in a push whose contact has a moment; finite ones are not."""
    def pushed(**values):
        plant = make_plant(make, robot_of('differential', **PROMPT), DriveImperfections(
            wheel_creep=1e-3, **values), obj=box(mass=5.0), object_pose=Pose(0.38, 0.06, 0.3))
        return driven(plant, lambda t: Twist(0.2, 0.0, 2.5 * math.cos(9.0 * t)), 1.5)

    ideal = pushed()
    assert pushed(**faults).tobytes() == ideal.tobytes()
    assert np.abs(pushed(yaw_stiffness=1e6) - ideal).max() < 1e-2
    assert np.abs(pushed(yaw_stiffness=20.0) - ideal)[:, 2].max() > 1e-2
    assert np.abs(pushed(play=0.005) - ideal).max() > 1e-2


def test_the_robot_yaws_by_the_moment_that_the_contact_has():
    """Friction at the limit, as it slides along the object; the odometry does not see it."""
    obj, stiffness = box(mass=5.0), 30.0
    plant = make_plant(Plant, robot_of('holonomic', **PROMPT),
                       DriveImperfections(yaw_stiffness=stiffness), obj=obj,
                       object_pose=Pose(0.371, 0.0, 0.0))
    driven(plant, Twist(0.1, 0.0, 0.0), 0.5)
    driven(plant, Twist(0.1, 0.15, 0.0), 0.5)
    truth = plant.truth(0.0)
    expected = -0.17 * obj.contact_friction_coefficient * truth.force_n / stiffness
    assert truth.force_n > 10.0 and plant.odometry_pose.theta == 0.0
    assert plant.robot_pose.theta == pytest.approx(expected, rel=0.02)


@pytest.mark.parametrize('drive, axes', [('differential', (0,)), ('differential', (2,)),
                                         ('holonomic', (0,)), ('holonomic', (1,)),
                                         ('holonomic', (2,))])
def test_wheels_lose_their_play_at_every_reversal(drive, axes):
    """Exactly, and nothing while they go on, rest between, or move within the play."""
    base, ideal = base_of(drive, play=0.004), base_of(drive)
    speed = np.zeros(3)
    speed[list(axes)] = 0.2
    play = 0.004 / (0.1 if axes == (2,) else 1.0)
    lost = np.zeros(3)
    for sign, losses in ((1.0, 0.0), (0.0, 0.0), (1.0, 0.0), (-1.0, 1.0), (0.0, 0.0), (-1.0, 0.0),
                         (1.0, 1.0)):
        command = Twist(*(sign * speed).tolist())
        ways = moved(ideal, command, 0.3), moved(base, command, 0.3)
        if drive == 'differential' and axes == (2,) and sign == 1.0 and not lost.any():
            # One wheel turns back at once.
            lost += abs(ways[0] - ways[1])
            assert lost[2] == pytest.approx(0.5 * play, abs=1e-9)
            continue
        assert np.abs(ways[0] - ways[1])[list(axes)] == pytest.approx(losses * play, abs=1e-9)
    assert base.odometry_pose == ideal.odometry_pose


def test_wheels_spin_in_rotation_too():
    """Against a moment above the force at the wheels; below it nothing is lost."""
    robot = robot_of('differential', track=0.2, max_push_force=20.0, **PROMPT)
    rotations = []
    for moment in (0.0, -1.9, -2.5):
        base = ImperfectDrive(robot, DriveImperfections(), Pose(0.0, 0.0, 0.0), 1.0)
        rotations.append(moved(base, Twist(0.0, 0.0, 1.0), 1.0, moment)[2])
        assert base.odometry_pose.theta == pytest.approx(1.0, abs=1e-3)
    assert rotations[:2] == pytest.approx([1.0, 1.0], abs=1e-3) and abs(rotations[2]) < 0.1


def test_odometry_of_a_simulation_counts_wheels():
    """A robot whose wheels spin measures a way that it has not gone; motion capture does not."""
    robot = robot_of('differential', max_push_force=5.0)
    simulation = Simulation(box(mass=5.0), robot, Pose(0.38, 0.0, 0.0), Pose(0.0, 0.0, 0.0),
                            SimulationSettings())
    odometry = None
    while simulation.time < 2.0:
        measurement = simulation.next_measurement()
        odometry = measurement if hasattr(measurement, 'twist') else odometry
        simulation.command(Twist(0.2, 0.0, 0.0))
    assert odometry.pose.x > 0.3 > 0.1 > simulation.truth.robot_pose.x


@pytest.mark.parametrize('fields', [{'start': 1.0, 'end': 1.0, 'factor': 0.5},
                                    {'start': 0.0, 'end': 1.0, 'factor': 1.5}])
def test_malformed_intervals_are_refused(fields):
    with pytest.raises(ValueError, match='SpeedFactor'):
        SpeedFactor(**fields)
    with pytest.raises(ValueError, match='speed_factors'):
        DriveImperfections(speed_factors=[1.0])
