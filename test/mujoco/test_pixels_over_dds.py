"""A task from pixels to wheels over DDS: simulator in MuJoCo, detector, planner, controller."""

import dataclasses

from helpers.extras import import_extra, skip_without_graphics
from push_ros.topics import SIM, TAG_DETECTOR
from push_scenario.dds.replay import NodeStart, run_over_dds
from push_scenario.definition.placement import Placement
from push_scenario.definition.scenario import Start
from push_scenario.simulation.result import Outcome
import pytest

import_extra('cv2', 'vision')
cases = import_extra('mujoco', 'mujoco', 'benchmarks.pixels.cases')
pytestmark = [pytest.mark.dds, pytest.mark.slow]
# A lens in the room so near that small images show the tags.
NEAR_LENS = dataclasses.replace(cases.ROOM_LENS, x=0.0, y=-1.2, z=1.1)


def nodes_of(view) -> dict[str, NodeStart]:
    """Start the simulator with a camera, and the detector that knows where that is."""
    camera = NEAR_LENS if view == 'room' else cases.camera_of(view)
    lens, tags = (camera.x, camera.y, camera.z, camera.heading, camera.pitch), 'box_04'
    return {
        SIM: NodeStart('push_mujoco.mujoco_node', {
            'mujoco.tags': tags, 'mujoco.image_rate': cases.RATE, 'mujoco.image_width': 320,
            'mujoco.image_height': 240, 'mujoco.publish_object_pose': False,
            **({'mujoco.room_camera': list(lens)} if view == 'room' else {})}),
        TAG_DETECTOR: NodeStart('push_tags.tag_detector_node', {
            'tags': tags, 'object_pose_with_covariance': False,
            'pose_frame': 'odom' if view == 'room' else 'base_link',
            **dict(zip(('camera.x', 'camera.y', 'camera.z', 'camera.yaw', 'camera.pitch'),
                       lens))})}


@pytest.mark.parametrize('view', cases.VIEWS)
def test_an_object_that_only_images_show_is_pushed_to_its_goal(view, tmp_path) -> None:
    """Truly: within what the drift of the wheels leaves of the tolerance."""
    skip_without_graphics()
    drawn, tolerance = cases.draw_scenario(view, 0), cases.TOLERANCES['robot']
    supervision = dataclasses.replace(drawn.task.supervision,
                                      position_tolerance=tolerance.position,
                                      heading_tolerance=tolerance.heading)
    scenario = dataclasses.replace(
        drawn, name='pixels', goal=Placement(0.1, 0.0, 0.0),
        start=Start(robot=Placement(-0.6, 0.0, 0.0)), time_limit=60.0,
        task=dataclasses.replace(drawn.task, supervision=supervision))
    result = run_over_dds(scenario, None, tmp_path, real_time=True, record=False,
                          nodes=nodes_of(view))
    assert result.outcome is Outcome.DONE, result.reason
    assert result.pushes >= 1
    assert abs(result.position_error) <= 2.0 * tolerance.position
