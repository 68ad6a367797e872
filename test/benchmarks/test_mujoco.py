"""The plant against MuJoCo, an engine that shares neither code nor contact law with it."""

import dataclasses
import math
import statistics
from typing import Any

from benchmarks.chances.runs import push_plant
from helpers.extras import import_extra
from push_model.geometry import Pose
from push_model.signals import STOP
from push_sim_node.plant import Plant
import pytest

comparison = import_extra('mujoco', 'mujoco', 'benchmarks.plant.comparison')
MujocoPlant = import_extra('mujoco', 'mujoco', 'push_mujoco.velocity_robot').MujocoPlant
by_mujoco, by_plant = comparison.by_mujoco, comparison.by_plant
pose_difference, PUSHES = comparison.pose_difference, comparison.PUSHES
DEFAULT, HARD, TUNED = comparison.DEFAULT, comparison.HARD, comparison.TUNED
pytestmark = [pytest.mark.physics, pytest.mark.slow]
QUICK = dataclasses.replace(TUNED, step=1e-3)
# Speed below which MuJoCo shifts the loads of the feet too little to matter [m/s].
SLOW = 0.11


def difference(push, engine):
    """Return distance [mm] and angle [deg] between both engines at the end of a push."""
    distance, angle = pose_difference(by_mujoco(push, engine)[-1], by_plant(push)[0][-1])
    return 1e3 * distance, math.degrees(angle)


def steady(push):
    """Tell whether the push is one that both engines must agree on closely."""
    return math.hypot(*push.speed) < SLOW and not push.spin and push.grip >= 0.5


@pytest.mark.parametrize('push', [push for push in PUSHES if steady(push)])
def test_slow_sticking_pushes_agree_closely(push):
    distance, angle = difference(push, QUICK)
    assert distance < 0.8 and angle < 0.15


@pytest.mark.parametrize('push', [push for push in PUSHES if not steady(push)])
def test_fast_spinning_and_sliding_pushes_agree(push):
    distance, angle = difference(push, QUICK)
    assert distance < 3.0 and angle < 0.8


@pytest.mark.parametrize('push', comparison.RAISED[2::3], ids=lambda push: push.kind)
def test_pushes_above_the_floor_agree(push):
    """Loads shift in both; without that the plant would be several degrees off."""
    distance, angle = difference(push, QUICK)
    assert distance < 1.5 and angle < 0.1
    flat = dataclasses.replace(push, contact_height=0.0, center_of_mass_height=0.0)
    shift = pose_difference(by_plant(flat)[0][-1], by_plant(push)[0][-1])
    assert push.kind == 'uneven box' or math.degrees(shift.angle) > 0.4


@pytest.mark.parametrize('push', comparison.AT_WALLS)
def test_pushes_at_walls_agree(push):
    """Walls move the ends by centimetres, and by as much in both."""
    distance, angle = difference(push, QUICK)
    assert distance < 3.0 and angle < 0.8
    free = dataclasses.replace(push, room=comparison.Room())
    assert pose_difference(by_plant(free)[0][-1], by_plant(push)[0][-1]).distance > 0.01


@pytest.mark.parametrize('change, push', [
    ({'grip': 0.24}, PUSHES[22]), ({'kind': 'uneven box'}, PUSHES[4]), ({'mass': 3.0}, PUSHES[9]),
    ({'offset': 0.025}, PUSHES[1]), ({'kind': 'three feet'}, PUSHES[2])])
def test_comparison_tells_laws_apart(change, push):
    """Parameters of the model move the end by more than the bounds; mass alone does not."""
    poses, _ = by_plant(push)
    changed, _ = by_plant(dataclasses.replace(push, **change))
    distance = 1e3 * pose_difference(poses[-1], changed[-1]).distance
    assert distance < 0.01 if 'mass' in change else distance > 3.0


def coast(engine, push):
    """Push with a robot that brakes hard, let the object slide on; return its last two poses."""
    robot = dataclasses.replace(push.robot, max_acceleration=20.0)
    poses = []
    for seconds, command in ((0.5, push.command), (0.1, STOP), (1.0, STOP)):
        if not poses:
            plant = engine(push.object, robot, Pose(0.0, 0.0, 0.0), push.robot_pose())
        plant.advance(seconds, command)
        poses.append(plant.object_pose)
    return poses[1:]


@pytest.mark.parametrize('push', [comparison.Push('box', 2.0, 0.2, 0.5, 0.0, (1.0, 0.0)),
                                  comparison.Push('box', 2.0, 0.4, 0.5, 0.04, (1.0, 0.0)),
                                  comparison.Push('three feet', 2.0, 0.3, 0.5, -0.03, (0.7, 0.0)),
                                  comparison.Push('bin', 5.0, 0.3, 0.5, 0.02, (0.8, 0.0))])
def test_object_slides_on_as_far_in_both(push):
    plant = coast(Plant, push)
    mujoco = coast(lambda *scene: MujocoPlant(*scene, QUICK), push)
    distance, angle = pose_difference(plant[1], mujoco[1])
    assert plant[1].x - plant[0].x > 0.02
    assert distance < 2e-3 and math.degrees(angle) < 0.3


def test_difference_shrinks_as_contacts_are_made_harder_and_tuned():
    pushes = (PUSHES[5], PUSHES[9], PUSHES[13], PUSHES[17], PUSHES[19])
    default, hard, tuned = (statistics.median(difference(push, engine)[0] for push in pushes)
                            for engine in (DEFAULT, HARD, TUNED))
    assert default > 10.0 * hard > 10.0 * tuned


def test_difference_shrinks_as_the_contact_of_the_robot_yields_less():
    soft = [difference(PUSHES[18], dataclasses.replace(QUICK, bumper_impedance=(stiff, stiff)))[0]
            for stiff in (0.9, 0.99, 0.999)]
    assert soft[0] > 4.0 * soft[1] > 16.0 * soft[2]


@pytest.mark.parametrize('changes, sinks', [
    ({}, False), ({'bumper_mass': 1e-3}, True),
    ({'bumper_mass': 1e-3, 'bumper_impedance': (0.9999, 0.9999)}, False)])
def test_a_light_bumper_sinks_into_the_object_unless_its_contact_is_stiff(
        changes: dict[str, Any], sinks: bool) -> None:
    """Contacts soften with the inverse masses of their bodies."""
    push = PUSHES[0]
    engine = dataclasses.replace(comparison.ELLIPTIC, **changes)
    plant = MujocoPlant(push.object, push.robot, Pose(0.0, 0.0, 0.0), push.robot_pose(), engine)
    plant.advance(0.2 / push.speed[0], push.command)
    center = plant.object_pose.inverse() @ plant.robot_pose
    gap = min(x for x, _ in push.object.outline) - center.x - push.robot.radius
    assert (gap < -1e-2) == sinks and (abs(gap) < 2e-3) != sinks


def test_difference_shrinks_as_the_push_slows_down():
    """Loads that depend on the speed of the feet are MuJoCo's; the effect vanishes with it."""
    angles = []
    for speed in (0.4, 0.2, 0.1, 0.05):
        push = comparison.Push('uneven box', 3.0, 0.3, 0.6, 0.02, (speed, 0.0), distance=0.4)
        angles.append(difference(push, dataclasses.replace(TUNED, step=5e-4))[1])
    assert angles[0] > 1.3 * angles[1] > 1.6 * angles[2] > 1.6 * angles[3]


@pytest.mark.parametrize('push', PUSHES[:3], ids=lambda push: f'{push.offset} m, {push.speed}')
def test_plant_of_steered_pushes_holds_the_contact_as_the_own_plant_does(push: Any) -> None:
    """The bumper must not rub upwards: the object would hop, and rotate by a degree in 0.1 m."""
    poses = []
    for plant_type in (Plant, push_plant(is_spatial=True)):
        plant = plant_type(push.object, push.robot, Pose(0.0, 0.0, 0.0), push.robot_pose())
        for _ in range(round(0.1 / push.speed[0] / 0.02)):
            plant.advance(0.02, push.command)
        poses.append(plant.object_pose)
    distance, angle = pose_difference(*poses)
    assert distance < 1e-4 and math.degrees(angle) < 0.03
