"""A push that has gone astray goes on with a new plan from where it is."""

import dataclasses
import math

from push_model.events import PushEvent
from push_scenario.definition.catalogue import find_scenario
from push_scenario.definition.loader import read_scenario
from push_scenario.simulation.loop import simulate
from push_scenario.simulation.result import Outcome
from push_sim_node.disturbance import FrictionChange
import pytest

# Two whole runs for each law.
pytestmark = pytest.mark.slow
# How far the truth may be off the estimate at the end of a push: 95 of 100 are nearer [m].
ESTIMATE = 0.008


def astray(law, limit):
    """Let one foot catch shortly before the goal, with no further approach of its own."""
    demo = read_scenario(find_scenario('corner_push_mismatch'))
    caught = (FrictionChange(13.0, 20.0, 3.0, 1),)
    # Floor for the round that the new plan takes, which is wider than the default.
    control = dataclasses.replace(demo.control, max_reapproaches=0, max_replan_requests=limit,
                                  max_path_deviation=5.0)
    return simulate(dataclasses.replace(
        demo, time_limit=200.0, control=control,
        simulation=dataclasses.replace(demo.simulation, friction_changes=caught)), law)


@pytest.mark.parametrize('law', ['feedback', 'mpc'])
def test_a_new_plan_brings_a_push_that_went_astray_to_its_goal(law):
    """Without one it ends beside the goal; with one at the goal, on the tape of one run."""
    alone, helped = astray(law, 0), astray(law, 1)
    assert alone.outcome is Outcome.FAILED and PushEvent.GOAL_MISSED in alone.codes
    assert helped.outcome is Outcome.DONE
    assert helped.tape['time'][-1] > alone.tape['time'][-1] + 10.0
    goal = helped.scenario.goal
    last = {name: helped.tape[f'object_{name}'][-1] for name in ('x', 'y', 'theta')}
    # It is the estimate that is within the tolerance.
    off = math.dist((last['x'], last['y']), (goal.x, goal.y))
    assert off < helped.scenario.control.position_tolerance + ESTIMATE
    assert abs(math.remainder(last['theta'] - goal.theta, 2.0 * math.pi)) < math.radians(3.0)
