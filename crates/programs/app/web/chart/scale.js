// Axes: round numbers at round places, as in the reports.

/**
 * Round places of ticks between two numbers: steps of 1, 2 or 5 times a power of ten.
 * @param {number} low @param {number} high @param {number} most
 */
export function ticks(low, high, most) {
  const raw = (high - low) / Math.max(1, most);
  if (!(raw > 0) || !Number.isFinite(raw)) return { step: 1, places: [low] };
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map((factor) => factor * power).find((candidate) => candidate >= raw) ?? 10 * power;
  const places = [];
  for (let k = Math.ceil(low / step); k * step <= high * (1 + 1e-12) && places.length < 100; k += 1) places.push(k * step);
  return { step, places };
}

/** A number with the digits that a step needs. @param {number} value @param {number} step */
export function shown(value, step) {
  const digits = Math.max(0, Math.min(12, -Math.floor(Math.log10(step) + 1e-9)));
  const size = Math.abs(value);
  if (size >= 1e7 || (size > 0 && size < 1e-4 && step < 1e-4)) return value.toExponential(2).replace('-', '−');
  return value.toFixed(digits).replace(/^-/, '−');
}

/** A measured number with five digits. @param {number | null | undefined} value */
export function figure(value) {
  if (value === null || value === undefined || !Number.isFinite(value)) return '–';
  const size = Math.abs(value);
  if (size !== 0 && (size >= 1e6 || size < 1e-3)) return value.toExponential(3).replace(/-/g, '−');
  return value.toPrecision(5).replace(/-/g, '−');
}

/** A number with three digits, without zeros behind them. @param {number} value */
export const rounded = (value) => String(Number(value.toPrecision(3)));

/** A proportion. @param {{ estimate: number }} share */
export const percent = (share) => `${rounded(100 * share.estimate)} %`;

/** @typedef {{ low: number, high: number, isLog?: boolean }} Range */

/** Where a value is in a range, from 0 to 1. @param {Range} range @param {number} value */
export function part({ low, high, isLog }, value) {
  return isLog ? Math.log(value / low) / Math.log(high / low) : (value - low) / (high - low);
}

/** The value at a part of a range. @param {Range} range @param {number} part */
export function value({ low, high, isLog }, part) {
  return isLog ? low * (high / low) ** part : low + part * (high - low);
}

/**
 * Ticks with their texts. A logarithmic axis has powers of ten, and where these are few also 2 and 5 times each.
 * @param {Range} range @param {number} most
 * @returns {[number, string][]}
 */
export function places({ low, high, isLog }, most) {
  const decades = isLog ? Math.log10(high / low) : 0;
  if (!isLog || decades < 1) {
    const { step, places: all } = ticks(low, high, most);
    return all.map((place) => [place, shown(place, step)]);
  }
  const several = Math.ceil(decades / Math.max(1, most));
  const factors = decades * 3 <= most ? [1, 2, 5] : [1];
  /** @type {[number, string][]} */
  const found = [];
  for (let power = Math.floor(Math.log10(low)); power <= Math.log10(high); power += 1) {
    for (const factor of factors) {
      const place = factor * 10 ** power;
      if (power % several || place < low * (1 - 1e-9) || place > high * (1 + 1e-9)) continue;
      found.push([place, Math.abs(power) > 4 ? place.toExponential(0).replace(/-/g, '−') : String(Number(place.toPrecision(3)))]);
    }
  }
  return found;
}
