'use strict';
// What the camera sees of the floor, and how well the robot knows where the object is.

// Half the length of the sign of a camera, in pixels.
const CAMERA_SIZE = 11;

// Pose of the camera: on the robot, or fixed in the room.
function cameraPose(camera, robot) {
  if (camera.place === 'room') return camera.mount;
  return [...transform(robot, camera.mount), robot[2] + camera.mount[2]];
}

// Whether the camera sees the object; where nobody says so, it does.
function isSeen(values) { return values('object_seen') !== 0; }

// The floor that the camera sees, between its nearest and farthest distance; dashed while it does not see the object.
function drawView(pen, camera, pose, isObjectSeen) {
  const c = pen.context, { scale, width, height } = pen.camera, [x, y] = pen.camera.toScreen(pose);
  // Farther than this nothing is on the screen.
  const end = Math.hypot(x, y) + Math.hypot(x - width, y - height) + width + height;
  const far = Math.min(scale * camera.farthest, end), near = Math.min(scale * camera.nearest, far);
  const left = -pose[2] - camera.half_angle, right = -pose[2] + camera.half_angle;
  const isRound = camera.half_angle > 3.14;
  c.beginPath();
  c.arc(x, y, far, left, right);
  if (isRound) c.closePath();
  if (isRound && near) c.moveTo(x + near * Math.cos(right), y + near * Math.sin(right));
  if (near || !isRound) c.arc(x, y, near, right, left, true);
  c.closePath();
  c.globalAlpha = isObjectSeen ? 0.13 : 0.05;
  c.fillStyle = pen.colors.view;
  c.fill();
  c.globalAlpha = 1;
  c.setLineDash(isObjectSeen ? [] : [5, 5]);
  c.lineWidth = 1.3;
  c.strokeStyle = pen.colors.view;
  c.stroke();
  c.setLineDash([]);
}

// A camera: a triangle that opens in the direction in which it looks.
function drawCameraSign(pen, pose) {
  const size = CAMERA_SIZE / pen.camera.scale;
  const corners = [[-0.3 * size, 0], [size, 0.8 * size], [size, -0.8 * size]];
  pen.shape(corners.map((corner) => transform(pose, corner)), { fill: pen.colors.view, stroke: pen.colors.paper, width: 1.5 });
}

// An ellipse of two standard deviations.
function drawEllipse(pen, point, major, minor, angle, style) {
  const c = pen.context, [x, y] = pen.camera.toScreen(point), { scale } = pen.camera;
  c.beginPath();
  c.ellipse(x, y, 2 * major * scale, 2 * minor * scale, -angle, 0, 2 * Math.PI);
  if (style.fill) {
    c.globalAlpha = style.alpha;
    c.fillStyle = style.fill;
    c.fill();
    c.globalAlpha = 1;
  }
  c.lineWidth = style.width;
  c.strokeStyle = style.stroke;
  c.stroke();
}
