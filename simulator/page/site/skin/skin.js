// Skin as the sliders set it, and the impedances that a meter then reads.

import { unpacked } from "rcskin/arrays";
import { Finger } from "rcskin/finger";
import { Model } from "rcskin/model";
import { Outline } from "rcskin/outline";
import { Sheets } from "rcskin/sheets";
import { Walls } from "rcskin/walls";

/** @typedef {import("rcskin/model").Complex} Complex */
/** @typedef {import("rcskin/model").Touched} Touched */
/** @typedef {import("rcskin/model").Shown} Shown */
/**
 * Touch of a rectangle about x, y in m; a pixel has its row and column, from 1. finger: capacitance to earth, F; a rod has none.
 * @typedef {{x: number, y: number, width: number, height: number, factor: number, finger?: number, row?: number, column?: number}} Touch
 */
/**
 * Factors on the resistance of each sheet and of its foils' contacts, and on all capacitance; loss tangent.
 * @typedef {{top: number, bottom: number, capacitance: number, loss: number}} Cast
 */

const ROUGHLY = 1e-8; // relative error of Rs and of Cp that the localizer accepts
const MOST_KNOWN = 3000;

export class Skin {
  /** @param {any} data as `packed` writes it */
  constructor(data) {
    this.data = data;
    this.model = new Model(data.model);
    this.sheets = new Sheets(data.model);
    this.outline = new Outline(data);
    this.finger = new Finger(data, this.outline);
    this.walls = new Walls(data.model);
    this.basis = unpacked(data.basis);
    /** @type {number[]} */
    this.frequencies = data.frequencies;
    /** @type {Map<string, Shown[]>} */
    this.known = new Map();
    /** @type {{ratio: number, fed: import("rcskin/sheets").Fed[]} | null} */
    this.kept = null;
  }

  /** Touch of a whole pixel. @param {number} row @param {number} column @param {number} factor @returns {Touch} */
  pixel(row, column, factor) {
    return { ...this.outline.box(row, column), factor, row, column };
  }

  /** Touch by a finger. @param {Touch} touch @returns {Touch} */
  byFinger(touch) {
    const finger = this.finger.of(touch);
    return finger ? { ...touch, finger } : touch;
  }

  /** Parts of M that rise; touches enter by the area that they cover of each cell. @param {Touch[]} touches @param {Cast} cast @returns {Touched} */
  touched(touches, cast) {
    const { rows, columns } = this.model.grid;
    const factors = new Float64Array(rows * columns).fill(1);
    const fingers = new Float64Array(rows * columns);
    const covers = touches.map((touch) => this.#covered(touch));
    for (const [k, touch] of touches.entries()) {
      const covered = covers[k];
      const whole = covered.reduce((sum, [, part]) => sum + part, 0);
      for (const [cell, part] of covered) {
        factors[cell] *= 1 - part + touch.factor * part;
        fingers[cell] += ((touch.finger ?? 0) * part) / whole;
      }
    }
    const touched = this.finger.withAround(factors, fingers, cast.capacitance);
    const walls = this.walls.of(
      touches.map(({ factor }, k) => ({ covered: new Map(covers[k]), factor })),
    );
    return {
      ...touched,
      cells: [...touched.cells, ...walls.map(([wall]) => wall)],
      rises: [...touched.rises, ...walls.map(([, rise]) => rise)],
    };
  }

  /** Cells that a touch covers, and the covered fraction of each. @param {Touch} touch @returns {[number, number][]} */
  #covered(touch) {
    const { rows, columns } = this.model.grid;
    const { length, width } = this.data.skin;
    if (this.outline.groups)
      return [[((touch.row ?? 1) - 1) * columns + (touch.column ?? 1) - 1, 1]];
    const across = shares(touch.x, touch.width, length, columns);
    return shares(touch.y, touch.height, width, rows).flatMap((up, i) =>
      across.flatMap((along, j) => {
        const part = up * along;
        return part > 0 ? [/** @type {[number, number]} */ ([i * columns + j, part])] : [];
      }),
    );
  }

  /** Factor that represents those of both sheets. @param {Pick<Cast, "top" | "bottom">} cast */
  common({ top, bottom }) {
    if (top === bottom) return top;
    if (this.sheets.apart) return top * this.conductances({ top, bottom })[0];
    const { shares } = this.data.weights;
    return top * shares[0] + bottom * shares[1];
  }

  /** Conductances of the sheets over those of the model, apart from the common factor. @param {Pick<Cast, "top" | "bottom">} cast @returns {[number, number]} */
  conductances({ top, bottom }) {
    if (!this.sheets.apart || top === bottom) return [1, 1];
    const [ofTop, ofBottom] = this.data.weights.mismatch;
    return [(top / bottom) ** ofTop, (top / bottom) ** ofBottom];
  }

  /** True if these settings change every curve, and not by a scale alone. @param {Cast} cast */
  anew(cast) {
    const { sheets, finger } = this;
    const scaled = !finger.around || cast.capacitance === 1;
    return sheets.gauges !== null || this.conductances(cast)[0] !== 1 || !scaled;
  }

  /** All excitations of the skin as it is set and pressed. @param {Cast} cast @param {Touched} touched */
  fed(cast, touched) {
    if (this.sheets.gauges) return this.#fedAnew(cast, touched);
    const ratio = this.conductances(cast)[0];
    if (this.kept?.ratio !== ratio) this.kept = { ratio, fed: this.#fedAnew(cast, touched) };
    return this.kept.fed;
  }

  /** @param {Cast} cast @param {Touched} touched */
  #fedAnew(cast, touched) {
    return this.sheets.fed(this.conductances(cast), touched) ?? this.model.fed;
  }

  /** Responses of every interface, valid for all capacitances and losses of the sliders. @param {Touch[]} touches @param {Cast} cast @param {boolean} roughly to 1e-8 @returns {Shown[]} */
  responses(touches, cast, roughly = false) {
    const foam = this.finger.around ? cast.capacitance : 1;
    const key = JSON.stringify([touches, this.conductances(cast)[0], foam, roughly]);
    const known = this.known.get(key);
    if (known) return known;
    const { range } = this.data;
    const most = range.resistance[1];
    const farthest = this.variable(this.frequencies.length - 1, {
      top: most,
      bottom: most,
      capacitance: range.capacitance[1],
      loss: 0,
    });
    const touched = this.touched(touches, cast);
    const rtol = roughly ? ROUGHLY : undefined;
    const found = this.model.interfaces(
      this.fed(cast, touched).map((fed) => this.model.response(fed, touched, farthest, rtol)),
    );
    if (this.known.size > MOST_KNOWN) this.known.clear();
    this.known.set(key, found);
    return found;
  }

  /** Variable s of the model, rad/s, for a skin as it is set. @param {number} at number of the frequency @param {Cast} cast @returns {Complex} */
  variable(at, cast) {
    const scale = this.common(cast) * cast.capacitance;
    const [re, im, reByLoss, imByLoss] = this.data.weights.s[at];
    return { re: scale * (re + cast.loss * reByLoss), im: scale * (im + cast.loss * imByLoss) };
  }

  /** Impedance at the meter's end, ohm. @param {Shown} response @param {number} at number of the frequency @param {Cast} cast @returns {Complex} */
  impedance(response, at, cast) {
    const Y = response.admittance(this.variable(at, cast));
    const common = this.common(cast);
    const { resistance, inductance, unguarded } = this.data.leads;
    const omega = 2 * Math.PI * this.frequencies[at];
    const seen = { re: Y.re / common, im: Y.im / common + omega * unguarded };
    const size = seen.re * seen.re + seen.im * seen.im;
    return { re: resistance + seen.re / size, im: omega * inductance - seen.im / size };
  }

  /**
   * Difference of the sheets' potentials, and the top sheet's potential, at the raster's points for 1 V.
   * @param {number} drive @param {Touch[]} touches @param {number} at number of the frequency @param {Cast} cast
   */
  field(drive, touches, at, cast) {
    const touched = this.touched(touches, cast);
    const fed = this.fed(cast, touched);
    const s = this.variable(at, cast);
    const found = this.model.drivesOf(drive).map((k) => this.model.potentials(fed[k], touched, s));
    const u = found.reduce(({ re, im }, own) => ({
      re: re.map((value, k) => value + own.re[k]),
      im: im.map((value, k) => value + own.im[k]),
    }));
    const { rows, columns } = this.data.raster;
    const points = rows * columns;
    const fields = this.basis.length / points / this.model.size;
    const each = Array.from({ length: fields }, (_, field) => ({
      re: this.#spread(u.re, field, points),
      im: this.#spread(u.im, field, points),
    }));
    if (fields === 1) {
      const share = (this.data.weights.shares[0] * cast.top) / this.common(cast);
      const part = (/** @type {Float64Array} */ values) => values.map((value) => share * value);
      return { across: each[0], top: { re: part(each[0].re), im: part(each[0].im) } };
    }
    const less = (/** @type {"re" | "im"} */ name) =>
      each[0][name].map((value, point) => value - each[1][name][point]);
    return { across: { re: less("re"), im: less("im") }, top: each[0] };
  }

  /** @param {Float64Array} u @param {number} field @param {number} points */
  #spread(u, field, points) {
    const found = new Float64Array(points);
    for (let k = 0; k < u.length; k++) {
      const from = (field * u.length + k) * points;
      for (let point = 0; point < points; point++) found[point] += u[k] * this.basis[from + point];
    }
    return found;
  }
}

/** Fraction of each uniform cell along a side that lies under a touch. @param {number} middle @param {number} size @param {number} side @param {number} cells */
function shares(middle, size, side, cells) {
  const step = side / cells;
  return Array.from({ length: cells }, (_, cell) => {
    const low = Math.max(middle - size / 2, cell * step);
    const high = Math.min(middle + size / 2, (cell + 1) * step);
    const part = (high - low) / step;
    return part < 1e-9 ? 0 : part > 1 - 1e-9 ? 1 : part;
  });
}

/** Frequencies, among the given ones, at which an interface is read; all by number. @param {any} data @param {number} drive @param {number[]} frequencies @returns {number[]} */
export function readAt(data, drive, frequencies) {
  return data.taken ? frequencies.filter((k) => data.taken[drive][k]) : frequencies;
}

/** @param {Complex} Z ohm @param {number} frequency Hz */
export function parallelCapacitance(Z, frequency) {
  return -Z.im / (Z.re * Z.re + Z.im * Z.im) / (2 * Math.PI * frequency);
}
