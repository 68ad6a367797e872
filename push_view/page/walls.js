'use strict';
// Walls as they are drawn: on a grid, along its axes, and one of them under the pointer.

// Walls begin and end on a grid of so many lines to a metre.
const GRID_LINES = 10;
// A wall that is this near to an axis runs along it [rad].
const NEARLY_STRAIGHT = Math.PI / 15;
const WALL_THICKNESS = 0.1;

function snapPoint(point) {
  return point.slice(0, 2).map((value) => Math.round(value * GRID_LINES) / GRID_LINES);
}

// The other end of a wall: on the grid, and along an axis where it nearly is.
function snapWallEnd(from, to) {
  const end = snapPoint(to), [dx, dy] = [to[0] - from[0], to[1] - from[1]];
  const angle = Math.atan2(Math.abs(dy), Math.abs(dx));
  if (angle < NEARLY_STRAIGHT) end[1] = from[1];
  if (angle > Math.PI / 2 - NEARLY_STRAIGHT) end[0] = from[0];
  return end;
}

function distanceToWall(wall, point) {
  const [x0, y0, x1, y1] = wall, [dx, dy] = [x1 - x0, y1 - y0];
  const squared = dx * dx + dy * dy;
  const part = squared ? Math.min(1, Math.max(0, ((point[0] - x0) * dx + (point[1] - y0) * dy) / squared)) : 0;
  return Math.hypot(point[0] - x0 - part * dx, point[1] - y0 - part * dy);
}

// Number of the wall at a point, the newest first; -1 where there is none. Margin in metres.
function wallAt(walls, point, margin) {
  return walls.findLastIndex((wall) => distanceToWall(wall, point) < 0.5 * WALL_THICKNESS + margin);
}
