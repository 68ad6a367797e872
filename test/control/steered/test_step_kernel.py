"""Prediction of a control step: against the integrated dynamics, and as plain Python."""

from helpers.contact_sites import arc_trajectory, FACE, VERTEX
from helpers.objects import box
import numpy as np
from push_control.settings import ControlSettings
from push_control.steered import step_kernel
from push_control.steered.contact_model import ContactModel
from push_control.steered.estimation.contact_site import initial_contact_site, SITE_SIZE
from push_control.steered.estimation.filter_kernel import (
    C_SQUARED, LAST, LATEST, MEMORY_SIZE, STATE, WALK)
from push_control.steered.estimation.push_motion import MotionState
from push_control.steered.monitors import STEERABLE
from push_control.steered.path.guidance import Guidance
from push_control.steered.path.path import SampledPath
from push_dynamics.compiled import interpreted
from push_model.geometry import Pose
from push_model.parameters import RoundRobot
from push_model.signals import Twist
from push_sim_node.plant import Plant
import pytest

SETTINGS = ControlSettings()
OBJECT = box(foot=0.18)
LAG = 0.25
SITES = {'differential': VERTEX, 'holonomic': FACE}
SPEED = 0.1


def pushing_plant(drive, target):
    """Return a plant in which the robot has pushed for a second, straight on."""
    robot = RoundRobot(radius=0.17, drive=drive, time_constant=LAG, max_acceleration=5.0)
    poses = (Pose(*rows[0].tolist()) for rows in (target.object_poses, target.robot_poses))
    plant = Plant(OBJECT, robot, *poses)
    heading = target.contact_poses[0, 2] - target.robot_poses[0, 2]
    ahead = Twist(*Pose(0.0, 0.0, heading).rotate((SPEED, 0.0)), 0.0)
    plant.advance(1.0, ahead if drive == 'holonomic' else Twist(SPEED))
    return plant


def looked_at(plant, target):
    """Model the contact, from what is so in the plant; return the model and its next look."""
    model = ContactModel(OBJECT, plant.robot, SETTINGS, target)
    model.aim(Pose(*target.object_poses[-1].tolist()))
    memory = np.zeros(MEMORY_SIZE)
    memory[:SITE_SIZE] = initial_contact_site(OBJECT, plant.robot, target).values
    memory[C_SQUARED:LAST] = model.motion.supports.values
    memory[LAST + 1:STATE] = plant.robot_twist
    memory[LATEST:WALK] = MotionState(*plant.object_pose, plant.robot_pose.theta, *model.center)
    guidance = Guidance(SampledPath(model.nominal, target), SETTINGS)

    def look():
        model.look(memory, 0.0, guidance)

    look()
    return model, look


@pytest.mark.parametrize('speed', [0.02, 0.15])
@pytest.mark.parametrize('curvature', [-0.15, 0.15])
@pytest.mark.parametrize('drive', sorted(SITES))
def test_the_push_is_foreseen_one_drive_lag_ahead(drive, curvature, speed):
    """Where the integrated dynamics bring object and robot under the command that was sent."""
    target = arc_trajectory(OBJECT, SITES[drive], 0.05, 1.0)
    plant = pushing_plant(drive, target)
    start = plant.object_pose
    model, look = looked_at(plant, target)
    command, mode = model.command(curvature, speed)
    assert mode == STEERABLE
    look()
    plant.advance(LAG, command)
    moved = np.hypot(*np.subtract(plant.object_pose[:2], start[:2]))
    assert moved > 0.5 * min(SPEED, speed) * LAG
    assert model.predicted.pose[:2] == pytest.approx(plant.object_pose[:2],
                                                     abs=0.04 * moved + 2e-4)
    assert model.predicted.theta == pytest.approx(plant.object_pose.theta, abs=5e-3)
    assert model.predicted.phi == pytest.approx(plant.robot_pose.theta, abs=1e-3)


@pytest.mark.parametrize('drive', sorted(SITES))
def test_plain_python_sees_and_commands_the_same(drive, monkeypatch):
    """But for rounding, with loads that a push shifts and without."""
    target = arc_trajectory(OBJECT, SITES[drive], 0.05, 1.0)
    plant = pushing_plant(drive, target)

    def outcome():
        model, look = looked_at(plant, target)
        command, mode = model.command(0.1, 0.05)
        look()
        return np.concatenate([
            model.predicted, model.flat_output, model.flat_output_now, model.limits_now,
            (model.zeta, model.zeta_rest), model.zeta_limits, command, (mode,)])

    compiled = outcome()
    for name in ('look', 'write_command'):
        monkeypatch.setattr(step_kernel, name, interpreted(getattr(step_kernel, name)))
    np.testing.assert_allclose(outcome(), compiled, rtol=1e-9, atol=1e-12)
    assert np.all(np.isfinite(compiled))
