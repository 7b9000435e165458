// Channels and their roles: each with its trace, its unit, its sign, and why it was chosen.

import { faults, get } from '../api.js';
import { drawSmall, thumbnail } from '../chart/thumbnail.js';
import { failed, fill, h, say } from '../dom.js';
import { Edit } from '../edit.js';
import { link, note } from '../place.js';
import { result } from '../work.js';

export const title = 'Channels';

/** @typedef {{ key: string, symbol: string, what: string }} Role */
/** @typedef {{ name: string, unit?: string, sign?: number } & Record<string, any>} Mapping */

const WIDTH = 220;
const HEIGHT = 40;

/** @param {HTMLElement} element @param {Record<string, string>} given */
export async function show(element, given) {
  const { benches, recordings } = await get('state');
  const file = given.file || benches[0]?.file;
  if (!file) {
    fill(element, h('p', {}, 'There is no bench file yet. ', h('a', { href: link('bench') }, 'Propose one'), ' from the recordings.'));
    return;
  }
  const [edit, roles] = await Promise.all([Edit.open(file), get('roles')]);
  let recording = given.recording || recordings[0]?.file;
  /** @type {{ name: string, unit: string }[]} */
  let channels = [];
  /** Reasons of the proposal, by role. @type {Map<string, { channel: string, reasons: string[], confidence: number }>} */
  const reasons = new Map();
  const rows = h('tbody', {});
  const choice = h('select', { onchange: () => open(choice.value) },
    recordings.map((/** @type {any} */ each) => h('option', { value: each.file, selected: each.file === recording }, each.file)));
  const why = h('button', { onclick: () => propose() }, 'Propose roles from the recordings');
  edit.tools.append(why, h('a', { href: link('bench', { file }) }, 'The rest of the bench file'));
  fill(element, h('h1', {}, `Channels of ${file}`), edit.tools, h('label', {}, 'Traces of ', choice),
    h('div', { class: 'scroll', tabindex: 0, role: 'region', 'aria-label': 'Roles' }, h('table', { class: 'roles' },
      h('caption', {}, 'Roles'),
      h('thead', {}, h('tr', {}, ['Role', 'Channel', 'Unit, if another than recorded', 'Opposite sign', 'Trace', 'Why'].map((head) => h('th', { scope: 'col' }, head)))),
      rows)));
  edit.listen(element);
  edit.heard = (_now, isSettled) => { if (isSettled) draw(); };
  await open(recording);

  /** @param {string} name */
  async function open(name) {
    recording = name;
    note('roles', { file, recording }, false);
    try {
      channels = name ? (await get('channels', { file: name })).channels : [];
      await draw();
    } catch (error) {
      failed(error);
    }
  }

  async function draw() {
    const { values } = await faults(file, edit.now);
    if (!values) return say('The file is no TOML at the moment. Correct it as text.', true);
    say('');
    fill(rows, roles.map((/** @type {Role} */ role) => row(role, mapping(values.channels?.[role.key]), values.channels ?? {})));
  }

  /** @param {Role} role @param {Mapping | null} now @param {Record<string, any>} all */
  function row(role, now, all) {
    const id = `role-${role.key}`;
    const names = channels.map((channel) => channel.name);
    const others = now && !names.includes(now.name) ? [now.name, ...names] : names;
    const select = h('select', { id, onchange: () => choose(role, now, select.value, all) },
      h('option', { value: '' }, '– none –'), others.map((name) => h('option', { value: name, selected: name === now?.name }, name)));
    const unit = h('input', {
      type: 'text', value: now?.unit ?? '', disabled: !now, 'aria-label': `Unit of ${role.what}`,
      placeholder: channels.find((channel) => channel.name === now?.name)?.unit ?? '',
      onchange: () => set(role, { ...now, name: now?.name ?? '', unit: unit.value.trim() || undefined }),
    });
    const sign = h('input', {
      type: 'checkbox', checked: now?.sign === -1, disabled: !now, 'aria-label': `Opposite sign of ${role.what}`,
      onchange: () => set(role, { ...now, name: now?.name ?? '', sign: sign.checked ? -1 : undefined }),
    });
    const trace = thumbnail(`Trace of ${now?.name ?? 'no channel'}`, WIDTH, HEIGHT);
    if (now && names.includes(now.name)) drawSmall(trace, recording, [now.name], sign.checked).catch(failed);
    const reason = reasons.get(role.key);
    const is = reason && (reason.channel === now?.name ? 'Proposed' : `${reason.channel} was proposed`);
    return h('tr', {},
      h('th', { scope: 'row' }, h('label', { for: id }, role.symbol), ' ', h('span', { class: 'soft' }, role.what)),
      h('td', {}, select), h('td', {}, unit), h('td', {}, sign), h('td', {}, trace),
      h('td', { class: 'why' }, reason ? `${is}, ${Math.round(100 * reason.confidence)} %: ${reason.reasons.join('; ')}` : ''));
  }

  /**
   * Gives a role a channel; the role that had it gets the other one, so that two are swapped by one act.
   * @param {Role} role @param {Mapping | null} now @param {string} name @param {Record<string, any>} all
   */
  function choose(role, now, name, all) {
    const changes = [{ key: ['channels', role.key], value: name ? written({ ...now, name }) : null }];
    const other = name && roles.find((/** @type {Role} */ each) => each.key !== role.key && mapping(all[each.key])?.name === name);
    if (other) {
      const its = mapping(all[other.key]);
      changes.push({ key: ['channels', other.key], value: now ? written({ ...its, name: now.name }) : null });
    }
    edit.set(changes);
  }

  /** @param {Role} role @param {Mapping} now */
  function set(role, now) {
    edit.set([{ key: ['channels', role.key], value: written(now) }]);
  }

  async function propose() {
    why.disabled = true;
    try {
      const proposal = await result(['init', ...recordings.map((/** @type {any} */ each) => each.file), '--out=.dynoid/proposal.toml', '--force']);
      for (const channel of proposal.channels) reasons.set(channel.role, channel);
      await draw();
    } catch (error) {
      failed(error);
    }
    why.disabled = false;
  }
}

/** A mapping, which the file may write as a name alone. @param {any} value @returns {Mapping | null} */
function mapping(value) {
  if (value === undefined || value === null) return null;
  return typeof value === 'string' ? { name: value } : value;
}

/** A mapping as the file has it: a name alone where there is nothing else. @param {Mapping} mapping */
function written(mapping) {
  const { name, ...rest } = mapping;
  const kept = Object.fromEntries(Object.entries(rest).filter(([, value]) => value !== undefined));
  return Object.keys(kept).length ? { name, ...kept } : name;
}
