"""The controller's node asks the planner's, over Fast DDS."""

import math

from helpers.node_bench import bench
from push_control.steered.estimation.contact_site import initial_contact_site
from push_model.files.flat_values import to_parameter_values
from push_model.geometry import distance, Pose
from push_model.signals import Twist
from push_planner.problem import problem_from_placement
from push_planner.steered.planner import plan_push
from push_ros.conversions.plan import to_plan_message
from push_ros.conversions.plan_request import from_request_message
from push_ros.conversions.primitives import to_stamp
from push_ros.topics import CONTROLLER
from push_scenario.definition.catalogue import find_scenario
from push_scenario.definition.loader import read_scenario
import pytest

pytestmark = [pytest.mark.dds, pytest.mark.slow]

SCENARIO = read_scenario(find_scenario('straight_push'))
OBJECT, ROBOT, GOAL = SCENARIO.start.object.pose, SCENARIO.robot_start, SCENARIO.goal.pose
PARAMETERS = {**to_parameter_values(SCENARIO.object, 'object.'),
              **to_parameter_values(SCENARIO.robot, 'robot.'),
              # The robot that is played here does not turn, and is hardly commanded to.
              'control.feedback_cone_fraction': 0.1,
              'use_sim_time': True, 'lockstep': True, 'control.max_reapproaches': 0,
              'accept_unrequested_plans': True}
PERIOD = 0.1


def texts(b):
    """List what was reported."""
    return [status.message for message in b.received['diagnostics'] for status in message.status]


def test_the_planner_is_asked_once_where_a_push_ends_beside_its_goal(tmp_path):
    """Object and robot go past the goal, 8 cm beside it; the robot stands and the node asks."""
    target = plan_push(problem_from_placement(SCENARIO.object, SCENARIO.robot, OBJECT, ROBOT, GOAL,
                                              SCENARIO.planner)).trajectory
    assert initial_contact_site(SCENARIO.object, SCENARIO.robot, target).kind == 'vertex'
    with bench(tmp_path, CONTROLLER, 'push_control.controller_node', PARAMETERS) as b:
        b.subscribe('push_request')
        b.subscribe('cmd_vel')
        b.subscribe('diagnostics')
        b.wait_until(lambda: b.received['diagnostics'])
        b.clock(0.0)
        b.publish('push_plan', to_plan_message(target, to_stamp(0.0), 'odom'))
        b.wait_until(lambda: any('task: push' in text for text in texts(b)))
        b.connect(OBJECT, ROBOT)
        bearing = math.atan2(GOAL.y - OBJECT.y, GOAL.x - OBJECT.x)
        aside = math.atan2(0.08, math.hypot(GOAL.x - OBJECT.x, GOAL.y - OBJECT.y))
        course = bearing + aside - ROBOT.theta
        time, distance_moved, command = 0.0, 0.0, (0.0, 0.0, 0.0)
        while not any('beside the goal' in text for text in texts(b)):
            time += PERIOD
            speed = math.hypot(command[0], command[1])
            distance_moved += speed * PERIOD
            assert time < 30.0
            move = (distance_moved * math.cos(bearing + aside),
                    distance_moved * math.sin(bearing + aside))
            place, pose = (Pose(start.x + move[0], start.y + move[1], start.theta)
                           for start in (ROBOT, OBJECT))
            twist = Twist(speed * math.cos(course), speed * math.sin(course), 0.0)
            b.odometry(time, place, twist=twist)
            command = b.object_pose(time, pose)
        assert command == (0.0, 0.0, 0.0)
        requests = b.received['push_request']
        b.wait_until(lambda: requests)
        b.odometry(time + PERIOD, place)
        b.spin(0.3)
    assert len(requests) == 1
    request = from_request_message(requests[0], 'odom')
    assert distance(request.goal, GOAL) < 5e-3
