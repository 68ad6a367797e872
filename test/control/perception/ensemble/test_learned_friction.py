"""What was learned of an object in earlier tasks is where the filter starts from."""

from helpers.objects import box
from push_control.perception.ensemble.ensemble_state import OdometryNoise
from push_control.perception.ensemble.push_ensemble import PushEnsemble
from push_control.perception.object_knowledge import ObjectKnowledge
from push_control.settings import ControlSettings
from push_control.supervision_settings import SupervisionSettings
from push_control.task.supervisor import Supervisor
from push_model.friction import friction_center
from push_model.parameters import RoundRobot
from push_navigation.settings import DriveSettings
import pytest

KNOWN = ObjectKnowledge((0.02, -0.01), 0.003, 0.25, 0.03)


def same(found):
    """Compare with what was known; centres of members bend a little with their supports."""
    return (found.friction_center == pytest.approx(KNOWN.friction_center, abs=1e-4)
            and found.center_deviation == pytest.approx(KNOWN.center_deviation, abs=1e-4)
            and found.contact_friction == pytest.approx(KNOWN.contact_friction, abs=1e-6)
            and found.contact_friction_deviation == pytest.approx(
                KNOWN.contact_friction_deviation, abs=1e-6))


def test_the_ensemble_starts_from_what_was_known():
    """Its object pushes so, its members scatter so, and it yields the same again."""
    ensemble = PushEnsemble(box(), RoundRobot(radius=0.17), ControlSettings(),
                            OdometryNoise(0.02, 0.02, 0.003, 0.01))
    assert not same(ensemble.knowledge)
    ensemble.start_from(KNOWN)
    assert same(ensemble.knowledge)
    assert friction_center(ensemble.obj) == pytest.approx(KNOWN.friction_center, abs=1e-3)
    assert ensemble.obj.contact_friction_coefficient == pytest.approx(0.25)


def test_a_supervisor_hands_it_on():
    """From the task before to the task after."""
    arguments = (box(), RoundRobot(radius=0.17), ControlSettings(), DriveSettings(),
                 SupervisionSettings())
    assert same(Supervisor(*arguments, knowledge=KNOWN).perception.knowledge)
    assert not same(Supervisor(*arguments).perception.knowledge)
