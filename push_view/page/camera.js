'use strict';
// What part of the floor the canvas shows, and in which colours.

const COLORS = ['paper', 'ink', 'faint', 'grid', 'object', 'goal', 'robot', 'believed', 'force', 'cone', 'view',
                'wall', 'plan', 'accent', 'push-0', 'push-1', 'push-2', 'push-3', 'push-4', 'push-5'];

// Room beside what there is on a live page, to drag things to, and the least side of what is shown [m].
const ROOM = 0.35, LEAST_SIDE = 2;

function themeColors() {
  const style = getComputedStyle(document.documentElement);
  return Object.fromEntries(COLORS.map((name) => [name, style.getPropertyValue('--' + name).trim()]));
}

class Camera {
  constructor(canvas) {
    this.canvas = canvas;
    this.center = [0, 0];
    this.scale = 150;  // pixels per metre
    this.isFitted = false;
    this.isMoved = false;  // by the user, who is not to lose what he looks at
    this.resize();
  }

  resize() {
    const ratio = window.devicePixelRatio || 1;
    this.width = this.canvas.clientWidth;
    this.height = this.canvas.clientHeight;
    this.ratio = ratio;
    this.canvas.width = Math.round(this.width * ratio);
    this.canvas.height = Math.round(this.height * ratio);
  }

  toScreen(point) {
    return [0.5 * this.width + this.scale * (point[0] - this.center[0]),
            0.5 * this.height - this.scale * (point[1] - this.center[1])];
  }

  toFloor(x, y) {
    return [this.center[0] + (x - 0.5 * this.width) / this.scale,
            this.center[1] - (y - 0.5 * this.height) / this.scale];
  }

  pan(dx, dy) {
    this.isMoved = true;
    this.center = [this.center[0] - dx / this.scale, this.center[1] + dy / this.scale];
  }

  zoom(factor, x = 0.5 * this.width, y = 0.5 * this.height) {
    this.isMoved = true;
    const before = this.toFloor(x, y);
    this.scale = Math.min(3000, Math.max(20, this.scale * factor));
    const after = this.toFloor(x, y);
    this.center = [this.center[0] + before[0] - after[0], this.center[1] + before[1] - after[1]];
  }

  // Show everything that moves, the goals and the walls.
  fit(recording) {
    const xs = [], ys = [];
    const add = (x, y, margin) => { xs.push(x - margin, x + margin); ys.push(y - margin, y + margin); };
    const scene = recording.scene;
    if (!scene || !this.width) return;
    const extent = Math.max(...(scene.objects || [scene.object]).flatMap((object) => outlineOf(object).map((vertex) => Math.hypot(...vertex))));
    const shown = recording.isLive ? this.recent(recording) : recording.paths;
    const goals = recording.isLive ? recording.goals.slice(-1) : recording.goals;
    for (const point of shown.object) add(point[0], point[1], extent);
    for (const point of shown.robot) add(point[0], point[1], scene.robot.radius);
    for (const goal of goals) add(goal.pose[0], goal.pose[1], extent);
    const order = recording.latest('order', Infinity);
    if (order) {
      for (const body of ['object', 'goal']) draggable(recording, recording.end, body).forEach(({ pose }) => add(pose[0], pose[1], extent));
      for (const move of order.moves) add(move.pose[0], move.pose[1], extent);
    }
    for (const wall of recording.walls) {
      add(wall[0], wall[1], 0);
      add(wall[2], wall[3], 0);
    }
    if (scene.camera && scene.camera.place === 'room') add(...scene.camera.mount.slice(0, 2), 0.2);
    const map = recording.latest('map', Infinity);
    if (map && map.rows.some((row) => row.includes('#')) && map.rows.length * map.resolution < 8) {
      for (const corner of [[0, 0], [1, 0], [0, 1], [1, 1]]) {
        add(...transform(map.origin, [corner[0] * map.rows[0].length * map.resolution,
                                      corner[1] * map.rows.length * map.resolution]), 0);
      }
    }
    if (!xs.length) return;
    const room = recording.isLive ? ROOM : 0, least = recording.isLive ? LEAST_SIDE : 0;
    const span = (list) => [Math.min(...list) - room, Math.max(...list) + room];
    const [left, right] = span(xs), [low, high] = span(ys);
    const side = Math.max(least, right - left), height = Math.max(least, high - low);
    this.center = [0.5 * (left + right), 0.5 * (low + high)];
    this.scale = 0.94 * Math.min(this.width / side, this.height / height, 800);
    this.isFitted = true;
    this.isMoved = false;
  }

  // Paths of object and robot since the last goal.
  recent(recording) {
    const goal = recording.latest('goal', Infinity), start = goal ? goal.time : -Infinity;
    return Object.fromEntries(['object', 'robot'].map((body) => [body, recording.path(body, start, Infinity)]));
  }

  // Where object and robot are now, as paths of one point.
  present(recording) {
    return Object.fromEntries(['object', 'robot'].map((body) => [body, recording.paths[body].slice(-1)]));
  }

  // Show everything again where something has left the view, unless its user has chosen the view.
  follow(recording) {
    if (this.isMoved || !this.isFitted) return;
    const present = this.present(recording), points = [...present.object, ...present.robot];
    const isInside = ([x, y]) => x > 0 && y > 0 && x < this.width && y < this.height;
    if (!points.every((point) => isInside(this.toScreen(point)))) this.fit(recording);
  }
}
