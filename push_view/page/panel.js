'use strict';
// Values, tables, events and settings beside the floor.

const STATES = {
  idle: 'idle', plan: 'plans', approach: 'drives to the object', align: 'probes for contact', push: 'pushes',
  retreat: 'backs off', look: 'looks for the object', done: 'done', missed: 'missed the goal', failed: 'failed', paused: 'paused',
  stopped: 'stopped' };
// The panel is renewed this often while time runs [ms].
const PANEL_PERIOD = 100;

const byId = (id) => document.getElementById(id);

function setText(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

// A span of a class.
function span(className, text = '') {
  return Object.assign(document.createElement('span'), { className, textContent: text });
}

function cell(row, text, tag = 'td') {
  const element = document.createElement(tag);
  element.textContent = text;
  row.append(element);
  return element;
}

// Name of a state of the supervisor; one that stands for a fault is stopped.
function stateName(message) {
  return message.state === 'idle' && message.reason && !message.requested ? 'stopped' : message.state;
}

const LEGEND = [
  ['object', '<rect x="3" y="3" width="24" height="12" fill="var(--object)" fill-opacity=".2" stroke="var(--object)" stroke-width="2"/>'],
  ['goal', '<rect x="3" y="3" width="24" height="12" fill="none" stroke="var(--goal)" stroke-width="2.5" stroke-dasharray="6 3"/>'],
  ['robot', '<circle cx="15" cy="9" r="7" fill="var(--robot)" stroke="var(--ink)"/><path d="M15 9h7" stroke="var(--ink)" stroke-width="2"/>'],
  ['believed pose', '<rect x="3" y="3" width="24" height="12" fill="none" stroke="var(--believed)" stroke-width="1.6" stroke-dasharray="7 2 2 2"/>'],
  ['run before', '<rect x="3" y="3" width="24" height="12" fill="none" stroke="var(--faint)" stroke-width="1.2" stroke-dasharray="2 3"/>'],
  ['path of the object in push 1', '<path d="M2 13 22 6" stroke="var(--push-0)" stroke-width="3.5"/><circle cx="23" cy="6" r="5" fill="var(--paper)" stroke="var(--push-0)" stroke-width="2"/>'],
  ['path of the robot', '<path d="M2 9h26" stroke="var(--faint)" stroke-width="2" stroke-dasharray="1 4"/>'],
  ['plan', '<path d="M2 9h26" stroke="var(--plan)" stroke-width="2" stroke-dasharray="7 4"/>'],
  ['object after push 2, as planned', '<rect x="3" y="2" width="24" height="14" fill="none" stroke="var(--push-1)" stroke-width="1.5" stroke-dasharray="4 3"/><circle cx="15" cy="9" r="5" fill="var(--paper)" stroke="var(--push-1)" stroke-width="2"/>'],
  ['robot where push 2 starts, and its way there, as planned', '<path d="M1 9h14" stroke="var(--push-1)" stroke-width="1.5" stroke-dasharray="2 3"/><circle cx="22" cy="9" r="6.5" fill="none" stroke="var(--push-1)" stroke-dasharray="4 3"/>'],
  ['no plan: free floor, floor that is needed', '<circle cx="15" cy="9" r="5" fill="var(--force)" fill-opacity=".2" stroke="var(--force)"/><circle cx="15" cy="9" r="8" fill="none" stroke="var(--force)" stroke-width="1.5" stroke-dasharray="5 2"/>'],
  ['no plan: where the robot may be there, 2 σ', '<ellipse cx="15" cy="9" rx="13" ry="5" fill="var(--believed)" fill-opacity=".3" stroke="var(--believed)" stroke-width="1.5"/>'],
  ['no plan: no room for the robot at this side', '<circle cx="15" cy="9" r="8" fill="none" stroke="var(--force)" stroke-width="1.5"/><path d="m11 5 8 8m0-8-8 8" stroke="var(--force)" stroke-width="2.5"/>'],
  ['no plan: the object would be in a wall', '<rect x="3" y="3" width="24" height="12" fill="var(--force)" fill-opacity=".3" stroke="var(--force)" stroke-width="3"/>'],
  ['contact force (1 m: the weight)', '<path d="M3 9h22m-6-5 6 5-6 5" fill="none" stroke="var(--force)" stroke-width="2.5"/>'],
  ['friction cone', '<path d="M3 9 27 2v14z" fill="var(--cone)" fill-opacity=".15" stroke="var(--cone)" stroke-dasharray="5 2 1 2"/>'],
  ['true centre of friction', '<path d="m10 4 10 10m0-10L10 14" stroke="var(--object)" stroke-width="3"/>'],
  ['believed centre of friction, 2 σ', '<path d="M15 3v12M9 9h12" stroke="var(--believed)" stroke-width="2.5"/><ellipse cx="15" cy="9" rx="13" ry="8" fill="none" stroke="var(--believed)"/>'],
  ['what the camera sees; dashed: not the object', '<path d="M3 9 27 2v14z" fill="var(--view)" fill-opacity=".15" stroke="var(--view)"/>'],
  ['object unseen: true, believed, 2 σ', '<rect x="2" y="3" width="14" height="12" fill="none" stroke="var(--object)" stroke-dasharray="2 3"/><rect x="12" y="3" width="14" height="12" fill="var(--believed)" fill-opacity=".2" stroke="var(--believed)" stroke-dasharray="7 2 2 2"/><ellipse cx="19" cy="9" rx="5" ry="3" fill="var(--believed)" fill-opacity=".4" stroke="var(--believed)"/>'],
  ['a wall was touched', '<circle cx="15" cy="9" r="7" fill="var(--paper)" stroke="var(--force)" stroke-width="2.5"/><path d="m12 6 6 6m0-6-6 6" stroke="var(--force)" stroke-width="2"/>'],
  ['friction of a foot: true, nominal', '<circle cx="9" cy="9" r="5" fill="var(--object)" fill-opacity=".5"/><circle cx="22" cy="9" r="5" fill="none" stroke="var(--faint)" stroke-dasharray="3 2"/>'],
];

// What the controller learns of a base: its name in messages, on the page, in which unit and with how many decimals.
const BASE_VALUES = [
  ['dead_time', 'dead time', 's', 2], ['min_speed', 'least speed', 'm/s', 3],
  ['min_yaw_rate', 'least yaw rate', 'rad/s', 2], ['pulse', 'pulse', 's', 2],
  ['max_acceleration', 'acceleration', 'm/s²', 2], ['max_yaw_acceleration', 'yaw acceleration', 'rad/s²', 1],
  ['first_gain', 'gain of the left wheel', '', 2], ['second_gain', 'gain of the right wheel', '', 2], ['gain_deviation', 'deviation of gains', '', 2]];
const HOLONOMIC_LABELS = { first_gain: 'gain of the translation', second_gain: 'gain of the rotation' };

class Panel {
  constructor(onTime) {
    this.onTime = onTime;
    this.charts = CHARTS.map((definition) => new Chart(definition, byId('charts'), onTime));
    this.values = new Map();
    this.room = new RoomPanel();
    this.renewedAt = -Infinity;
    this.eventsVersion = '';
    this.inputs = new Map();
    byId('legend').innerHTML = LEGEND.map(
      ([name, picture]) => `<li><svg viewBox="0 0 30 18" aria-hidden="true">${picture}</svg>${name}</li>`).join('');
    for (const term of document.querySelectorAll('th.term')) explain(term, term.textContent);
  }

  // A new scene: tables have other rows.
  setScene(recording) {
    const scene = recording.scene;
    setText(byId('title'), scene.title);
    setText(byId('description'), scene.description);
    this.room.setScene(scene);
    this.setFriction(scene.object);
    this.setBase(recording.scene);
    this.eventsVersion = '';
    this.inputs.clear();
  }

  // Rows for each foot of the object that is pushed.
  setFriction(object) {
    const body = byId('friction').tBodies[0];
    body.textContent = '';
    this.object = object;
    this.friction = object.supports.map((support, i) => this.frictionRow(
      body, `foot ${i + 1} (${support[0].toFixed(2)}, ${support[1].toFixed(2)})`, `friction.${i}`));
    this.friction.push(this.frictionRow(body, 'contact', 'contact_friction'));
  }

  // A differential drive has least speeds of its wheels only.
  setBase(scene) {
    const body = byId('base').tBodies[0];
    body.textContent = '';
    const isHolonomic = scene.robot.drive === 'holonomic';
    this.base = BASE_VALUES.filter(([name]) => isHolonomic || name !== 'min_yaw_rate').map(([name, wheelLabel, unit, digits]) => {
      const row = body.insertRow(), label = isHolonomic && HOLONOMIC_LABELS[name] || wheelLabel;
      const head = explain(cell(row, unit ? `${label} [${unit}]` : label, 'th'), label);
      Object.assign(head, { scope: 'row', className: 'term' });
      return { name, digits, cells: [0, 1, 2].map(() => cell(row, '')) };
    });
  }

  frictionRow(body, name, setting) {
    const row = body.insertRow();
    Object.assign(explain(cell(row, name, 'th'), name), { scope: 'row', className: 'term' });
    const cells = { setting, trueValue: cell(row, ''), nominal: cell(row, ''), believed: cell(row, '') };
    return cells;
  }

  isLate(recording) { return this.charts.some((chart) => chart.isLate(recording)); }

  show(recording, time, now, isForced) {
    if (!recording.scene) return;
    const isRenewed = isForced || now - this.renewedAt >= PANEL_PERIOD;
    this.charts.forEach((chart) => chart.show(recording, time, now, isRenewed));
    if (!isRenewed) return;
    this.renewedAt = now;
    const values = recording.at(time), state = recording.latest('state', time);
    const ending = recording.latest('ending', time);
    const { object } = recording.sceneAt(time);
    if (object !== this.object) this.setFriction(object);
    this.room.show(recording, time);
    this.showState(state, ending);
    this.showValues(recording, values, time);
    this.showFriction(recording, values, time);
    this.showBase(recording, time);
    this.showEvents(recording, time);
  }

  showState(state, ending) {
    // Done with its commands, a law in open loop may have missed the goal.
    const isMissed = Boolean(ending && ending.missed && ending.missed.length);
    const name = isMissed ? 'missed' : state ? stateName(state) : 'idle';
    byId('state').dataset.state = name;
    setText(byId('state'), STATES[name] || name);
    setText(byId('reason'), state && state.reason || isMissed && ending.missed.join('; ') || ending && ending.reason || '');
  }

  setValue(name, text) {
    if (!this.values.has(name)) {
      const term = document.createElement('dt'), value = document.createElement('dd');
      term.append(explain(span('term', name), name));
      byId('values').append(term, value);
      this.values.set(name, value);
    }
    setText(this.values.get(name), text);
  }

  showValues(recording, values, time) {
    const row = recording.isEmpty ? 0 : recording.rowAt(time);
    const [distance, angle] = recording.isEmpty ? [NaN, NaN] : poseError(recording, row);
    const number = (value, factor, digits, unit) =>
      Number.isFinite(value) ? `${(factor * value).toFixed(digits)} ${unit}` : '–';
    this.setValue('object to goal', `${number(distance, 1e3, 1, 'mm')}, ${number(angle, 1 / DEGREE, 1, '°')}`);
    this.setValue('gap between robot and object', number(values('gap'), 1e3, 0, 'mm'));
    this.setValue('contact force', number(Math.hypot(values('force_n'), values('force_t')), 1, 1, 'N'));
    this.setValue('speed of the robot', number(Math.hypot(values('robot_v_x'), values('robot_v_y')), 1, 2, 'm/s'));
    const pushes = recording.pushes().filter((push) => push.start <= time).length;
    this.setValue('pushes so far', String(pushes));
    if (recording.has('believed_object_x')) {
      this.setValue('believed minus true object', number(
        Math.hypot(values('believed_object_x') - values('object_x'), values('believed_object_y') - values('object_y')), 1e3, 1, 'mm'));
      this.setValue('known to (standard deviation)', `${number(values('believed_object_deviation_major'), 1e3, 1, 'mm')}, ${
        number(values('believed_object_heading_deviation'), 1 / DEGREE, 1, '°')}`);
      this.setValue('object seen', isSeen(values) ? 'yes' : 'no');
    }
    this.showOutlook(recording, time);
    const truth = recording.latest('truth', time), center = recording.sceneAt(time).object.friction_center;
    if (truth) {
      const x = values('believed_center_x'), y = values('believed_center_y');
      const believed = Number.isFinite(x) ? [x, y] : center;
      this.setValue('believed minus true centre of friction', number(Math.hypot(
        believed[0] - truth.friction_center[0], believed[1] - truth.friction_center[1]), 1e3, 0, 'mm'));
    }
  }

  // What the last plan states of the end, until that is there.
  showOutlook(recording, time) {
    const plan = recording.latest('plan', time), outlook = plan && plan.outlook;
    if (!outlook) return;
    const isOver = Boolean(recording.latest('ending', time));
    const text = (words) => isOver ? '–' : words;
    const left = (level) => Math.max(0, outlook[`time.${level}`] - (time - plan.time)).toFixed(0);
    const error = (level) => (1e3 * outlook[`position_error.${level}`]).toFixed(1);
    this.setValue('stated chance', text(`${(100 * outlook.chance).toFixed(0)} %`));
    this.setValue('time left, as stated', text(`${left('median')} s (95 %: ${left('p95')} s)`));
    this.setValue('error at the end, as stated', text(`${error('median')} mm (95 %: ${error('p95')} mm)`));
  }

  showFriction(recording, values, time) {
    const truth = recording.latest('truth', time), nominal = recording.sceneAt(time).object;
    const text = (value) => Number.isFinite(value) ? value.toFixed(2) : '–';
    this.friction.forEach((cells, i) => {
      const isContact = i === this.friction.length - 1;
      const known = truth ? (isContact ? truth.contact_friction : truth.friction[i]) : NaN;
      if (!this.inputs.has(cells.setting)) setText(cells.trueValue, text(known));
      setText(cells.nominal, text(isContact ? nominal.contact_friction : nominal.friction[i]));
      setText(cells.believed, text(values(isContact ? 'believed_contact_friction' : `believed_friction_${i}`)));
    });
  }

  showBase(recording, time) {
    const learned = recording.latest('base', time), scene = recording.scene;
    byId('base-section').hidden = !learned;
    for (const { name, digits, cells } of this.base) {
      [scene.true_base, scene.robot, learned].forEach((values, i) => {
        const value = values && values[name];
        setText(cells[i], Number.isFinite(value) ? value.toFixed(digits) : '–');
      });
    }
  }

  showEvents(recording, time) {
    const version = `${recording.states.length},${recording.goals.length},${recording.orders.length},${recording.displacements.length},${recording.collisions.length},${recording.endings.length}`;
    if (version !== this.eventsVersion) {
      this.eventsVersion = version;
      this.listEvents(recording);
    }
    const current = this.events.filter((event) => event.time <= time + 1e-9).pop();
    for (const event of this.events) {
      const isCurrent = event === current;
      if (event.isCurrent === isCurrent) continue;
      event.isCurrent = isCurrent;
      event.button.setAttribute('aria-current', String(isCurrent));
      if (isCurrent) byId('events').scrollTop = event.button.offsetTop - byId('events').offsetTop - 90;
    }
  }

  listEvents(recording) {
    let pushes = 0;
    const texts = [
      ...recording.states.map((message, i) => {
        if (recording.isPushStart(i)) pushes += 1;
        const state = stateName(message), name = state === 'push' ? `push ${pushes}` : STATES[state] || state;
        return [message.time, message.reason ? `${name}: ${message.reason}` : name];
      }),
      ...recording.orders.filter((message) => message.text).map((message) => [message.time, message.text]),
      ...(recording.scene.objects ? [] : recording.goals.slice(1)).map((message) => [message.time, 'new goal']),
      ...recording.displacements.map((message) => [message.time, 'somebody moves the object']),
      ...recording.collisions.map((message) => [message.time, `the ${message.body} touches a wall`]),
      ...recording.endings.map((message) => [message.time, `run over: ${[message.outcome, ...(message.missed || [])].join('; ')}`]),
    ].sort((one, other) => one[0] - other[0]);
    byId('events').textContent = '';
    this.events = texts.map(([time, text]) => {
      const item = document.createElement('li'), button = document.createElement('button');
      button.type = 'button';
      for (const part of [`${time.toFixed(1)} s`, text]) {
        button.append(Object.assign(document.createElement('span'), { textContent: part }));
      }
      button.addEventListener('click', () => this.onTime(time));
      item.append(button);
      byId('events').append(item);
      return { time, button, isCurrent: false };
    });
  }

  // The table of a report: a head, and lines of cells.
  showResults(lines, notes) {
    const table = byId('results').querySelector('table');
    for (const part of [table.tHead, table.tBodies[0], byId('notes')]) part.textContent = '';
    const head = table.tHead.insertRow();
    lines[0].forEach((text) => { cell(head, text, 'th').scope = 'col'; });
    for (const line of lines.slice(1)) {
      const row = table.tBodies[0].insertRow();
      line.forEach((text, i) => {
        const element = cell(row, text, i ? 'td' : 'th');
        if (!i) element.scope = 'row';
      });
    }
    for (const note of notes) {
      byId('notes').append(Object.assign(document.createElement('li'), { textContent: note }));
    }
    byId('results').hidden = false;
  }

  // Settings of a live page: choices, and numbers with a range; send takes a message.
  showControls(message, send) {
    byId('calls').replaceChildren(...message.calls.map((name) => {
      const button = Object.assign(document.createElement('button'), { type: 'button', name, textContent: name });
      button.addEventListener('click', () => send({ type: 'call', name }));
      return button;
    }));
    const names = JSON.stringify([message.choices.map((choice) => choice.options), message.settings.map((setting) => setting.name)]);
    if (names === this.controlNames && this.inputs.size) {
      this.renewControls(message);
      return;
    }
    this.controlNames = names;
    byId('choices').textContent = '';
    byId('sensors').textContent = '';
    this.inputs.clear();
    for (const choice of message.choices) this.addChoice(choice, send);
    for (const setting of message.settings) {
      const friction = this.friction.find((cells) => cells.setting === setting.name);
      this.addSetting(setting, friction && friction.trueValue, send);
    }
  }

  // The same inputs with other values; the one in use stays as it is, with its focus.
  renewControls(message) {
    for (const { name, value } of message.choices) byId('choices').querySelector(`[name="${name}"]`).value = value;
    for (const setting of message.settings) {
      const input = this.inputs.get(setting.name);
      if (input === document.activeElement) continue;
      input.value = setting.factor * setting.value;
      input.dispatchEvent(new Event('input'));
    }
  }

  addChoice(choice, send) {
    const label = document.createElement('label'), select = document.createElement('select');
    for (const option of choice.options) select.append(new Option(option.replaceAll('_', ' '), option));
    select.value = choice.value;
    select.name = choice.name;
    select.addEventListener('change', () => send({ type: 'choose', [choice.name]: select.value }));
    label.append(explain(span('term', choice.name), choice.name), select);
    byId('choices').append(label);
  }

  addSetting(setting, place, send) {
    const label = document.createElement('label'), input = document.createElement('input');
    const output = span('value');
    const low = setting.factor * setting.low, high = setting.factor * setting.high, step = (high - low) / 100;
    const digits = high >= 50 ? 0 : high > 2 ? 1 : 2;
    const show = () => { output.textContent = ` ${Number(input.value).toFixed(digits)} ${setting.unit}`; };
    Object.assign(input, { type: 'range', min: low, max: high, step, name: setting.name });
    input.value = setting.factor * setting.value;
    input.setAttribute('aria-label', setting.label);
    show();
    input.addEventListener('input', show);
    input.addEventListener('change', () => send({ type: 'set', name: setting.name, value: Number(input.value) / setting.factor }));
    this.inputs.set(setting.name, input);
    if (place) {
      place.replaceChildren(input, output);
      return;
    }
    label.append(explain(span('term', setting.label), setting.label), output, input);
    byId('sensors').append(label);
  }
}
