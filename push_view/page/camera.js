'use strict';
// What part of the floor the canvas shows, and in which colours.

const COLORS = ['paper', 'ink', 'faint', 'grid', 'object', 'goal', 'robot', 'believed', 'force', 'cone', 'view',
                'wall', 'plan', 'accent', 'push-0', 'push-1', 'push-2', 'push-3', 'push-4', 'push-5'];

// What a live page shows round the first goal at least [m].
const LIVE_EXTENT = 1.4;

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
    const extent = Math.max(...outlineOf(scene.object).map((vertex) => Math.hypot(...vertex)));
    for (const point of recording.paths.object) add(point[0], point[1], extent);
    for (const point of recording.paths.robot) add(point[0], point[1], scene.robot.radius);
    for (const goal of recording.goals) add(goal.pose[0], goal.pose[1], extent);
    if (scene.camera && scene.camera.place === 'room') add(...scene.camera.mount.slice(0, 2), 0.2);
    const map = recording.latest('map', Infinity);
    if (map && map.rows.length && !recording.isLive && map.rows.length * map.resolution < 8) {
      for (const corner of [[0, 0], [1, 0], [0, 1], [1, 1]]) {
        add(...transform(map.origin, [corner[0] * map.rows[0].length * map.resolution,
                                      corner[1] * map.rows.length * map.resolution]), 0);
      }
    }
    if (!xs.length) return;
    // Room to drag things to.
    const [goal] = recording.goals, [object] = recording.paths.object, [robot] = recording.paths.robot;
    const middle = goal ? goal.pose : object || robot;
    if (recording.isLive && middle) add(middle[0], middle[1], LIVE_EXTENT);
    const span = (list) => [Math.min(...list), Math.max(...list)];
    const [left, right] = span(xs), [low, high] = span(ys);
    this.center = [0.5 * (left + right), 0.5 * (low + high)];
    this.scale = 0.94 * Math.min(this.width / (right - left), this.height / (high - low), 800);
    this.isFitted = true;
    this.isMoved = false;
  }
}
