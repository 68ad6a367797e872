'use strict';
// What a live simulation offers beside the floor: presets, a link, a file, and what is being prepared.

const HINT_READ = 'push_control hint read';

class SessionControls {
  constructor(app) {
    this.app = app;
    this.link = '';
    this.openedLink = '';
    byId('undo').addEventListener('click', () => app.send({ type: 'undo' }));
    byId('copy-link').addEventListener('click', () => this.copyLink());
    byId('hint-read').addEventListener('click', () => this.closeHint());
    byId('save').href = `scenario.yaml${window.location.search}`;
    window.addEventListener('hashchange', () => this.openLink());
  }

  showPresets(presets) {
    byId('presets').hidden = !presets.length;
    byId('presets').replaceChildren(...presets.map((preset) => {
      const button = Object.assign(document.createElement('button'), {
        type: 'button', textContent: preset.name, title: preset.help });
      button.addEventListener('click', () => preset.commands.forEach((command) => this.command(command)));
      return button;
    }));
  }

  command(command) {
    this.app.send(command.type === 'kick' ? { type: 'displace', pose: this.kicked(command.by) } : command);
  }

  // Pose of the object after a kick: aside, away from the robot, and round.
  kicked([aside, away, rotation]) {
    const { recording } = this.app, values = recording.at(recording.end);
    const [x, y, theta] = poseOf(values, 'object'), robot = poseOf(values, 'robot');
    const angle = Math.atan2(y - robot[1], x - robot[0]), c = Math.cos(angle), s = Math.sin(angle);
    return [x + c * away - s * aside, y + s * away + c * aside, theta + rotation];
  }

  // What is prepared: over the floor where its user waits for it, else in a line.
  showPreparation(message) {
    for (const [id, isShown] of [['preparing', message.is_awaited], ['background', !message.is_awaited]]) {
      byId(id).hidden = !message.name || !isShown;
      const hint = message.part ? '' : ' (compiled the first time)';
      setText(byId(id).querySelector('span'), isShown ? `preparing pushes: ${message.name}${hint}` : '');
      const bar = byId(id).querySelector('progress');
      // Of what is compiled nobody knows how far it is.
      if (message.part) bar.value = message.part; else bar.removeAttribute('value');
    }
  }

  // A link that came with the address is opened once, after the server has said what there is.
  openLink() {
    const link = window.location.hash.slice(1);
    if (!link || link === this.openedLink) return;
    this.openedLink = link;
    this.app.send({ type: 'open', link });
  }

  async copyLink() {
    const { origin, pathname } = window.location, url = `${origin}${pathname}#${this.link}`;
    this.openedLink = this.link;
    try {
      await navigator.clipboard.writeText(url);
      this.app.showMessage('the link is in the clipboard', REFUSAL_TIME);
    } catch {
      // Without permission it stands in the address, to be copied there.
      window.location.hash = this.link;
      this.app.showMessage('the link is in the address of the page', REFUSAL_TIME);
    }
  }

  // Once for each visitor.
  showHint() {
    try {
      byId('hint').hidden = Boolean(localStorage.getItem(HINT_READ));
    } catch {
      byId('hint').hidden = false;
    }
  }

  closeHint() {
    byId('hint').hidden = true;
    try {
      localStorage.setItem(HINT_READ, 'yes');
    } catch {
      // Then it is shown again next time.
    }
  }
}
