// Fits the simulated press that is nearest to a measured sweep, with its residual.

import { observed } from "rcskin/meter";

/** @typedef {import("rcskin/model").Complex} Complex */
/** @typedef {import("rcskin/localizer").Localizer} Localizer */
/** Pixel of a press, 0 if nothing is pressed, and the relative rise of its capacitance. @typedef {{row: number, column: number, rise: number}} Fit */
/** Residuals of ln |Z| and of the phase in standard errors, by interface and frequency; NaN where nothing was read. @typedef {{size: number[][], phase: number[][]}} Residual */

/**
 * @param {Localizer} localizer @param {Complex[][]} Z measured @param {Complex[][]} rest baseline as measured, or as simulated if it was not measured
 * @returns {Fit}
 */
export function fitted(localizer, Z, rest) {
  const held = localizer.seen(rest);
  const seen = localizer.seen(Z).map((value, i) => value - held[i]);
  const none = new Float64Array(seen.length);
  let best = { row: 0, column: 0, rise: 0, off: nearest(none, none, seen).off };
  for (const { row, column, curve } of localizer.classes) {
    if (row === 0) continue;
    const rises = [0, ...localizer.rises];
    const points = [none, ...curve];
    for (let k = 0; k + 1 < points.length; k++) {
      const { off, part } = nearest(points[k], points[k + 1], seen);
      if (off < best.off)
        best = { row, column, rise: rises[k] + part * (rises[k + 1] - rises[k]), off };
    }
  }
  return { row: best.row, column: best.column, rise: best.rise };
}

/** Finds the place between two points that is nearest to the observed values; NaN values do not count. @param {Float64Array} from @param {Float64Array} to @param {Float64Array} seen */
function nearest(from, to, seen) {
  let [length, along] = [0, 0];
  for (let i = 0; i < seen.length; i++) {
    if (Number.isNaN(seen[i])) continue;
    length += (to[i] - from[i]) ** 2;
    along += (to[i] - from[i]) * (seen[i] - from[i]);
  }
  const part = length > 0 ? Math.min(Math.max(along / length, 0), 1) : 0;
  let off = 0;
  for (let i = 0; i < seen.length; i++) {
    if (Number.isNaN(seen[i])) continue;
    off += (seen[i] - from[i] - part * (to[i] - from[i])) ** 2;
  }
  return { part, off };
}

/**
 * Measured change less the simulated one.
 * @param {{Z: Complex[][], rest: Complex[][]}} measured @param {{Z: Complex[][], rest: Complex[][]}} simulated
 * @param {{magnitude: number, phase: number}} error of one change
 * @returns {Residual}
 */
export function residual(measured, simulated, error) {
  const left = measured.Z.map((values, drive) => {
    const [now, held, pressed, unpressed] = [
      values,
      measured.rest[drive],
      simulated.Z[drive],
      simulated.rest[drive],
    ].map(observed);
    return now.map((value, i) => value - held[i] - (pressed[i] - unpressed[i]));
  });
  const part = (/** @type {number} */ odd, /** @type {number} */ unit) =>
    left.map((values) => [...values].filter((_, i) => i % 2 === odd).map((value) => value / unit));
  return { size: part(0, error.magnitude), phase: part(1, error.phase) };
}

/** Root mean square of a residual, and its largest value with its place. @param {Residual} residual */
export function summary({ size, phase }) {
  let [sum, count] = [0, 0];
  const worst = { value: 0, drive: 0, at: 0 };
  for (const part of [size, phase]) {
    for (const [drive, values] of part.entries()) {
      for (const [at, value] of values.entries()) {
        if (Number.isNaN(value)) continue;
        sum += value * value;
        count += 1;
        if (Math.abs(value) > Math.abs(worst.value)) Object.assign(worst, { value, drive, at });
      }
    }
  }
  return { rms: Math.sqrt(sum / (count || 1)), worst };
}
