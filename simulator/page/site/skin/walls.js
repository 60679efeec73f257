// Walls around touches, as in simulator/press/walls.py and, for partly covered cells, bounds/part_maps.py.

/**
 * Touch: the fraction that it covers of each cell, and its factor.
 * @typedef {{covered: Map<number, number>, factor: number}} Cover
 */

const SAME = 1e-9; // fraction of a cell

export class Walls {
  /** @param {any} model of the page */
  constructor(model) {
    /** Pairs of adjacent cells, one after the other. @type {number[]} */
    this.pairs = model.walls?.pairs ?? [];
    this.start = model.walls?.start ?? 0;
    this.grid = model.grid;
  }

  /** Walls and the amount of each. @param {Cover[]} covers @returns {[number, number][]} */
  of(covers) {
    const pressed = covers.filter(({ factor }) => factor !== 1);
    /** @type {[number, number][]} */
    const found = [];
    if (pressed.length === 0) return found;
    for (let wall = 0; wall < this.pairs.length / 2; wall++) {
      const sides = pressed.map((cover) => this.#sides(wall, cover));
      const rise = excess(sides, pressed);
      if (rise !== 0) found.push([this.start + wall, rise]);
    }
    return found;
  }

  /** Covered fractions on both sides of a wall; an outermost cell that is covered less than the other counts as not covered. @param {number} wall @param {Cover} cover @returns {[number, number]} */
  #sides(wall, { covered }) {
    const [one, other] = this.pairs.slice(2 * wall, 2 * wall + 2);
    const [a, b] = [covered.get(one) ?? 0, covered.get(other) ?? 0];
    return [
      a < b - SAME && this.#outermost(one, other) ? 0 : a,
      b < a - SAME && this.#outermost(other, one) ? 0 : b,
    ];
  }

  /** True if there is no cell behind a cell, as seen from its neighbour. @param {number} cell @param {number} neighbour */
  #outermost(cell, neighbour) {
    const { rows, columns } = this.grid;
    const behind = 2 * cell - neighbour;
    if (Math.floor(cell / columns) !== Math.floor(neighbour / columns))
      return behind < 0 || behind >= rows * columns;
    return Math.floor(behind / columns) !== Math.floor(cell / columns);
  }
}

/** Amount of a wall between two partly covered cells: the mean over the covered length. @param {[number, number][]} sides of each touch @param {Cover[]} covers @returns {number} */
function excess(sides, covers) {
  if (sides.every(([a, b]) => a === b)) return 0;
  const ends = [...new Set([0, 1, ...sides.flat()])].sort((a, b) => a - b);
  let whole = 0;
  for (let k = 1; k < ends.length; k++) {
    const middle = (ends[k - 1] + ends[k]) / 2;
    const [one, other] = [0, 1].map((side) =>
      covers.reduce((c, { factor }, n) => (sides[n][side] > middle ? c * factor : c), 1),
    );
    whole += (ends[k] - ends[k - 1]) * ofStep(Math.min(one, other) / Math.max(one, other));
  }
  return whole;
}

/** Capacitance of a step in the gap, per metre, over the permittivity. @param {number} a smaller gap over the larger */
function ofStep(a) {
  const b = 1 - a;
  const walls = b > 0 ? ((b * b) / a) * Math.log((1 + a) / b) : 0;
  return (2 * Math.log1p((b * b) / (4 * a)) + walls) / Math.PI;
}
