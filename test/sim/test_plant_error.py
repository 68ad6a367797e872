"""The plant's error over twelve scenes of about a metre, by its step."""

import statistics

from benchmarks.plant.scenes import apart, extrapolated, SCENES
from push_sim_node.truth import ContactMode
import pytest

pytestmark = [pytest.mark.physics, pytest.mark.slow]


@pytest.fixture(scope='module')
def references():
    """Return the ends of all scenes for ever finer steps, which halve and are extrapolated."""
    return [extrapolated(scene.end(scene.plant(4e-4)), scene.end(scene.plant(2e-4)))
            for scene in SCENES]


@pytest.mark.parametrize('step, most, median', [(1e-3, 5e-5, 1e-5), (2e-3, 1e-4, 2e-5),
                                                (5e-3, 2e-4, 5e-5), (1e-2, 3e-4, 1e-4)])
def test_error_of_the_step(references, step, most, median):
    errors = [apart(scene.end(scene.plant(step)), end)
              for scene, end in zip(SCENES, references)]
    assert max(errors) < most
    assert statistics.median(errors) < median


def test_scenes_meet_every_kind_of_contact():
    modes = set()
    for scene in SCENES:
        plant = scene.plant(2e-3)
        for seconds, command in scene.commands:
            for _ in range(4):
                plant.advance(seconds / 4, command)
                modes.add(plant.truth(0.0).mode)
    assert modes == {ContactMode.STICK, ContactMode.SLIDE_LEFT, ContactMode.SEPARATE}
