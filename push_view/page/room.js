'use strict';
// Several objects: each in its colour, with its name, its goal, and where planned moves leave it.

// Dashes of where a move ends, and of its path [pixels].
const MOVE_DASH = [2, 3], MOVE_PATH_DASH = [2, 5];
// How visible a later move is.
const LATER_ALPHA = 0.5;
const MARKS = { at_goal: '✓', given_up: '✗', moving: '▶', moving_aside: '▶' };

// What there is to drag: {index, pose} of each object or goal.
function draggable(recording, time, body) {
  const { scene } = recording, values = recording.at(time);
  if (!scene.objects) {
    const goal = recording.latest('goal', Infinity);
    return [{ index: 0, pose: body === 'goal' && goal ? goal.pose.slice() : poseOf(values, 'object') }];
  }
  const order = recording.latest('order', Infinity);
  return scene.objects.map((object, index) => ({
    index, pose: body === 'object' ? poseOf(values, `body_${index}`) : order && order.goals[index] && order.goals[index].slice() }))
    .filter(({ pose }) => pose);
}

// Outline of one of the objects in its own frame.
function outlineAt(scene, index) {
  return outlineOf(scene.objects ? scene.objects[index] : scene.object);
}

// Color of one of several objects; null where there is but one.
function objectColor(floor, scene, index) {
  return scene.objects ? floor.colors['push-' + index % PUSH_COLOR_COUNT] : null;
}

// Goals, planned moves, and the objects that stand.
function drawRoom(floor, recording, time, edit) {
  const { scene } = recording, order = recording.latest('order', time), values = recording.at(time);
  const outline = floor.outline;
  order.goals.forEach((goal, index) => {
    if (!goal || edit && edit.body === 'goal' && edit.index === index) return;
    floor.outline = outlineAt(scene, index);
    floor.drawGoal(goal, false, objectColor(floor, scene, index));
  });
  order.moves.forEach((move, i) => drawMove(floor, scene, move, i));
  if (!recording.isEmpty) {
    scene.objects.forEach((object, index) => {
      if (index === order.pushed) return;
      const pose = poseOf(values, `body_${index}`), color = objectColor(floor, scene, index);
      floor.outline = outlineAt(scene, index);
      floor.drawSolidObject(pose, color);
      if (floor.canDragObject) floor.drawHandle(pose, color);
    });
  }
  floor.outline = outline;
}

// Where a move ends, and the path there; that of the next one is strong.
function drawMove(floor, scene, move, i) {
  const color = objectColor(floor, scene, move.index), c = floor.context;
  floor.outline = outlineAt(scene, move.index);
  c.globalAlpha = i ? LATER_ALPHA : 1;
  floor.line(move.path, color, 2, MOVE_PATH_DASH);
  c.globalAlpha = 1;
  floor.drawObject(move.pose, { stroke: color, width: 1.5, dash: MOVE_DASH });
}

// Names on the objects with marks of their states, and the numbers of moves above where they end.
function drawNames(floor, recording, time) {
  const { scene } = recording, order = recording.latest('order', time), values = recording.at(time), c = floor.context;
  c.font = '600 12px system-ui, sans-serif';
  c.textAlign = 'center';
  c.textBaseline = 'middle';
  c.lineWidth = 4;
  c.strokeStyle = floor.colors.paper;
  c.fillStyle = floor.colors.ink;
  scene.objects.forEach((object, index) => {
    const [x, y] = floor.camera.toScreen(poseOf(values, `body_${index}`));
    const text = [MARKS[order.states[index].state], object.name].filter(Boolean).join(' ');
    c.strokeText(text, x, y);
    c.fillText(text, x, y);
  });
  order.moves.forEach(({ index, pose }, i) => {
    const top = Math.max(...outlineAt(scene, index).map((vertex) => transform(pose, vertex)[1]));
    floor.label(String(i + 1), [pose[0], top], objectColor(floor, scene, index));
  });
}

// Seconds that remain of a plan.
function secondsLeft(order, time) { return Math.max(0, order.seconds - (time - order.time)); }

// What comes next and why, and how long all of it takes.
function orderText(order, time) {
  const start = `${order.placed} of ${order.goal_count} at their goals`;
  if (order.text) return `${start}, about ${secondsLeft(order, time).toFixed(0)} s left. Now: ${order.text}.`;
  return order.states.some((item) => item.state === 'waiting') ? `${start}. The order is planned anew once the robot stands.` : `${start}. Nothing more is moved.`;
}

// The table of objects beside the floor.
class RoomPanel {
  setScene(scene) {
    byId('room-section').hidden = !scene.objects;
    this.rows = [];
    byId('objects').textContent = '';
    (scene.objects || []).forEach((object, index) => {
      const row = byId('objects').insertRow(), head = cell(row, '', 'th');
      head.scope = 'row';
      const swatch = span('swatch');
      swatch.style.background = `var(--push-${index % PUSH_COLOR_COUNT})`;
      head.append(swatch, object.name);
      this.rows.push({ number: cell(row, ''), state: cell(row, '') });
    });
  }

  show(recording, time) {
    const order = recording.latest('order', time);
    if (!order || !this.rows.length) return;
    setText(byId('order'), orderText(order, time));
    order.states.forEach((item, index) => {
      const numbers = order.moves.flatMap((move, i) => move.index === index ? [i + 1] : []);
      setText(this.rows[index].number, numbers.join(', '));
      setText(this.rows[index].state, [MARKS[item.state], item.text].filter(Boolean).join(' ') + (item.reason ? `: ${item.reason}` : ''));
    });
  }
}
