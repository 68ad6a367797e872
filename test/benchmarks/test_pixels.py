"""Tasks from pixels: what is detected in an image is where the object is."""

import math

from helpers.extras import import_extra, skip_without_graphics
import numpy as np
from push_model.geometry import distance, Pose, wrap_angle
import pytest

import_extra('cv2', 'vision')
cases = import_extra('mujoco', 'mujoco', 'benchmarks.pixels.cases')


@pytest.mark.parametrize('view', ['robot', 'room'])
def test_an_object_is_detected_within_what_the_detector_states(view) -> None:
    """And in an empty image there is none."""
    skip_without_graphics()
    from push_mujoco.rendering import render_camera, TaggedScene
    camera = cases.camera_of(view)
    layout = cases.read_tag_layout('box_04')
    detect = cases.tag_eye(camera, layout).detect
    scene = TaggedScene(cases.read_simulated_robot(cases.ROBOT), cases.read_object('box_04'),
                        cases.tag_pictures(layout))
    rng = np.random.default_rng(3)
    for heading in (0.4, -2.0):
        pose = Pose(0.8, 0.05, heading)
        image = render_camera(scene, camera, pose, Pose(0.0, 0.0, 0.0), noise=rng)
        detected = detect(0.0, image.mean(axis=2).astype(np.uint8))
        assert distance(detected.pose, pose) < min(
            0.01, 5.0 * math.sqrt(2.0) * detected.covariance.position_deviation)
        assert abs(wrap_angle(detected.pose.theta - heading)) < math.radians(2.0)
    assert detect(0.0, np.full((camera.height, camera.width), 128, dtype=np.uint8)) is None


def test_errors_in_images_are_as_large_as_stated() -> None:
    """From near, where tags err by where they are glued, to far, where their corners do."""
    skip_without_graphics()
    from benchmarks.pixels.tag_errors import measure
    for depth in (0.55, 1.2, 2.7):
        squares = measure(depth, 12, seed=5).squares
        assert len(squares) >= 9
        assert 0.7 < math.sqrt(np.mean(squares) / 3.0) < 1.3


def test_drawn_tasks_differ_by_their_seed_alone() -> None:
    first, again, other = (cases.draw_scenario('room', seed) for seed in (1, 1, 2))
    assert first == again
    assert first.goal != other.goal
    assert first.sensors.camera.place == 'room'
    places = [cases.draw_scenario('robot', seed).task.map is None for seed in range(4)]
    assert places == [kind.place == 'floor' for kind in cases.KINDS]


def test_records_are_read_as_they_were_written(tmp_path) -> None:
    """And their tasks are not run again; a row counts what is done and is not."""
    benchmark = import_extra('mujoco', 'mujoco', 'benchmarks.pixels.__main__')
    path = tmp_path / 'records.jsonl'
    assert benchmark.read_records(path) == []
    lines = ('{"view": "room", "seed": %s, "outcome": "DONE", "reason": "", "time": 20.0, '
             '"position_error": %s, "heading_error": 0.0}\n' % item
             for item in ((0, 0.004), (4, 0.012)))
    path.write_text(''.join(lines))
    endings = benchmark.read_records(path)
    assert [ending.is_within for ending in endings] == [True, False]
    assert '| 1 of 2 | 1 | 8.0, 12.0 mm | 20 s |' in benchmark.rows(endings)[0]
    assert benchmark.run_tasks(0, path, 1) == endings
