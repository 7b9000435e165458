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

/**
 * Places of ticks on a logarithmic axis: 1, 2 and 5 of each decade where there is room, or else the decades.
 * @param {number} low @param {number} high @param {number} most
 */
export function decades(low, high, most) {
  const [first, last] = [Math.floor(Math.log10(low)), Math.ceil(Math.log10(high))];
  const every = Math.max(1, Math.ceil((last - first) / Math.max(1, most)));
  const steps = 3 * (last - first) <= most ? [1, 2, 5] : [1];
  const places = [];
  for (let power = first; power <= last; power += every) {
    for (const step of steps) if (step * 10 ** power >= low && step * 10 ** power <= high) places.push(step * 10 ** power);
  }
  return places;
}
