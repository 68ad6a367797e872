"""The law of straight pushes: where it stops, and how it steers, against the simulated plant."""

import functools

from helpers.objects import box
from helpers.straight_pushes import IDEAL, open_floor_primitives
import numpy as np
from push_control.behaviors.rollout_law import CURVATURES, RolloutLaw
from push_control.perception.ensemble.members import Members
from push_dynamics.walls import Wall
from push_model.geometry import Pose
from push_model.signals import Twist
from push_primitives.cost_to_go import CostToGo
from push_sim_node.plant import Plant
import pytest

# The cost-to-go of the box takes some seconds where it is not in the store.
pytestmark = pytest.mark.slow

# Face behind the box, its robot there, and how fast that pushes.
FACE, DISTANCE, SPEED, HORIZON = 3, 0.37, 0.15, 0.7


@functools.lru_cache(maxsize=None)
def symmetric_cost():
    """Return the cost-to-go at this face, averaged with its mirror image."""
    cost = open_floor_primitives(box()).cost_to_go
    mirrored = np.roll(cost.values[:, :, ::-1, ::-1], 1, axis=2)
    return CostToGo(0.5 * (cost.values + mirrored), cost.distances, cost.headings)


def members_at(offset, count=20):
    """Return equal members whose robots are at an offset from the middle of the face."""
    members = Members(box(), IDEAL, count)
    members.set_robot_poses(np.tile((-DISTANCE, offset, 0.0), (count, 1)))
    members.set_object_poses(np.zeros((count, 3)))
    return members


def law_at(offset, goal, walls=()):
    """Return the law of a push at an offset from the middle of the face."""
    return RolloutLaw(members_at(offset), symmetric_cost(), FACE, Pose(*goal), SPEED, walls)


def scanned_costs(offset, goal, curvature, step=0.002, walls=()):
    """Push the plant along an arc; return distances and what stopping there would cost."""
    plant = Plant(box(), IDEAL, Pose(0.0, 0.0, 0.0), Pose(-DISTANCE, offset, 0.0), walls=walls)
    command = Twist(0.2, 0.0, 0.2 * curvature)
    plant.set_velocities(Twist(0.0, 0.0, 0.0), command)
    distances, costs = np.arange(0.0, HORIZON, step), []
    for distance in distances:
        residual = plant.object_pose.inverse() @ Pose(*goal)
        costs.append(symmetric_cost().at(residual, FACE) + distance / SPEED)
        plant.advance(step / command.v_x, command)
    return distances, np.array(costs)


@pytest.mark.parametrize('offset, goal, curvature, tolerance', [
    (0.0, (0.04, 0.01, 0.0), 0.0, 0.1), (0.1, (0.02, 0.0, -0.05), 0.0, 0.1),
    (0.1, (0.05, 0.0, -0.1), 0.0, 0.1), (0.05, (0.1, 0.0, 0.0), 0.0, 0.1),
    (0.05, (0.3, 0.0, 0.0), 0.0, 0.1), (0.05, (0.5, -0.2, 0.0), -2.0, 0.4),
    (-0.05, (0.5, 0.0, 0.5), -1.0, 0.4)])
def test_it_stops_where_the_plant_has_the_least_cost(offset, goal, curvature, tolerance):
    """Within a tenth of a second, and some more on long arcs that are sampled coarsely."""
    decision = law_at(offset, goal).stop(curvature, HORIZON, 0.0)
    distances, costs = scanned_costs(offset, goal, curvature)
    cost = np.interp(decision.stopping_distance, distances, costs)
    assert cost - costs.min() < tolerance
    # Neither to stop at once nor to go on for ever comes near.
    assert min(costs[0], costs[-1]) > costs.min() + tolerance


def test_beside_a_wall_it_knows_that_the_object_does_not_turn():
    """The robot is beside the middle of the face: on open floor it would have to stop early."""
    walls, offset, goal = (Wall(-3.0, 0.2, 3.0, 0.2),), -0.05, (0.3, 0.0, 0.0)
    decision = law_at(offset, goal, walls).stop(0.0, HORIZON, 0.0)
    distances, costs = scanned_costs(offset, goal, 0.0, walls=walls)
    expected = np.interp(decision.stopping_distance, distances, costs)
    assert decision.cost == pytest.approx(expected, abs=0.05)
    on_open_floor = law_at(offset, goal).stop(0.0, HORIZON, 0.0)
    assert on_open_floor.cost > decision.cost + 2.0
    assert on_open_floor.stopping_distance < decision.stopping_distance - 0.05


def test_at_the_goal_it_stops_at_once():
    """Whatever the arc, any further push leads away."""
    for curvature in (0.0, 1.0):
        decision = law_at(0.05, (0.0, 0.0, 0.0)).stop(curvature, HORIZON, 0.0)
        assert decision.stopping_distance < 2e-3 and decision.cost < 0.1


@pytest.mark.parametrize('goal', [(0.3, 0.1, 0.0), (0.3, -0.1, 0.2), (0.6, 0.0, -0.3)])
@pytest.mark.parametrize('offset', [0.0, 0.08])
def test_the_mirrored_push_is_steered_mirrored(offset, goal):
    """As much to the other side, as far, and in the same time."""
    one = law_at(offset, goal).steer(0.0, 0.0, HORIZON, 0.0)
    two = law_at(-offset, np.multiply(goal, (1.0, -1.0, -1.0))).steer(0.0, 0.0, HORIZON, 0.0)
    assert one.curvature == -two.curvature
    assert one.stopping_distance == pytest.approx(two.stopping_distance)
    assert one.cost == pytest.approx(two.cost)


@pytest.mark.parametrize('distance', [0.1, 0.3, 0.6])
def test_straight_ahead_needs_no_curvature(distance):
    """Nor does it stop far from the goal."""
    decision = law_at(0.0, (distance, 0.0, 0.0)).steer(0.0, 0.0, HORIZON, 0.0)
    assert decision.curvature == 0.0
    assert decision.stopping_distance == pytest.approx(distance, abs=0.03)


@pytest.mark.parametrize('distance', [0.3, 0.6])
def test_it_steers_to_the_side_of_the_goal(distance):
    """And the more the further aside the goal is; to turn the object, the other way round."""
    asides, turns = (-0.1, -0.05, 0.0, 0.05, 0.1), (-0.4, -0.2, 0.0, 0.2, 0.4)
    to_side = [law_at(0.0, (distance, aside, 0.0)).steer(0.0, 0.0, HORIZON, 0.0).curvature
               for aside in asides]
    to_turn = [law_at(0.0, (distance, 0.0, turn)).steer(0.0, 0.0, HORIZON, 0.0).curvature
               for turn in turns]
    assert to_side == sorted(to_side) and to_side[0] < 0.0 < to_side[-1]
    assert to_turn == sorted(to_turn, reverse=True) and to_turn[-1] < 0.0 < to_turn[0]


def test_what_it_chooses_is_no_worse_than_any_arc():
    """Its expected time is the least of those that keep one curvature, or go on straight."""
    law = law_at(0.08, (0.5, -0.1, -0.2))
    chosen = law.steer(0.3, -0.7, HORIZON, 0.0)
    for curvature in (*CURVATURES, 0.3, -0.7):
        change = 0.04 * abs(curvature - 0.3)
        assert chosen.cost <= law.stop(curvature, HORIZON, 0.0).cost + change + 1e-9


def test_rollouts_leave_the_members_as_they_were():
    """They are made on copies."""
    members = members_at(0.08)
    before = members.states.copy()
    law = RolloutLaw(members, symmetric_cost(), FACE, Pose(0.5, -0.1, -0.2), SPEED)
    law.steer(0.0, 1.0, HORIZON, 0.0)
    law.stop(1.0, HORIZON, 0.0)
    assert np.array_equal(members.states, before)
