"""Columns of random cases of pushes, for batches whose workers import them."""

import os
from pathlib import Path

from helpers.objects import box
import numpy as np
from push_model.geometry import FloatArray
from push_model.parameters import RoundRobot
from push_scenario.batch.varied_push import VariedPush

Columns = dict[str, FloatArray]
PUSH = VariedPush(box(), RoundRobot(0.17, 'holonomic'), (0.0, 0.0, 0.0), (-0.37, 0.0, 0.0),
                  ((0.1, 0.2, 0.0, 0.0), (0.1, 0.1, 0.1, 0.5)), step=5e-3)


def draw(rng: np.random.Generator, count: int) -> Columns:
    """Draw masses, frictions and starts."""
    start = np.tile(np.array(PUSH.robot_pose), (count, 1))
    start[:, 1:] = rng.uniform(-0.1, 0.1, (count, 2))
    return {'object.mass': rng.uniform(1.0, 5.0, count),
            'object.contact_friction_coefficient': rng.uniform(0.1, 0.8, count),
            'friction_factors': rng.uniform(0.5, 1.5, (count, 4)), 'robot_pose': start}


def draw_in(folder: str | Path, rng: np.random.Generator, count: int) -> Columns:
    """Draw the same, and note in a folder that a block has been drawn; break off at a flag."""
    drawn = draw(rng, count)
    if Path(folder, 'flag').exists() and len(os.listdir(folder)) > 3:
        raise KeyboardInterrupt
    Path(folder, f'{drawn["object.mass"][0]!r}').touch()
    return drawn
