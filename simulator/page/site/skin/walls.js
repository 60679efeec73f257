// Walls around touches, as simulator/press/walls.py and, of cells that are covered in part, bounds/fields/edges.py.

/**
 * A touch: what part it covers of each cell, and its factor.
 * @typedef {{covered: Map<number, number>, factor: number}} Cover
 */

const SAME = 1e-9; // of a cell

export class Walls {
  /** @param {any} model of the page */
  constructor(model) {
    /** Pairs of cells that meet, one after the other. @type {number[]} */
    this.pairs = model.walls?.pairs ?? [];
    this.start = model.walls?.start ?? 0;
    this.grid = model.grid;
  }

  /** Walls that there are, and how much of each. @param {Cover[]} covers @returns {[number, number][]} */
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

  /** What a touch covers on either side; an outermost cell that it covers less than the other counts as none. @param {number} wall @param {Cover} cover @returns {[number, number]} */
  #sides(wall, { covered }) {
    const [one, other] = this.pairs.slice(2 * wall, 2 * wall + 2);
    const [a, b] = [covered.get(one) ?? 0, covered.get(other) ?? 0];
    return [
      a < b - SAME && this.#outermost(one, other) ? 0 : a,
      b < a - SAME && this.#outermost(other, one) ? 0 : b,
    ];
  }

  /** Whether there is nothing behind a cell, as seen from its neighbour. @param {number} cell @param {number} neighbour */
  #outermost(cell, neighbour) {
    const { rows, columns } = this.grid;
    const behind = 2 * cell - neighbour;
    if (Math.floor(cell / columns) !== Math.floor(neighbour / columns))
      return behind < 0 || behind >= rows * columns;
    return Math.floor(behind / columns) !== Math.floor(cell / columns);
  }
}

/** Between two cells that touches cover in part: the mean over what they cover. @param {[number, number][]} sides of each touch @param {Cover[]} covers @returns {number} */
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

/** Capacitance of a step in the gap, over permittivity and for each metre. @param {number} a smaller gap over the larger */
function ofStep(a) {
  const b = 1 - a;
  const walls = b > 0 ? ((b * b) / a) * Math.log((1 + a) / b) : 0;
  return (2 * Math.log1p((b * b) / (4 * a)) + walls) / Math.PI;
}
