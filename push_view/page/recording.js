'use strict';
// A run as its messages describe it: columns of numbers over time, and what held from when on.

const KINDS = ['state', 'goal', 'plan', 'refusal', 'order', 'map', 'truth', 'base', 'displacement', 'collision', 'ending'];
// Columns that change in steps.
const STEPS = ['mode', 'object_seen'];
const ANGLES = /(_theta|_angle|^normal)$/;
// Rows that a page keeps: an hour at 25 Hz; then the older half goes.
const MOST_ROWS = 90000;
// Rows of a run that is kept as the run before [at 50 Hz]; chosen: what is shorter was begun by mistake.
const LEAST_GHOST = 50;
// Points of a drawn path are this far apart [m].
const PATH_STEP = 0.004;

function wrapAngle(angle) {
  return Math.atan2(Math.sin(angle), Math.cos(angle));
}

// Number of the last item of a list in order of time that is not later; -1 where all are.
function lastNotLater(list, time, timeOf) {
  let low = -1, high = list.length - 1;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (timeOf(list[middle]) <= time) low = middle; else high = middle - 1;
  }
  return low;
}

class Recording {
  constructor() {
    this.version = 0;
    this.ghost = null;  // the run before
    this.showsGhost = true;
    this.walls = [];  // that were drawn: [x, y, x, y] each
    this.clear(null);
  }

  // Keep what has been as the run before, to be shown beside the next one.
  takeGhost() {
    if (!this.time || this.time.length < LEAST_GHOST || this.scene.objects) return;
    const { scene, time, columns, goals, truths } = this, { rowAt, at, latest } = Recording.prototype;
    this.ghost = { scene, time, columns, goals, truths, isEmpty: false, rowAt, at, latest };
  }

  get shownGhost() { return this.showsGhost ? this.ghost : null; }

  clear(scene) {
    this.takeGhost();
    this.scene = scene;
    this.names = scene ? scene.columns : [];
    this.columns = Object.fromEntries(this.names.map((name) => [name, []]));
    this.time = this.columns.time || [];
    this.paths = { object: [], robot: [] };
    for (const kind of KINDS) this[kind + 's'] = [];
    this.pushCache = { count: 0, list: [] };
    this.version += 1;
  }

  apply(message) {
    if (message.type === 'scene') {
      this.clear(message);
    } else if (message.type === 'rows') {
      message.rows.forEach((row) => this.addRow(row));
    } else if (message.type === 'camera') {
      this.scene.camera = message.camera;
    } else if (KINDS.includes(message.type)) {
      this[message.type + 's'].push(message);
    } else {
      return false;
    }
    this.version += 1;
    return true;
  }

  addRow(row) {
    if (this.time.length && row[0] <= this.time[this.time.length - 1]) return;
    this.names.forEach((name, i) => this.columns[name].push(row[i] === null ? NaN : row[i]));
    for (const body of ['object', 'robot']) this.extendPath(body);
    if (this.time.length > MOST_ROWS) {
      for (const name of this.names) this.columns[name].splice(0, MOST_ROWS / 2);
    }
  }

  extendPath(body) {
    const last = this.time.length - 1, path = this.paths[body];
    const x = this.columns[body + '_x'][last], y = this.columns[body + '_y'][last];
    if (!Number.isFinite(x)) return;
    const before = path[path.length - 1];
    if (!before || Math.hypot(x - before[0], y - before[1]) > PATH_STEP) {
      path.push([x, y, this.time[last]]);
      if (path.length > MOST_ROWS) path.splice(0, MOST_ROWS / 2);
    }
  }

  get isEmpty() { return this.time.length === 0; }
  get start() { return this.isEmpty ? 0 : this.time[0]; }
  get end() { return this.isEmpty ? 0 : this.time[this.time.length - 1]; }
  has(name) { return name in this.columns; }

  // Number of the last row that is not later; the first where all are.
  rowAt(time) { return Math.max(0, lastNotLater(this.time, time, (value) => value)); }

  // Points (x, y) of the path of a body, from the last one before a time to another time.
  path(body, start, end) {
    const path = this.paths[body], timeOf = (point) => point[2];
    return path.slice(Math.max(0, lastNotLater(path, start, timeOf)), lastNotLater(path, end, timeOf) + 1);
  }

  // Values at a time: a function of the name of a column.
  at(time) {
    if (this.isEmpty) return () => NaN;
    const row = this.rowAt(time), next = Math.min(row + 1, this.time.length - 1);
    const span = this.time[next] - this.time[row];
    const ratio = span > 0 ? Math.min(1, Math.max(0, (time - this.time[row]) / span)) : 0;
    return (name) => {
      const column = this.columns[name];
      if (!column) return NaN;
      const value = column[row], change = column[next] - value;
      if (STEPS.includes(name) || !(ratio > 0) || Number.isNaN(change)) return value;
      return value + ratio * (ANGLES.test(name) ? wrapAngle(change) : change);
    };
  }

  // The latest of a kind that is not later than a time; kinds come in order of time.
  latest(kind, time) {
    const list = this[kind + 's'];
    return list[lastNotLater(list, time + 1e-9, (message) => message.time)] || null;
  }

  // The scene, with the object that is pushed at a time, and its bounds.
  sceneAt(time) {
    const { scene } = this, order = scene && scene.objects ? this.latest('order', time) : null;
    if (!order) return scene;
    const object = scene.objects[order.pushed], { position_bound, heading_bound } = object;
    return { ...scene, object, position_bound, heading_bound };
  }

  // Where the object that is pushed is, as of values at a time.
  objectPose(values, time) {
    const order = this.scene.objects ? this.latest('order', time) : null;
    return poseOf(values, order ? `body_${order.pushed}` : 'object');
  }

  // Name of the colour of a push: its own, or in a room that of its object.
  pushColor(number, time) {
    const order = this.scene.objects ? this.latest('order', time) : null;
    return 'push-' + (order ? order.pushed : number) % PUSH_COLOR_COUNT;
  }

  // Whether a push begins with a state: reasons may change under way.
  isPushStart(i) {
    return this.states[i].state === 'push' && !(i > 0 && this.states[i - 1].state === 'push');
  }

  // Pushes as {number, start, end}.
  pushes() {
    if (this.pushCache.count !== this.states.length) this.pushCache = { count: this.states.length, list: this.findPushes() };
    return this.pushCache.list;
  }

  findPushes() {
    const found = [];
    this.states.forEach((message, i) => {
      if (this.isPushStart(i)) found.push({ number: found.length, start: message.time, end: Infinity });
      else if (message.state !== 'push' && found.length) {
        const last = found[found.length - 1];
        last.end = Math.min(last.end, message.time);
      }
    });
    return found;
  }
}

// Vertices of the object in its own frame.
function outlineOf(object) {
  if (object.outline.length) return object.outline;
  return Array.from({ length: 60 }, (_, i) => [
    object.radius * Math.cos(Math.PI * i / 30), object.radius * Math.sin(Math.PI * i / 30)]);
}

function transform(pose, point) {
  const c = Math.cos(pose[2]), s = Math.sin(pose[2]);
  return [pose[0] + c * point[0] - s * point[1], pose[1] + s * point[0] + c * point[1]];
}

function poseOf(values, body) {
  return [values(body + '_x'), values(body + '_y'), values(body + '_theta')];
}

// What the report holds: a document, or null on a live page.
async function embeddedDocument() {
  const text = document.getElementById('recording').textContent.trim();
  return text ? unpack(text) : null;
}

// JSON that was compressed and written in letters.
async function unpack(text) {
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('gzip'));
  return JSON.parse(await new Response(stream).text());
}
