"""What a simulated camera sees: angle, distances, contact, the robot in front; relative poses."""

import dataclasses
import math

import numpy as np
from push_model.contact import contact_point, face_normal
from push_model.geometry import distance, Pose, wrap_angle
from push_model.parameters import Contact, PushedObject, RoundRobot
from push_model.signals import ObjectPose, Odometry, Twist
from push_scenario import load_scenario
from push_scenario.simulation.loop import first_observation, make_simulation
from push_sim_node.camera import Camera, CameraSettings, mirrored_tilt
from push_sim_node.sensors import PoseSensor, SensorSettings, Sighting
import pytest

SCENARIO = load_scenario('task_demo')
BOX: PushedObject = SCENARIO.object
ROBOT: RoundRobot = SCENARIO.robot
RADIUS = ROBOT.radius


def random_poses(seed, count=200):
    """Draw poses of object and robot that do not overlap."""
    draws = np.random.default_rng(seed)
    while count:
        obj, robot = (Pose(*draws.uniform(-1.5, 1.5, 2), draws.uniform(-4.0, 4.0))
                      for _ in range(2))
        if distance(obj, robot) > 0.7:
            count -= 1
            yield obj, robot


def camera(**settings):
    """Make a camera that looks at the box."""
    return Camera(CameraSettings(**settings), BOX, RADIUS)


@pytest.mark.parametrize('settings', [
    {'place': 'none'},
    {'place': 'robot', 'mount_x': 0.1, 'half_angle': 0.6, 'nearest': 0.25, 'farthest': 2.0},
    {'place': 'robot', 'reference': 'robot', 'mount_heading': 1.0, 'half_angle': 1.0}])
def test_what_the_robot_sees_does_not_depend_on_where_the_world_has_its_origin(settings):
    seen = set()
    for obj, robot in random_poses(1):
        moved = Pose(3.0, -2.0, 2.0)
        here, there = (camera(**settings).sees(frame @ obj, frame @ robot)
                       for frame in (Pose(0.0, 0.0, 0.0), moved))
        assert here == there
        seen.add(here)
    assert seen == ({True} if settings['place'] == 'none' else {True, False})


def test_a_camera_turned_with_its_robot_sees_the_same_as_one_turned_on_it():
    on_robot = {'place': 'robot', 'half_angle': 0.7, 'farthest': 2.0}
    for obj, robot in random_poses(2):
        turned = camera(mount_heading=0.9, **on_robot).sees(obj, robot)
        assert turned == camera(**on_robot).sees(obj, robot @ Pose(0.0, 0.0, 0.9))


def test_the_limits_of_the_view():
    """Just within the angle, the nearest and the farthest distance, and just beyond."""
    limited = camera(place='robot', half_angle=0.5, nearest=0.3, farthest=2.0)
    half_width = max(x for x, _ in BOX.outline)
    for gap, is_seen in ((0.31, True), (0.29, False)):
        assert limited.sees(Pose(half_width + gap, 0.0, 0.0), Pose(0.0, 0.0, 0.0)) is is_seen
    for range_, is_seen in ((1.99, True), (2.01, False)):
        assert limited.sees(Pose(range_, 0.0, 0.3), Pose(0.0, 0.0, 0.0)) is is_seen
    for bearing, is_seen in ((0.49, True), (0.51, False), (-0.49, True), (-0.51, False)):
        obj = Pose(1.5 * math.cos(bearing), 1.5 * math.sin(bearing), 0.0)
        assert limited.sees(obj, Pose(0.0, 0.0, 0.0)) is is_seen


def test_an_object_in_contact_is_hidden_where_stated():
    half_width = max(x for x, _ in BOX.outline)
    for gap, is_seen in ((0.0, False), (0.01, True)):
        obj = Pose(half_width + RADIUS + gap, 0.0, 0.0)
        assert camera(place='robot', is_blind_in_contact=True).sees(
            obj, Pose(0.0, 0.0, 0.0)) is is_seen
        assert camera(place='robot').sees(obj, Pose(0.0, 0.0, 0.0))


def test_the_robot_hides_what_is_behind_it_from_a_camera_in_the_room():
    """On the line between, on either side by less than its radius, and not behind the object."""
    room = camera(place='room', mount_x=-3.0)
    obj = Pose(1.0, 0.0, 0.4)
    for robot, is_seen in ((Pose(-1.0, 0.0, 0.0), False), (Pose(-1.0, RADIUS - 0.01, 2.0), False),
                           (Pose(-1.0, RADIUS + 0.01, 2.0), True), (Pose(1.6, 0.0, 0.0), True),
                           (Pose(-1.0, -RADIUS - 0.01, 0.0), True)):
        assert room.sees(obj, robot) is is_seen
        assert Camera(CameraSettings(place='room', mount_x=-3.0), BOX, math.inf).sees(obj, robot)


def test_noise_grows_with_the_distance():
    settings = SensorSettings(pose_noise=2e-3, pose_heading_noise=5e-3, camera=CameraSettings(
        place='robot', noise_per_distance=0.01, heading_noise_per_distance=0.02))
    sensor = PoseSensor(settings, *(np.random.default_rng(seed) for seed in (1, 2, 3)))
    for distance_, position, heading in ((0.0, 2e-3, 5e-3), (2.0, 0.022, 0.045)):
        sighting = Sighting(distance=distance_)
        poses = np.array([sensor.measure(0.1 * i, Pose(0.0, 0.0, 0.0), sighting).pose
                          for i in range(3000)])
        assert poses.std(axis=0) == pytest.approx([position, position, heading], rel=0.06)


def test_a_mirrored_tilt_turns_the_normal_of_the_tag_to_the_other_side_of_the_line_of_sight():
    """The tag itself stays. Nothing is mistaken straight on, nor on a round object."""
    tags = [Pose(*contact_point(BOX, Contact('face', side)), face_normal(BOX, side) + math.pi)
            for side in range(len(BOX.outline))]
    for bearing in np.linspace(-3.0, 3.0, 50):
        flip = mirrored_tilt(BOX, bearing)
        seen = min(tags, key=lambda tag: abs(wrap_angle(bearing - tag.theta)))
        moved = flip @ seen
        assert moved[:2] == pytest.approx(seen[:2], abs=1e-12)
        assert wrap_angle(moved.theta + seen.theta - 2.0 * bearing) == pytest.approx(
            0.0, abs=1e-9)
    for tag in tags:
        assert mirrored_tilt(BOX, tag.theta) == pytest.approx((0.0, 0.0, 0.0), abs=1e-9)
    disc = load_scenario('bin_round').object
    assert mirrored_tilt(disc, 1.0) == (0.0, 0.0, 0.0)


def test_poses_relative_to_the_room_are_refused():
    with pytest.raises(ValueError, match='CameraSettings.reference'):
        CameraSettings(place='room', reference='robot')


def simulation(**sensors):
    """Make the simulation of the demo with other sensors, the robot before the object."""
    scenario = dataclasses.replace(SCENARIO, sensors=SensorSettings(**sensors))
    return make_simulation(scenario)


def measurements(sim, until):
    """Let the robot drive a circle; collect what is measured, and where robot and object are."""
    taken = []
    while sim.time < until:
        taken.append((sim.next_measurement(), sim.plant.robot_pose, sim.plant.object_pose))
        sim.command(Twist(0.1, 0.0, 1.0))
    return taken


def test_a_camera_without_limits_leaves_every_measurement_as_it_is():
    """The same draws, the same times; the view only leaves poses out."""
    noise = {'pose_noise': 2e-3, 'pose_latency': 0.08, 'odometry_scale': 0.02}
    plain, unlimited, limited = (
        [measured for measured, *_ in measurements(simulation(**noise, camera=each), 8.0)]
        for each in (CameraSettings(), CameraSettings(place='robot'),
                     CameraSettings(place='robot', half_angle=0.6)))
    assert plain == unlimited
    assert [each for each in plain if each in limited] == limited
    poses = [[each for each in taken if isinstance(each, ObjectPose)]
             for taken in (plain, limited)]
    assert 0 < len(poses[1]) < len(poses[0])


@pytest.mark.parametrize('latency', [0.0, 0.013, 0.15])
def test_relative_poses_are_those_in_the_frame_of_the_robot_at_their_time(latency):
    """Whatever odometry makes of it; in the world they are placed by odometry of that time."""
    relative = CameraSettings(place='robot', reference='robot', half_angle=1.0, mount_x=0.1)
    taken = measurements(simulation(pose_rate=10.0, pose_latency=latency, camera=relative,
                                    odometry_heading_drift=0.3, odometry_scale=0.1), 8.0)
    robots = {measured.time: (measured.pose, robot, obj) for measured, robot, obj in taken
              if isinstance(measured, Odometry)}
    assert isinstance(taken[0][0], Odometry)
    poses = [measured for measured, *_ in taken if isinstance(measured, ObjectPose)]
    assert len(poses) > 5
    for pose in poses:
        odometry, robot, obj = robots[pose.time]
        expected = robot.inverse() @ obj
        assert pose.relative[:2] == pytest.approx(expected[:2], abs=1e-9)
        assert wrap_angle(pose.relative.theta - expected.theta) == pytest.approx(0.0, abs=1e-9)
        placed = odometry @ pose.relative
        assert pose.pose[:2] == pytest.approx(placed[:2], abs=1e-9)
        assert wrap_angle(pose.pose.theta - placed.theta) == pytest.approx(0.0, abs=1e-9)


def test_a_run_may_begin_with_an_object_that_is_not_seen():
    """Odometry comes; the object when the robot has turned to it."""
    first = SCENARIO.start.robot_pose(BOX, RADIUS)
    behind = CameraSettings(place='robot', half_angle=0.5, mount_heading=wrap_angle(
        math.atan2(-first.y, -first.x) - first.theta + math.pi))
    sim = simulation(camera=behind)
    observation = first_observation(sim)
    assert observation.object_pose is None and sim.time == 0.0
    assert any(isinstance(measured, ObjectPose) for measured, *_ in measurements(sim, 8.0))
