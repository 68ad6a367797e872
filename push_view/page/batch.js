'use strict';
// Report of a batch: tables, and runs that are unpacked once somebody follows a link to them.

const LINK = /^#run-(\d+)$/;

class Batch {
  // open: called with the messages, the table and the name of a run.
  constructor(report, open) {
    this.report = report;
    this.open = open;
    document.title = report.title;
    byId('batch').hidden = false;
    for (const table of report.tables) byId('batch').append(this.section(table));
    for (const note of report.notes) {
      byId('batch').append(Object.assign(document.createElement('p'), { textContent: note }));
    }
    report.runs.forEach((run, i) => byId('run').append(new Option(run.name, i)));
    byId('run').addEventListener('change', () => { window.location.hash = `run-${byId('run').value}`; });
    byId('run-choice').hidden = true;
    document.querySelector('main').hidden = true;
    window.addEventListener('hashchange', () => this.openLinked());
    this.openLinked();
  }

  section(table) {
    const section = document.createElement('section'), element = document.createElement('table');
    section.append(Object.assign(document.createElement('h2'), { textContent: table.title }), element);
    const hasRuns = Object.keys(table.runs).length > 0;
    const head = element.createTHead().insertRow(), body = element.createTBody();
    for (const text of [...table.lines[0], ...(hasRuns ? ['replay'] : [])]) cell(head, text, 'th').scope = 'col';
    table.lines.slice(1).forEach((line, i) => {
      const row = body.insertRow();
      line.forEach((text) => cell(row, text));
      if (hasRuns) this.link(cell(row, ''), table.runs[i + 1]);
    });
    return section;
  }

  link(place, number) {
    if (number === undefined) return;
    const link = Object.assign(document.createElement('a'), { href: `#run-${number}`, textContent: '▶ replay' });
    link.setAttribute('aria-label', `replay ${this.report.runs[number].name}`);
    place.append(link);
  }

  async openLinked() {
    const found = window.location.hash.match(LINK), run = found && this.report.runs[Number(found[1])];
    if (!run) return;
    byId('run').value = found[1];
    byId('run-choice').hidden = false;
    document.querySelector('main').hidden = false;
    const { messages, table } = await unpack(run.packed);
    this.open(messages, table, run.name);
    byId('stage').scrollIntoView({ block: 'start' });
  }
}
