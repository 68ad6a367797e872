'use strict';
// Puts the page together: a report that it holds, or the server it came from.

// How long it is shown why something was refused [ms].
const REFUSAL_TIME = 6000;

class App {
  constructor() {
    this.recording = new Recording();
    this.camera = new Camera(byId('floor'));
    this.floor = new Floor(byId('floor'), this.camera);
    this.player = new Player(this.recording);
    this.panel = new Panel((time) => this.player.seek(time));
    this.canEdit = false;
    this.needsDrawing = true;
    this.shown = { time: NaN, version: -1 };
    this.frames = [];
    this.editor = new Editor(byId('floor'), this);
    this.session = new SessionControls(this);
    this.connection = null;
    this.listen();
    requestAnimationFrame((now) => this.frame(now));
  }

  redraw() { this.needsDrawing = true; }

  send(message) { if (this.connection) this.connection.send(message); }

  listen() {
    new ResizeObserver(() => {
      this.camera.resize();
      if (!this.camera.isMoved) this.camera.fit(this.recording);
      this.redraw();
    }).observe(byId('floor'));
    matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => {
      this.floor.setTheme();
      this.recording.version += 1;
      this.redraw();
    });
    const zoom = (factor) => { this.camera.zoom(factor); this.redraw(); };
    const fit = () => { this.camera.fit(this.recording); this.redraw(); };
    byId('zoom-in').addEventListener('click', () => zoom(1.3));
    byId('zoom-out').addEventListener('click', () => zoom(1 / 1.3));
    byId('fit').addEventListener('click', fit);
    byId('ghost').addEventListener('change', () => {
      this.recording.showsGhost = byId('ghost').checked;
      this.recording.version += 1;
    });
    byId('restart').addEventListener('click', () => this.send({ type: 'restart' }));
    const keys = {
      ' ': () => this.player.toggle(), ',': () => this.player.step(-1), '.': () => this.player.step(1),
      'f': fit, '+': () => zoom(1.3), '-': () => zoom(1 / 1.3) };
    TOOLS.forEach((tool, i) => { keys[i + 1] = () => { if (tool === 'pan' || (this.tools || []).includes(tool)) this.editor.setTool(tool); }; });
    document.addEventListener('keydown', (event) => {
      const isTyping = event.target.closest('input, select, textarea, summary');
      const isButton = event.target.closest('button') && event.key === ' ';
      if ((event.ctrlKey || event.metaKey) && event.key === 'z' && (this.tools || []).includes('wall')) {
        event.preventDefault();
        this.send({ type: 'undo' });
      }
      if (isTyping || isButton || event.ctrlKey || event.altKey || event.metaKey || !keys[event.key]) return;
      event.preventDefault();
      keys[event.key]();
    });
  }

  fitOnce() {
    if (!this.camera.isFitted && this.camera.width) this.camera.fit(this.recording);
  }

  apply(message) {
    if (this.recording.apply(message)) {
      if (message.type === 'scene') this.onScene();
      if (message.type === 'rows') this.onRows();
    } else if (message.type === 'controls') {
      this.onControls(message);
    } else if (message.type === 'run') {
      this.onRun(message);
    } else if (message.type === 'walls') {
      this.onWalls(message);
    } else if (message.type === 'link') {
      this.session.link = message.link;
    } else if (message.type === 'preparation') {
      this.session.showPreparation(message);
    } else if (message.type === 'notice') {
      this.showMessage(message.text, this.player.ownsTime && !message.is_passing ? Infinity : REFUSAL_TIME);
    } else if (message.type === 'refused') {
      this.showMessage(`refused: ${message.text}`, REFUSAL_TIME);
    }
  }

  onRows() {
    this.fitOnce();
    if (this.recording.isLive && this.player.isFollowing && !this.editor.edit) this.camera.follow(this.recording);
  }

  onWalls(message) {
    this.recording.walls = message.walls;
    this.floor.hoveredWall = -1;
    byId('undo').disabled = !message.can_undo;
    byId('clear-walls').disabled = !message.walls.length;
    this.redraw();
  }

  onScene() {
    byId('ghost-choice').hidden = !this.recording.ghost;
    this.recording.isLive = this.player.isLive;
    this.camera.isFitted = false;
    this.player.time = 0;
    this.panel.setScene(this.recording);
  }

  // What the user of a live page can do: of a simulation everything, of a robot some things or none.
  onControls(message) {
    this.tools = message.tools;
    this.canEdit = message.tools.length > 0;
    this.player.ownsTime = message.owns_time;
    const shown = {
      tools: this.canEdit, restart: message.owns_time, 'clear-walls': message.tools.includes('wall'),
      undo: message.tools.includes('wall'), 'copy-link': message.choices.length > 0, save: message.choices.length > 0,
      'choice-section': message.owns_time, 'sensor-section': message.settings.length > 0,
      calls: message.calls.length > 0, 'speed-choice': message.owns_time };
    for (const [id, isShown] of Object.entries(shown)) byId(id).hidden = !isShown;
    for (const radio of document.getElementsByName('tool')) {
      radio.parentElement.hidden = radio.value !== 'pan' && !message.tools.includes(radio.value);
    }
    for (const element of document.querySelectorAll('.live')) element.hidden = !this.canEdit;
    this.floor.showsHandles = this.canEdit;
    this.floor.canDragObject = message.tools.includes('object');
    if (!this.canEdit) this.editor.setTool('pan');
    this.panel.showControls(message, (answer) => this.send(answer));
    this.session.showPresets(message.presets);
    byId('hint-walls').hidden = !message.tools.includes('wall');
    if (message.owns_time) {
      this.session.showHint();
      this.session.openLink();
    }
    this.redraw();
  }

  onRun(message) {
    // While it shows again what has been, time stands.
    if (!message.paused || this.player.isFollowing) this.player.isPlaying = !message.paused;
    if (!message.paused) this.player.isFollowing = true;
    this.player.speed = message.speed;
    this.player.rate = message.achieved === null ? message.speed : Math.max(message.achieved, LEAST_RATE);
    byId('speed').value = message.speed;
    const isSlow = message.achieved !== null && message.achieved < 0.8 * message.speed;
    const isResting = message.at_rest && !message.paused;
    setText(byId('achieved'), isResting ? 'time stands until something happens' : isSlow ? `(this machine: ${message.achieved} ×)` : '');
  }

  showMessage(text, duration = Infinity) {
    clearTimeout(this.messageTimer);
    byId('message').hidden = !text;
    setText(byId('message'), text);
    if (duration < Infinity) this.messageTimer = setTimeout(() => this.showMessage(''), duration);
  }

  openRun(messages) {
    messages.forEach((message) => this.apply(message));
    this.fitOnce();
    this.player.isPlaying = !matchMedia('(prefers-reduced-motion: reduce)').matches;
  }

  // A report: one of its runs at a time.
  openDocument(report) {
    const open = (run) => this.openRun(run.messages);
    this.player.showSpeeds(REPORT_SPEEDS);
    report.runs.forEach((run, i) => byId('run').append(new Option(run.name, i)));
    byId('run-choice').hidden = report.runs.length < 2;
    byId('run').addEventListener('change', () => open(report.runs[byId('run').value]));
    const endings = report.runs.flatMap((run) => run.messages.filter((message) => message.type === 'ending'));
    this.panel.showResults(report.table, endings.flatMap((ending) => ending.notes));
    open(report.runs[0]);
  }

  openConnection() {
    this.connection = new Connection(
      (messages) => messages.forEach((message) => this.apply(message)),
      (isOpen) => {
        this.showMessage(isOpen ? '' : 'no connection to the server; trying again');
        byId('stage').dataset.connected = isOpen;
      });
    this.player.send = (message) => this.send(message);
    this.player.isFollowing = true;
    this.player.showSpeeds(LIVE_SPEEDS);
  }

  frame(now) {
    const dt = this.before === undefined ? 0 : Math.min(0.25, (now - this.before) / 1000);
    this.before = now;
    const started = performance.now();
    this.player.advance(dt);
    const { recording, player } = this;
    if (this.needsDrawing || player.time !== this.shown.time || recording.version !== this.shown.version || this.panel.isLate(recording)) {
      const isForced = this.needsDrawing;
      this.shown = { time: player.time, version: recording.version };
      this.needsDrawing = false;
      this.floor.draw(recording, player.time, this.editor.edit);
      this.panel.show(recording, player.time, now, isForced || !player.isPlaying);
      player.show(now);
      this.frames.push(performance.now() - started);
      if (this.frames.length > 600) this.frames.splice(0, 300);
    }
    requestAnimationFrame((next) => this.frame(next));
  }
}

const app = new App();
embeddedDocument().then((report) => {
  if (!report) app.openConnection();
  else app.openDocument(report);
});
