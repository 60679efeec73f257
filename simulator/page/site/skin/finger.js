// Capacitance of fingers to earth, and the parts of M beyond the foam, as in simulator/press/parts.py.

/** @typedef {import("rcskin/model").Touched} Touched */
/** @typedef {import("rcskin/skin").Touch} Touch */

const LOOKED_AT = 64; // places along each side of a touch that are tested for skin
const DIGITS = 5; // digits of a capacitance, so that a press as text equals the solved press

export class Finger {
  /** @param {any} data of the page @param {import("rcskin/outline").Outline} outline */
  constructor(data, outline) {
    /** null if the capacitance of fingers is unknown. */
    this.given = data.finger ?? null;
    this.parts = data.model.parts ?? null;
    this.across = data.model.across ?? false;
    this.outline = outline;
  }

  /** True if there is more than foam: its capacitance is then no mere scale. */
  get around() {
    return this.parts !== null;
  }

  /** Capacitance of a finger on a touch, F. @param {Touch} touch */
  of(touch) {
    if (!this.given) return 0;
    const { whole, perArea, series } = this.given;
    if (whole !== null) return whole;
    const own = perArea * this.#area(touch);
    return Number((series ? (own * series) / (own + series) : own).toPrecision(DIGITS));
  }

  /**
   * Parts of M that a press changes, in units in which all of M is multiplied by the factor of the foam.
   * @param {Float64Array} factors of c of each cell @param {Float64Array} fingers F of each cell @param {number} foam factor on all of c @returns {Touched}
   */
  withAround(factors, fingers, foam) {
    const raised = [...factors.keys()].filter((cell) => factors[cell] !== 1);
    const touched = { cells: raised, rises: raised.map((cell) => factors[cell] - 1), fixed: 0 };
    if (!this.parts) return touched;
    const { cells, rises } = touched;
    const fingered = [...fingers.keys()].filter((cell) => fingers[cell] !== 0);
    const across = this.across ? raised : [];
    return {
      cells: [
        ...cells,
        ...fingered.map((cell) => this.parts.fingers + cell),
        ...across.map((cell) => this.parts.thickness + cell),
      ],
      rises: [
        ...rises,
        ...fingered.map((cell) => fingers[cell] / foam),
        ...across.map((cell) => 1 / factors[cell] - 1),
      ],
      fixed: 1 / foam - 1,
    };
  }

  /** Area of the skin under a touch, m². @param {Touch} touch */
  #area({ x, y, width, height, row, column }) {
    const { outline } = this;
    const pixel = outline.held.findIndex((each) => each.row === row && each.column === column);
    if (pixel >= 0) return this.given.areas[pixel];
    let there = 0;
    for (let i = 0; i < LOOKED_AT; i++)
      for (let j = 0; j < LOOKED_AT; j++)
        there += Number(
          outline.has(
            x + ((i + 0.5) / LOOKED_AT - 0.5) * width,
            y + ((j + 0.5) / LOOKED_AT - 0.5) * height,
          ),
        );
    return (width * height * there) / LOOKED_AT ** 2;
  }
}
