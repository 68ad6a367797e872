'use strict';
// Draws the floor at one instant.

const GRAVITY = 9.81;
// Shadow of what stands on the floor [m], and the lid of a box as a part of its outline.
const SHADOW = [0.02, -0.025], SHADOW_COLOR = '#000', LID = 0.8;

class Floor extends Pen {
  constructor(canvas, camera) {
    super(canvas.getContext('2d', { alpha: false }), camera);
    this.ground = new Ground(camera);
    this.hoveredWall = -1;  // the one that a click removes
  }

  setTheme() {
    super.setTheme();
    if (this.ground) this.ground.setTheme();
  }

  // edit: what is being dragged, or null.
  draw(recording, time, edit) {
    if (!this.camera.canvas.width) return;  // nothing is seen of it yet
    this.ground.show(this, recording, time);
    const scene = recording.sceneAt(time), order = scene && recording.latest('order', time);
    if (!scene) return;
    this.outline = outlineOf(scene.object);
    const goal = recording.latest('goal', time);
    this.drawHoveredWall(recording.walls[this.hoveredWall]);
    this.drawGhost(recording.shownGhost, time);
    if (order) drawRoom(this, recording, time, edit);
    drawPlanned(this, recording, time, goal);
    if (goal && !order && !(edit && edit.body === 'goal')) this.drawGoal(goal.pose);
    if (!recording.isEmpty) this.drawBodies(recording, time, order ? objectColor(this, scene, order.pushed) : this.colors.object);
    if (order && !recording.isEmpty) drawNames(this, recording, time);
    this.drawDisplacement(recording.latest('displacement', time), time);
    this.drawCollisions(recording, time, goal);
    if (edit) this.drawEdit(edit, scene);
    this.drawCaption(recording, time);
  }

  // Which push it is, of how many where all are known.
  drawCaption(recording, time) {
    const pushes = recording.pushes(), count = pushes.filter((push) => push.start <= time).length;
    const state = recording.latest('state', time);
    if (!state || !count || state.state !== 'push') return;
    const isWhole = !recording.isLive || recording.latest('state', Infinity) !== state;
    const c = this.context;
    c.font = '600 16px system-ui, sans-serif';
    c.textAlign = 'left';
    c.textBaseline = 'top';
    c.fillStyle = this.colors[recording.pushColor(count - 1, time)];
    c.fillText(isWhole ? `push ${count} of ${pushes.length}` : `push ${count}`, 44, 10);
  }

  // Object and robot of the run before, at the same time.
  drawGhost(ghost, time) {
    if (!ghost) return;
    const values = ghost.at(time), style = { stroke: this.colors.faint, width: 1.2, dash: [2, 3] };
    this.shape(outlineOf(ghost.scene.object).map((vertex) => transform(poseOf(values, 'object'), vertex)), style);
    this.drawRobot(poseOf(values, 'robot'), ghost.scene.robot.radius, style);
  }

  drawHoveredWall(wall) {
    if (wall) this.line([wall.slice(0, 2), wall.slice(2)], this.colors.force, Math.max(4, WALL_THICKNESS * this.camera.scale));
  }

  // The object with a bar that marks its front.
  drawObject(pose, style) {
    this.shape(this.outline.map((vertex) => transform(pose, vertex)), style);
    const front = Math.max(...this.outline.map((vertex) => vertex[0]));
    this.line([transform(pose, [0.6 * front, 0]), transform(pose, [front, 0])], style.stroke,
              style.width, style.dash);
  }

  // The box from above: its shadow, its sides, and its lid.
  drawSolidObject(pose, color) {
    const { paper } = this.colors, vertices = this.outline;
    const shadow = [pose[0] + SHADOW[0], pose[1] + SHADOW[1], pose[2]];
    this.shape(vertices.map((vertex) => transform(shadow, vertex)), { fill: SHADOW_COLOR, alpha: 0.16 });
    this.shape(vertices.map((vertex) => transform(pose, vertex)), { fill: paper });
    this.drawObject(pose, { fill: color, stroke: color, width: 2.5, alpha: 0.3 });
    this.shape(vertices.map((vertex) => transform(pose, vertex.map((value) => LID * value))), { fill: paper, alpha: 0.5 });
  }

  // The robot from above: its wheels below its deck.
  drawSolidRobot(pose, robot) {
    const { robot: body, ink, paper } = this.colors, { radius } = robot, { scale } = this.camera;
    this.circle([pose[0] + SHADOW[0], pose[1] + SHADOW[1]], radius * scale, { fill: SHADOW_COLOR, alpha: 0.16 });
    this.drawRobot(pose, radius, { fill: body, stroke: ink, width: 2, alpha: 0.75 });
    this.circle(pose, 0.62 * radius * scale, { fill: paper, alpha: 0.3 });
    for (const angle of robot.drive === 'holonomic' ? [0, 2 * Math.PI / 3, -2 * Math.PI / 3] : [Math.PI / 2, -Math.PI / 2]) {
      const wheel = [...transform(pose, [0.74 * radius * Math.cos(angle), 0.74 * radius * Math.sin(angle)]), pose[2] + angle + Math.PI / 2];
      this.shape([[1, 1], [-1, 1], [-1, -1], [1, -1]].map(
        ([u, v]) => transform(wheel, [0.24 * radius * u, 0.1 * radius * v])), { fill: ink });
    }
  }

  drawRobot(pose, radius, style) {
    this.circle(pose, radius * this.camera.scale, style);
    this.line([pose, transform(pose, [radius, 0])], style.stroke, style.width, style.dash);
  }

  drawGoal(pose, isEdited = false, color = null) {
    const stroke = color || this.colors.goal, style = { stroke, width: isEdited ? 4 : 2.8, dash: [8, 4] };
    this.drawObject(pose, style);
    this.drawHandle(pose, stroke);
  }

  // A ring ahead of the front: what rotates it.
  handleOf(pose, outline = this.outline) {
    const front = Math.max(...outline.map((vertex) => vertex[0]));
    return transform(pose, [front + 26 / this.camera.scale, 0]);
  }

  drawHandle(pose, color) {
    if (!this.showsHandles) return;
    const handle = this.handleOf(pose), front = Math.max(...this.outline.map((vertex) => vertex[0]));
    this.line([transform(pose, [front, 0]), handle], color, 1.5);
    this.circle(handle, 7, { fill: this.colors.paper, stroke: color, width: 2.5 });
  }

  drawBodies(recording, time, bodyColor) {
    const values = recording.at(time), scene = recording.sceneAt(time), colors = this.colors;
    const truth = recording.latest('truth', time);
    const object = recording.objectPose(values, time), robot = poseOf(values, 'robot');
    const isObjectSeen = isSeen(values), camera = scene.camera && cameraPose(scene.camera, robot);
    if (camera) drawView(this, scene.camera, camera, isObjectSeen);
    // What nobody sees is an outline.
    if (isObjectSeen) this.drawSolidObject(object, bodyColor);
    else this.drawObject(object, { stroke: bodyColor, width: 1.5, dash: [2, 4] });
    this.drawSupports(scene, truth, object);
    if (this.canDragObject) this.drawHandle(object, bodyColor);
    this.drawSolidRobot(robot, scene.robot);
    if (camera) drawCameraSign(this, camera);
    this.drawBelief(values, scene, object);
    if (truth) this.drawCenter(transform(object, truth.friction_center));
    this.drawContact(values, truth || scene.object, scene.object.mass);
  }

  // Discs as large as the true friction, rings as large as the nominal one.
  drawSupports(scene, truth, pose) {
    const nominal = scene.object.friction, most = Math.max(...nominal, ...(truth ? truth.friction : []));
    const size = (value) => 0.045 * this.camera.scale * Math.sqrt(value / most);
    scene.object.supports.forEach((support, i) => {
      const point = transform(pose, support);
      if (truth) this.circle(point, size(truth.friction[i]), { fill: this.colors.object, alpha: 0.45 });
      this.circle(point, size(nominal[i]), { stroke: this.colors.faint, width: 1.2, dash: [3, 2] });
    });
  }

  drawBelief(values, scene, object) {
    const colors = this.colors, style = { stroke: colors.believed, width: 1.6, dash: [9, 3, 2, 3] };
    const believed = poseOf(values, 'believed_object'), robot = poseOf(values, 'believed_robot');
    if (believed.every(Number.isFinite)) this.drawBelievedObject(values, scene, believed, style);
    if (robot.every(Number.isFinite)) this.drawRobot(robot, scene.robot.radius, style);
    let center = [values('believed_center_x'), values('believed_center_y')];
    if (!center.every(Number.isFinite)) center = scene.object.friction_center;
    const point = transform(object, center), c = this.context;
    const [x, y] = this.camera.toScreen(point);
    // A plus, and the ellipse of two standard deviations.
    c.beginPath();
    c.moveTo(x - 8, y);
    c.lineTo(x + 8, y);
    c.moveTo(x, y - 8);
    c.lineTo(x, y + 8);
    c.lineWidth = 2.5;
    c.strokeStyle = colors.believed;
    c.stroke();
    const [major, minor] = [values('believed_center_deviation_major'), values('believed_center_deviation_minor')];
    if (!(major > 0)) return;
    drawEllipse(this, point, major, minor, object[2] + values('believed_center_angle'),
                { stroke: colors.believed, width: 1.5 });
  }

  // With a camera also how well it is known: an ellipse, and the outline rotated by two standard deviations to either
  // side. While nothing is seen it is what the robot goes by, and filled.
  drawBelievedObject(values, scene, pose, style) {
    const isObjectSeen = isSeen(values), { colors } = this;
    this.drawObject(pose, isObjectSeen ? style : { ...style, fill: colors.believed, width: 2.5, alpha: 0.2 });
    const major = values('believed_object_deviation_major'), heading = values('believed_object_heading_deviation');
    if (!scene.camera || !(major > 0)) return;
    if (!isObjectSeen) {
      for (const side of [-2, 2]) {
        const rotated = [pose[0], pose[1], pose[2] + side * heading];
        this.shape(this.outline.map((vertex) => transform(rotated, vertex)), { stroke: colors.believed, width: 1, dash: [2, 3] });
      }
    }
    drawEllipse(this, pose, major, values('believed_object_deviation_minor'), values('believed_object_deviation_angle'),
                { fill: colors.believed, alpha: 0.3, stroke: colors.believed, width: 1.5 });
  }

  // The true centre of friction: a cross.
  drawCenter(point) {
    const c = this.context, [x, y] = this.camera.toScreen(point);
    c.beginPath();
    c.moveTo(x - 6, y - 6);
    c.lineTo(x + 6, y + 6);
    c.moveTo(x - 6, y + 6);
    c.lineTo(x + 6, y - 6);
    c.lineWidth = 3;
    c.strokeStyle = this.colors.object;
    c.stroke();
  }

  drawContact(values, truth, mass) {
    if (!(values('force_n') > 0)) return;
    const contact = [values('contact_x'), values('contact_y'), values('normal')];
    const half = Math.atan(truth.contact_friction), length = 0.28;
    const edge = (angle) => transform(contact, [length * Math.cos(angle), length * Math.sin(angle)]);
    this.shape([contact, edge(-half), edge(half)],
               { fill: this.colors.cone, stroke: this.colors.cone, width: 1.2, dash: [6, 2, 1, 2], alpha: 0.12 });
    // A metre of arrow is the weight of the object.
    const scale = 1 / (mass * GRAVITY);
    const tip = transform(contact, [scale * values('force_n'), scale * values('force_t')]);
    this.arrow(contact, tip, this.colors.force);
    this.circle(contact, 4, { fill: this.colors.force });
  }

  arrow(start, end, color) {
    const [x0, y0] = this.camera.toScreen(start), [x1, y1] = this.camera.toScreen(end);
    if (Math.hypot(x1 - x0, y1 - y0) < 2) return;
    const angle = Math.atan2(y1 - y0, x1 - x0), c = this.context;
    c.lineWidth = 3;
    c.strokeStyle = color;
    c.beginPath();
    c.moveTo(x0, y0);
    c.lineTo(x1, y1);
    for (const side of [-0.5, 0.5]) {
      c.moveTo(x1, y1);
      c.lineTo(x1 - 11 * Math.cos(angle + side), y1 - 11 * Math.sin(angle + side));
    }
    c.stroke();
  }

  // For two seconds: from where to where somebody has moved the object.
  drawDisplacement(message, time) {
    if (!message || time > message.time + 2) return;
    this.arrow(message.before, message.after, this.colors.force);
  }

  // Where robot or object touched a wall: a ring with a cross in it, since the last goal.
  drawCollisions(recording, time, goal) {
    const since = recording.isLive && goal ? goal.time : -Infinity, c = this.context;
    for (const collision of recording.collisions) {
      if (collision.time > time + 1e-9 || collision.time < since) continue;
      const [x, y] = this.camera.toScreen(collision.point);
      this.circle(collision.point, 12, { fill: this.colors.paper, stroke: this.colors.force, width: 3 });
      c.beginPath();
      for (const side of [-1, 1]) {
        c.moveTo(x - 5, y - 5 * side);
        c.lineTo(x + 5, y + 5 * side);
      }
      c.stroke();
    }
  }

  drawEdit(edit, scene) {
    const color = objectColor(this, scene, edit.index) || this.colors.object;
    if (edit.body !== 'wall') this.outline = outlineAt(scene, edit.index);
    if (edit.body === 'goal') this.drawGoal(edit.pose, true, objectColor(this, scene, edit.index));
    if (edit.body === 'object') {
      this.drawObject(edit.pose, { stroke: color, width: 3, dash: [4, 4] });
      this.drawHandle(edit.pose, color);
    }
    if (edit.body === 'wall') {
      const width = Math.max(3, 0.1 * this.camera.scale);
      if (edit.from) this.line([edit.from, edit.to], this.colors.wall, width);
      this.circle(edit.to, 8, { stroke: this.colors.accent, width: 2 });
    }
  }
}
