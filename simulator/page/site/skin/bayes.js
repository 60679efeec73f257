// Location of a touch by Bayes' rule on simulated curves: pixels of unknown strength, and no touch.

import { normal } from "rcskin/meter";

/**
 * Change of the readings by every class against the baseline, in units of their error.
 * Curves over the strength of a press are linear between the known strengths.
 * @typedef {{row: number, column: number, curve: Float64Array[]}} Class
 */
/** @typedef {{chances: Float64Array, misfit: number, readings: number}} Belief */
/** @typedef {{pixel: number, column: number, row: number, draws: number, nearest: {first: number, second: number, distance: number}}} Apart */

const SURE = 3.7; // standard deviations: one sweep in ten thousand has a larger misfit

/**
 * Posterior of each class; the prior is equal for all classes, and uniform over the strengths of a curve.
 * @param {Class[]} classes @param {Float64Array} seen change from the baseline, in units of the error
 * @returns {Belief}
 */
export function believed(classes, seen) {
  const best = { misfit: Infinity };
  const logs = classes.map((each) => {
    const known =
      each.curve.length > 1 ? alongCurve(each.curve, seen) : atPoint(each.curve[0], seen);
    best.misfit = Math.min(best.misfit, known.misfit);
    return known.log;
  });
  const most = Math.max(...logs);
  const chances = Float64Array.from(logs, (log) => Math.exp(log - most));
  const sum = chances.reduce((a, b) => a + b, 0);
  return { chances: chances.map((each) => each / sum), misfit: best.misfit, readings: seen.length };
}

/** True if even the nearest class is farther off than noise explains. @param {Belief} belief */
export function novel(belief) {
  const n = belief.readings;
  const spread = 2 / (9 * n);
  const limit = n * (1 - spread + SURE * Math.sqrt(spread)) ** 3; // of chi squared: Wilson and Hilferty
  return belief.misfit > limit;
}

/** @param {Float64Array} point @param {Float64Array} seen */
function atPoint(point, seen) {
  const misfit = squared(point, seen);
  return { misfit, log: -misfit / 2 };
}

/** Integrates the likelihood along a curve: each straight piece gives normal tails. @param {Float64Array[]} curve @param {Float64Array} seen */
function alongCurve(curve, seen) {
  let misfit = Infinity;
  const logs = [];
  for (let k = 0; k + 1 < curve.length; k++) {
    const [from, to] = [curve[k], curve[k + 1]];
    let [length, along, start] = [0, 0, 0];
    for (let i = 0; i < seen.length; i++) {
      const step = to[i] - from[i];
      const off = seen[i] - from[i];
      length += step * step;
      along += step * off;
      start += off * off;
    }
    const size = Math.sqrt(length);
    const place = length > 0 ? along / length : 0;
    const beside = Math.max(start - along * place, 0);
    const nearest = Math.min(Math.max(place, 0), 1);
    misfit = Math.min(misfit, beside + length * (place - nearest) ** 2);
    logs.push(-beside / 2 + logWithin(-place * size, (1 - place) * size) - Math.log(size || 1));
  }
  const most = Math.max(...logs);
  const sum = logs.reduce((total, log) => total + Math.exp(log - most), 0);
  return { misfit, log: most + Math.log(sum / logs.length) };
}

/** Logarithm of the integral of exp(-x²/2) from low to high. @param {number} low @param {number} high */
function logWithin(low, high) {
  if (low > 0) return logWithin(-high, -low);
  if (high < -5)
    return (
      -(high * high) / 2 -
      Math.log(-high) +
      Math.log1p(-Math.exp(-Math.min((low * low - high * high) / 2, 700)))
    );
  return Math.log(Math.sqrt(2 * Math.PI) * Math.max(below(high) - below(low), 1e-300));
}

/** Normal distribution function at x, to 7.5e-8: Abramowitz and Stegun 26.2.17. @param {number} x */
function below(x) {
  const t = 1 / (1 + 0.2316419 * Math.abs(x));
  const tail =
    ((((1.330274429 * t - 1.821255978) * t + 1.781477937) * t - 0.356563782) * t + 0.31938153) * t;
  const above = (tail * Math.exp(-(x * x) / 2)) / Math.sqrt(2 * Math.PI);
  return x > 0 ? 1 - above : above;
}

/** @param {Float64Array} a @param {Float64Array} b */
function squared(a, b) {
  let sum = 0;
  for (let i = 0; i < a.length; i++) sum += (a[i] - b[i]) ** 2;
  return sum;
}

/**
 * Separation of classes: fraction of presses of usual strength that are classified correctly, and the nearest two classes.
 * @param {Class[]} classes @param {number[]} usual places on each curve, from 0, that presses have
 * @param {number} draws of each class @returns {Apart}
 */
export function apart(classes, usual, draws) {
  const random = normal(1);
  const right = { pixel: 0, column: 0, row: 0 };
  let count = 0;
  classes.forEach((own, index) => {
    for (let draw = 0; draw < draws; draw++) {
      const seen = at(own.curve, usual[draw % usual.length]);
      const { chances } = believed(
        classes,
        seen.map((value) => value + random()),
      );
      const chosen = chances.indexOf(Math.max(...chances));
      right.pixel += Number(chosen === index);
      right.column += Number(heaviest(classes, chances, "column") === own.column);
      right.row += Number(heaviest(classes, chances, "row") === own.row);
      count += 1;
    }
  });
  const share = {
    pixel: right.pixel / count,
    column: right.column / count,
    row: right.row / count,
  };
  return { ...share, draws: count, nearest: nearest(classes, usual[Math.floor(usual.length / 2)]) };
}

/** Row or column of the largest probability. @param {Class[]} classes @param {Float64Array} chances @param {"row" | "column"} axis */
export function heaviest(classes, chances, axis) {
  const sums = summed(classes, chances, axis);
  return [...sums].reduce((a, b) => (b[1] > a[1] ? b : a))[0];
}

/** Probabilities summed by row or by column. @param {Class[]} classes @param {Float64Array} chances @param {"row" | "column"} axis @returns {Map<number, number>} */
export function summed(classes, chances, axis) {
  const sums = new Map();
  for (const [k, each] of classes.entries()) {
    sums.set(each[axis], (sums.get(each[axis]) ?? 0) + chances[k]);
  }
  return sums;
}

/** @param {Class[]} classes @param {number} usual */
function nearest(classes, usual) {
  const found = { first: 0, second: 0, distance: Infinity };
  const points = classes.map((each) => at(each.curve, usual));
  classes.forEach((_, first) => {
    classes.forEach((other, second) => {
      if (first === second) return;
      const { misfit } =
        other.curve.length > 1
          ? alongCurve(other.curve, points[first])
          : atPoint(other.curve[0], points[first]);
      const distance = Math.sqrt(misfit);
      if (distance < found.distance) Object.assign(found, { first, second, distance });
    });
  });
  return found;
}

/** @param {Float64Array[]} curve @param {number} place from 0 to the last @returns {Float64Array} */
function at(curve, place) {
  if (curve.length === 1) return curve[0];
  const first = Math.min(Math.floor(place), curve.length - 2);
  const part = place - first;
  return curve[first].map((value, i) => (1 - part) * value + part * curve[first + 1][i]);
}
