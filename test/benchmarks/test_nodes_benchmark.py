"""Laws of the benchmark of nodes: what it pairs, and that it measures processes."""

import os
import time

from benchmarks.nodes import cpu_time, latencies
import numpy as np
import pytest


def test_each_pose_is_paired_with_the_command_that_answers_it():
    """Commands in between answer odometry; a pose without a command before the next has none."""
    poses = [1.0, 2.0, 3.0, 4.0]
    assert latencies(poses, [0.5, 1.25, 1.5, 3.5]) == [0.25, 0.5]
    assert latencies(poses, []) == []


@pytest.mark.parametrize('seed', range(3))
def test_the_latency_of_a_chain_is_its_delay(seed):
    """However poses and other commands fall, where the answer comes first."""
    rng = np.random.default_rng(seed)
    poses = np.cumsum(rng.uniform(0.04, 0.06, 50))
    delays = rng.uniform(0.001, 0.004, poses.size)
    others = poses + rng.uniform(0.005, 0.03, poses.size)
    commands = np.sort([*(poses + delays), *others])
    assert latencies(poses.tolist(), commands.tolist()) == pytest.approx(delays)


def test_the_time_of_a_process_grows_with_its_work():
    before = cpu_time(os.getpid())
    began = time.process_time()
    while time.process_time() < began + 0.05:
        pass
    # In ticks of the kernel, of 10 ms.
    assert cpu_time(os.getpid()) >= before + 0.03
