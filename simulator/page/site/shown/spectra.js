// Rs, Cp and their changes against the baseline over frequency: four charts of one interface.

import { Chart, withPrefix } from "rcskin/charts";
import { parallelCapacitance } from "rcskin/skin";

/** @typedef {import("rcskin/model").Complex} Complex */
/** @typedef {import("rcskin/charts").Curve} Curve */
/** @typedef {(Z: Complex, frequency: number) => number} Quantity */
/**
 * Spectra of one interface. rest, last: without noise; last is empty if nothing was pressed before.
 * @typedef {{rest: Complex[], last: Complex[], now: Complex[], heldAgainst: Complex[]}} Spectra
 */

const BAND = 2; // standard deviations, within which 19 of 20 readings lie
/** @type {Quantity} */
const seriesResistance = (Z) => Z.re;

export class SpectraCharts {
  /** @param {(id: string) => HTMLCanvasElement} canvas @param {number[]} frequencies Hz */
  constructor(canvas, frequencies) {
    this.frequencies = frequencies;
    this.shown = [
      {
        of: seriesResistance,
        turned: (/** @type {Complex} */ Z) => Math.abs(Z.im / Z.re),
        itself: new Chart(canvas("Rs"), "Rs", "kohm", 1e-3, true),
        change: new Chart(canvas("dRs"), "Change of Rs", "%", 100, false),
      },
      {
        of: parallelCapacitance,
        turned: (/** @type {Complex} */ Z) => Math.abs(Z.re / Z.im),
        itself: new Chart(canvas("Cp"), "Cp", "pF", 1e12, true),
        change: new Chart(canvas("dCp"), "Change of Cp", "%", 100, false),
      },
    ];
  }

  /** @param {Spectra} spectra @param {{magnitude: number, phase: number}} noise @param {number} marked Hz */
  draw(spectra, noise, marked) {
    const f = this.frequencies;
    for (const { of, turned, itself, change } of this.shown) {
      const values = (/** @type {Complex[]} */ Z) => Z.map((z, k) => of(z, f[k]));
      const [rest, last, now, held] = [
        values(spectra.rest),
        values(spectra.last),
        values(spectra.now),
        values(spectra.heldAgainst),
      ];
      const off = spectra.now.map(
        (z) => BAND * Math.hypot(noise.magnitude, turned(z) * noise.phase),
      );
      itself.draw(
        f,
        curves(
          rest,
          last,
          now,
          off.map((part, k) => Math.abs(part * now[k])),
        ),
        marked,
      );
      change.draw(
        f,
        curves(
          rest.map(() => 0),
          last.map((value, k) => value / rest[k] - 1),
          now.map((value, k) => value / held[k] - 1),
          off,
        ),
        marked,
      );
    }
  }

  /** Readings at one frequency in words. @param {Spectra} spectra @param {number} at its number */
  inWords(spectra, at) {
    const [f, Z] = [this.frequencies[at], spectra.now[at]];
    const [Rs, Cp] = [withPrefix(Z.re, "ohm"), withPrefix(parallelCapacitance(Z, f), "F")];
    return `At ${withPrefix(f, "Hz")}: Rs ${Rs}, Cp ${Cp}. Bands hold 19 of 20 readings.`;
  }
}

/** @param {number[]} rest @param {number[]} last @param {number[]} now @param {number[]} off @returns {Curve[]} */
function curves(rest, last, now, off) {
  const low = now.map((value, k) => value - off[k]);
  const high = now.map((value, k) => value + off[k]);
  return [
    { kind: "rest", values: rest },
    ...(last.length ? [/** @type {Curve} */ ({ kind: "last", values: last })] : []),
    { kind: "now", values: now, low, high },
  ];
}
