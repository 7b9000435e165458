// A bench file that is edited: undo, redo, drafts that outlive the page and the program, and no save over another's
// change. All views of one bench file edit it through this.

import { Fault, change, forget, get, keep, save } from './api.js';
import { failed, h, say } from './dom.js';

/** After so long without a key what was typed is kept. */
const PAUSE_MS = 300;

export class Edit {
  /** @param {string} file @param {string} text @param {string | null} state */
  constructor(file, text, state) {
    this.file = file;
    this.now = text;
    this.state = state;
    /** @type {string[]} */
    this.past = [];
    /** @type {string[]} */
    this.future = [];
    /** @type {ReturnType<typeof setTimeout> | undefined} */
    this.pause = undefined;
    /** Hears of every new text, and again when it was kept. @type {(text: string, isSettled: boolean) => void} */
    this.heard = () => {};
    this.stand = h('span', { class: 'soft', role: 'status' });
    this.undo = h('button', { onclick: () => this.step(this.past, this.future) }, 'Undo');
    this.redo = h('button', { onclick: () => this.step(this.future, this.past) }, 'Redo');
    this.tools = h('div', { class: 'tools' },
      h('button', { class: 'button', onclick: () => this.store() }, 'Save'), this.undo, this.redo,
      h('button', { onclick: () => this.reload() }, 'Load again'), this.stand);
    this.enable();
  }

  /** Opens a file with what was typed over it and not saved. @param {string} file */
  static async open(file) {
    const [read, kept] = await Promise.all([get('text', { file }), get('draft', { file })]);
    const edit = new Edit(file, kept.text ?? read.text, read.state);
    if (kept.text !== null && kept.text !== read.text) {
      edit.stand.textContent = kept.of === read.state ? 'typed earlier, not saved' : 'typed earlier; the file was changed since';
    }
    return edit;
  }

  /** Takes a new text, which can be undone; what is typed without a pause is one step. @param {string} next */
  changed(next) {
    if (next === this.now) return;
    if (this.pause === undefined) this.past.push(this.now);
    this.future = [];
    this.take(next);
  }

  /** Sets values by their keys; null takes a key away. @param {{ key: string[], value: any }[]} changes */
  async set(changes) {
    try {
      this.changed(await change(this.file, this.now, changes));
    } catch (error) {
      failed(error);
    }
  }

  /** @param {string} next */
  take(next) {
    this.now = next;
    this.stand.textContent = 'not saved';
    clearTimeout(this.pause);
    this.pause = setTimeout(() => this.settle(), PAUSE_MS);
    this.enable();
    this.heard(next, false);
  }

  async settle() {
    this.pause = undefined;
    this.heard(this.now, true);
    await keep(this.file, this.now, this.state);
  }

  /** @param {string[]} from @param {string[]} to */
  step(from, to) {
    const next = from.pop();
    if (next === undefined) return;
    to.push(this.now);
    this.take(next);
  }

  enable() {
    this.undo.disabled = this.past.length === 0;
    this.redo.disabled = this.future.length === 0;
  }

  async store() {
    clearTimeout(this.pause);
    this.pause = undefined;
    try {
      this.state = (await save(this.file, this.now, this.state)).state;
      this.stand.textContent = 'saved';
      say('');
    } catch (error) {
      await keep(this.file, this.now, this.state);
      say(error instanceof Fault ? error.message : String(error), true);
    }
  }

  async reload() {
    const fresh = await get('text', { file: this.file });
    this.state = fresh.state;
    this.changed(fresh.text);
    clearTimeout(this.pause);
    this.pause = undefined;
    await forget(this.file);
    this.heard(this.now, true);
    this.stand.textContent = '';
    say('');
  }

  /** Ctrl-S saves. @param {HTMLElement} element */
  listen(element) {
    element.addEventListener('keydown', (event) => {
      if ((event.ctrlKey || event.metaKey) && event.key === 's') {
        event.preventDefault();
        this.store();
      }
    });
  }
}
