'use strict';
// Time that is shown: of a recording, or the newest of a live run.

const REPORT_SPEEDS = [0.25, 0.5, 1, 2, 5, 10];
const LIVE_SPEEDS = [1, 2, 3, 5, 10];
// A live page shows what is this old, so that it moves evenly between messages [s of wall time].
const LIVE_DELAY = 0.1;
// Rows of a live page are expected to come at this rate at least, however busy the machine is.
const LEAST_RATE = 0.2;

// Slider and clock are renewed this often while time runs [ms].
const CLOCK_PERIOD = 60;

class Player {
  constructor(recording) {
    this.recording = recording;
    this.time = 0;
    this.speed = 1;
    this.rate = 1;  // live: at which rows come
    this.shownAt = -Infinity;
    this.isPlaying = false;
    this.isFollowing = false;  // live, at the newest rows
    this.send = null;
    this.ownsTime = true;  // live: whether time can be stopped
    byId('play').addEventListener('click', () => this.toggle());
    byId('back').addEventListener('click', () => this.step(-1));
    byId('forward').addEventListener('click', () => this.step(1));
    byId('time').addEventListener('input', () => this.seek(Number(byId('time').value)));
    byId('speed').addEventListener('change', () => this.setSpeed(Number(byId('speed').value)));
  }

  get isLive() { return this.send !== null; }

  showSpeeds(speeds) {
    byId('speed').replaceChildren(...speeds.map((speed) => new Option(`${speed} ×`, speed)));
    byId('speed').value = this.speed;
  }

  setSpeed(speed) {
    this.speed = this.rate = speed;
    if (this.isLive && this.ownsTime) this.send({ type: 'run', speed });
  }

  toggle() {
    // Of a simulation that was scrubbed back it is first shown again what has been.
    const isReplay = !this.isLive || this.ownsTime && !this.isFollowing;
    if (!isReplay) {
      this.follow(!(this.isPlaying && this.isFollowing));
      return;
    }
    if (!this.isLive && !this.isPlaying && this.time >= this.recording.end) this.time = this.recording.start;
    this.isPlaying = !this.isPlaying;
  }

  // Live: show the newest, and let time go on or stop.
  follow(isPlaying) {
    this.isFollowing = true;
    this.isPlaying = isPlaying;
    if (this.ownsTime) this.send({ type: 'run', paused: !isPlaying });
  }

  pause() {
    if (this.isLive && this.ownsTime && this.isPlaying) this.send({ type: 'run', paused: true });
    this.isPlaying = false;
  }

  seek(time) {
    this.pause();
    this.isFollowing = false;
    this.time = Math.min(this.recording.end, Math.max(this.recording.start, time));
  }

  step(rows) {
    const recording = this.recording;
    if (recording.isEmpty) return;
    const row = recording.rowAt(this.time + 1e-9) + rows, last = recording.time.length - 1;
    if (this.isLive && this.ownsTime && row > last) {
      this.isFollowing = true;
      this.send({ type: 'step' });
      return;
    }
    this.seek(recording.time[Math.min(last, Math.max(0, row))]);
  }

  // Let time pass [s of wall time].
  advance(dt) {
    const { recording } = this;
    if (recording.isEmpty) return;
    if (this.isLive && this.isFollowing) {
      if (!this.isPlaying) {
        this.time = recording.end;
        return;
      }
      // Faster where it lags behind, slower where it is about to run out of rows.
      const lag = recording.end - this.time, aim = LIVE_DELAY * this.rate;
      if (lag < 0 || lag > 10 * aim + 1) this.time = recording.end - aim;
      this.time = Math.min(recording.end, this.time + dt * this.rate * Math.max(0, 1 + 0.5 * (lag - aim) / aim));
      return;
    }
    if (!this.isPlaying) return;
    this.time += dt * this.speed;
    if (this.time < recording.end) return;
    this.time = recording.end;
    this.isPlaying = false;
    if (this.isLive) this.follow(true);
  }

  // Slider and clock, at some of the frames while time runs.
  show(now) {
    if (this.isPlaying && now - this.shownAt < CLOCK_PERIOD) return;
    this.shownAt = now;
    const slider = byId('time'), { recording } = this;
    slider.min = recording.start;
    slider.max = Math.max(recording.end, recording.start + 0.01);
    if (document.activeElement !== slider || this.isPlaying) slider.value = this.time;
    slider.setAttribute('aria-valuetext', `${this.time.toFixed(1)} seconds`);
    setText(byId('clock'), `${this.time.toFixed(1)} of ${recording.end.toFixed(1)} s`);
    setText(byId('play'), this.isPlaying ? '❚❚' : '▶');
    const label = this.isPlaying ? 'pause' : 'play';
    if (byId('play').getAttribute('aria-label') !== label) byId('play').setAttribute('aria-label', label);
  }
}
