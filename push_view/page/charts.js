'use strict';
// Strips of one quantity over time, with a cursor at the time that is shown.

const DEGREE = Math.PI / 180;
const LEFT = 38, TOP = 6, BOTTOM = 14;
// Live strips are drawn again this often [ms].
const CHART_PERIOD = 250;

// Pose of the object at a row minus the goal of that time.
function poseError(recording, row) {
  const columns = recording.columns, goal = recording.latest('goal', recording.time[row]);
  if (!goal) return [NaN, NaN];
  return [Math.hypot(columns.object_x[row] - goal.pose[0], columns.object_y[row] - goal.pose[1]),
          wrapAngle(columns.object_theta[row] - goal.pose[2])];
}

function boundsOf(bound, factor) {
  return bound === null ? [] : [factor * bound];
}

const CHARTS = [
  { title: 'position error [mm]', isLog: true, least: 0.5, digits: 1,
    value: (recording, row) => 1e3 * poseError(recording, row)[0],
    bounds: (recording, time) => boundsOf(recording.sceneAt(time).position_bound, 1e3) },
  { title: 'heading error [°]', isLog: true, least: 0.02, digits: 2,
    value: (recording, row) => Math.abs(poseError(recording, row)[1]) / DEGREE,
    bounds: (recording, time) => boundsOf(recording.sceneAt(time).heading_bound, 1 / DEGREE) },
  { title: 'contact force from the normal [°]', range: 60, digits: 0,
    value: (recording, row) => {
      const columns = recording.columns;
      if (!columns.force_n || !(columns.force_n[row] > 0)) return NaN;
      return Math.atan2(columns.force_t[row], columns.force_n[row]) / DEGREE;
    },
    bounds: (recording, time) => {
      const truth = recording.latest('truth', time) || recording.sceneAt(time).object;
      const half = Math.atan(truth.contact_friction) / DEGREE;
      return [-half, half];
    } },
];

class Chart {
  constructor(definition, parent, onScrub) {
    this.definition = definition;
    const box = document.createElement('div');
    box.className = 'chart';
    box.innerHTML = '<p><span class="term"></span><span class="value"></span></p><canvas role="img"></canvas><i hidden></i>';
    box.querySelector('.term').textContent = definition.title;
    explain(box.querySelector('.term'), definition.title);
    this.output = box.querySelector('.value');
    this.canvas = box.querySelector('canvas');
    this.canvas.setAttribute('aria-label', definition.title + ' over time');
    this.cursor = box.querySelector('i');
    parent.append(box);
    const scrub = (event) => {
      if (event.buttons !== 1) return;
      onScrub(this.start + (event.offsetX - LEFT) / (this.width - LEFT) * (this.end - this.start));
    };
    this.canvas.addEventListener('pointerdown', scrub);
    this.canvas.addEventListener('pointermove', scrub);
    this.drawn = { version: -1, at: -Infinity };
    // Asking the canvas at every frame would have the page laid out each time.
    new ResizeObserver(() => { this.drawn.version = -1; this.drawn.at = -Infinity; }).observe(this.canvas);
  }

  // Whether there is something that was not drawn yet, as the strip was drawn a moment ago.
  isLate(recording) { return !recording.isEmpty && recording.version !== this.drawn.version; }

  // The strip moves at every frame, its number is written at some.
  show(recording, time, now, isWritten) {
    if (recording.isEmpty) return;
    if (this.isLate(recording) && now - this.drawn.at > CHART_PERIOD) {
      this.drawn = { version: recording.version, at: now };
      this.draw(recording);
    }
    const x = LEFT + (time - this.start) / (this.end - this.start) * (this.width - LEFT);
    this.cursor.hidden = false;
    this.cursor.style.transform = `translateX(${Math.min(x, this.width - 2)}px)`;
    if (!isWritten) return;
    const value = this.definition.value(recording, recording.rowAt(time));
    setText(this.output, Number.isFinite(value) ? value.toFixed(this.definition.digits) : '–');
  }

  draw(recording) {
    const { definition, canvas } = this, ratio = window.devicePixelRatio || 1, colors = themeColors();
    this.width = canvas.clientWidth;
    this.height = canvas.clientHeight;
    if (!this.width) return;
    canvas.width = this.width * ratio;
    canvas.height = this.height * ratio;
    this.start = recording.start;
    this.end = Math.max(recording.end, this.start + 1);
    const rows = this.sampledRows(recording), before = recording.shownGhost;
    const values = rows.map((row) => definition.value(recording, row));
    const rowsBefore = before ? this.sampledRows(before).filter((row) => before.time[row] <= this.end) : [];
    const valuesBefore = rowsBefore.map((row) => definition.value(before, row));
    this.setRange([...values, ...valuesBefore]);
    const c = canvas.getContext('2d');
    c.setTransform(ratio, 0, 0, ratio, 0, 0);
    c.font = '10px system-ui, sans-serif';
    this.shadePushes(c, recording, colors);
    this.drawAxes(c, colors);
    for (const bound of definition.bounds(recording, recording.end)) {
      this.polyline(c, [this.start, this.end], [bound, bound], colors.goal, [5, 3]);
    }
    if (before) this.polyline(c, rowsBefore.map((row) => before.time[row]), valuesBefore, colors.faint, [2, 3]);
    this.polyline(c, rows.map((row) => recording.time[row]), values, colors.ink, []);
  }

  // One row per pixel is enough.
  sampledRows(recording) {
    const count = recording.time.length, step = Math.max(1, Math.floor(count / this.width));
    return Array.from({ length: Math.floor((count - 1) / step) + 1 }, (_, i) => i * step);
  }

  setRange(values) {
    const { isLog, least, range } = this.definition;
    if (!isLog) {
      this.low = -range;
      this.high = range;
      return;
    }
    const most = Math.max(least * 10, ...values.filter(Number.isFinite));
    this.low = Math.log10(least);
    this.high = Math.log10(1.3 * most);
  }

  x(time) { return LEFT + (time - this.start) / (this.end - this.start) * (this.width - LEFT); }

  y(value) {
    const { isLog, least } = this.definition;
    const level = isLog ? Math.log10(Math.max(value, least)) : value;
    return TOP + (this.height - TOP - BOTTOM) * (1 - (level - this.low) / (this.high - this.low));
  }

  polyline(c, times, values, color, dash) {
    c.beginPath();
    let isDown = false;
    times.forEach((time, i) => {
      if (!Number.isFinite(values[i])) {
        isDown = false;
      } else {
        if (isDown) c.lineTo(this.x(time), this.y(values[i]));
        else c.moveTo(this.x(time), this.y(values[i]));
        isDown = true;
      }
    });
    c.setLineDash(dash);
    c.lineWidth = 1.5;
    c.strokeStyle = color;
    c.stroke();
    c.setLineDash([]);
  }

  shadePushes(c, recording, colors) {
    c.globalAlpha = 0.2;
    for (const push of recording.pushes()) {
      c.fillStyle = colors[recording.pushColor(push.number, push.start)];
      const left = this.x(Math.max(push.start, this.start)), right = this.x(Math.min(push.end, this.end));
      if (right > left) c.fillRect(left, 0, right - left, this.height - BOTTOM);
    }
    c.globalAlpha = 1;
  }

  drawAxes(c, colors) {
    c.strokeStyle = colors.grid;
    c.fillStyle = colors.faint;
    c.lineWidth = 1;
    c.textAlign = 'right';
    c.textBaseline = 'middle';
    const marks = this.definition.isLog
      ? [0.1, 1, 10, 100, 1000].filter((mark) => Math.log10(mark) >= this.low && Math.log10(mark) <= this.high)
      : [-this.definition.range / 2, 0, this.definition.range / 2];
    for (const mark of marks) {
      c.beginPath();
      c.moveTo(LEFT, this.y(mark));
      c.lineTo(this.width, this.y(mark));
      c.stroke();
      c.fillText(String(mark), LEFT - 4, this.y(mark));
    }
    c.textBaseline = 'alphabetic';
    c.textAlign = 'left';
    c.fillText(`${this.start.toFixed(0)} s`, LEFT, this.height - 2);
    c.textAlign = 'right';
    c.fillText(`${this.end.toFixed(0)} s`, this.width - 2, this.height - 2);
  }
}
