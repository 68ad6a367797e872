'use strict';
// What is planned, as numbered ghosts of the object, and what stands against a plan.

const PLAN_STATES = ['approach', 'align', 'push'];
// Dashes of a ghost, of the robot's way to a push, and of the floor that is needed [pixels].
const GHOST_DASH = [4, 3], WAY_DASH = [2, 4], NEEDED_DASH = [6, 3];

// Goals and plans that are younger replace a plan or a refusal.
function drawPlanned(floor, recording, time, goal) {
  const plan = recording.latest('plan', time), state = recording.latest('state', time);
  const refusal = recording.latest('refusal', time), since = goal ? goal.time : -Infinity;
  if (refusal && refusal.time >= since && !(plan && plan.time > refusal.time)) {
    drawRefusal(floor, refusal, recording.scene.robot);
  } else if (plan && plan.time >= since && (!state || PLAN_STATES.includes(state.state))) {
    drawPlan(floor, recording, plan, state && state.state === 'push', time);
  }
}

// The push that is under way, or next, and those that follow.
function drawPlan(floor, recording, plan, isPushing, time) {
  const first = recording.pushes().filter((push) => push.start <= time).length - (isPushing ? 1 : 0);
  const pushes = [{ pose: plan.object[plan.object.length - 1], robot: plan.robot[0], approach: plan.approach }, ...plan.later];
  // In a room numbers are those of moves.
  const isNumbered = pushes.length > 1 && !recording.scene.objects;
  floor.line(plan.object, floor.colors.plan, 2, [7, 4]);
  let before = pushes[0].pose;
  pushes.forEach((push, i) => {
    const number = first + i, color = floor.colors[recording.pushColor(number, time)];
    if (!isPushing || i) {
      floor.line(push.approach, color, 1.2, WAY_DASH);
      if (push.robot) floor.drawRobot(push.robot, recording.scene.robot.radius, { stroke: color, width: 1, dash: GHOST_DASH });
    }
    if (i) floor.line([before, push.pose], color, 1.5, [7, 4]);
    floor.drawObject(push.pose, { stroke: color, width: 1.5, dash: GHOST_DASH });
    before = push.pose;
  });
  if (isNumbered) {
    pushes.forEach((push, i) => floor.label(String(first + i + 1), push.pose, floor.colors['push-' + (first + i) % PUSH_COLOR_COUNT]));
  }
}

function drawRefusal(floor, refusal, robot) {
  const { force, believed, ink, paper } = floor.colors, { place } = refusal;
  if (refusal.nearest) floor.drawObject(refusal.nearest, { stroke: ink, width: 1.5, dash: GHOST_DASH });
  if (refusal.overlap) floor.drawObject(refusal.overlap, { fill: force, stroke: force, width: 3, alpha: 0.3 });
  for (const face of refusal.faces) {
    floor.circle(face.point, robot.radius * floor.camera.scale, { stroke: face.has_room ? ink : force, width: 1.5, dash: face.has_room ? GHOST_DASH : [] });
    if (!face.has_room) drawCross(floor, face.point, force);
  }
  if (!place) return;
  floor.circle(place.point, 0.5 * place.width * floor.camera.scale, { fill: force, stroke: force, width: 1.5, alpha: 0.15 });
  if (place.needed) floor.circle(place.point, 0.5 * place.needed * floor.camera.scale, { stroke: force, width: 2, dash: NEEDED_DASH });
  if (place.ellipse) drawEllipse(floor, place.point, ...place.ellipse, { fill: believed, stroke: believed, width: 1.5, alpha: 0.3 });
  const text = `${place.width.toFixed(2)} m free` + (place.needed ? `, ${place.needed.toFixed(2)} m needed` : '');
  const [x, y] = floor.camera.toScreen(place.point), c = floor.context;
  const above = y - 0.5 * Math.max(place.width, place.needed || 0) * floor.camera.scale - 12;
  c.font = '600 13px system-ui, sans-serif';
  c.textAlign = 'center';
  c.textBaseline = 'middle';
  c.lineWidth = 4;
  c.strokeStyle = paper;
  // Inside of the canvas.
  const height = Math.max(14, above);
  c.strokeText(text, x, height);
  c.fillStyle = force;
  c.fillText(text, x, height);
}

function drawCross(floor, point, color) {
  const [x, y] = floor.camera.toScreen(point), c = floor.context;
  c.beginPath();
  for (const side of [-1, 1]) {
    c.moveTo(x - 7, y - 7 * side);
    c.lineTo(x + 7, y + 7 * side);
  }
  c.lineWidth = 3;
  c.strokeStyle = color;
  c.stroke();
}
