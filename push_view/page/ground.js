'use strict';
// What stands still on the floor: grid, walls, and the paths so far. It is kept as a picture, as there is too much of it
// to be drawn 60 times a second.

const PUSH_COLOR_COUNT = 6;
// The picture is drawn again after so much time of the recording [s]; meanwhile the rest of the paths is drawn on top.
const GROUND_PERIOD = 2;
// What moves farther from one row to the next was put there [m].
const JUMP = 0.15;

class Ground extends Pen {
  constructor(camera) {
    super(document.createElement('canvas').getContext('2d', { alpha: false }), camera);
    this.forget();
  }

  forget() { this.drawn = { key: '', scene: null, until: -Infinity }; }

  setTheme() {
    super.setTheme();
    this.forget();
  }

  // Draw it with another pen, up to a time.
  show(pen, recording, time) {
    const { camera, drawn } = this, goal = recording.latest('goal', time), map = recording.latest('map', time);
    const since = recording.isLive && goal ? goal.time : -Infinity;
    const key = [...camera.center, camera.scale, camera.width, camera.height, camera.ratio, since, map ? map.time : '',
                 recording.maps.length].join();
    if (key !== drawn.key || recording.scene !== drawn.scene || time < drawn.until || time > drawn.until + GROUND_PERIOD) {
      this.drawn = { key, scene: recording.scene, until: time };
      this.draw(recording, map, since, time);
    }
    pen.context.setTransform(1, 0, 0, 1, 0, 0);
    pen.context.drawImage(this.context.canvas, 0, 0);
    pen.context.setTransform(camera.ratio, 0, 0, camera.ratio, 0, 0);
    drawTrails(pen, recording, Math.max(since, this.drawn.until), time);
  }

  draw(recording, map, since, time) {
    const { camera, context: c } = this;
    if (c.canvas.width !== camera.canvas.width || c.canvas.height !== camera.canvas.height) {
      c.canvas.width = camera.canvas.width;
      c.canvas.height = camera.canvas.height;
    }
    c.setTransform(camera.ratio, 0, 0, camera.ratio, 0, 0);
    c.fillStyle = this.colors.paper;
    c.fillRect(0, 0, camera.width, camera.height);
    this.drawGrid();
    if (!recording.scene) return;
    this.drawMap(map);
    drawTrails(this, recording, since, time);
  }

  drawGrid() {
    const c = this.context, camera = this.camera;
    const step = [0.1, 0.2, 0.5, 1, 2, 5].find((size) => size * camera.scale > 56) || 10;
    const [left, top] = camera.toFloor(0, 0), [right, bottom] = camera.toFloor(camera.width, camera.height);
    c.strokeStyle = this.colors.grid;
    c.lineWidth = 1;
    c.fillStyle = this.colors.faint;
    c.font = '11px system-ui, sans-serif';
    c.textAlign = 'left';
    c.textBaseline = 'alphabetic';
    const digits = step < 1 ? 1 : 0;
    c.beginPath();
    for (let i = Math.ceil(left / step); i * step <= right; i += 1) {
      const x = camera.toScreen([i * step, 0])[0];
      c.moveTo(x, 0);
      c.lineTo(x, camera.height);
      c.fillText((i * step).toFixed(digits), x + 3, camera.height - 4);
    }
    for (let i = Math.ceil(bottom / step); i * step <= top; i += 1) {
      const y = camera.toScreen([0, i * step])[1];
      c.moveTo(0, y);
      c.lineTo(camera.width, y);
      if (y > 14 && y < camera.height - 16) c.fillText((i * step).toFixed(digits) + (i ? '' : ' m'), 4, y - 3);
    }
    c.stroke();
  }

  drawMap(map) {
    if (!map || !map.rows.length) return;
    const c = this.context, side = map.resolution;
    // Outside the map nothing may move either.
    const right = side * map.rows[0].length, top = side * map.rows.length;
    this.shape([[0, 0], [right, 0], [right, top], [0, top]].map((corner) => transform(map.origin, corner)),
               { stroke: this.colors.wall, width: 1.5, dash: [2, 6] });
    c.fillStyle = this.colors.wall;
    c.strokeStyle = this.colors.wall;
    c.lineWidth = 1;
    c.beginPath();
    map.rows.forEach((row, j) => {
      // Neighbours in a row are one rectangle.
      for (let i = row.indexOf('#'); i >= 0;) {
        let end = i;
        while (row[end] === '#') end += 1;
        [[i, j], [end, j], [end, j + 1], [i, j + 1]].forEach(([u, v], corner) => {
          const [x, y] = this.camera.toScreen(transform(map.origin, [u * side, v * side]));
          if (corner) c.lineTo(x, y); else c.moveTo(x, y);
        });
        c.closePath();
        i = row.indexOf('#', end);
      }
    });
    c.fill();
    c.stroke();
  }
}

// Paths of object and robot between two times, the first of which may have been before everything.
function drawTrails(pen, recording, start, end) {
  pen.line(recording.path('robot', start, end), pen.colors.faint, 1.5, [1, 4], JUMP);
  for (const push of recording.pushes()) {
    if (push.start > end || push.end < start) continue;
    const color = pen.colors[recording.pushColor(push.number, push.start)];
    pen.line(recording.path('object', Math.max(push.start, start), Math.min(push.end, end)), color, 3.5, [], JUMP);
    // In a room numbers are those of moves.
    if (push.start > start && !recording.scene.objects) pen.label(String(push.number + 1), poseOf(recording.at(push.start), 'robot'), color);
  }
}
