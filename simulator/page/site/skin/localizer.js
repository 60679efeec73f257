// Localizer of a page: curves of every pixel of the skin as the sliders set it, in units of error.

import { apart, believed, heaviest, novel, summed } from "rcskin/bayes";
import { observed } from "rcskin/meter";
import { readAt } from "rcskin/skin";

/** @typedef {import("rcskin/skin").Skin} Skin */
/** @typedef {import("rcskin/skin").Cast} Cast */
/** @typedef {import("rcskin/model").Complex} Complex */
/** @typedef {import("rcskin/bayes").Class} Class */
/**
 * Readings that are used, and their standard errors: of |Z| as a fraction, of the phase in rad.
 * @typedef {{drives: number[], frequencies: number[], magnitude: number, phase: number}} Readings
 */

export const RESTS = 6; // baseline sweeps, averaged, that readings are compared with
const STRENGTHS = [0.25, 0.35, 0.5, 0.7, 0.85, 1, 1.18, 1.42, 1.9, 2.5]; // over the usual rise
const FEW_STRENGTHS = [0.35, 0.7, 1, 1.9]; // while a slider moves that changes every curve
const QUANTILES = [-1.28, -0.52, 0, 0.52, 1.28]; // of a normal distribution: 10, 30, ... 90 %
const ENOUGH = 0.9;

export class Localizer {
  /** @param {Skin} skin @param {Cast} cast @param {Readings} readings @param {number} factor usual, of capacitance @param {boolean} few true if a few strengths suffice @param {boolean} earthed true if fingers press, which may touch without pressing */
  constructor(skin, cast, readings, factor, few, earthed) {
    this.skin = skin;
    this.cast = cast;
    this.readings = readings;
    const most = skin.data.range.rise[1];
    const rise = factor - 1;
    const strengths = [...(earthed ? [0] : []), ...(few ? FEW_STRENGTHS : STRENGTHS)];
    this.strengths = strengths.filter((part) => part * rise <= most);
    this.rises = this.strengths.map((part) => part * rise);
    this.rest = this.curve([]);
    /** @type {Class[]} */
    this.classes = [{ row: 0, column: 0, curve: [new Float64Array(this.rest.length)] }];
    for (const { row, column } of skin.outline.held) {
      const curve = this.rises.map((each) => {
        const touch = skin.pixel(row, column, 1 + each);
        return this.changed([earthed ? skin.byFinger(touch) : touch]);
      });
      this.classes.push({ row, column, curve });
    }
  }

  /** Used readings of Z by interface and frequency, in units of their error. @param {Complex[][]} Z */
  seen(Z) {
    const { drives, frequencies, magnitude, phase } = this.readings;
    const used = drives.flatMap((drive) =>
      readAt(this.skin.data, drive, frequencies).map((k) => Z[drive][k]),
    );
    const scale = 1 / Math.sqrt(1 + 1 / RESTS);
    return observed(used).map((value, i) => (scale * value) / (i % 2 ? phase : magnitude));
  }

  /** Readings of a press without noise. @param {import("rcskin/skin").Touch[]} touches */
  curve(touches) {
    const { skin, cast } = this;
    const found = skin.responses(touches, cast, true);
    return this.seen(
      found.map((each) => skin.frequencies.map((_, k) => skin.impedance(each, k, cast))),
    );
  }

  /** @param {import("rcskin/skin").Touch[]} touches */
  changed(touches) {
    return this.curve(touches).map((value, i) => value - this.rest[i]);
  }

  /** Answer of the localizer from measured readings. @param {Complex[][]} Z @param {Complex[][]} rest both by interface and frequency */
  locate(Z, rest) {
    const held = this.seen(rest);
    const belief = believed(
      this.classes,
      this.seen(Z).map((value, i) => value - held[i]),
    );
    return { ...belief, words: this.#words(belief) };
  }

  /** Separation of pixels. @param {number} spread of the rise, as a fraction @param {number} draws of each */
  apart(spread, draws) {
    const usual = QUANTILES.map((quantile) => this.#place(1 + spread * quantile));
    return apart(this.classes, usual, draws);
  }

  /** Place on the curves of a rise, given as a fraction of the usual one. @param {number} part */
  #place(part) {
    const known = this.strengths;
    const above = known.findIndex((each) => each >= part);
    if (above <= 0) return above === 0 ? 0 : known.length - 1;
    return above - 1 + (part - known[above - 1]) / (known[above] - known[above - 1]);
  }

  /** @param {import("rcskin/bayes").Belief} belief */
  #words(belief) {
    if (novel(belief)) return "Cannot tell: no single pixel explains these readings";
    const best = belief.chances.indexOf(Math.max(...belief.chances));
    const { row, column } = this.classes[best];
    const percent = (/** @type {number} */ share) => `${Math.floor(100 * share)} %`;
    if (belief.chances[best] >= ENOUGH) {
      return row === 0
        ? `Nothing pressed (${percent(belief.chances[best])})`
        : `Row ${row}, column ${column} (${percent(belief.chances[best])})`;
    }
    for (const axis of /** @type {("column" | "row")[]} */ (["column", "row"])) {
      const likely = heaviest(this.classes, belief.chances, axis);
      const share = summed(this.classes, belief.chances, axis).get(likely) ?? 0;
      const other = axis === "column" ? "row" : "column";
      if (likely > 0 && share >= ENOUGH)
        return `Some ${other} of ${axis} ${likely} (${percent(share)})`;
    }
    return `Cannot tell which: most likely row ${row}, column ${column} (${percent(belief.chances[best])})`;
  }
}
