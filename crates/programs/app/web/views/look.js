// Recordings as they are: plots over one time axis, cursors, and figures of the stretch between them.

import { get, view } from '../api.js';
import { Panels } from '../chart/panels.js';
import { figure } from '../chart/scale.js';
import { failed, fill, h, say, table } from '../dom.js';
import { note } from '../place.js';
import { nameOf, picture, stretch } from '../save.js';
import { Marks } from './marks.js';
import { size } from './start.js';
import { Stretch } from './stretch.js';

export const title = 'Look';

/** @typedef {{ file: string, channel: string, panel: number, offset_s: number }} Chosen */

/** @param {HTMLElement} element @param {Record<string, string>} given */
export async function show(element, given) {
  const state = await get('state');
  const files = /** @type {{ file: string, bytes: number }[]} */ (state.recordings);
  if (!files.length) {
    fill(element, h('p', {}, 'There are no recordings in this folder. Start the app on the folder that has them.'));
    return;
  }
  /** @type {Chosen[]} */
  let chosen = given.show ? JSON.parse(given.show) : [];
  let file = given.file ?? chosen[0]?.file ?? files[0].file;
  /** @type {Map<string, any>} */
  const catalogues = new Map();

  const plots = h('div', { class: 'plots' });
  const figures = h('div', { class: 'figures' });
  const list = h('div', { class: 'channels' });
  const shown = h('div', { class: 'shown' });
  const filter = h('input', { type: 'search', placeholder: 'Find a channel', 'aria-label': 'Find a channel', oninput: () => channels() });
  const over = h('input', { type: 'checkbox' });
  const choice = h('select', { 'aria-label': 'Recording', onchange: () => open(choice.value) },
    files.map((each) => h('option', { value: each.file, selected: each.file === file }, `${each.file} (${size(each.bytes)})`)));
  const form = h('select', { 'aria-label': 'Format' }, [['csv', 'CSV'], ['parquet', 'Parquet'], ['mf4', 'MF4']].map(([value, text]) => h('option', { value }, text)));
  const analysis = new Stretch(given.analysis ? JSON.parse(given.analysis) : {}, { lines: () => chosen, span, changed: () => remember(false) });
  const [marking, listed] = [h('span'), h('div')];
  fill(element,
    h('aside', {}, choice, h('label', {}, over, ' lay the next one over it'), filter, list, shown),
    h('section', { class: 'stage' },
      h('div', { class: 'tools' },
        h('button', { onclick: () => panels.all(), title: 'Home' }, 'All'),
        h('button', { onclick: () => panels.zoom(0.5), title: '+' }, 'Closer'),
        h('button', { onclick: () => panels.zoom(2), title: '-' }, 'Farther'),
        h('button', { onclick: () => between() }, 'Zoom to the cursors'), marking,
        h('span', { class: 'hint' }, 'Click for cursor A, again for B. Wheel zooms, drag moves, double click shows all.')),
      plots, figures, listed, analysis.element,
      h('div', { class: 'tools' },
        h('button', { onclick: () => saved(panels.canvas, 'plots') }, 'Save the plots as a picture'),
        h('button', { onclick: () => analysis.plot ? saved(analysis.plot.canvas, analysis.looks.kind ?? '') : say('Choose an analysis first.') }, 'Save the analysis as a picture'),
        h('label', {}, 'Save the stretch as ', form, ' ', h('button', { onclick: () => keep().catch(failed) }, 'Save')))));

  const panels = new Panels(plots, { moved: (_from, _to, isSettled) => { remember(isSettled); if (!marked()) analysis.update(); }, marked: () => { remember(false); measure(); }, failed });

  const marks = new Marks(panels, () => ({ file, drawn: chosen }), state.benches[0]?.file);
  marking.append(marks.button);
  listed.append(marks.element);

  /** @type {ReturnType<typeof setTimeout> | undefined} */
  let noting;
  function remember(/** @type {boolean} */ isNew) {
    clearTimeout(noting);
    noting = setTimeout(() => note('look', {
      file, show: JSON.stringify(chosen), from: panels.from, to: panels.to, a: panels.cursors[0], b: panels.cursors[1],
      analysis: analysis.looks.kind && JSON.stringify(analysis.looks),
    }, isNew), 150);
  }

  /** The stretch between the cursors; none without two of them. */
  function marked() {
    const [a, b] = panels.cursors;
    return a === null || b === null || a === b ? null : { from: Math.min(a, b), to: Math.max(a, b), words: 'Between the cursors' };
  }

  /** The stretch between the cursors, or else the one that is seen. */
  function span() {
    return marked() ?? { from: panels.from, to: panels.to, words: 'What is seen' };
  }

  /** @param {HTMLCanvasElement} canvas @param {string} what */
  function saved(canvas, what) {
    const { from, to } = what === 'plots' ? panels : span();
    picture(canvas, nameOf(file.split('/').at(-1) ?? file, from, to, `${what}.png`));
  }

  /** Writes the stretch of each recording that is shown. */
  async function keep() {
    const { from, to } = span();
    const parts = new Map(chosen.map((each) => [`${each.offset_s}\n${each.file}`, each]));
    for (const { file: name, offset_s } of parts.values()) {
      const own = chosen.filter((each) => each.file === name && each.offset_s === offset_s);
      await stretch(name, own.map((each) => each.channel), from - offset_s, to - offset_s, form.value);
    }
  }

  function between() {
    const found = marked();
    if (found) panels.goTo(found.from, found.to);
    else say('Set both cursors first: click twice into a plot.');
  }

  /** @param {string} name */
  async function catalogue(name) {
    if (!catalogues.has(name)) catalogues.set(name, await get('channels', { file: name }));
    return catalogues.get(name);
  }

  /** @param {string} name */
  async function open(name) {
    file = name;
    say('');
    try {
      const found = await catalogue(name);
      const isNew = !chosen.some((each) => each.file === name);
      if (isNew) {
        const own = usual(found.channels.map((/** @type {any} */ channel) => channel.name), name);
        chosen = over.checked ? [...chosen, ...own] : own;
      }
      channels();
      marks.show();
      if (isNew) await draw(true);
    } catch (error) {
      fill(list);
      failed(error);
    }
  }

  /**
   * The channels to begin with: those that are drawn of another recording, or else the first.
   * @param {string[]} names @param {string} name
   */
  function usual(names, name) {
    const same = chosen.filter((each) => names.includes(each.channel));
    if (same.length) return same.map((each) => ({ ...each, file: name, offset_s: 0 }));
    return names.slice(0, 3).map((channel, panel) => ({ file: name, channel, panel, offset_s: 0 }));
  }

  function channels() {
    const found = catalogues.get(file);
    const words = filter.value.toLowerCase();
    const matching = found.channels.filter((/** @type {any} */ channel) => channel.name.toLowerCase().includes(words));
    fill(list,
      h('p', { class: 'soft' }, `${matching.length} of ${found.channels.length} channels`),
      matching.slice(0, 500).map((/** @type {any} */ channel) => {
        const isShown = chosen.some((each) => each.file === file && each.channel === channel.name);
        const box = h('input', { type: 'checkbox', checked: isShown, onchange: () => toggle(channel.name, box.checked) });
        return h('label', { class: 'channel', title: channel.comment || channel.name }, box, h('span', {}, channel.name), h('span', { class: 'soft' }, channel.unit));
      }));
  }

  /** The lines that are drawn: in which plot, moved in time by how much. */
  function lines() {
    const several = new Set(chosen.map((each) => each.file)).size > 1;
    fill(shown, chosen.length > 0 && h('p', { class: 'soft' }, 'Plot, and time added in s'), chosen.map((each) => {
      const name = several ? `${each.channel} of ${each.file}` : each.channel;
      const panel = h('input', {
        type: 'number', min: 1, value: each.panel + 1, 'aria-label': `Plot of ${name}`,
        onchange: () => { each.panel = Math.max(1, Math.round(Number(panel.value))) - 1; draw(false).catch(failed); },
      });
      const offset = h('input', {
        type: 'number', step: 'any', value: each.offset_s, 'aria-label': `Time added to ${name}, s`,
        onchange: () => { each.offset_s = Number(offset.value) || 0; draw(false).catch(failed); },
      });
      return h('div', { class: 'line-of' }, h('span', { title: name }, name), panel, offset);
    }));
  }

  /** @param {string} channel @param {boolean} isShown */
  function toggle(channel, isShown) {
    if (isShown) chosen.push({ file, channel, panel: 1 + Math.max(-1, ...chosen.map((each) => each.panel)), offset_s: 0 });
    else chosen = chosen.filter((each) => !(each.file === file && each.channel === channel));
    draw(false).catch(failed);
  }

  /** @param {boolean} isAll whether all of the time is to be seen */
  async function draw(isAll) {
    const places = [...new Set(chosen.map((each) => each.panel))].sort((a, b) => a - b);
    const kept = new Map(panels.panels.flatMap((panel) => panel.traces).map((trace) => [`${trace.file}\n${trace.channel}`, trace]));
    const all = await Promise.all(places.map(async (place) => ({
      traces: await Promise.all(chosen.filter((each) => each.panel === place).map(async ({ file: name, channel, offset_s }) => {
        const found = await catalogue(name);
        const unit = found.channels.find((/** @type {any} */ each) => each.name === channel)?.unit ?? '';
        const old = kept.get(`${name}\n${channel}`);
        return old?.offset_s === offset_s ? old : { file: name, channel, unit, offset_s, columns: new Float64Array(), held: null };
      })),
    })));
    const span = await extent();
    if (span) panels.whole = span;
    if (isAll) [panels.from, panels.to] = [panels.whole.from, panels.whole.to];
    panels.show(all);
    marks.show();
    lines();
    remember(false);
    measure();
  }

  /** The time that the recordings which are shown take. */
  async function extent() {
    let [from, to] = [Infinity, -Infinity];
    for (const name of new Set(chosen.map((each) => each.file))) {
      const own = chosen.filter((each) => each.file === name);
      const whole = await view(name, own.map((each) => each.channel), -Infinity, Infinity, 1);
      own.forEach(({ offset_s }, index) => {
        const [first, last] = whole[index] ?? [];
        if (first === undefined) return;
        from = Math.min(from, first + offset_s);
        to = Math.max(to, last + offset_s);
      });
    }
    return to > from ? { from, to } : null;
  }

  /** @type {AbortController | undefined} */
  let measuring;
  async function measure() {
    analysis.update();
    measuring?.abort();
    const [a, b] = panels.cursors;
    if (a === null) return fill(figures);
    measuring = new AbortController();
    const { signal } = measuring;
    await new Promise((done) => setTimeout(done, 80));
    if (signal.aborted) return;
    try {
      const rows = await Promise.all(chosen.map((each) => row(each, a, b, signal)));
      if (signal.aborted) return;
      const heads = ['Channel', 'at A', ...(b === null ? [] : ['at B', 'B − A', 'slope per s', 'mean', 'RMS', 'least', 'largest', 'samples'])];
      fill(figures, table(heads, rows, b === null ? `A at ${figure(a)} s` : `A at ${figure(a)} s, B at ${figure(b)} s, Δt = ${figure(b - a)} s`));
    } catch (error) {
      if (!(error instanceof DOMException)) failed(error);
    }
  }

  /** @param {Chosen} each @param {number} a @param {number | null} b @param {AbortSignal} signal */
  async function row({ file: name, channel, offset_s }, a, b, signal) {
    const given = { file: name, channels: [channel], from_s: Math.min(a, b ?? a) - offset_s, to_s: Math.max(a, b ?? a) - offset_s };
    const [found] = await get('stretch', given, signal);
    const first = [channel, figure(found.first)];
    if (b === null) return first;
    return [...first, ...[found.last, found.change, found.slope_per_s, found.mean, found.rms, found.least, found.largest].map(figure), String(found.samples)];
  }

  if (given.from && given.to) {
    [panels.from, panels.to] = [Number(given.from), Number(given.to)];
    panels.cursors = [given.a, given.b].map((time) => (time ? Number(time) : null));
  }
  await marks.open().catch(failed);
  await open(file);
  if (chosen.length) await draw(!given.from);
  return () => {
    clearTimeout(noting);
    analysis.end();
  };
}
