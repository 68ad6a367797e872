"""Two small rooms with a blocked door, three objects and a lidar on the robot."""

from push_scenario.tidying.room import Room, room_from_text

ROOM = """
description: two rooms, a bin in their door, a box that has to come through, a crate at its goal
robot: {file: holonomic_017.yaml}
start: {robot: {x: -0.75, y: 0.6}}
objects:
  crate: {object: {file: box_04.yaml}, start: {x: -1.5, y: -0.9}, goal: {x: -1.5, y: -0.9}}
  box: {object: {file: box_04.yaml}, start: {x: -0.75, y: 0.0}, goal: {x: 0.65, y: 0.0}}
  bin: {object: {file: bin.yaml}, start: {x: 0.0, y: 0.05}}
sensors:
  pose_noise: 0.001
  pose_heading_noise_deg: 0.2
  pose_latency: 0.08
  odometry_scale: 0.02
  odometry_heading_drift: 0.02
  lidar: {rate: 4.0, beams: 180}
time_limit: 200
task:
  place: {source: scan, mount: stated, start_position: 0.02, start_heading: 0.02}
  map:
    resolution: 0.05
    origin: {x: -2.05, y: -1.35}
    rows: |
"""
ENDS, SIDES = ['#' * 82], ['#' + '.' * 80 + '#']
BESIDE_DOOR = ['#' + '.' * 39 + '##' + '.' * 39 + '#']
ROWS = [*ENDS, *BESIDE_DOOR * 16, *SIDES * 20, *BESIDE_DOOR * 16, *ENDS]


def small_rooms() -> Room:
    """Return both rooms."""
    return room_from_text(ROOM + '\n'.join(8 * ' ' + row for row in ROWS), 'rooms')
