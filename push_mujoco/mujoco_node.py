"""ROS node of the simulator in MuJoCo."""

import sys
from typing import Any

from push_model.optional import how_to_install
from push_ros.executor import run


def make_node() -> Any:
    """
    Make the node: the true object, a true robot on wheels, and their sensors.

    It is the simulator, with all its topics, services and parameters, but for several objects; the
    plant is MuJoCo's. Besides it publishes ``image_raw`` (rgb8) with ``camera_info``. Parameters
    besides: ``mujoco.*``.

    :raises SystemExit: where MuJoCo is not installed.
    """
    try:
        # Imported here: nodes are looked for, and described, without their extras.
        from push_mujoco.ros.engine_simulator import EngineSimulator
    except ModuleNotFoundError as error:
        raise SystemExit(f'mujoco_sim: {how_to_install(error.name) or error}') from error
    return EngineSimulator()


if __name__ == '__main__':
    sys.exit(run(make_node))
