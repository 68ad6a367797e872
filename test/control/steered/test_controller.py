"""The controller as a whole: symmetries, phases, and what makes it wait or refuse."""

import dataclasses
import math

from helpers.push_case import (
    box, holonomic_plan, mirrored_object, mirrored_target, random_case, run, vertex_plan)
import numpy as np
from push_control.settings import ControlSettings
from push_control.steered.controller import Controller, MAX_SAFETY_STOPS, WAITING_TIME_LIMIT
from push_control.steered.status import Phase
from push_model.events import PushEvent
from push_model.geometry import Pose
from push_model.observation import Observation
from push_model.parameters import PushedObject, RoundRobot, Support
from push_model.signals import ObjectPose, Odometry, STOP, Twist
from push_model.trajectory import COLUMNS, PushTrajectory
from push_safety.status import SafetyReason
import pytest

SETTINGS = ControlSettings()
OPEN_LOOP = ControlSettings(control_law='open_loop')
ROBOT = RoundRobot(radius=0.17)
HOLONOMIC = dataclasses.replace(ROBOT, drive='holonomic')


@pytest.fixture(scope='module')
def recorded():
    """Observations, their intervals, and the commands that answered them; 15 s of one push."""
    case, seen = random_case(4), []
    run(case, SETTINGS, 4, max_time=15.0, on_step=lambda _, __, now: seen.append(now))
    steps = [(now, now.time - before.time) for before, now in zip(seen[:1] + seen, seen)]
    return case, steps, answers(case.nominal, case.target, steps)


def answers(obj, target, steps, robot=ROBOT, settings=SETTINGS):
    """Feed observations to a fresh controller."""
    controller = Controller(obj, robot, settings)
    return np.array([controller.step(target, now, dt) for now, dt in steps])


def moved_target(target, move):
    """Carry every pose by ``move`` and turn every velocity with it."""
    turn = Pose(0.0, 0.0, move.theta)
    arrays = {'times': target.times}
    for name in COLUMNS:
        carry = (lambda row: move @ Pose(*row)) if name.endswith('poses') else (
            lambda row: (*turn.rotate(row[:2]), row[2]))
        arrays[name] = np.array([carry(row) for row in getattr(target, name).tolist()])
    return PushTrajectory(**arrays)


def test_the_record_is_a_real_push(recorded):
    """The commands that the symmetry tests compare do steer, both ways."""
    _, _, commands = recorded
    assert commands[:, 0].max() > 0.1
    assert commands[:, 2].min() < -0.02 and commands[:, 2].max() > 0.02


def test_commands_do_not_depend_on_where_the_world_frame_lies(recorded):
    """Moving target and measurements together changes nothing in the robot's axes."""
    case, steps, commands = recorded
    move = Pose(3.0, -7.0, 2.5)
    moved = [(Observation(now.time, now.odometry._replace(pose=move @ now.odometry.pose),
                          now.object_pose._replace(pose=move @ now.object_pose.pose)), dt)
             for now, dt in steps]
    found = answers(case.nominal, moved_target(case.target, move), moved)
    assert found == pytest.approx(commands, abs=1e-6)


def test_a_mirrored_world_gets_mirrored_commands(recorded):
    """Left and right are treated alike by all that lies between."""
    case, steps, commands = recorded

    def mirror(pose):
        return Pose(pose[0], -pose[1], -pose[2])

    moved = []
    for now, dt in steps:
        twist = Twist(now.odometry.twist.v_x, 0.0, -now.odometry.twist.omega)
        odometry = Odometry(now.odometry.time, mirror(now.odometry.pose), twist)
        pose = now.object_pose._replace(pose=mirror(now.object_pose.pose))
        moved.append((Observation(now.time, odometry, pose), dt))
    found = answers(mirrored_object(case.nominal), mirrored_target(case.target), moved)
    assert found == pytest.approx(commands * (1.0, 1.0, -1.0), abs=1e-6)


def test_a_repeated_observation_gets_the_same_answer_and_changes_nothing(recorded):
    """As when the sim offers a measurement again because the answer was lost."""
    case, steps, commands = recorded
    controller = Controller(case.nominal, ROBOT, SETTINGS)
    for (now, dt), command in zip(steps[:300], commands):
        assert controller.step(case.target, now, dt) == tuple(command)
        status = controller.status
        assert controller.step(case.target, now, dt) == tuple(command)
        assert controller.step(case.target, now, 0.2) == tuple(command)
        assert controller.status == status


def test_a_new_target_and_reset_start_afresh(recorded):
    """The same observations after either give the same commands as at first."""
    case, steps, commands = recorded
    controller = Controller(case.nominal, ROBOT, SETTINGS)
    for target in (case.target, dataclasses.replace(case.target)):
        found = [controller.step(target, now, dt) for now, dt in steps[:100]]
        assert np.array(found) == pytest.approx(commands[:100], abs=0.0)
    controller.reset()
    assert controller.status.phase is Phase.IDLE
    assert controller.step(None, steps[0][0], 0.02) == STOP
    assert controller.status.phase is Phase.IDLE


def replayed_until(controller, case, steps, time):
    """Feed observations up to a time; return the last one."""
    for now, dt in steps:
        if now.time > time:
            return now
        controller.step(case.target, now, dt)
    raise ValueError(f'time: got {time}, expected it within the record')


def later(now, age, pose_age=None, pose=None):
    """Make an observation ``age`` after ``now``, of a robot that goes on."""
    odometry = now.odometry._replace(time=now.odometry.time + age)
    measured = now.object_pose
    if pose_age is not None:
        measured = ObjectPose(now.time + age - pose_age, pose or measured.pose)
    return Observation(now.time + age, odometry, measured)


def test_two_lost_poses_in_a_row_do_not_stop_the_robot_and_more_do(recorded):
    """At 20 Hz and 80 ms: stale no sooner than 0.23 s and no later than 0.3 s after its time."""
    case, steps, _ = recorded
    controller = Controller(case.nominal, ROBOT, SETTINGS)
    now = replayed_until(controller, case, steps, 8.0)
    last = now.object_pose.time
    while now.time < last + 0.29:
        now = later(now, 0.01)
        command = controller.step(case.target, now, 0.01)
        if now.time < last + 0.235:
            assert command.v_x > 0.0 and controller.status.phase is Phase.PUSHING
    assert command == STOP
    assert controller.status.phase is Phase.WAITING
    assert controller.status.event is PushEvent.OBJECT_POSE_STALE
    now = later(now, 0.02, pose_age=0.08)
    assert controller.step(case.target, now, 0.02).v_x > 0.0
    assert controller.status.phase is Phase.PUSHING
    assert controller.status.event is None and not controller.status.reason


def test_stale_odometry_stops_the_robot(recorded):
    """Poses alone do not drive it."""
    case, steps, _ = recorded
    controller = Controller(case.nominal, ROBOT, SETTINGS)
    now = replayed_until(controller, case, steps, 8.0)
    for _ in range(8):
        time = now.time + 0.05
        now = Observation(time, now.odometry, ObjectPose(time - 0.08, now.object_pose.pose))
        command = controller.step(case.target, now, 0.05)
    assert command == STOP
    assert controller.status.phase is Phase.WAITING
    assert controller.status.event is PushEvent.ODOMETRY_STALE


def stopped(controller, case, now, stop, count=10):
    """Hold the robot of a push for a while; return the last observation and command."""
    command = None
    for _ in range(count):
        now = later(now, 0.05, pose_age=0.08)
        now = now._replace(odometry=now.odometry._replace(twist=STOP))
        controller.on_safety_report(stop, stop)
        command = controller.step(case.target, now, 0.05)
    return now, command


@pytest.mark.parametrize('stop', [
    SafetyReason.NOT_MOVING.report(expected='', measured=''),
    SafetyReason.ODOMETRY_JUMPED.report(distance=0.3, rotation=29.0)],
    ids=['base', 'odometry'])
def test_a_push_that_is_stopped_goes_on_and_fails_where_that_is_too_often(recorded, stop):
    """With the reason each time, the sooner the later it is stopped again."""
    case, steps, _ = recorded
    controller = Controller(case.nominal, ROBOT, SETTINGS)
    now = replayed_until(controller, case, steps, 8.0)
    for _ in range(MAX_SAFETY_STOPS - 1):
        now, command = stopped(controller, case, now, stop)
        assert command == STOP and controller.status.phase is Phase.WAITING
        assert controller.event.codes == (PushEvent.SAFETY_STOP, stop.code)
        for _ in range(12):
            now = later(now, 0.05, pose_age=0.08)
            controller.on_safety_report(None, None)
            command = controller.step(case.target, now, 0.05)
        assert command.v_x > 0.0 and controller.status.phase is Phase.PUSHING
    now, command = stopped(controller, case, now, stop)
    assert command == STOP and controller.status.phase is Phase.FAILED
    assert controller.event.codes == (PushEvent.STOPPED_TOO_OFTEN, stop.code)
    assert str(stop) in controller.status.reason


def test_a_push_that_stays_stopped_is_given_up(recorded):
    """And one without feedback at its first stop, as nothing tells where it is."""
    case, steps, _ = recorded
    stop = SafetyReason.MOVES_OTHERWISE.report(expected='', measured='')
    controller = Controller(case.nominal, ROBOT, SETTINGS)
    now = replayed_until(controller, case, steps, 4.0)
    stopped(controller, case, now, stop, round(WAITING_TIME_LIMIT / 0.05) + 5)
    assert controller.status.phase is Phase.FAILED
    assert controller.event.codes == (
        PushEvent.GAVE_UP_WAITING, PushEvent.SAFETY_STOP, stop.code)
    controller = Controller(case.nominal, ROBOT, OPEN_LOOP)
    stopped(controller, case, replayed_until(controller, case, steps, 4.0), stop, 1)
    assert controller.status.phase is Phase.FAILED
    assert controller.event.codes == (PushEvent.SAFETY_STOP, stop.code)


def test_a_base_that_drives_on_at_the_goal_is_no_success():
    """The push is not done while the robot moves, and is judged anew where it stands."""
    case, last, ends, phases = random_case(4), [STOP], [], set()
    stop = SafetyReason.MOVES_OTHERWISE.report(expected='', measured='')

    def drive_on(plant, controller, observation):
        command = controller.step(case.target, observation, 0.0)
        if command != STOP:
            last[:] = [command]
            return
        if last != [STOP]:
            ends.append(observation.time)
            phases.add(controller.status.phase)
        if ends and observation.time < ends[0] + 2.0:
            plant.command(last[0])
            controller.on_safety_report(stop, stop)
        else:
            controller.on_safety_report(None, None)

    outcome = run(case, SETTINGS, 4, on_step=drive_on)
    assert Phase.DONE not in phases
    assert outcome.status.event is PushEvent.GOAL_MISSED and outcome.status.replan_requested
    assert outcome.position_error > SETTINGS.position_tolerance


def test_an_object_beside_its_goal_is_not_done_where_its_flat_output_is() -> None:
    """The flat output is within the tolerance, and the heading error adds to the distance."""
    settings = ControlSettings(position_tolerance=0.002, max_replan_requests=0)
    outcome = run(random_case(7), settings, 7)
    assert outcome.status.event is PushEvent.GOAL_MISSED
    assert outcome.status.position_error > settings.position_tolerance
    assert abs(outcome.status.heading_error) < settings.heading_tolerance


@pytest.mark.parametrize('bad', [math.nan, math.inf])
def test_what_is_not_finite_stops_the_robot_and_leaves_no_trace(recorded, bad):
    """A broken pose or odometry is answered by a stop; afterwards everything is finite."""
    case, steps, _ = recorded
    controller = Controller(case.nominal, ROBOT, SETTINGS)
    now = replayed_until(controller, case, steps, 8.0)
    broken = later(now, 0.02, 0.08, Pose(1.0, bad, 0.0))
    assert controller.step(case.target, broken, 0.02) == STOP
    assert controller.status.event is PushEvent.OBJECT_POSE_NOT_FINITE
    broken = later(now, 0.03)
    broken = broken._replace(odometry=broken.odometry._replace(twist=Twist(0.1, 0.0, bad)))
    assert controller.step(case.target, broken, 0.01) == STOP
    assert controller.status.event is PushEvent.ODOMETRY_NOT_FINITE
    command = controller.step(case.target, later(now, 0.04, 0.08), 0.01)
    assert controller.status.phase is Phase.PUSHING
    assert all(math.isfinite(value) for value in command) and command.v_x > 0.0


def test_without_a_pose_it_waits(recorded):
    """A target alone does not move the robot."""
    case, steps, _ = recorded
    controller = Controller(case.nominal, ROBOT, SETTINGS)
    assert controller.step(case.target, steps[0][0]._replace(object_pose=None), 0.0) == STOP
    assert controller.status.phase is Phase.WAITING
    assert controller.status.event is PushEvent.NO_OBJECT_POSE


def test_a_negative_interval_is_refused(recorded):
    """The error names it."""
    case, steps, _ = recorded
    controller = Controller(case.nominal, ROBOT, SETTINGS)
    with pytest.raises(ValueError, match='dt'):
        controller.step(case.target, steps[0][0], -0.1)


def test_after_a_gap_the_robot_speeds_up_from_where_it_was(recorded):
    """As while code is compiled: no more than in the longest time without odometry."""
    case, steps, _ = recorded
    start, gap = steps[:3], SETTINGS.odometry_timeout
    commands = [answers(case.nominal, case.target, [*start[:2], (start[2][0], dt)])[-1]
                for dt in (gap, 10.0, start[2][1])]
    assert commands[0] == pytest.approx(commands[1], abs=0.0)
    assert commands[2][0] < commands[0][0] < 0.5 * case.target.contact_twists[:, 0].max()


def test_an_object_that_does_not_follow_is_given_up():
    """The robot drives on for some centimetres, no further than half a metre."""
    case = random_case(3)
    controller = Controller(case.nominal, ROBOT, SETTINGS)
    start = Pose(*case.target.object_poses[0].tolist())
    driven, command = 0.0, STOP
    for k in range(2000):
        time = 0.02 * k
        odometry = Odometry(time, case.robot_pose, command)
        command = controller.step(case.target, Observation(time, odometry,
                                                           ObjectPose(time, start)), 0.02)
        driven += 0.02 * command.v_x
        if controller.status.phase is Phase.FAILED:
            break
    assert controller.status.phase is Phase.FAILED
    assert controller.status.event is PushEvent.OBJECT_DOES_NOT_FOLLOW
    assert 0.1 < driven < 0.5 and command == STOP


def test_a_differential_drive_on_a_face_is_refused_and_a_robot_elsewhere_too():
    """Both before anything moves, with a reason."""
    obj = box(0.4, 2.0, [0.3] * 4)
    face = holonomic_plan(obj, HOLONOMIC, (-0.2, 0.0), 0.0, Pose(1.5, 0.1, 0.1), 0.15)
    away = dataclasses.replace(face, robot_poses=face.robot_poses - (0.1, 0.0, 0.0))
    for robot, target, reason in ((ROBOT, face, 'vertex'), (HOLONOMIC, away, 'contact')):
        controller = Controller(obj, robot, SETTINGS)
        first = face.robot_poses[0].tolist()
        now = Observation(0.0, Odometry(0.0, Pose(*first), STOP),
                          ObjectPose(0.0, Pose(0.0, 0.0, 0.0)))
        assert controller.step(target, now, 0.0) == STOP
        assert controller.status.phase is Phase.FAILED and reason in controller.status.reason


def test_open_loop_plays_the_plan_and_stops():
    """Integrated, its commands are the planned path; measurements are not used."""
    case = random_case(4)
    controller = Controller(case.nominal, ROBOT, OPEN_LOOP)
    pose, time, dt = Pose(*case.target.robot_poses[0].tolist()), 0.0, 0.005
    while controller.status.phase is not Phase.DONE and time < 300.0:
        now = Observation(time, Odometry(time, Pose(math.nan, 0.0, 0.0), STOP))
        command = controller.step(case.target, now, dt)
        pose = pose @ Pose(dt * command.v_x, 0.0, dt * command.omega)
        time += dt
    assert command == STOP
    assert pose == pytest.approx(case.target.robot_poses[-1], abs=0.02)
    assert case.target.duration < time < 2.0 * case.target.duration + 10.0


def test_an_object_without_friction_is_refused():
    """Nothing could be said about its motion."""
    obj = box(0.4, 2.0, [0.3] * 4)
    target = vertex_plan(obj, ROBOT, Pose(0.8, 0.8, 0.0), 0.15, vertices=(2,))
    icy = PushedObject(mass=2.0, inertia=0.1, supports=(Support(0.0, 0.0, 0.0),),
                       outline=obj.outline)
    controller = Controller(icy, ROBOT, SETTINGS)
    now = Observation(0.0, Odometry(0.0, Pose(*target.robot_poses[0].tolist()), STOP),
                      ObjectPose(0.0, Pose(0.0, 0.0, 0.0)))
    assert controller.step(target, now, 0.0) == STOP
    assert controller.status.phase is Phase.FAILED and 'friction' in controller.status.reason


def test_a_target_that_starts_at_the_push_is_taken_up_without_a_stop(recorded):
    """The rest of the plan as a new one: estimate and speed stay, and the commands go on."""
    case, steps, commands = recorded
    controller = Controller(case.nominal, ROBOT, SETTINGS)
    for now, dt in steps[:400]:
        controller.step(case.target, now, dt)
    time = steps[400][0].time
    begin = int(np.searchsorted(case.target.times, time - 0.3))
    rest = PushTrajectory(times=case.target.times[begin:] - case.target.times[begin],
                          **{name: getattr(case.target, name)[begin:] for name in COLUMNS})
    rejected, center = controller.status.rejected_poses, controller.status.friction_center
    found = np.array([controller.step(rest, now, dt) for now, dt in steps[400:500]])
    assert controller.status.phase is Phase.PUSHING and controller.status.travelled_distance < 0.5
    assert controller.status.rejected_poses - rejected < 5
    assert controller.status.friction_center == pytest.approx(center, abs=0.02)
    assert commands[400:500, 0].min() > 0.05
    assert found[:, 0] == pytest.approx(commands[400:500, 0], rel=0.1)
    steps_before = np.abs(np.diff(commands[50:400], axis=0)).max(axis=0)
    assert (np.abs(np.diff(found, axis=0, prepend=commands[399:400])) <= steps_before).all()


def test_a_target_that_starts_elsewhere_starts_afresh(recorded):
    """Another contact, or an object elsewhere: the robot is not where it starts, and stops."""
    case, steps, _ = recorded
    away = moved_target(case.target, Pose(1.0, 0.0, 0.0))
    for target in (away, mirrored_target(case.target)):
        controller = Controller(case.nominal, ROBOT, SETTINGS)
        for now, dt in steps[:60]:
            controller.step(case.target, now, dt)
        assert controller.status.phase is Phase.PUSHING
        assert controller.step(target, *steps[60]) == STOP
        assert controller.status.phase is Phase.FAILED


@pytest.mark.parametrize('law', [SETTINGS, OPEN_LOOP], ids=['feedback', 'open loop'])
@pytest.mark.parametrize('place, is_refused', [
    (Pose(-1.5, 0.3, 0.0), True), (Pose(0.0, 0.0, 0.0), False), (Pose(0.0, 0.04, 0.0), False),
    (Pose(0.0, 0.0, 0.5), True)],
    ids=['away', 'there', 'beside', 'askew'])
def test_a_robot_that_is_not_where_the_plan_starts_does_not_move(law, place, is_refused):
    """It is told where to stand, in the world; near enough is good."""
    case = random_case(4)
    start = Pose(*case.target.robot_poses[0].tolist())
    moved = Pose(start.x + place.x, start.y + place.y, start.theta + place.theta)
    controller = Controller(case.nominal, ROBOT, law)
    now = Observation(0.0, Odometry(0.0, moved, STOP),
                      ObjectPose(0.0, Pose(*case.target.object_poses[0].tolist())))
    command = controller.step(case.target, now, 0.0)
    assert (controller.status.phase is Phase.FAILED) == (command == STOP) == is_refused
    if is_refused:
        values = controller.event.values
        assert controller.event.code is PushEvent.ROBOT_NOT_AT_START
        assert (values['x'], values['y'], values['heading']) == pytest.approx(start)
        assert values['rotation'] == pytest.approx(abs(math.degrees(place.theta)))
