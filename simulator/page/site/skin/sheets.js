// Excitations of a skin whose sheets differ from those of the model, with its K.

import { startsOf, unpacked } from "rcskin/arrays";
import { Cholesky, dot, inverted, padded, times } from "rcskin/linear";

/**
 * Packed excitation. allowed: potentials of terminals in V, the first one driven.
 * @typedef {{conductance: number, driven: number[], tied: number[][], tiedInverse: number[][], common: number[][],
 *   allowed: number[][], allowedAtNoCurrent: boolean[]}} Feed
 */
/**
 * Excitation: potentials of all coordinates in V; floating ones are tied by a conductance or common to a sheet.
 * K in S, and its factors beyond the terminals; null if K is the identity.
 * @typedef {{conductance: number, driven: Float64Array, tied: Float64Array[], tiedInverse: number[][],
 *   common: Float64Array[], K: Float64Array | null, factors: Cholesky | null}} Fed
 */
/** Conductance of top and bottom over that of the model. @typedef {[number, number]} Conductances */
/** @typedef {import("rcskin/model").Touched} Touched */

/** Excitation of a model in whose coordinates K is the identity. @param {Feed} feed @param {number} size @returns {Fed} */
export function fedAtRest(feed, size) {
  const whole = (/** @type {number[]} */ row) => padded(row, size);
  return {
    conductance: feed.conductance,
    driven: whole(feed.driven),
    tied: feed.tied.map(whole),
    tiedInverse: feed.tiedInverse,
    common: feed.common.map(whole),
    K: null,
    factors: null,
  };
}

export class Sheets {
  /** @param {import("rcskin/model").PackedModel} packed */
  constructor(packed) {
    this.packed = packed;
    this.top = packed.top && unpacked(packed.top);
    this.gauges = packed.gauges && {
      ...packed.gauges,
      factors: unpacked(packed.gauges.factors),
      starts: startsOf(packed.gauges.ranks),
    };
  }

  /** True if each sheet is a field of its own. */
  get apart() {
    return this.top !== null;
  }

  /** All excitations of a pressed skin; null if its sheets are those of the model. @param {Conductances} conductances @param {Touched} touched @returns {Fed[] | null} */
  fed(conductances, touched) {
    const gauged = this.gauges !== null && touched.cells.length > 0;
    const same = conductances.every((each) => each === 1);
    if (same && !gauged) return null;
    const K = this.#stiffness();
    if (this.top && !same) this.#weigh(K, this.top, conductances);
    if (gauged) this.#strain(K, conductances, touched);
    return fedBy(this.packed, K);
  }

  /** K of the model, S, row after row. */
  #stiffness() {
    const { size, terminals, conductance } = this.packed;
    const K = new Float64Array(size * size);
    for (let k = terminals; k < size; k++) K[k * size + k] = 1;
    conductance.forEach((row, i) => {
      K.set(row, i * size);
    });
    return K;
  }

  /** @param {Float64Array} K @param {ArrayLike<number>} top its part of K @param {Conductances} conductances */
  #weigh(K, top, [ofTop, ofBottom]) {
    for (let k = 0; k < K.length; k++) K[k] = ofTop * top[k] + ofBottom * (K[k] - top[k]);
  }

  /** Adds the changes of piezoresistive sheets under touches. @param {Float64Array} K @param {Conductances} conductances @param {Touched} touched */
  #strain(K, conductances, { cells, rises }) {
    if (!this.gauges) return;
    const { size } = this.packed;
    const { piezoresistance, factors, starts, ranks } = this.gauges;
    const parts = ranks.length / piezoresistance.length;
    for (const [field, gauge] of piezoresistance.entries()) {
      for (const [n, cell] of cells.entries()) {
        if (cell >= parts) continue;
        const strain = Math.max(1 - 1 / (1 + rises[n]), 0);
        const change = conductances[field] * (1 / (1 + gauge * strain) - 1);
        if (change === 0) continue;
        const part = field * parts + cell;
        for (let row = starts[part] * size; row < starts[part + 1] * size; row += size) {
          for (let i = 0; i < size; i++) {
            const own = change * factors[row + i];
            for (let k = 0; k < size; k++) K[i * size + k] += own * factors[row + k];
          }
        }
      }
    }
  }
}

/** All excitations for any K; the twin of own_coordinates and excited_terminals. @param {import("rcskin/model").PackedModel} packed @param {Float64Array} K @returns {Fed[]} */
function fedBy(packed, K) {
  const { size, terminals, fields } = packed;
  const factors = new Cholesky(K, size, terminals);
  const lift = Array.from({ length: terminals }, (_, terminal) => {
    const lifted = K.slice(terminal * size, (terminal + 1) * size).map((value) => -value);
    factors.solve(lifted);
    lifted.fill(0, 0, terminals);
    lifted[terminal] = 1;
    return lifted;
  });
  const currents = lift.map((v) => times(K, v));
  const between = withoutCommon(
    lift.map((v) => currents.map((current) => dot(v, current))),
    fields,
  );
  const spread = (/** @type {number[]} */ row) => {
    const whole = new Float64Array(size);
    for (const [terminal, volts] of row.entries())
      for (let k = 0; k < size; k++) whole[k] += volts * lift[terminal][k];
    return whole;
  };
  return packed.feeds.map((feed) => {
    const { driven, conductance, tied, tiedInverse, common } = drivenBy(feed, between);
    return {
      conductance,
      driven: spread(driven),
      tied: tied.map(spread),
      tiedInverse,
      common: common.map(spread),
      K,
      factors,
    };
  });
}

/** Potentials of the terminals that an excitation drives. @param {Feed} feed @param {number[][]} between conductance of terminals, S */
function drivenBy({ allowed, allowedAtNoCurrent }, between) {
  const S = allowed.map((a, i) =>
    allowed.map((b, j) =>
      allowedAtNoCurrent[i] || allowedAtNoCurrent[j]
        ? 0
        : dot(
            a,
            between.map((row) => dot(row, b)),
          ),
    ),
  );
  const others = [...allowed.keys()].slice(1);
  const tied = others.filter((k) => !allowedAtNoCurrent[k]);
  const tiedInverse = inverted(tied.map((i) => tied.map((j) => S[i][j])));
  const seen = tied.map((k) => S[k][0]);
  const follow = tiedInverse.map((row) => -dot(row, seen));
  return {
    conductance: S[0][0] + dot(seen, follow),
    driven: allowed[0].map((own, k) =>
      tied.reduce((sum, mode, n) => sum + follow[n] * allowed[mode][k], own),
    ),
    tied: tied.map((k) => allowed[k]),
    tiedInverse,
    common: others.filter((k) => allowedAtNoCurrent[k]).map((k) => allowed[k]),
  };
}

/** Removes rounding: rows and columns of one field then sum to zero. @param {number[][]} between @param {number[]} fields of terminals */
function withoutCommon(between, fields) {
  for (const field of new Set(fields)) {
    const [first, ...others] = [...fields.keys()].filter((k) => fields[k] === field);
    const sum = (/** @type {number[]} */ values) => values.reduce((a, b) => a + b, 0);
    between[first] = between[first].map((_, k) => -sum(others.map((other) => between[other][k])));
    for (const row of between) row[first] = -sum(others.map((other) => row[other]));
  }
  return between;
}
