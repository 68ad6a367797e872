"""Support friction that changes with time, and an object that is displaced."""

from helpers.objects import box
from push_model.geometry import Pose
from push_model.parameters import RoundRobot
from push_model.signals import Twist
from push_sim_node.disturbance import (
    change_times, friction_factors, FrictionChange, ObjectDisplacement,
)
from push_sim_node.simulation import Simulation, SimulationSettings
import pytest


def pushed(changes, seconds=2.0):
    """Push a box straight while friction changes; return the simulation."""
    sim = Simulation(box(), RoundRobot(0.17), Pose(0.0, 0.0, 0.0), Pose(-0.37, 0.0, 0.0),
                     SimulationSettings(friction_changes=changes))
    while sim.time < seconds:
        sim.next_measurement()
        sim.command(Twist(0.2, 0.0, 0.0))
    return sim


def column(sim, name):
    """Return a column of the tape."""
    return sim.tape[name]


def test_friction_change_acts_while_it_lasts():
    sim = pushed([FrictionChange(0.6, 1.1, 0.5)])
    times, force = column(sim, 'time'), column(sim, 'force_n')
    full = 2.0 * 9.81 * 0.3
    for begin, end, ratio in ((0.45, 0.6, 1.0), (0.64, 1.1, 0.5), (1.14, 1.4, 1.0)):
        inside = (times > begin) & (times <= end)
        assert force[inside] == pytest.approx(ratio * full, rel=0.03)


def test_friction_change_under_one_support_rotates_the_object():
    ends = []
    for support in (0, 3):
        sim = pushed([FrictionChange(0.0, 9.0, 3.0, support)])
        ends.append(sim.truth.object_pose.theta)
    assert ends[0] < -0.1 and ends[1] == pytest.approx(-ends[0], abs=1e-9)


def test_friction_changes_multiply_and_end():
    changes = (FrictionChange(1.0, 3.0, 0.5), FrictionChange(2.0, 4.0, 3.0, 1))
    assert change_times(changes) == [1.0, 2.0, 3.0, 4.0]
    assert friction_factors(changes, 0.9, 2) == (1.0, 1.0)
    assert friction_factors(changes, 1.0, 2) == (0.5, 0.5)
    assert friction_factors(changes, 2.0, 2) == (0.5, 1.5)
    assert friction_factors(changes, 3.0, 2) == (1.0, 3.0)
    assert friction_factors(changes, 4.0, 2) == (1.0, 1.0)


@pytest.mark.parametrize('shift', [-4e-10, -1e-10, 1e-10, 4e-10])
def test_friction_changes_between_two_nanoseconds_act_and_end(shift: float) -> None:
    """As those a billionth of a second later or earlier, which are times of the simulation."""
    changes = [FrictionChange(0.6 + shift, 1.1 + shift, 0.5)]
    exact = pushed([FrictionChange(0.6, 1.1, 0.5)], 1.4)
    assert column(pushed(changes, 1.4), 'force_n') == pytest.approx(column(exact, 'force_n'))


def test_malformed_friction_changes_are_refused():
    with pytest.raises(ValueError, match='FrictionChange.end'):
        FrictionChange(2.0, 1.0, 0.5)
    with pytest.raises(ValueError, match='FrictionChange.support: got 4'):
        pushed([FrictionChange(0.0, 1.0, 0.5, 4)])
    with pytest.raises(ValueError, match='friction_changes'):
        SimulationSettings(friction_changes=[1.0])


def displaced(object_displacements, robot=Pose(-1.0, 0.0, 0.0)):
    """Return a simulation of a box that a person moves while the robot stands."""
    return Simulation(box(), RoundRobot(0.17), Pose(1.0, 2.0, 0.5), robot,
                      SimulationSettings(object_displacements=object_displacements))


def test_displacements_are_in_the_frame_of_the_object():
    """Whatever their order in the list, at their times, one after the other, and again."""
    one, two = ObjectDisplacement(0.3, 0.2, -0.1, 0.4), ObjectDisplacement(0.6, 0.0, 0.3, -1.0)
    sim = displaced((two, one))
    ends = (Pose(1.0, 2.0, 0.5) @ one.relative_pose,
            Pose(1.0, 2.0, 0.5) @ one.relative_pose @ two.relative_pose)
    for _ in range(2):
        while sim.time < 0.9:
            sim.next_measurement()
            pose = sim.truth.object_pose
            if sim.time < 0.3:
                assert pose == pytest.approx((1.0, 2.0, 0.5), abs=1e-12)
            else:
                assert pose == pytest.approx(ends[sim.time >= 0.6], abs=1e-12)
        assert sim.truth.object_twist == (0.0, 0.0, 0.0)
        sim.reset()


def test_a_displacement_into_the_robot_is_refused_by_name():
    sim = displaced((ObjectDisplacement(0.5, -1.0),), Pose(1.0, 2.0, 0.5) @ Pose(-1.0, 0.1, 0.0))
    with pytest.raises(ValueError, match='object_displacements: at 0.5 s'):
        while sim.time < 1.0:
            sim.next_measurement()
    with pytest.raises(ValueError, match='object_displacements'):
        SimulationSettings(object_displacements=[0.5])
