"""Beginnings and ends of contact: impact, separation, corners; and what rolling conserves."""

import math

from helpers.objects import bin_, box
from helpers.plant_reference import ramp_robot
import numpy as np
from push_model.contact import find_contact
from push_model.dynamics import impulse, ObjectTerms, State
from push_model.geometry import Pose, wrap_angle
from push_model.parameters import GRAVITY, RoundRobot
from push_model.signals import STOP, Twist
from push_sim_node.plant import Plant
from push_sim_node.truth import ContactMode
import pytest
from scipy.optimize import brentq

pytestmark = pytest.mark.physics
ORIGIN = Pose(0.0, 0.0, 0.0)
SUDDEN = {'max_speed': 2.0, 'max_acceleration': 100.0, 'time_constant': 0.0}


def hit(obj, offset, command, step=1e-5):
    """Drive at full speed into the object's left side; return the truth just after impact."""
    robot = RoundRobot(0.17, 'holonomic', **SUDDEN)
    plant = Plant(obj, robot, ORIGIN, Pose(-0.47, offset, 0.0), step)
    assert plant.truth(0.0).mode is ContactMode.SEPARATE
    while plant.truth(0.0).mode is ContactMode.SEPARATE:
        plant.advance(2 * step, command)
    return plant.truth(0.0)


@pytest.mark.parametrize('obj, offset', [
    (box(contact_friction_coefficient=2.0, center_of_mass=(0.02, -0.03)), 0.05),
    (box(contact_friction_coefficient=2.0), -0.12), (bin_(), 0.03)])
def test_first_impact_gives_the_impulse_of_the_model(obj, offset):
    command = Twist(0.5, 0.1, 0.0)
    truth = hit(obj, offset, command)
    state = State(0.0, 0.0, 0.0, 0.0, truth.normal, *truth.contact_point)
    d_omega, j_n, j_t = (float(v) for v in impulse(ObjectTerms.of(obj), state, 0.5, 0.1))
    assert truth.mode is ContactMode.STICK and abs(j_t) < obj.contact_friction_coefficient * j_n
    assert abs(d_omega) > 0.1
    assert truth.object_twist.omega == pytest.approx(d_omega, rel=1e-3)
    assert momentum(obj, truth) == pytest.approx([j_n, j_t], rel=1e-2, abs=1e-3)


def momentum(obj, truth):
    """Return the object's momentum along normal and tangent [N s]."""
    v_x, v_y, omega = truth.object_twist
    x, y = Pose(0.0, 0.0, truth.object_pose.theta).rotate(obj.center_of_mass)
    return Pose(0.0, 0.0, -truth.normal).rotate((obj.mass * (v_x - omega * y),
                                                 obj.mass * (v_y + omega * x)))


@pytest.mark.parametrize('side', [1.0, -1.0])
def test_impact_outside_the_cone_acts_along_its_edge(side):
    obj = box(contact_friction_coefficient=0.2)
    truth = hit(obj, -0.08 * side, Twist(0.5, 0.4 * side, 0.0))
    j_n, j_t = momentum(obj, truth)
    assert truth.mode is (ContactMode.SLIDE_LEFT if side > 0.0 else ContactMode.SLIDE_RIGHT)
    assert j_n > 0.1
    assert j_t == pytest.approx(0.2 * side * j_n, rel=1e-3)


def test_impact_takes_the_energy_of_an_inelastic_blow():
    """A robot that does not yield spends m v^2, of which half moves the object."""
    energy = hit(box(), 0.0, Twist(0.5, 0.0, 0.0)).energy
    assert energy.kinetic == pytest.approx(0.5 * 2.0 * 0.5 ** 2, rel=1e-2)
    assert energy.contact_loss + energy.impact_loss == pytest.approx(energy.kinetic, rel=1e-2)
    assert energy.integration_loss < 1e-2 * energy.impact_loss


def test_object_coasts_when_the_robot_brakes_and_is_caught_again():
    robot = RoundRobot(0.17, 'differential', **SUDDEN)
    plant = Plant(box(), robot, ORIGIN, Pose(-0.37, 0.0, 0.0), 1e-4)
    plant.advance(0.5, Twist(1.0, 0.0, 0.0))
    assert plant.truth(0.0).mode is ContactMode.STICK
    assert plant.truth(0.0).gap == pytest.approx(0.0, abs=1e-9)
    plant.advance(1.0, STOP)
    truth = plant.truth(0.0)
    assert truth.mode is ContactMode.SEPARATE
    coast, brake = 1.0 / (2.0 * 0.3 * GRAVITY), 1.0 / (2.0 * 100.0)
    assert truth.gap == pytest.approx(coast - brake, rel=1e-3)
    plant.advance(truth.gap / 0.2 + 0.1, Twist(0.2, 0.0, 0.0))
    truth = plant.truth(0.0)
    assert truth.mode is ContactMode.STICK and truth.gap == pytest.approx(0.0, abs=1e-9)
    assert truth.object_twist.v_x == pytest.approx(0.2, abs=1e-6)
    assert truth.force_n == pytest.approx(2.0 * GRAVITY * 0.3, rel=1e-3)


@pytest.mark.parametrize('radius', [0.17, 0.5])
def test_rolling_on_a_face_conserves_offset_and_angle(radius):
    """The offset plus R_p times (robot heading - object orientation) stays."""
    obj, robot = box(contact_friction_coefficient=5.0), ramp_robot(radius, 'differential')
    plant = Plant(obj, robot, ORIGIN, Pose(-0.2 - radius, 0.01, 0.1))
    conserved, rotations = [], []
    for i in range(20):
        plant.advance(0.1, Twist(0.25, 0.0, 0.3 * math.cos(i)))
        truth = plant.truth(0.0)
        assert truth.mode is ContactMode.STICK
        contact, _, _ = find_contact(obj, truth.object_pose, truth.robot_pose[:2], radius)
        assert contact.kind == 'face'
        rotations.append(truth.robot_pose.theta - truth.object_pose.theta)
        conserved.append(contact.offset + radius * rotations[-1])
    assert np.ptp(rotations) > 0.02
    assert np.ptp(conserved) < 2e-6


def test_running_round_a_corner_is_smooth():
    obj, robot = box(contact_friction_coefficient=0.1), ramp_robot(0.17)
    plant = Plant(obj, robot, ORIGIN, Pose(-0.37, 0.12, 0.0))
    kinds, normals, gaps, moves = [], [], [], []
    pose = plant.object_pose
    for _ in range(1000):
        plant.advance(2e-3, Twist(0.15, 0.25, 0.0))
        truth = plant.truth(0.0)
        moves.append(math.hypot(truth.object_pose.x - pose.x, truth.object_pose.y - pose.y))
        pose = truth.object_pose
        if truth.mode is ContactMode.SEPARATE:
            continue
        kinds.append(find_contact(obj, pose, truth.robot_pose[:2], 0.17)[0].kind)
        normals.append(wrap_angle(truth.normal - pose.theta))
        gaps.append(truth.gap)
    assert kinds.count('face') > 100 and kinds.count('vertex') > 100
    assert normals[-1] < -0.3 and np.abs(np.diff(normals)).max() < 5e-3
    assert np.abs(gaps).max() < 1e-6
    assert max(moves) < 2e-3 * math.hypot(0.15, 0.25)


def tilts(radius, seconds):
    """Push straight along a face's normal, 5 mm off centre; return the tilt every second."""
    obj, robot = box(contact_friction_coefficient=5.0), ramp_robot(radius)
    plant = Plant(obj, robot, ORIGIN, Pose(-0.2 - radius, 0.005, 0.0))
    angles = []
    for _ in range(seconds):
        plant.advance(1.0, Twist(0.5, 0.0, 0.0))
        angles.append(plant.object_pose.theta)
    return np.array(angles)


def test_straight_push_grows_unstable_with_a_narrow_robot():
    """The friction centre is farther from the face than the effective radius."""
    rotations = np.diff(tilts(0.17, 5))
    assert (rotations < 0.0).all() and (np.diff(rotations) < 0.0).all()


def test_straight_push_settles_at_the_equilibrium_with_a_wide_robot():
    """There the friction centre is straight ahead of the contact, which has rolled aside."""
    settled = tilts(0.24, 60)
    tilt = brentq(lambda rho: 0.24 * rho - 0.2 * math.tan(rho) - 0.005, 0.01, 0.2)
    assert tilt == pytest.approx(0.005 / (0.24 - 0.2), rel=0.05)
    assert settled[-1] == pytest.approx(-tilt, rel=1e-4)


def test_spin_of_a_pushing_robot_drags_the_object_along():
    ends = []
    for omega in (-1.0, 0.0, 1.0):
        plant = Plant(bin_(), ramp_robot(0.17), ORIGIN, Pose(-0.37, 0.0, 0.0))
        plant.advance(0.5, Twist(0.2, 0.0, 0.0))
        plant.advance(0.2, Twist(0.2, 0.0, omega))
        ends.append(plant.truth(0.0))
    assert ends[0].force_t < -1.0 and ends[2].force_t > 1.0
    assert ends[0].object_pose.theta > 0.05 and ends[2].object_pose.theta < -0.05
    assert ends[1].force_t == pytest.approx(0.0, abs=1e-9)


def test_overlap_is_moved_back_or_refused():
    robot = ramp_robot(0.17)
    plant = Plant(box(), robot, ORIGIN, Pose(-0.368, 0.05, 0.3))
    assert plant.robot_pose == pytest.approx((-0.37, 0.05, 0.3))
    plant.advance(1.0)
    assert plant.object_pose == ORIGIN
    with pytest.raises(ValueError, match=r'robot_pose: .* overlap .* 0\.07 m'):
        Plant(box(), robot, ORIGIN, Pose(-0.3, 0.0, 0.0))
    with pytest.raises(ValueError, match='object_pose'):
        Plant(box(), robot, Pose(math.nan, 0.0, 0.0), Pose(-0.5, 0.0, 0.0))


def creeping(creep, speed=0.1, friction=0.6):
    """Push 0.3 m straight at a face beside its middle; return plant, slip and load by distance."""
    obj, robot = box(contact_friction_coefficient=friction), ramp_robot(0.17)
    plant = Plant(obj, robot, ORIGIN, Pose(-0.37, 0.08, 0.0), 1e-3, creep=creep)
    slips = loads = 0.0
    before = plant.truth(0.0)
    for _ in range(int(0.3 / speed / 0.01)):
        plant.advance(0.01, Twist(speed, 0.0, 0.0))
        truth = plant.truth(0.0)
        # The contact rolls R_p (robot - object heading) along the face; the rest is slip.
        found = [find_contact(obj, sample.object_pose, sample.robot_pose[:2], 0.17)[0].offset
                 for sample in (before, truth)]
        rolled = 0.17 * (truth.object_pose.theta - before.object_pose.theta)
        slips += found[1] - found[0] - rolled
        loads += 0.01 * speed * truth.force_t / (friction * truth.force_n)
        before = truth
    return plant, slips, loads


def test_a_contact_that_creeps_slips_with_distance_and_load():
    """As much as creep times the distance, weighted with the load; at any speed."""
    plant, slip, load = creeping(0.02)
    assert plant.mode is ContactMode.STICK
    assert abs(load) > 0.02
    assert abs(slip) == pytest.approx(0.02 * abs(load), rel=0.03)
    _, slow_slip, slow_load = creeping(0.02, 0.05)
    assert abs(slow_slip) == pytest.approx(0.02 * abs(slow_load), rel=0.03)
    _, stuck, _ = creeping(0.0)
    assert abs(stuck) < 1e-5 < 1e-4 < abs(slip)


def test_the_energy_of_creep_is_lost_at_the_contact():
    """The balance stays exact."""
    energies = [creeping(creep)[0].energy for creep in (0.0, 0.02)]
    for energy in energies:
        assert energy.work == pytest.approx(sum(energy[1:]))
    assert abs(energies[0].contact_loss) < 1e-6 < 1e-4 < energies[1].contact_loss


@pytest.mark.parametrize('obj', [box(contact_friction_coefficient=0.0),
                                 bin_(contact_friction_coefficient=0.0)])
def test_a_contact_without_friction_only_presses(obj):
    """Nothing drags the object along the contact, and after the impact nothing is lost there."""
    plant = Plant(obj, ramp_robot(0.17), ORIGIN, Pose(-0.37, 0.05, 0.2), creep=0.02)
    losses = []
    for _ in range(50):
        plant.advance(0.02, Twist(0.2, 0.05, 0.3))
        truth = plant.truth(0.0)
        assert truth.force_t == 0.0
        losses.append(truth.energy.contact_loss)
    assert np.ptp(losses[10:]) < 1e-3 * truth.energy.work
    assert truth.energy.work > 0.1 and plant.unsolved_steps == 0
