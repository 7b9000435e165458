// Stretches of recordings that are left out, alone are used, or test the model: marked in the plots, listed and changed by number.

import { faults, uses } from '../api.js';
import { failed, fill, h, say } from '../dom.js';
import { Edit } from '../edit.js';
import { link } from '../place.js';

/** @typedef {{ place: number, usage: string, from_s: number, to_s: number }} Stretch */
/** @typedef {{ file: string, offset_s: number }} Drawn */

/** Uses of a stretch: its key in the bench file, its letter in the plots, its colour. */
const USES = [
  { key: 'leave_out', letter: 'L', kind: 'leave', words: 'leave out (L)' },
  { key: 'estimate', letter: 'E', kind: 'estimate', words: 'use this alone (E)' },
  { key: 'validate', letter: 'V', kind: 'validate', words: 'keep for validation (V)' },
];

/** Pixels that a drag takes at least. */
const LEAST_DRAG = 3;

export class Marks {
  /**
   * @param {import('../chart/panels.js').Panels} panels
   * @param {() => { file: string, drawn: Drawn[] }} shown the recording that is marked, and all that are drawn
   * @param {string | undefined} bench the bench file
   */
  constructor(panels, shown, bench) {
    this.panels = panels;
    this.shown = shown;
    this.bench = bench;
    /** @type {Edit | null} */
    this.edit = null;
    /** @type {Map<string, { name: string, stretches: Stretch[] }>} */
    this.known = new Map();
    /** The stretch that is being drawn. @type {[number, number] | null} */
    this.growing = null;
    /** Faults of the marks in the bench file. @type {{ line: number, text: string }[]} */
    this.faults = [];
    this.isOn = false;
    this.button = h('button', { 'aria-pressed': 'false', title: 'm', onclick: () => this.turn() }, 'Mark');
    this.element = h('section', { class: 'marks', 'aria-label': 'Marked stretches', hidden: true });
    this.panels.canvas.addEventListener('keydown', (event) => {
      if (event.key === 'm' && !event.ctrlKey && !event.metaKey && !event.altKey) this.turn();
    });
    this.listen();
  }

  /** Reads what is marked, if there is a bench file. */
  async open() {
    if (!this.bench) return;
    this.edit = await Edit.open(this.bench);
    this.edit.heard = (_now, isSettled) => { if (isSettled) this.read().catch(failed); };
    this.edit.listen(this.element);
    await this.read();
  }

  async read() {
    if (!this.edit) return;
    const [all, { faults: found }] = await Promise.all([uses(this.edit.file, this.edit.now), faults(this.edit.file, this.edit.now)]);
    this.known = new Map(all.map((/** @type {any} */ use) => [use.file, use]));
    this.faults = found.filter((fault) => fault.text.startsWith('recordings.stretch'));
    this.show();
  }

  /** Turns marking on or off. */
  turn() {
    if (!this.edit) {
      say('There is no bench file yet, which keeps the marks. Propose one in the view Bench.');
      return;
    }
    this.isOn = !this.isOn;
    this.button.setAttribute('aria-pressed', String(this.isOn));
    this.panels.canvas.style.cursor = this.isOn ? 'col-resize' : '';
    this.show();
  }

  /** Draws the marks of all recordings that are shown. */
  draw() {
    const { drawn } = this.shown();
    const several = new Set(drawn.map((each) => each.file)).size > 1;
    const places = new Map(drawn.map((each) => [`${each.file}\n${each.offset_s}`, each]));
    this.panels.stretches = [...places.values()].flatMap((each) => (this.known.get(each.file)?.stretches ?? []).map(({ usage, from_s, to_s }) => {
      const { kind, letter } = USES.find((use) => use.key === usage) ?? USES[0];
      return { from_s: from_s + each.offset_s, to_s: to_s + each.offset_s, kind, text: several ? `${letter} ${each.file}` : letter };
    }));
    if (this.growing) {
      const [from_s, to_s] = [Math.min(...this.growing), Math.max(...this.growing)];
      this.panels.stretches.push({ from_s, to_s, kind: USES[0].kind, text: USES[0].letter });
    }
    this.panels.draw();
  }

  /** Draws and lists the marks. */
  show() {
    this.draw();
    const { file } = this.shown();
    const focused = this.element.contains(document.activeElement) ? document.activeElement?.getAttribute('aria-label') : null;
    this.list(file);
    if (focused) /** @type {HTMLElement | null} */ (this.element.querySelector(`[aria-label="${focused}"]`))?.focus();
  }

  /** @param {string} file */
  list(file) {
    const stretches = this.known.get(file)?.stretches ?? [];
    this.element.hidden = !this.isOn && !stretches.length;
    if (!this.edit || this.element.hidden) return;
    fill(this.element, h('h2', {}, `Stretches of ${file}`), this.isOn && h('p', { class: 'soft' },
      'Drag over the plot (with Shift to move it), or set the cursors A and B. A sample at either end belongs to the stretch. Times are s of the recording’s own clock.'),
      this.edit.tools,
      h('div', { class: 'tools' },
        h('button', { onclick: () => this.ofCursors() }, 'Mark from A to B'),
        h('a', { href: link('bench', { file: this.bench }) }, 'The bench file as text')),
      this.faults.length > 0 && h('ul', { class: 'fault' }, this.faults.map((fault) => h('li', {}, `Line ${fault.line}: ${fault.text}`))),
      stretches.length ? h('ol', {}, stretches.map((stretch, index) => this.row(stretch, index + 1))) : h('p', {}, 'Nothing is marked: all of it is used.'));
  }

  /** @param {Stretch} stretch @param {number} number */
  row(stretch, number) {
    const field = (/** @type {string} */ name, /** @type {number} */ value) => h('input', {
      type: 'number', step: 'any', value, 'aria-label': `${name} of stretch ${number}, s`, onchange: () => set(),
    });
    const [from, to] = [field('Beginning', stretch.from_s), field('End', stretch.to_s)];
    const usage = h('select', { 'aria-label': `Use of stretch ${number}`, onchange: () => set() },
      USES.map((use) => h('option', { value: use.key, selected: use.key === stretch.usage }, use.words)));
    const key = ['recordings', 'stretch', String(stretch.place)];
    const set = () => this.edit?.set([
      ...(usage.value === stretch.usage ? [] : [{ key: [...key, stretch.usage], value: null }]),
      { key: [...key, usage.value], value: [Number(from.value), Number(to.value)] },
    ]);
    return h('li', {}, from, ' to ', to, ' s ', usage, ' ',
      h('button', { 'aria-label': `Delete stretch ${number}`, onclick: () => this.edit?.set([{ key, value: null }]) }, 'Delete'));
  }

  ofCursors() {
    const [a, b] = this.panels.cursors;
    if (a === null || b === null || a === b) say('Set both cursors first: click twice into a plot, or press a and b.');
    else this.add(a, b);
  }

  /** Marks a stretch of the chosen recording, between two times of the plot. @param {number} a @param {number} b */
  add(a, b) {
    const { file, drawn } = this.shown();
    const offset_s = drawn.find((each) => each.file === file)?.offset_s ?? 0;
    const name = this.known.get(file)?.name;
    const [from, to] = [Math.min(a, b) - offset_s, Math.max(a, b) - offset_s].map((time) => this.rounded(time));
    if (name && from < to) this.edit?.set([{ key: ['recordings', 'stretch', '+'], value: { file: name, [USES[0].key]: [from, to] } }]);
  }

  /** A time to a tenth of a pixel. @param {number} time */
  rounded(time) {
    const digits = Math.max(0, Math.min(12, 1 - Math.floor(Math.log10((this.panels.to - this.panels.from) / this.panels.width))));
    return Number(time.toFixed(digits));
  }

  /** While marking is on, a drag marks in place of moving. */
  listen() {
    const { canvas } = this.panels;
    const first = { capture: true };
    canvas.addEventListener('pointerdown', (event) => {
      if (!this.isOn || event.button !== 0 || event.shiftKey) return;
      event.stopImmediatePropagation();
      canvas.setPointerCapture(event.pointerId);
      const time = this.panels.timeAt(event.offsetX);
      this.growing = [time, time];
    }, first);
    canvas.addEventListener('pointermove', (event) => {
      if (!this.growing) return;
      this.growing[1] = this.panels.timeAt(event.offsetX);
      this.draw();
    }, first);
    canvas.addEventListener('pointerup', () => {
      if (!this.growing) return;
      const [a, b] = this.growing;
      this.growing = null;
      this.draw();
      // A click without a drag sets a cursor, as ever.
      if (Math.abs(this.panels.xOf(a) - this.panels.xOf(b)) <= LEAST_DRAG) this.panels.click(a);
      else this.add(a, b);
    }, first);
    canvas.addEventListener('pointercancel', () => {
      this.growing = null;
      this.draw();
    });
  }
}
