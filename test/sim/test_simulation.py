"""Simulated time: order of events, determinism, time-outs, disturbances."""

import itertools
import math

from helpers.objects import box
from push_model.geometry import Pose
from push_model.parameters import RoundRobot
from push_model.signals import ObjectPose, Odometry, STOP, Twist
from push_sim_node.sensors import SensorSettings
from push_sim_node.simulation import Simulation, SimulationSettings
from push_sim_node.truth import ContactMode
import pytest

NOISY = SensorSettings(pose_noise=2e-3, pose_heading_noise=5e-3, pose_latency=0.08,
                       pose_drop_probability=0.1, odometry_scale_noise=0.02,
                       odometry_heading_drift_noise=0.02, odometry_speed_noise=0.01)


def simulation(sensors=SensorSettings(), obj=None, **settings):
    """Return a simulation of a robot that touches a box."""
    return Simulation(obj or box(), RoundRobot(0.17), Pose(0.0, 0.0, 0.0),
                      Pose(-0.37, 0.02, 0.0), SimulationSettings(**settings), sensors)


def run(sim, seconds, command=lambda t: Twist(0.2, 0.0, 0.1 * math.sin(t))):
    """Answer every measurement; return (delivery time, measurement) pairs."""
    events = []
    while True:
        measurement = sim.next_measurement()
        if sim.time > seconds:
            return events
        events.append((sim.time, measurement))
        sim.command(command(sim.time))


def poses_of(events):
    """Return the pairs that deliver object poses."""
    return [(time, item) for time, item in events if isinstance(item, ObjectPose)]


def column(sim, name):
    """Return a column of the tape."""
    return sim.tape[name]


def test_first_pose_then_first_odometry_at_time_0():
    sim = simulation(SensorSettings(pose_latency=0.08, pose_drop_probability=1.0,
                                    pose_dropouts=((0.0, 1.0),)))
    assert sim.time == 0.0
    assert sim.next_measurement() == ObjectPose(0.0, Pose(0.0, 0.0, 0.0))
    first = sim.next_measurement()
    assert isinstance(first, Odometry) and first[:3] == (0.0, Pose(-0.37, 0.02, 0.0), STOP)
    assert sim.time == 0.0
    assert isinstance(sim.next_measurement(), Odometry) and sim.time == 0.02


def test_rates_latency_and_stamps():
    events = run(simulation(SensorSettings(pose_latency=0.08)), 2.0)
    odometry = [(t, m) for t, m in events if isinstance(m, Odometry)]
    assert [t for t, _ in odometry] == [i / 50 for i in range(101)]
    assert all(m.time == t for t, m in odometry)
    assert [m.time for _, m in poses_of(events)] == [i / 20 for i in range(39)]
    assert [t for t, _ in poses_of(events)[1:]] == [round(i / 20 + 0.08, 9) for i in range(1, 39)]


def test_a_late_pose_is_that_of_its_stamp():
    sim = simulation(SensorSettings(pose_latency=0.1))
    events = run(sim, 2.0)
    course = {row[0]: row[1:4] for row in sim.rows}
    late = [m for _, m in poses_of(events) if m.time in course]
    assert len(late) > 15
    assert all(m.pose == pytest.approx(course[m.time], abs=1e-12) for m in late)


def test_poses_come_before_odometry_of_the_same_time():
    events = run(simulation(SensorSettings(pose_latency=0.05)), 1.0)
    together = [(one, two) for (t, one), (u, two) in itertools.pairwise(events) if t == u]
    assert len(together) > 5
    assert all(isinstance(one, ObjectPose) and isinstance(two, Odometry) for one, two in together)


def test_same_seed_same_tape_to_the_last_bit():
    one, two, other = (simulation(NOISY, seed=seed) for seed in (3, 3, 4))
    events = [run(sim, 2.0) for sim in (one, two, other)]
    assert events[0] == events[1]
    assert one.tape.to_bytes() == two.tape.to_bytes()
    assert events[0] != events[2]
    assert len(one.tape) > 90 and len(one.rows[0]) == len(one.columns)


def test_reset_begins_the_same_run_again():
    sim = simulation(NOISY, seed=3)
    first = run(sim, 1.0)
    tape = sim.tape.to_bytes()
    sim.reset()
    assert sim.time == 0.0 and sim.rows == []
    assert run(sim, 1.0) == first
    assert sim.tape.to_bytes() == tape
    sim.reset(Pose(0.1, 0.2, 0.3))
    assert sim.truth.object_pose == pytest.approx((0.1, 0.2, 0.3))
    assert sim.truth.robot_pose == pytest.approx((-0.37, 0.02, 0.0))


def test_streams_are_independent():
    """Losing poses and another odometry error leave the noise of the poses as it is."""
    def poses(**errors):
        sim = simulation(SensorSettings(pose_noise=2e-3, **errors))
        return [m for _, m in poses_of(run(sim, 1.0, lambda t: Twist(0.2, 0.0, 0.1)))]

    plain = {m.time: m for m in poses()}
    lossy = poses(pose_drop_probability=0.4, odometry_scale_noise=0.1, odometry_speed_noise=0.1)
    assert 5 < len(lossy) < len(plain)
    assert all(plain[m.time] == m for m in lossy)


def test_robot_stops_when_commands_cease():
    sim = simulation(command_timeout=0.5)
    run(sim, 1.0, lambda t: Twist(0.2, 0.0, 0.0))
    last = sim.time
    while sim.time < last + 1.2:
        sim.next_measurement()
    times, speeds = column(sim, 'time'), column(sim, 'robot_v_x')
    commands = column(sim, 'command_v_x')
    assert speeds[(times > 0.9) & (times < last + 0.45)] == pytest.approx(0.2, abs=1e-3)
    assert (commands[(times > 0.0) & (times < last + 0.45)] == 0.2).all()
    stopped = times >= last + 0.5
    assert (commands[stopped] == 0.0).all()
    assert abs(speeds[-1]) < 2e-3
    sim.command(Twist(0.1, 0.0, 0.0))
    run(sim, sim.time + 0.5, lambda t: Twist(0.1, 0.0, 0.0))
    assert column(sim, 'robot_v_x')[-1] > 0.09


def test_robot_stands_before_the_first_command():
    sim = simulation()
    for _ in range(100):
        sim.next_measurement()
    assert sim.truth.robot_pose == (-0.37, 0.02, 0.0)
    assert sim.truth.object_pose == (0.0, 0.0, 0.0)


@pytest.mark.parametrize('twist', [Twist(math.nan, 0.0, 0.0), Twist(0.0, 0.1, 0.0)])
def test_refused_command_changes_nothing(twist):
    sim = simulation()
    sim.next_measurement()
    sim.command(Twist(0.2, 0.0, 0.0))
    with pytest.raises(ValueError, match='command'):
        sim.command(twist)
    while sim.time < 0.4:
        sim.next_measurement()
    assert sim.truth.robot_twist.v_x == pytest.approx(0.2, abs=0.02)


def test_tape_agrees_with_the_truth():
    sim = simulation()
    run(sim, 1.0)
    truth = sim.truth
    row = dict(zip(sim.columns, sim.rows[-1]))
    assert row['time'] == truth.time == sim.time
    assert [row['object_x'], row['object_y'], row['object_theta']] == list(truth.object_pose)
    assert (row['force_n'], row['force_t']) == (truth.force_n, truth.force_t)
    assert row['mode'] == 1.0 and truth.mode is ContactMode.STICK
    assert abs(row['pushing_angle']) < 0.3 and truth.pushing_angle == row['pushing_angle']
    assert abs(row['gap']) < 1e-6
    assert math.isnan(sim.tape['pushing_angle'][0])
