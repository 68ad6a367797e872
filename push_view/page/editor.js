'use strict';
// Dragging on the floor, by pointer and by keys: goal, object, walls, and the view itself.

const TOOLS = ['goal', 'object', 'wall', 'pan'];
const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
// Steps of keys [m], [rad].
const COARSE = 0.05, FINE = 0.01, TURN = Math.PI / 36;
// How near to a handle a pointer must be, to a wall, and how little it moves in a click [pixels].
const NEAR = 22, NEAR_WALL = 6, CLICK = 5;
// Steps of a rotation with Shift.
const ROTATION_STEP = Math.PI / 12;

function isInside(point, outline) {
  return outline.every((vertex, i) => {
    const next = outline[(i + 1) % outline.length];
    return (next[0] - vertex[0]) * (point[1] - vertex[1]) - (next[1] - vertex[1]) * (point[0] - vertex[0]) >= 0;
  });
}

class Editor {
  constructor(canvas, app) {
    this.canvas = canvas;
    this.app = app;
    this.edit = null;
    this.index = 0;  // of what was dragged last, which keys move
    this.pointers = new Map();
    canvas.addEventListener('pointerdown', (event) => this.onDown(event));
    canvas.addEventListener('pointermove', (event) => this.onMove(event));
    for (const name of ['pointerup', 'pointercancel']) canvas.addEventListener(name, (event) => this.onUp(event));
    canvas.addEventListener('wheel', (event) => {
      event.preventDefault();
      app.camera.zoom(Math.exp(-0.0015 * event.deltaY), event.offsetX, event.offsetY);
      app.redraw();
    }, { passive: false });
    canvas.addEventListener('keydown', (event) => this.onKey(event));
    for (const radio of document.getElementsByName('tool')) {
      radio.addEventListener('change', () => this.setTool(radio.value));
    }
    canvas.addEventListener('pointerleave', () => this.hover(null));
    byId('clear-walls').addEventListener('click', () => this.app.send({ type: 'clear_walls' }));
    this.setTool('goal');
  }

  get canEdit() { return this.app.canEdit; }

  setTool(tool) {
    this.tool = tool;
    this.edit = null;
    document.querySelector(`input[name="tool"][value="${tool}"]`).checked = true;
    this.app.floor.tool = tool;
    this.app.redraw();
  }

  // All that can be dragged, what the tool is for first: {body, index, pose}.
  get items() {
    const { recording, player } = this.app;
    return (this.tool === 'object' ? ['object', 'goal'] : ['goal', 'object']).filter((body) => this.canDrag(body)).flatMap(
      (body) => draggable(recording, player.time, body).map((item) => ({ body, ...item })));
  }

  // What a pointer takes hold of: {body, index, pose, isRotation}, or null for the floor.
  grip(x, y) {
    const { floor, camera, recording } = this.app;
    if (!this.canEdit || recording.isEmpty || !floor.outline) return null;
    const point = camera.toFloor(x, y), { items } = this;
    for (const item of items) {
      const [u, v] = camera.toScreen(floor.handleOf(item.pose, outlineAt(recording.scene, item.index)));
      if (Math.hypot(u - x, v - y) < NEAR) return { ...item, isRotation: true };
    }
    for (const item of items) {
      const { pose } = item, [dx, dy] = [point[0] - pose[0], point[1] - pose[1]];
      const c = Math.cos(pose[2]), s = Math.sin(pose[2]);
      if (isInside([c * dx + s * dy, -s * dx + c * dy], outlineAt(recording.scene, item.index))) return { ...item, isRotation: false };
    }
    return null;
  }

  canDrag(body) { return (this.app.tools || []).includes(body); }

  nameOf({ body, index }) {
    const { objects } = this.app.recording.scene;
    if (!objects) return body;
    return body === 'goal' ? `goal of ${objects[index].name}` : objects[index].name;
  }

  // Number of the wall that a click would remove; -1 where it removes none.
  wallUnder(x, y) {
    const { camera, recording } = this.app;
    if (!this.canEdit || this.tool !== 'wall') return -1;
    return wallAt(recording.walls, camera.toFloor(x, y), NEAR_WALL / camera.scale);
  }

  // Show what the pointer would take hold of: by its shape, and by the wall that a click removes.
  hover(event) {
    const { floor } = this.app, before = floor.hoveredWall;
    floor.hoveredWall = event ? this.wallUnder(event.offsetX, event.offsetY) : -1;
    if (floor.hoveredWall !== before) this.app.redraw();
    let cursor = 'grab', title = '';
    if (this.pointers.size) cursor = this.tool === 'wall' ? 'crosshair' : 'grabbing';
    else if (floor.hoveredWall >= 0) [cursor, title] = ['pointer', 'click: remove this wall'];
    else if (this.tool === 'wall') cursor = 'crosshair';
    else if (event && this.tool !== 'pan') {
      const grip = this.grip(event.offsetX, event.offsetY);
      if (grip) title = `drag: ${grip.isRotation ? 'rotate' : 'move'} the ${this.nameOf(grip)}`;
      if (grip) cursor = grip.isRotation ? 'alias' : 'move';
    }
    if (this.canvas.style.cursor !== cursor) this.canvas.style.cursor = cursor;
    if (this.canvas.title !== title) this.canvas.title = title;
  }

  onDown(event) {
    this.canvas.focus({ preventScroll: true });
    this.canvas.setPointerCapture(event.pointerId);
    this.pointers.set(event.pointerId, [event.offsetX, event.offsetY]);
    if (this.pointers.size > 1) {
      this.edit = null;
      return;
    }
    const point = this.app.camera.toFloor(event.offsetX, event.offsetY);
    if (this.canEdit && this.tool === 'wall') {
      const from = event.altKey ? point : snapPoint(point);
      this.edit = { body: 'wall', from, to: from, pressed: [event.offsetX, event.offsetY] };
    } else if (this.tool !== 'pan') {
      const grip = this.grip(event.offsetX, event.offsetY);
      if (!grip) return;
      if (grip.body !== this.tool) this.setTool(grip.body);
      const { pose } = grip;
      this.index = grip.index;
      this.edit = { ...grip, offset: [point[0] - pose[0], point[1] - pose[1]] };
    }
    this.hover(event);
    this.app.redraw();
  }

  onMove(event) {
    if (!this.pointers.has(event.pointerId)) {
      this.hover(event);
      return;
    }
    const before = this.pointers.get(event.pointerId), now = [event.offsetX, event.offsetY];
    if (this.pointers.size === 2) {
      this.pinch(event.pointerId, before, now);
    } else if (this.edit) {
      this.drag(this.app.camera.toFloor(...now), event);
    } else {
      this.app.camera.pan(now[0] - before[0], now[1] - before[1]);
    }
    this.pointers.set(event.pointerId, now);
    this.app.redraw();
  }

  drag(point, { altKey, shiftKey }) {
    const edit = this.edit;
    if (edit.body === 'wall') {
      edit.to = altKey ? point : snapWallEnd(edit.from, point);
    } else if (edit.isRotation) {
      const angle = Math.atan2(point[1] - edit.pose[1], point[0] - edit.pose[0]);
      edit.pose[2] = shiftKey ? Math.round(angle / ROTATION_STEP) * ROTATION_STEP : angle;
    } else {
      edit.pose[0] = point[0] - edit.offset[0];
      edit.pose[1] = point[1] - edit.offset[1];
    }
  }

  pinch(id, before, now) {
    const other = [...this.pointers].find(([key]) => key !== id)[1];
    const size = (point) => Math.max(1, Math.hypot(point[0] - other[0], point[1] - other[1]));
    this.app.camera.zoom(size(now) / size(before), 0.5 * (now[0] + other[0]), 0.5 * (now[1] + other[1]));
  }

  onUp(event) {
    this.pointers.delete(event.pointerId);
    if (event.type === 'pointerup' && this.edit) this.release(event);
    this.edit = null;
    this.hover(event);
    this.app.redraw();
  }

  // A click with the tool for walls removes the one under it, and draws none.
  release(event) {
    const { pressed } = this.edit;
    if (!pressed || Math.hypot(event.offsetX - pressed[0], event.offsetY - pressed[1]) > CLICK) {
      this.confirm();
      return;
    }
    this.removeWall(this.wallUnder(event.offsetX, event.offsetY));
  }

  removeWall(index) {
    if (index >= 0) this.app.send({ type: 'remove_wall', wall: index });
  }

  confirm() {
    const edit = this.edit;
    this.edit = null;
    if (edit.body === 'wall') {
      if (edit.from) this.app.send({ type: 'wall', start: edit.from, end: edit.to });
    } else {
      this.app.send({ type: edit.body === 'goal' ? 'goal' : 'displace', pose: edit.pose, index: edit.index });
    }
  }

  onKey(event) {
    if (!this.canEdit || event.ctrlKey || event.altKey || event.metaKey) return;
    const step = event.shiftKey ? FINE : COARSE, arrow = ARROWS[event.key];
    if (arrow && this.tool === 'pan') {
      this.app.camera.pan(-40 * arrow[0], 40 * arrow[1]);
    } else if (arrow) {
      this.startEdit();
      this.move(arrow[0] * step, arrow[1] * step);
    } else if ((event.key === '[' || event.key === ']') && ['goal', 'object'].includes(this.tool)) {
      this.startEdit();
      this.edit.pose[2] += (event.key === '[' ? 1 : -1) * TURN;
    } else if (event.key === 'Enter' && this.tool === 'wall') {
      this.placeWallEnd();
    } else if (event.key === 'Delete' && this.tool === 'wall' && this.edit) {
      this.removeWall(wallAt(this.app.recording.walls, this.edit.to, COARSE));
    } else if (event.key === 'Enter' && this.edit) {
      this.confirm();
    } else if (event.key === 'Escape') {
      this.edit = null;
    } else {
      return;
    }
    event.preventDefault();
    event.stopPropagation();
    this.app.redraw();
  }

  startEdit() {
    if (this.edit) return;
    const item = this.items.find(({ body, index }) => body === this.tool && index === this.index) || this.items[0];
    this.edit = this.tool === 'wall' ? { body: 'wall', from: null, to: snapPoint(this.app.camera.center) }
      : { ...item, isRotation: false };
  }

  move(dx, dy) {
    const point = this.edit.body === 'wall' ? this.edit.to : this.edit.pose;
    point[0] += dx;
    point[1] += dy;
  }

  placeWallEnd() {
    this.startEdit();
    if (!this.edit.from) {
      this.edit.from = this.edit.to;
      this.edit.to = this.edit.to.slice();
      return;
    }
    const end = this.edit.to.slice();
    this.confirm();
    this.edit = { body: 'wall', from: null, to: end };
  }
}
