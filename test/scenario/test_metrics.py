"""Metrics of runs, compared with motions whose values are known."""

import math

from helpers.tapes import make_result, make_tape, straight_plan, TIMES
import numpy as np
from push_dynamics.layout import SEPARATE, STICK
from push_model.geometry import Pose
from push_scenario.evaluation.metrics import (
    deviation, distance_travelled, force_angle, is_as_expected, measure, slip_speed,
)
from push_scenario.simulation.result import Outcome
import pytest

RADIUS = 0.17


def test_a_run_along_its_plan_has_no_error():
    tape = make_tape(object_x=0.2 * TIMES, robot_x=0.2 * TIMES, mode=STICK)
    result = make_result(tape, straight_plan(), (2.0, 0.0, 0.0))
    metrics = measure(result)
    assert metrics.position_error == pytest.approx(0.0, abs=1e-12)
    assert metrics.heading_error == 0.0
    assert metrics.robot_path_length == pytest.approx(2.0)
    assert metrics.path_length_ratio == pytest.approx(1.0)
    assert metrics.max_deviation == pytest.approx(0.0, abs=1e-12)
    assert metrics.contact_time == pytest.approx(10.0)
    assert metrics.time == 9.0
    assert metrics.within_bounds and is_as_expected(result)


def test_errors_do_not_depend_on_the_world_frame():
    move = Pose(3.0, -2.0, 2.5)
    object_poses = [Pose(0.2 * t, 0.01 * t, 0.05 * t) for t in TIMES]
    moved = np.array([move @ pose for pose in object_poses])
    still = np.array(object_poses)
    results = []
    for poses, frame in ((still, Pose(0.0, 0.0, 0.0)), (moved, move)):
        tape = make_tape(object_x=poses[:, 0], object_y=poses[:, 1], object_theta=poses[:, 2],
                         robot_x=poses[:, 0], robot_y=poses[:, 1], mode=STICK)
        goal = frame @ Pose(2.0, 0.0, 0.3)
        plan = straight_plan(heading=frame.theta, origin=frame[:2])
        results.append(measure(make_result(tape, plan, goal)))
    for name in ('position_error', 'heading_error', 'robot_path_length', 'max_deviation'):
        assert getattr(results[0], name) == pytest.approx(getattr(results[1], name), abs=1e-9)
    assert results[0].position_error == pytest.approx(0.1)
    assert results[0].heading_error == pytest.approx(0.2)
    assert results[0].max_deviation == pytest.approx(0.1)
    assert not results[0].within_bounds


def test_heading_error_takes_the_short_way_round():
    tape = make_tape(object_x=0.2 * TIMES, object_theta=2 * math.pi - 0.02, robot_x=TIMES)
    metrics = measure(make_result(tape, straight_plan(), (2.0, 0.0, 0.0)))
    assert metrics.heading_error == pytest.approx(-0.02)


def test_a_run_that_arrives_but_is_not_done_is_not_as_expected():
    tape = make_tape(object_x=0.2 * TIMES, robot_x=0.2 * TIMES, mode=STICK)
    result = make_result(tape, straight_plan(), (2.0, 0.0, 0.0), Outcome.TIME_LIMIT)
    assert measure(result).within_bounds
    assert not is_as_expected(result)


def test_distance_travelled_on_a_circle_is_its_circumference():
    turn = 2 * math.pi * TIMES / 10.0
    tape = make_tape(robot_x=0.5 * np.cos(turn), robot_y=0.5 * np.sin(turn))
    distance = distance_travelled(tape)
    assert distance[0] == 0.0 and (np.diff(distance) > 0.0).all()
    assert distance[-1] == pytest.approx(math.pi, rel=1e-4)


def test_contact_time_counts_only_contact():
    tape = make_tape(robot_x=TIMES, mode=np.where(TIMES < 4.0, SEPARATE, STICK))
    metrics = measure(make_result(tape, straight_plan(), (0.0, 0.0, 0.0)))
    assert metrics.contact_time == pytest.approx(6.0, abs=0.03)


@pytest.mark.parametrize('normal', [0.0, 0.7, -2.5])
def test_a_spinning_robot_slides_by_its_circumference_and_a_rolling_one_not(normal):
    heading = 0.4
    spin = make_tape(robot_omega=1.3, robot_theta=heading, normal=normal, mode=STICK)
    assert slip_speed(spin, RADIUS) == pytest.approx(np.full(len(TIMES), 1.3 * RADIUS))
    along = Pose(0.0, 0.0, normal + math.pi / 2 - heading).rotate((-1.3 * RADIUS, 0.0))
    roll = make_tape(robot_omega=1.3, robot_theta=heading, normal=normal, mode=STICK,
                     robot_v_x=along[0], robot_v_y=along[1])
    assert slip_speed(roll, RADIUS) == pytest.approx(np.zeros(len(TIMES)), abs=1e-12)


def test_bodies_that_turn_about_one_point_do_not_slide():
    normal, omega = 0.3, 0.8
    center, robot = np.array([0.4, 0.1]), np.array([-0.3, 0.2])
    contact = robot + RADIUS * np.array([math.cos(normal), math.sin(normal)])
    tape = make_tape(object_x=center[0], object_y=center[1], object_v_x=-omega * center[1],
                     object_v_y=omega * center[0], object_omega=omega, robot_x=robot[0],
                     robot_y=robot[1], robot_v_x=-omega * robot[1], robot_v_y=omega * robot[0],
                     robot_omega=omega, contact_x=contact[0], contact_y=contact[1], normal=normal)
    assert slip_speed(tape, RADIUS) == pytest.approx(np.zeros(len(TIMES)), abs=1e-12)


def test_deviation_is_the_distance_from_the_nearest_point_also_beyond_the_end():
    plan = straight_plan(2.0)
    poses = np.array([[1.03, 0.2, 0.1], [2.3, -0.4, -0.1], [-0.3, 0.4, 2 * math.pi]])
    away, turn = deviation(poses, plan)
    assert away == pytest.approx([0.2, 0.5, 0.5])
    assert turn == pytest.approx([0.1, -0.1, 0.0])


def test_force_angle_is_that_of_the_force_and_nothing_without_force():
    tape = make_tape(force_n=np.where(TIMES < 5.0, 2.0, 0.0), force_t=-0.5)
    angle = force_angle(tape)
    assert angle[0] == pytest.approx(-math.atan(0.25))
    assert np.isnan(angle[-1])
