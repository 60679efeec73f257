// Reduced model of a skin: the browser's twin of simulator/models/reduced/kernel.py.

import { startsOf, unpacked } from "rcskin/arrays";
import { Response, Sum } from "rcskin/forms";
import { dot, inverted, Symmetric, times } from "rcskin/linear";
import { fedAtRest } from "rcskin/sheets";

/** @typedef {import("rcskin/arrays").Packed} Packed */
/** @typedef {import("rcskin/sheets").Feed} Feed */
/** @typedef {import("rcskin/sheets").Fed} Fed */
/**
 * @typedef {{grid: {rows: number, columns: number},
 *   steps: {fewest: number, most: number, rtol: number}, terminals: number, size: number,
 *   rows: Packed, diagonal: Packed, ranks: number[], factors: Packed, feeds: Feed[],
 *   combined?: [number, number][][] | null, parts?: {fingers: number, thickness: number}, across?: boolean,
 *   walls?: {start: number, pairs: number[]}, fixed?: Packed | null, fields: number[], conductance: number[][], top: Packed | null,
 *   gauges: {piezoresistance: number[], ranks: number[], factors: Packed} | null}} PackedModel
 */
/**
 * Parts of M that rise, cells of the grid first, and the rise of each; fixed: rise of the part that no press changes.
 * @typedef {{cells: number[], rises: number[], fixed: number}} Touched
 */
/** @typedef {import("rcskin/forms").Complex} Complex */
/** @typedef {import("rcskin/forms").Shown} Shown */

const LOST_SUSCEPTANCE = 1e-9;

export class Model {
  /** @param {PackedModel} packed */
  constructor(packed) {
    this.grid = packed.grid;
    this.steps = packed.steps;
    this.terminals = packed.terminals;
    this.size = packed.size;
    /** Excitations with the sheets of the model. */
    this.fed = packed.feeds.map((feed) => fedAtRest(feed, packed.size));
    this.rows = unpacked(packed.rows);
    this.diagonal = unpacked(packed.diagonal);
    this.factors = unpacked(packed.factors);
    this.starts = startsOf(packed.ranks);
    /** Excitations and their weights for each interface; null if each interface is one excitation. */
    this.combined = packed.combined ?? null;
    /** M of the parts that no press changes, row after row; null if there is only foam. */
    this.fixed = packed.fixed ? unpacked(packed.fixed) : null;
  }

  /** Responses of the interfaces. @param {Response[]} forms of every excitation @returns {Shown[]} */
  interfaces(forms) {
    if (!this.combined) return forms;
    return this.combined.map((parts) => new Sum(parts.map(([k, weight]) => [weight, forms[k]])));
  }

  /** Excitations of an interface; all act at once with high at 1 V and low at 0 V. @param {number} k @returns {number[]} */
  drivesOf(k) {
    return this.combined ? this.combined[k].map(([drive]) => drive) : [k];
  }

  /** Adds M v to the charge, in C. @param {Touched} touched @param {Float64Array} v @param {Float64Array} charge */
  charge(touched, v, charge) {
    const { terminals, size, rows, diagonal, factors } = this;
    charge.fill(0, 0, terminals);
    for (let k = terminals; k < size; k++) charge[k] = diagonal[k - terminals] * v[k];
    for (let row = 0; row < terminals; row++) {
      const from = row * size;
      let own = 0;
      for (let k = 0; k < size; k++) own += rows[from + k] * v[k];
      charge[row] = own;
      for (let k = terminals; k < size; k++) charge[k] += rows[from + k] * v[row];
    }
    for (let n = 0; n < touched.cells.length; n++) {
      const cell = touched.cells[n];
      for (let row = this.starts[cell]; row < this.starts[cell + 1]; row++) {
        const from = row * size;
        let part = 0;
        for (let k = 0; k < size; k++) part += factors[from + k] * v[k];
        part *= touched.rises[n];
        for (let k = 0; k < size; k++) charge[k] += part * factors[from + k];
      }
    }
    if (!this.fixed || touched.fixed === 0) return;
    for (let i = 0; i < size; i++) {
      let own = 0;
      for (let k = 0; k < size; k++) own += this.fixed[i * size + k] * v[k];
      charge[i] += touched.fixed * own;
    }
  }

  /**
   * Response of one excitation by Lanczos' method, until two steps in a row change neither Rs nor Cp.
   * @param {Fed} fed @param {Touched} touched @param {Complex} farthest s in rad/s, of all requested
   * @param {number} rtol of Rs and Cp @returns {Response}
   */
  response(fed, touched, farthest, rtol = this.steps.rtol) {
    const { size, terminals } = this;
    const neutral = this.#neutral(fed, touched);
    const potential = Float64Array.from(fed.driven);
    neutral(potential);
    const residual = new Float64Array(size);
    this.charge(touched, potential, residual);
    const found = new Response(fed.conductance, dot(potential, residual), [], []);
    const w = new Float64Array(size);
    const product = new Float64Array(size);
    const solution = new Float64Array(size);
    let now = found.admittance(farthest);
    let changeBefore = Infinity;
    while (found.diagonal.length < this.steps.most) {
      solution.set(residual);
      solution.fill(0, 0, terminals);
      fed.factors?.solve(solution);
      tie(fed, residual, solution);
      neutral(solution);
      const square = dot(residual, solution);
      if (!(square > 0)) break;
      const beside = Math.sqrt(square);
      for (let k = 0; k < size; k++) solution[k] /= beside;
      this.charge(touched, solution, product);
      const own = dot(solution, product);
      found.squared.push(square);
      found.diagonal.push(own);
      for (let k = 0; k < size; k++) {
        const before = w[k];
        w[k] = residual[k] / beside;
        residual[k] = product[k] - own * w[k] - beside * before;
      }
      const before = now;
      now = found.admittance(farthest);
      const change = difference(before, now);
      const { fewest } = this.steps;
      if (found.diagonal.length >= fewest && change <= rtol && changeBefore <= rtol) break;
      changeBefore = change;
    }
    return found;
  }

  /**
   * Potentials at 1 V in the model's coordinates, from one dense complex system.
   * @param {Fed} fed @param {Touched} touched @param {Complex} s rad/s
   * @returns {{re: Float64Array, im: Float64Array}}
   */
  potentials(fed, touched, s) {
    const { size, terminals } = this;
    const floating = [...fed.tied, ...fed.common];
    const M = this.#mass(touched);
    const charges = floating.map((v) => times(M, v));
    const charge = times(M, fed.driven);
    const ties = inverted(fed.tiedInverse);
    const first = floating.length - terminals;
    const n = first + size;
    const system = new Symmetric(n);
    for (let i = 0; i < n; i++) {
      for (let j = 0; j <= i; j++) {
        let mass;
        if (j >= floating.length) mass = M[(i - first) * size + j - first];
        else if (i >= floating.length) mass = charges[j][i - first];
        else mass = dot(floating[i], charges[j]);
        system.set(i, j, stiffness(i, j) + s.re * mass, s.im * mass);
      }
      const seen = i < floating.length ? dot(floating[i], charge) : charge[i - first];
      system.ask(i, -s.re * seen, -s.im * seen);
    }
    const found = system.solved();
    const u = { re: Float64Array.from(fed.driven), im: new Float64Array(size) };
    for (let i = 0; i < n; i++) {
      if (i >= floating.length) {
        u.re[i - first] += found.re[i];
        u.im[i - first] += found.im[i];
        continue;
      }
      for (let k = 0; k < size; k++) {
        u.re[k] += found.re[i] * floating[i][k];
        u.im[k] += found.im[i] * floating[i][k];
      }
    }
    return u;

    /** @param {number} i @param {number} j */
    function stiffness(i, j) {
      if (i < ties.length) return ties[i][j];
      if (j < floating.length) return 0;
      return fed.K ? fed.K[(i - first) * size + j - first] : Number(i === j);
    }
  }

  /** M of a press, F, row after row. @param {Touched} touched */
  #mass(touched) {
    const { size, terminals, rows, diagonal, factors } = this;
    const M = new Float64Array(size * size);
    for (let k = terminals; k < size; k++) M[k * size + k] = diagonal[k - terminals];
    for (let row = 0; row < terminals; row++) {
      for (let k = 0; k < size; k++) {
        M[row * size + k] = rows[row * size + k];
        M[k * size + row] = rows[row * size + k];
      }
    }
    for (let n = 0; n < touched.cells.length; n++) {
      const cell = touched.cells[n];
      for (let row = this.starts[cell] * size; row < this.starts[cell + 1] * size; row += size) {
        for (let i = 0; i < size; i++) {
          const part = touched.rises[n] * factors[row + i];
          for (let k = 0; k < size; k++) M[i * size + k] += part * factors[row + k];
        }
      }
    }
    if (this.fixed) for (let k = 0; k < M.length; k++) M[k] += touched.fixed * this.fixed[k];
    return M;
  }

  /** Shifts parts that float as a whole, so that each keeps its charge. @param {Fed} fed @param {Touched} touched */
  #neutral(fed, touched) {
    /** @type {{common: Float64Array, charge: Float64Array, own: number}[]} none of which charges another */
    const known = [];
    const neutral = (/** @type {Float64Array} */ v) => {
      for (const { common, charge, own } of known) {
        const shift = dot(charge, v) / own;
        for (let k = 0; k < v.length; k++) v[k] -= shift * common[k];
      }
    };
    for (const row of fed.common) {
      const common = Float64Array.from(row);
      neutral(common);
      const charge = new Float64Array(this.size);
      this.charge(touched, common, charge);
      known.push({ common, charge, own: dot(common, charge) });
    }
    return neutral;
  }
}

/** Adds the potentials that floating terminals take. @param {Fed} fed @param {Float64Array} y @param {Float64Array} solution */
function tie(fed, y, solution) {
  const currents = fed.tied.map((row) => dot(row, y));
  fed.tiedInverse.forEach((row, i) => {
    const potential = row.reduce((sum, each, j) => sum + each * currents[j], 0);
    for (let k = 0; k < solution.length; k++) solution[k] += potential * fed.tied[i][k];
  });
}

/** Difference of Rs and of Cp, relative to the other's. @param {Complex} Y @param {Complex} other */
function difference(Y, other) {
  const Rs = (/** @type {Complex} */ y) => y.re / (y.re * y.re + y.im * y.im);
  const susceptance = Math.max(
    Math.abs(other.im),
    LOST_SUSCEPTANCE * Math.hypot(other.re, other.im),
  );
  return Math.max(Math.abs(Rs(Y) / Rs(other) - 1), Math.abs(Y.im - other.im) / susceptance);
}
