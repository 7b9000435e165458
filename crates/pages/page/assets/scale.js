// Axes: mapping of numbers to pixels, ticks and their labels.

const decades = (value) => Math.floor(Math.log10(value));

/** A scale from data [low, high] to pixels [from, to]. */
function makeScale(kind, low, high, from, to) {
  const log = kind === "log";
  const u = log ? Math.log10 : (v) => v;
  const inverse = log ? (v) => Math.pow(10, v) : (v) => v;
  const [a, b] = [u(low), u(high)];
  const slope = (to - from) / (b - a || 1);
  return {
    kind, low, high,
    toPixel: (value) => from + (u(value) - a) * slope,
    toValue: (pixel) => inverse(a + (pixel - from) / slope),
  };
}

/** Round steps of 1, 2 or 5 so that at most about `count` ticks fit. */
function linearTicks(low, high, count) {
  const raw = (high - low) / Math.max(1, count);
  const power = Math.pow(10, decades(raw));
  const step = [1, 2, 5, 10].map((m) => m * power).find((s) => s >= raw * 0.999) || 10 * power;
  const ticks = [];
  for (let n = Math.ceil(low / step - 1e-9); n * step <= high + step * 1e-9; n++) ticks.push(n * step);
  return { ticks, format: (value) => fixedNumber(value, Math.max(0, -decades(step * 1.0001))) };
}

/** Steps that are parts of a turn, or turns; of small ranges the round steps of other numbers. */
function angleTicks(low, high, count) {
  const raw = (high - low) / Math.max(1, count);
  const step = [15, 30, 45, 90, 180, 360, 720, 1800, 3600].find((s) => s >= raw * 0.999);
  if (!step || raw <= 5) return linearTicks(low, high, count);
  const ticks = [];
  for (let n = Math.ceil(low / step); n * step <= high; n++) ticks.push(n * step);
  return { ticks, format: (value) => fixedNumber(value, 0) };
}

/** 1, 2 and 5 of each decade; every decade only, where there is no room for more. */
function logTicks(low, high, count) {
  const ticks = [];
  const wide = Math.log10(high / low) * 3 > count;
  for (let d = decades(low); d <= decades(high); d++) {
    for (const m of wide ? [1] : [1, 2, 5]) {
      const value = m * Math.pow(10, d);
      if (value >= low * 0.9999 && value <= high * 1.0001) ticks.push(value);
    }
  }
  return ticks.length > 1 ? { ticks, format: (value) => plainNumber(value, 4) } : linearTicks(low, high, count);
}

/** Ticks of a scale; a few more than fit comfortably where there would be only one. */
function makeTicks(scale, count) {
  if (scale.kind === "log") return logTicks(scale.low, scale.high, count);
  if (scale.kind === "angle") return angleTicks(scale.low, scale.high, count);
  let found = linearTicks(scale.low, scale.high, count);
  for (let more = 1.4; found.ticks.length < 2 && more < 3; more *= 1.4) {
    found = linearTicks(scale.low, scale.high, count * more);
  }
  return found;
}

/** A number with a fixed number of decimals, a true minus sign, and no minus zero. */
function fixedNumber(value, decimals) {
  const large = Math.abs(value) >= 1e6 || decimals > 6;
  const text = large ? value.toExponential(1) : value.toFixed(decimals);
  return Number(text) === 0 ? text.replace("-", "") : text.replace("-", "−");
}

/** A number to a few significant digits, for the read-out and for logarithmic axes. */
function plainNumber(value, digits) {
  if (!Number.isFinite(value)) return "–";
  const rounded = Number(value.toPrecision(digits));
  const large = Math.abs(rounded) >= 1e6 || (rounded !== 0 && Math.abs(rounded) < 1e-4);
  return (large ? rounded.toExponential(2) : String(rounded)).replace("-", "−");
}
