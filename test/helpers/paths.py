"""Paths that several tests drive along."""

import math
from typing import Any, Iterator, NamedTuple

import numpy as np
from push_dynamics.actuation import chord_velocity, track_command
from push_dynamics.layout import MAX_ACCELERATION, MAX_YAW_ACCELERATION, TIME_CONSTANT
from push_model.contact import find_contact
from push_model.geometry import FloatArray, Pose, wrap_angle
from push_model.parameters import PushedObject, RoundRobot
from push_navigation.path import differential_path, holonomic_path, Path
from push_navigation.path_follower import PathFollower
from push_navigation.settings import DriveSettings

# An arc to the left between straight lines, and a corner.
CURVE = [(1.0, 0.0, 0.0), (1.3, 0.3, 0.5 * math.pi), (1.3, 1.0, 0.0), (0.5, 1.5, 0.0)]


def curved_path(drive: str = 'differential', scale: float = 1.0) -> Path:
    """Return a path with an arc and a corner."""
    waypoints = [(scale * x, scale * y, arc_angle) for x, y, arc_angle in CURVE]
    start, goal = Pose(0.0, 0.0, 0.4), Pose(scale * 0.5, scale * 1.5, -2.0)
    if drive == 'holonomic':
        return holonomic_path(start, goal, waypoints)
    return differential_path(start, goal, waypoints, [False] * len(waypoints))


def approaches(obj: PushedObject, count: int, seed: int,
               radius: float = 0.17) -> Iterator[tuple[Pose, Pose, Pose]]:
    """Yield (object pose, robot in contact behind a push, pose at its next contact)."""
    rng = np.random.default_rng(seed)
    for _ in range(count):
        object_pose = Pose(*rng.uniform(-1.0, 1.0, 2), rng.uniform(-4.0, 4.0))
        places = []
        for spread in (0.05, 0.45):
            toward = rng.uniform(-math.pi, math.pi)
            far = Pose(object_pose.x + 3.0 * math.cos(toward),
                       object_pose.y + 3.0 * math.sin(toward), 0.0)
            _, normal, gap = find_contact(obj, object_pose, far, radius)
            places.append(Pose(far.x + gap * math.cos(normal), far.y + gap * math.sin(normal),
                               normal + rng.uniform(-spread, spread)))
        yield (object_pose, *places)


class DrivenApproach(NamedTuple):
    """
    Record of a robot that follows a path with the lag of its drive.

    :param follower: ``PathFollower``.
    :param poses: of the robot, shape (n, 3).
    :param time: that it took [s].
    :param aside: offset from the end of the path across the direction of motion [m].
    :param turned: difference from the heading there [rad].
    """

    follower: PathFollower
    poses: FloatArray
    time: float
    aside: float
    turned: float


def drive_along(path: Path, robot: RoundRobot, settings: DriveSettings, end_speed: float, *,
                lag: float | None = None, dt: float = 0.02, **options: Any) -> DrivenApproach:
    """Follow a path with the compiled actuation, until the follower has finished or missed."""
    follower = PathFollower(robot, settings, path, end_speed=end_speed, **options)
    drive = np.zeros(64)
    drive[TIME_CONSTANT] = robot.time_constant if lag is None else lag
    drive[MAX_ACCELERATION] = robot.max_acceleration
    drive[MAX_YAW_ACCELERATION] = robot.max_yaw_acceleration
    pose, moving, rows, elapsed = path.poses[0], (0.0, 0.0, 0.0), [], 0.0
    while len(rows) * dt < 60.0:
        command = follower.step(pose, elapsed)
        if follower.finished or follower.missed:
            break
        tracked = track_command(*moving, tuple(command), drive, dt)
        x, y = chord_velocity(pose.theta, tracked.mean_x, tracked.mean_y, tracked.mean_omega, dt)
        pose = Pose(pose.x + dt * x, pose.y + dt * y, pose.theta + dt * tracked.mean_omega)
        moving, elapsed = tuple(tracked)[:3], dt
        rows.append(pose)
    goal, direction = path.poses[-1], path.segments[-1].directions[1]
    _, aside = Pose(0.0, 0.0, -direction).rotate((pose.x - goal.x, pose.y - goal.y))
    return DrivenApproach(follower, np.array(rows), len(rows) * dt, aside,
                          wrap_angle(pose.theta - goal.theta))
